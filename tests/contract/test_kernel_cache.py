"""A cache of compiled kernels is never stale: its folder's name holds all that they are made of."""

import re
import shutil
from pathlib import Path

import pytest

import rps_exudyn
from rps_exudyn.base.compiled import fingerprint

PACKAGE = Path(rps_exudyn.__file__).parent


@pytest.fixture
def package(tmp_path: Path) -> Path:
    return Path(shutil.copytree(PACKAGE, tmp_path / "package", ignore=shutil.ignore_patterns("__pycache__")))


def test_copy_has_the_same_fingerprint(package: Path) -> None:
    assert fingerprint(package) == fingerprint(PACKAGE)


def test_swapped_entries_of_a_table_change_it(package: Path) -> None:
    """Kernels know the entries by number; the file that numbers them compiles nothing itself."""
    table = package / "mesh_contact" / "flank_data.py"
    text = table.read_text(encoding="utf-8")
    swapped = re.sub(r"\bSTIFFNESS,\n    DAMPING,", "DAMPING,\n    STIFFNESS,", text, count=1)
    assert swapped != text
    table.write_text(swapped, encoding="utf-8")
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


def test_what_is_not_compiled_leaves_it(package: Path) -> None:
    with (package / "cli" / "commands.py").open("a", encoding="utf-8") as source:
        source.write("# changed\n")
    assert fingerprint(package) == fingerprint(PACKAGE)
