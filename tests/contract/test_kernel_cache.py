"""A cache of compiled kernels is never stale: its folder's name holds all that they are made of."""

import ast
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import rps_exudyn
from rps_exudyn.base.compiled import KERNEL_SOURCES, fingerprint

PACKAGE = Path(rps_exudyn.__file__).parent


@pytest.fixture
def package(tmp_path: Path) -> Path:
    return Path(shutil.copytree(PACKAGE, tmp_path / "package", ignore=shutil.ignore_patterns("__pycache__")))


def test_copy_has_the_same_fingerprint(package: Path) -> None:
    assert fingerprint(package) == fingerprint(PACKAGE)


def test_swapped_fields_change_it(package: Path) -> None:
    """Kernels know the fields of a NamedTuple by number; the file that declares them compiles nothing itself."""
    declared = package / "mesh_contact" / "flank_data.py"
    text = declared.read_text(encoding="utf-8")
    swapped = text.replace(
        "    stiffness: float\n    damping: float\n", "    damping: float\n    stiffness: float\n"
    )
    assert swapped != text
    declared.write_text(swapped, encoding="utf-8")
    assert fingerprint(package) != fingerprint(PACKAGE)


@pytest.mark.parametrize(
    "name",
    [
        "forces/force_element.py",
        "forces/rigid_motion.py",
        "solvers/gear_kernel.py",
        "solvers/path_follower.py",
    ],
)
def test_any_kernel_source_changes_it(package: Path, name: str) -> None:
    with (package / name).open("a", encoding="utf-8") as source:
        source.write("# changed\n")
    assert fingerprint(package) != fingerprint(PACKAGE)


def test_all_that_kernels_read_is_covered() -> None:
    """Every module that compiles something, and every module whose names compiled code uses, is fingerprinted."""
    covered = {source for pattern in KERNEL_SOURCES for source in PACKAGE.glob(pattern)}
    makers = {"kernel", "inlined", "kernel_over"}
    for source in PACKAGE.rglob("*.py"):
        imports = [
            node
            for node in ast.walk(tree := ast.parse(source.read_text(encoding="utf-8")))
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("rps_exudyn.")
        ]
        origin = {alias.asname or alias.name: node.module for node in imports for alias in node.names}
        if not makers & origin.keys():
            continue
        assert source in covered, f"{source} is not fingerprinted"
        for function in ast.walk(tree):
            if isinstance(function, ast.FunctionDef) and _is_compiled(function, makers):
                used = {node.id for node in ast.walk(function) if isinstance(node, ast.Name)} & origin.keys()
                for name in used:
                    path = PACKAGE.parent / f"{str(origin[name]).replace('.', '/')}"
                    homes = {path.with_suffix(".py"), path / f"{name}.py"}
                    assert homes & covered, f"{name} of {origin[name]}, used in {source}"


def _is_compiled(function: ast.FunctionDef, makers: set[str]) -> bool:
    """Whether a function is decorated with one of the makers, or is an untyped one inside a typed one."""
    decorators = {node.id for node in function.decorator_list if isinstance(node, ast.Name)}
    return bool(decorators & makers) or function.returns is None


def test_second_process_compiles_nothing() -> None:
    """The handle on the gear's constants and what takes it come from the cache, in a process that starts anew."""
    for _ in range(2):
        done = subprocess.run([sys.executable, "-c", COUNT], check=True, capture_output=True, text=True)
    assert done.stdout.split() == ["0", "1", "0", "2"]


COUNT = """
import numpy as np
from rps_exudyn.base import compiled
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.gear_forces import gear_forces

force, handle = gear_forces(SteeringGear(), Fidelity(yoke="force")).dynamics
force(np.zeros(8), np.zeros(8), handle)
for stats in (force.stats, compiled._new_handle.stats):
    print(sum(stats.cache_misses.values()), sum(stats.cache_hits.values()))
"""


def test_what_is_not_compiled_leaves_it(package: Path) -> None:
    with (package / "cli" / "commands.py").open("a", encoding="utf-8") as source:
        source.write("# changed\n")
    assert fingerprint(package) == fingerprint(PACKAGE)
