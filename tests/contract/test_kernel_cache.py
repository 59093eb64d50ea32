"""A cache of compiled kernels is never stale: its folder's name holds all that they are made of."""

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import rps_exudyn
from rps_exudyn.base.kernel_cache import KERNEL_SOURCES, fingerprint

PACKAGE = Path(rps_exudyn.__file__).parent


@pytest.fixture
def package(tmp_path: Path) -> Path:
    return Path(shutil.copytree(PACKAGE, tmp_path / "package", ignore=shutil.ignore_patterns("__pycache__")))


def test_copy_has_the_same_fingerprint(package: Path) -> None:
    assert fingerprint(package) == fingerprint(PACKAGE)


def test_swapped_fields_change_it(package: Path) -> None:
    """Kernels know the fields of a NamedTuple by number; the file that declares them compiles nothing."""
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
    """Every module that compiles something is fingerprinted, and every module whose names it uses in that."""
    covered = {source for pattern in KERNEL_SOURCES for source in PACKAGE.glob(pattern)}
    seen = 0
    for source in PACKAGE.rglob("*.py"):
        tree = ast.parse(source.read_text(encoding="utf-8"))
        imports = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
        origin = {alias.name: f"{node.module}" for node in imports for alias in node.names}
        if not MAKERS & origin.keys():
            continue
        assert source in covered, f"{source} is not fingerprinted"
        for name in _used_by_kernels(tree) & origin.keys():
            if origin[name].startswith("rps_exudyn."):
                home = PACKAGE.parent / origin[name].replace(".", "/")
                assert {home.with_suffix(".py"), home / f"{name}.py"} & covered, f"{name}, used in {source}"
                seen += 1
    assert seen > 50


MAKERS = {"kernel", "apart", "inlined", "kernel_over"}


def _used_by_kernels(tree: ast.AST) -> set[str]:
    """Names in compiled functions, decorated or untyped as the closures of `kernel_over` are."""
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef) and not node.returns]
    nodes = [node for function in functions for node in ast.walk(function)]
    return {node.id for node in nodes if isinstance(node, ast.Name)} - MAKERS


def test_one_process_compiles_and_all_compute_the_same(tmp_path: Path) -> None:
    """The gear's force and the handle on its constants come from the cache in a process that starts anew, and
    the force is the same bit for bit: no multiply-add is fused in one and not in the other. A damaged cache
    is reported once, and what is missing is compiled again.
    """
    empty = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    empty["XDG_CACHE_HOME"] = str(tmp_path)

    def run() -> tuple[str, list[str], str]:
        done = subprocess.run(
            [sys.executable, "-c", FORCE], check=True, capture_output=True, text=True, env=empty
        )
        force, *counts = done.stdout.split()
        return force, counts, done.stderr

    compiled, loaded = run(), run()
    assert (compiled[1], loaded[1]) == (["1", "0", "1", "0"], ["0", "1", "0", "1"])
    for pattern, damage in (("*.nbc", lambda old: old[:-40] + bytes(40)), ("*.nbi", lambda old: old[:30])):
        for file in sorted(tmp_path.rglob(pattern))[:2]:
            file.write_bytes(damage(file.read_bytes()))
    mended, mended_again = run(), run()
    assert mended[2].count("is damaged; what is missing is compiled again") == 1
    assert compiled[2] == loaded[2] == mended_again[2] == ""
    assert compiled[0] == loaded[0] == mended[0] == mended_again[0]


FORCE = """
import numpy as np
from rps_exudyn.base import compiled
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.equilibrium import starting_guess, steady_rates
from rps_exudyn.solvers.gear_forces import gear_forces

gear = SteeringGear()
pair = GearPair.of(gear)
force, handle = gear_forces(gear, Fidelity().replace({"mesh": "ratio", "yoke": "force"})).dynamics
print(force(starting_guess(pair, 0.3), steady_rates(pair, gear.test.speed), handle).tobytes().hex())
for stats in (force.stats, compiled._new_handle.stats):
    print(sum(stats.cache_misses.values()), sum(stats.cache_hits.values()))
"""


def test_what_is_not_compiled_leaves_it(package: Path) -> None:
    with (package / "cli" / "commands.py").open("a", encoding="utf-8") as source:
        source.write("# changed\n")
    assert fingerprint(package) == fingerprint(PACKAGE)
