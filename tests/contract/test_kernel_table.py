"""The table of kernels, from which totals of progress bars follow, lists what there is.

Where a test here fails, kernels were renamed, added or removed: `python benchmarks/make.py kernel_table`.
"""

import ast
from functools import cache
from pathlib import Path

import pytest

import rps_exudyn
from benchmarks.kernel_table import WORKS
from rps_exudyn.base.kernel_table import KernelTable, kernel_table

PACKAGE = Path(rps_exudyn.__file__).parent
NO_KERNEL = {  # works that are refused: their scene needs inertia
    "stick-slip quasi-static",
    "yoke-impact quasi-static",
    "rattle quasi-static",
}


@cache
def functions(module: str) -> tuple[str, ...]:
    """Names of all functions in a module of the package."""
    tree = ast.parse((PACKAGE / module.replace(".", "/")).with_suffix(".py").read_text(encoding="utf-8"))
    return tuple(node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef))


def test_each_kernel_of_the_table_is_in_the_package() -> None:
    """By its name, or where it closes over other kernels by its name and theirs."""
    for kernel in kernel_table().seconds:
        module, _, name = kernel.rpartition(".")
        made = (name == each or name.startswith(f"{each}_") for each in functions(module))
        assert any(made), f"{module} has no {name}"


def test_each_scene_has_its_kernels_with_each_preset() -> None:
    assert set(kernel_table().works) == set(WORKS) - NO_KERNEL
    for work in kernel_table().works:
        assert kernel_table().kernels(work).total() > 30, work


def test_a_model_beside_the_presets_is_taken_for_its_preset() -> None:
    table = kernel_table()
    assert table.kernels("load-test full with bush rigid") == table.kernels("load-test full")
    assert not table.kernels("own-scene flank")


def test_table_is_read_as_it_is_written() -> None:
    table = kernel_table()
    again = KernelTable.from_dict(table.as_dict())
    assert {work: again.kernels(work) for work in table.works} == {
        work: table.kernels(work) for work in table.works
    }
    assert again.seconds == pytest.approx(table.seconds, abs=1e-3)
