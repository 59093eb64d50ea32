"""The cache of compiled kernels holds only what this process would compile."""

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

import rps_exudyn
from rps_exudyn.base.kernel_cache import KERNEL_SOURCES, fingerprint

PACKAGE = Path(rps_exudyn.__file__).parent


@pytest.fixture
def package(tmp_path: Path) -> Path:
    return Path(
        shutil.copytree(PACKAGE, tmp_path / "rps_exudyn", ignore=shutil.ignore_patterns("__pycache__"))
    )


def test_copy_has_the_same_fingerprint(package: Path) -> None:
    assert fingerprint(package) == fingerprint(PACKAGE)


@pytest.mark.parametrize(
    "name",
    [
        "forces/bearing.py",  # a record's fields, which kernels read by their places
        "forces/rigid_motion.py",
        "tooth_contact/flank_data.py",
        "solvers/gear_model.py",
        "solvers/follower.py",
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


MAKERS = {"kernel", "kernel_of", "inline"}


def _used_by_kernels(tree: ast.AST) -> set[str]:
    """Names in compiled functions, whose arguments and result have no types."""
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef) and not node.returns]
    nodes = [node for function in functions for node in ast.walk(function)]
    return {node.id for node in nodes if isinstance(node, ast.Name)} - MAKERS


def test_only_what_this_process_would_compile_is_loaded(package: Path) -> None:
    """The first process compiles, the second loads, and the force is the same bit for bit. Files that are
    damaged, foreign or of other sources are removed before numba reads them, and made again."""
    folder = package / "solvers" / "__pycache__"
    compiled, loaded = _force_by(package), _force_by(package)
    assert (compiled.misses, compiled.hits) == (1, 0)
    assert (loaded.misses, loaded.hits) == (0, 1)
    index, code = (next(folder.glob(f"follower.add_column_to-*.{kind}")) for kind in ("nbi", "nbc"))

    damages = {
        index: index.read_bytes()[:30],  # numba alone: UnpicklingError
        code: bytes(reversed(code.read_bytes())),
    }
    for file, content in damages.items():
        file.write_bytes(content)
        mended = _force_by(package)
        assert (mended.misses, mended.hits, mended.force) == (1, 0, compiled.force), file.suffix

    foreign = folder / "follower.add_column_to-1.py311.nbi"
    foreign.write_bytes(b"code of others")
    assert (_force_by(package).hits, foreign.exists()) == (1, False)

    with (package / "forces" / "bearing.py").open("a", encoding="utf-8") as source:
        source.write("# changed\n")
    outdated = _force_by(package)
    assert (outdated.misses, outdated.hits, outdated.force) == (1, 0, compiled.force)
    assert loaded.force == compiled.force


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="no modes of folders here")
def test_a_folder_that_others_can_write_to_holds_no_cache(tmp_path: Path) -> None:
    script = """
import sys
from pathlib import Path
from rps_exudyn.base import kernel_cache
kernel_cache.PACKAGE = Path(sys.argv[1])
exec(compile("def twice(x):\\n    return 2 * x\\n", sys.argv[1] + "/base/roots.py", "exec"))
made = kernel_cache.compiled(twice)
print(made(1.0), made.stats.cache_path)
"""
    source = tmp_path / "base" / "roots.py"
    source.parent.mkdir()
    source.write_text("", encoding="utf-8")
    folder = source.parent / "__pycache__"
    folder.mkdir()
    for mode, holds in ((0o777, False), (0o755, True)):
        folder.chmod(mode)
        done = subprocess.run(
            [sys.executable, "-c", script, tmp_path], check=True, capture_output=True, text=True
        )
        assert done.stdout.split() == ["2.0", str(folder) if holds else "None"]
        assert bool(list(folder.glob("*.nbi"))) == holds


def test_a_process_that_is_killed_leaves_its_kernels_to_the_next(tmp_path: Path) -> None:
    """What has no stamp is removed, so that each is stamped once it is compiled, not at the end."""
    script = """
import os
import sys
from pathlib import Path
from rps_exudyn.base import kernel_cache
from rps_exudyn.base.compiled import called
kernel_cache.PACKAGE = Path(sys.argv[1])
exec(compile("def twice(x):\\n    return 2 * x\\n", sys.argv[1] + "/base/roots.py", "exec"))
made = kernel_cache.compiled(twice)
called(made, 1.0)
print(sum(made.stats.cache_hits.values()), flush=True)
os._exit(0)
"""
    source = tmp_path / "base" / "roots.py"
    source.parent.mkdir()
    source.write_text("", encoding="utf-8")
    runs = (
        subprocess.run([sys.executable, "-c", script, tmp_path], check=True, capture_output=True, text=True)
        for _ in range(2)
    )
    assert [run.stdout.strip() for run in runs] == ["0", "1"]


class Force(NamedTuple):
    """The force of a steering column, of a process that starts anew, and how often its kernel was compiled
    and loaded."""

    force: str
    misses: int
    hits: int


def _force_by(package: Path) -> Force:
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    environment["PYTHONPATH"] = str(package.parent)
    done = subprocess.run(
        [sys.executable, "-c", FORCE],
        check=True,
        capture_output=True,
        text=True,
        env=environment,
        cwd=package.parent,
    )
    force, misses, hits = done.stdout.split()
    return Force(force, int(misses), int(hits))


FORCE = """
import numpy as np
from rps_exudyn.base.compiled import ready
from rps_exudyn.solvers.follower import add_column_to

column = np.array([1.0, 100.0, 0.2, 0.5, 0.3, 0.0, 0.0])
total, tangent = np.zeros(9), np.zeros((9, 9))
masses, before = np.diag(np.linspace(0, 0.1, 9)), np.zeros(9)
at = np.linspace(0, 1, 9), np.linspace(1, 0, 9), column, 4.0, masses, before
ready(add_column_to)(*at, 10.0, 1.0, total, tangent)
print((total.tobytes() + tangent.tobytes()).hex())
for counts in (add_column_to.stats.cache_misses, add_column_to.stats.cache_hits):
    print(sum(counts.values()))
"""


def test_what_is_not_compiled_leaves_it(package: Path) -> None:
    with (package / "cli" / "commands.py").open("a", encoding="utf-8") as source:
        source.write("# changed\n")
    assert fingerprint(package) == fingerprint(PACKAGE)
