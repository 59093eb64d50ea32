"""The shipped code of kernels is that of their sources, needs C's library alone, and is only run intact."""

import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from threading import Barrier

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.base import kernel_code
from rps_exudyn.base.compiled import VECTOR, Entry, entry, inline
from rps_exudyn.base.kernel_code import EXTERNALS, fingerprint, reason_not_usable
from rps_exudyn.base.kernel_compiler import shipped_entries
from rps_exudyn.solvers.bent_rack import fill_local_poses
from rps_exudyn.solvers.follower import add_column_to

ENTRIES = shipped_entries()
HERE = reason_not_usable(add_column_to)
shipped_here = pytest.mark.skipif("is" in HERE and "this is" in HERE, reason=HERE)


@shipped_here
def test_shipped_code_is_that_of_the_sources() -> None:
    """`python -m rps_exudyn.base.kernel_compiler` writes it anew, see CONTRIBUTING.md."""
    assert {entry.name: reason_not_usable(entry) for entry in ENTRIES if reason_not_usable(entry)} == {}
    assert set(kernel_code.marks()) == {"platform", *(entry.name for entry in ENTRIES)}


def test_shipped_code_needs_nothing_but_the_library_of_c() -> None:
    text = kernel_code._shipped()
    declared = set(re.findall(r"^declare .*@([\w.]+)\(", text, re.M))
    assert {name for name in declared if not name.startswith("llvm.")} <= set(EXTERNALS)
    assert not re.findall(r"^@.* = external", text, re.M)
    assert set(re.findall(r"^define [^@]*@([a-z][\w.]+)\(", text, re.M)) == {each.name for each in ENTRIES}


# --- what the fingerprint covers

SOURCE = '''
@inline
def part(x):
    """Half of it."""
    return x / FACTOR  # a reason
'''


def law_of(source: str, factor: float = 2.0, folder: Path | None = None) -> Entry:
    """An entry that calls a function of this source."""
    assert folder
    file = folder / f"law{len(list(folder.iterdir()))}.py"
    file.write_text(source, encoding="utf-8")
    names = {"inline": inline, "FACTOR": factor, "__name__": "law"}
    exec(compile(source, str(file), "exec"), names)

    def law(x):  # type: ignore[no-untyped-def]
        x[0] = part(x[0])  # noqa: F821

    law.__globals__["part"] = names["part"]
    return entry(VECTOR)(law)


def test_words_for_readers_do_not_change_the_fingerprint_and_all_else_does(tmp_path: Path) -> None:
    def mark(source: str, factor: float = 2.0) -> str:
        return fingerprint(law_of(source, factor, tmp_path))

    own = mark(SOURCE)
    assert mark(SOURCE.replace("Half of it", "The half").replace("a reason", "another one")) == own
    assert mark(SOURCE.replace("x / FACTOR", "x * FACTOR")) != own
    assert mark(SOURCE, factor=3.0) != own


# --- object files


def force_by(cache: Path, change: str = "") -> list[str]:
    """Call an entry in a new process; return what was said, and what it computed."""
    script = f"""
import numpy as np
from rps_exudyn.base import kernel_code
from rps_exudyn.base.progress import listening
from rps_exudyn.solvers.follower import add_column_to
{change}
column, total, tangent = np.array([1.0, 50.0, 0.2, 0.3, 0.1, 2e4, 1e-3]), np.zeros(9), np.zeros((9, 9))
q, v = np.linspace(0.01, 0.09, 9), np.linspace(-0.5, 0.5, 9)
with listening(lambda step: print(step.sentence)):
    add_column_to(q, v, column, 0.4, np.zeros((0, 0)), np.zeros(9), 10.0, 1.0, total, tangent)
print(total.tobytes().hex(), tangent.tobytes().hex())
"""
    environment = os.environ | {kernel_code.CACHE: str(cache)}
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, env=environment
    )
    return done.stdout.split("\n")[:-1]


PREPARING = "Preparing force laws for this machine, once"


@shipped_here
def test_only_intact_object_files_are_loaded(tmp_path: Path) -> None:
    made, loaded = force_by(tmp_path), force_by(tmp_path)
    assert (made[0], len(loaded)) == (PREPARING, 1)
    assert loaded[-1] == made[-1]
    (file,) = tmp_path.glob("*/kernels-*/*.o")
    content = file.read_bytes()
    for damage in (b"", content[:100], content[::-1], b"code of others"):
        file.write_bytes(damage)
        assert force_by(tmp_path) == made
        assert file.read_bytes() == content


@shipped_here
def test_each_processor_has_its_own(tmp_path: Path) -> None:
    made = force_by(tmp_path)
    other = "from llvmlite import binding\nbinding.get_host_cpu_name = lambda: 'x86-64'"
    assert force_by(tmp_path, other) == made
    assert len(force_by(tmp_path)) == 1
    assert len(list(tmp_path.glob("*/kernels-*/*.o"))) == 2


@shipped_here
def test_code_of_other_sources_goes(tmp_path: Path) -> None:
    force_by(tmp_path)
    (folder,) = tmp_path.glob("*/kernels-*")
    (other := folder.with_name("kernels-0123456789abcdef")).mkdir()
    force_by(tmp_path)
    assert (folder.exists(), other.exists()) == (True, False)


@shipped_here
@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="no modes of folders here")
def test_a_folder_that_others_can_write_to_holds_none(tmp_path: Path) -> None:
    force_by(tmp_path)
    (folder,) = tmp_path.glob("*/kernels-*")
    folder.chmod(0o777)
    assert force_by(tmp_path)[0] == PREPARING


@shipped_here
def test_without_a_folder_code_is_made_for_each_process(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for _ in range(2):
        assert force_by(tmp_path / "file")[0] == PREPARING


@shipped_here
@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ("kernel_code.SHIPPED = kernel_code.Path('nowhere')", "nowhere is damaged or missing"),
        ("kernel_code.SHIPPED = kernel_code.Path(kernel_code.__file__)", "is damaged or missing"),
        (
            "kernel_code.platform_of = lambda _: 'riscv64-linux'",
            "and this is riscv64-linux",
        ),
        ("kernel_code.fingerprint = lambda _: ''", "of other sources"),
        ("kernel_code.LLVM = (99, 0)", "llvmlite is older"),
    ],
)
def test_where_it_does_not_fit_numba_makes_the_same_and_says_why(
    tmp_path: Path, change: str, reason: str
) -> None:
    made = force_by(tmp_path, change)
    assert made[0].startswith("Compiling force laws, once, which takes about a minute: ")
    assert reason in made[0]
    assert made[-1] == force_by(tmp_path / "shipped")[-1]
    assert len(force_by(tmp_path, change)) == 1  # it is kept


def test_threads_may_need_the_same_kernel_first() -> None:
    """Sixteen threads begin with an entry that no thread has loaded."""
    begun, cold = Barrier(16), Entry(add_column_to.py_func, add_column_to.arguments)

    def run(_: int) -> float:
        total, tangent = np.zeros(9), np.zeros((9, 9))
        begun.wait()
        column = np.array([1.0, 50.0, 0.2, 0.3, 0.1, 2e4, 1e-3])
        cold(np.ones(9), np.ones(9), column, 0.4, np.zeros((0, 0)), np.zeros(9), 1.0, 1.0, total, tangent)
        return float(total[0])

    with ThreadPoolExecutor(begun.parties) as threads:
        assert len(set(threads.map(run, range(begun.parties)))) == 1


def test_processes_may_need_the_same_kernel_first(tmp_path: Path) -> None:
    with ThreadPoolExecutor(4) as threads:
        answers = list(threads.map(force_by, [tmp_path] * 4))
    assert len({answer[-1] for answer in answers}) == 1
    assert len(list(tmp_path.glob("*/kernels-*/*"))) == 1


# --- calls


@pytest.mark.parametrize(
    "wrong", [np.zeros((3, 8), dtype=np.float32), np.zeros(8), np.zeros((8, 3)).T, np.zeros((3, 3, 8))]
)
def test_arrays_of_other_types_are_refused(wrong: np.ndarray) -> None:
    bars = np.zeros(1, fill_local_poses.arguments[4].dtype)
    with pytest.raises(TypeError, match="without gaps"):
        fill_local_poses(wrong, np.zeros((3, 8)), 0.0, 0.0, bars, np.zeros(1), np.zeros((3, 3, 6)))


def test_too_few_arguments_are_refused() -> None:
    with pytest.raises(ValueError, match="shorter"):
        fill_local_poses(np.zeros((3, 8)))


def test_a_run_imports_no_numba() -> None:
    script = """
import sys
import rps_exudyn as rps
rps.run("free-pinion-torque", fidelity="quasi-static")
print("numba" in sys.modules, rps.run("free-pinion-torque", fidelity="quasi-static").status)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == f"{bool(HERE)} ok"


# --- the same as numba's


RUNS = [
    ({"mesh.law": "line"}, {}),
    ({"mesh.law": "teeth"}, {}),
    ({"mesh.law": "line", "rack.bow": 5e-5}, {}),
    ({"mesh.law": "teeth", "rack.bow": 5e-5}, {"pinion": "supported"}),
    ({}, {"mesh": "general-contact"}),
    ({}, {"mesh": "triangles"}),
    ({"rack.bow": 5e-5}, {"mesh": "general-contact"}),
    ({"mesh.law": "line", "mesh.friction_law": "bristle"}, {}),
]


def law_values(settings: dict[str, object], fidelity: dict[str, object]) -> list[np.ndarray]:
    """Forces, tangents and outputs of a gear at random states about its rest, and a path that it follows."""
    from rps_exudyn.solvers.gear_forces import gear_forces

    gear = rps.SteeringGear().replace(settings)
    forces = gear_forces(gear, rps.Fidelity.preset("quasi-static").replace(fidelity))
    balance, random = forces.statics, np.random.default_rng(1)
    found = [np.array([forces.approach])]
    for _ in range(20):
        q, v = random.normal(0, 5e-6, balance.size), random.normal(0, 1e-3, balance.size)
        q[0] = random.uniform(-3, 3)
        found += [*balance.force_and_tangent(q, v, 1.0, 200.0), np.array(balance.works[0]["out"])]
    run = rps.run("free-pinion-torque", gear, fidelity="quasi-static", turns=1)
    return [*found, *(np.asarray(signal) for signal in run.signals.values())]


@shipped_here
def test_all_laws_are_those_of_numba_bit_for_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    from rps_exudyn.base import kernel_compiler

    shipped = [law_values(*each) for each in RUNS]
    for each in ENTRIES:
        vars(each).pop("address", None)
        vars(each).pop("_code", None)
    monkeypatch.setattr(kernel_code, "address_of", kernel_compiler.address_of)
    compiled = [law_values(*each) for each in RUNS]
    for each in ENTRIES:
        vars(each).pop("address", None)
        vars(each).pop("_code", None)
    same = partial(np.array_equal, equal_nan=True)
    for pair in zip(shipped, compiled, strict=True):
        assert all(map(same, *pair))
