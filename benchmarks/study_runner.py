"""The runner of studies: time of many cases, memory, two processes against one, killed processes, storing.

Studies are run by the command line, in a temporary folder. What other processes do on the machine at the same
time lengthens elapsed times; CPU times and ratios suffer less.
"""

import contextlib
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

import rps_exudyn as rps
from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.block import CaseRecord, Keep, packed
from rps_exudyn.study.store import Store

DATA = "runner.json"
GRID = """
scene = "free-pinion-torque"
fidelity = "quasi-static"
{set}
[[axis]]
path = "yoke.preload"
linspace = ["100 N", "600 N", {first}]
[[axis]]
path = "mesh.friction"
linspace = [0.03, 0.1, {second}]
[[axis]]
path = "yoke.friction"
linspace = [0.03, 0.1, {third}]
[keep]
samples = {samples}
"""
SLOW = """
scene = "load-test"
fidelity = "flank"
[set]
test.turns = 1.5
[[axis]]
path = "yoke.preload"
linspace = ["200 N", "400 N", 40]
[keep]
signals = "none"
"""
COMMAND = [sys.executable, "-m", "rps_exudyn", "study"]
Measured = list[tuple[str, str]]
"""What was measured, and the number with its unit."""


def run(folder: Path, sizes: Mapping[str, Mapping[str, Any]] = MappingProxyType({})) -> None:
    """Make all measurements, or those named in `sizes` with these arguments."""
    rows: Measured = [("load of the machine before", f"{os.getloadavg()[0]:.2f}")]
    for name in sizes or MEASUREMENTS:
        with tempfile.TemporaryDirectory() as studies:
            rows += MEASUREMENTS[name](Path(studies), **sizes.get(name, {}))
        print(*rows[-1], sep=": ", flush=True)
    save_data(folder / DATA, {"rows": rows})


def many_cases(folder: Path, sides: tuple[int, int, int] = (10, 10, 10)) -> Measured:
    """Quasi-static cases of one turn, summary and 61 samples of every signal stored."""
    rows = []
    for jobs in (2, 1):
        file = written(folder, f"many_{jobs}", grid(sides, samples=61))
        seen = watched(file, folder / file.stem, jobs)
        number = f"{np.prod(sides)} quasi-static cases of one turn, {jobs} processes"
        rows.append((number, f"{seen['wall']:.1f} s, {seen['cpu']:.1f} s of CPU time"))
    return rows


def memory(folder: Path, sides: tuple[tuple[int, int, int], ...] = ((10, 10, 10), (25, 20, 20))) -> Measured:
    """The parent's memory over the number of cases."""
    rows = []
    for each in sides:
        file = written(folder, f"memory_{np.prod(each)}", grid(each, samples=2))
        seen = watched(file, folder / file.stem, 2)
        rows.append((f"memory of the parent, {np.prod(each)} cases", f"{seen['memory']:.0f} MB"))
    return rows


def scaling(folder: Path) -> Measured:
    """Two processes against one, the quicker of two runs each, and what the machine allows at this time."""
    file = written(folder, "slow", SLOW)
    walls = [
        min(watched(file, folder / f"slow_{repeat}_{jobs}", jobs)["wall"] for repeat in range(2))
        for jobs in (1, 2)
    ]
    found = f"{walls[0] / walls[1]:.2f} ({walls[0]:.1f} s and {walls[1]:.1f} s)"
    loops = f"{2 * spinning(1) / spinning(2):.2f}"
    return [
        ("two processes against one, 40 cases of a second", found),
        ("two empty loops against one", loops),
    ]


def kills(folder: Path, number: int = 25) -> Measured:
    """SIGKILL of the parent or of a worker at random moments, and the study's end compared with another's."""
    settings = '[set]\npinion.runout = "10 um"\nfidelity.step_angle = "0.03 deg"'
    file = written(folder, "kills", grid((8, 5, 5), samples=181, settings=settings))
    watched(file, folder / "undisturbed", 2)
    seen = killed(file, folder / "disturbed", number)
    what = f"200 cases after {seen['parent']} kills of the parent and {seen['worker']} of a worker"
    return [(what, compared(folder / "undisturbed", folder / "disturbed"))]


def killed(file: Path, out: Path, number: int, pause: tuple[float, float] = (0.3, 3.0)) -> Counter[str]:
    """Run a study to its end under so many SIGKILLs, after random pauses [s]; count whom they hit."""
    chance = random.Random(1)
    hit: Counter[str] = Counter()
    process = started(file, out, 2)
    while hit.total() < number:
        time.sleep(chance.uniform(*pause))
        if process.poll() is not None:
            break  # the study is done
        victim = chance.choice(("parent", "worker"))
        target = chance.choice(children(process.pid) or [0]) if victim == "worker" else process.pid
        if not target:  # none has been started yet
            continue
        with contextlib.suppress(ProcessLookupError):
            os.kill(target, signal.SIGKILL)
        hit[victim] += 1
        if victim == "parent":
            process.wait()
            process = started(file, out, 2)
    process.wait()
    return hit


def storing(folder: Path, cases: int = 50) -> Measured:
    """Return what a case costs beyond its simulation: in a block, and as a file of its own."""
    gear, rows = SteeringGear(), []
    gears = [gear.replace({"yoke.preload": 300.0 + k}) for k in range(cases)]
    results = [rps.run("free-pinion-torque", each, fidelity="quasi-static") for each in gears]
    for keep in (Keep(), Keep(samples=61), Keep(signals=())):
        thin = [keep.of(result) for result in results]
        start = time.perf_counter()
        (folder / "block.h5").write_bytes(packed([CaseRecord.of(f"{k:016x}", r) for k, r in enumerate(thin)]))
        each = 1e3 * (time.perf_counter() - start) / cases
        start = time.perf_counter()
        for result in thin[:10]:
            result.save(folder / "single.h5")
        single = 1e3 * (time.perf_counter() - start) / len(thin[:10])
        shape = f"{len(thin[0].signals)} signals of {len(thin[0].signals.get('time', ()))} values"
        rows.append((f"storing a case, {shape}: in a block; as a file", f"{each:.1f} ms; {single:.0f} ms"))
    return rows


# --- studies -----------------------------------------------------------------------------------
def grid(sides: tuple[int, int, int], samples: int, settings: str = "") -> str:
    """A study over preload and both frictions."""
    first, second, third = sides
    return GRID.format(set=settings, first=first, second=second, third=third, samples=samples)


def written(folder: Path, name: str, text: str) -> Path:
    """Write a study file."""
    file = folder / f"{name}.toml"
    file.write_text(text)
    return file


def started(file: Path, out: Path, jobs: int) -> "subprocess.Popen[bytes]":
    """Start a study in a process of its own."""
    command = [*COMMAND, str(file), "--out", str(out), "--jobs", str(jobs), "--yes"]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL)


def watched(file: Path, out: Path, jobs: int) -> dict[str, float]:
    """Wall and CPU time [s] of a whole study, and the greatest memory of its parent process [MB]."""
    start, before = time.perf_counter(), os.times()
    process, most = started(file, out, jobs), 0.0
    while process.poll() is None:
        most = max(most, peak_memory(process.pid))
        time.sleep(0.1)
    after = os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    return {"wall": time.perf_counter() - start, "cpu": cpu, "memory": most}


def peak_memory(pid: int) -> float:
    """Greatest memory of a process until now [MB]."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0.0
    return next((float(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM")), 0.0)


def children(pid: int) -> list[int]:
    """Process numbers of its children."""
    try:
        return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []


def compared(first: Path, second: Path) -> str:
    """Every number of two studies."""
    one, other = Store.open(first), Store.open(second)
    differing, signals = 0, 0
    ours = {case.hash: result for case, result in other.results()}
    for case, result in one.results():
        again = ours[case.hash]
        alike = result.status is again.status and dict(result.summary) == dict(again.summary)
        alike &= result.signals.keys() == again.signals.keys()
        alike &= all(
            np.array_equal(values, again.signals[name], equal_nan=True)
            for name, values in result.signals.items()
        )
        signals += len(result.signals)
        differing += not alike
    unreadable = len(one.skipped) + len(other.skipped)
    return f"{len(ours)} present, {unreadable} unreadable, {differing} differ ({signals} signals bit for bit)"


def spinning(processes: int) -> float:
    """Time [s] for this many processes to count, one each."""
    code = "k = 0\nwhile k < 20_000_000: k += 1"
    start = time.perf_counter()
    running = [subprocess.Popen([sys.executable, "-c", code]) for _ in range(processes)]
    for process in running:
        process.wait()
    return time.perf_counter() - start


MEASUREMENTS = {
    "many_cases": many_cases,
    "memory": memory,
    "scaling": scaling,
    "kills": kills,
    "storing": storing,
}


def runner_table(folder: Path) -> str:
    """All measurements."""
    return markdown(("what", "found"), load_data(folder / DATA)["rows"])


TOPIC = Topic(
    "15 min",
    "study_runner",
    run,
    {"sizes": {"many_cases": {"sides": (2, 2, 2)}, "storing": {"cases": 2}}},
    {"study_runner": runner_table},
)
