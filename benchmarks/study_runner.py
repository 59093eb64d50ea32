"""The runner of studies, measured: `python studies/bench_studies.py [thousand memory scaling kills storing]`.

Prints the numbers of results/studies/README.md. Studies are run by the command line, in a temporary folder.
"""

import contextlib
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.case_file import FileForms, Keep, kept
from rps_exudyn.simulate import run as simulate
from rps_exudyn.study.store import Store

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


def main(chosen: list[str]) -> None:
    """The measurements of these names, or all."""
    print(f"load of the machine's {os.cpu_count()} cores before: {os.getloadavg()[0]:.2f}")
    for name in chosen or MEASUREMENTS:
        with tempfile.TemporaryDirectory() as folder:
            MEASUREMENTS[name](Path(folder))


def thousand(folder: Path) -> None:
    """1000 quasi-static cases of one turn, summary and 61 samples of every signal stored."""
    for jobs in (2, 1):
        file = written(
            folder, f"thousand_{jobs}", GRID.format(set="", first=10, second=10, third=10, samples=61)
        )
        run = watched(file, folder / file.stem, jobs)
        print(f"1000 cases, {jobs} jobs: {run['wall']:.1f} s, {run['cpu']:.1f} s of processors, "
              f"parent {run['memory']:.0f} MB; {statuses(folder / file.stem)}")  # fmt: skip


def memory(folder: Path) -> None:
    """The parent's memory over the number of cases."""
    for number, sides in {1000: (10, 10, 10), 10_000: (25, 20, 20)}.items():
        first, second, third = sides
        text = GRID.format(set="", first=first, second=second, third=third, samples=2)
        file = written(folder, f"memory_{number}", text)
        run = watched(file, folder / file.stem, 2)
        print(f"{number} cases, 2 jobs: parent {run['memory']:.0f} MB, {run['wall']:.0f} s")


def scaling(folder: Path) -> None:
    """Two processes against one, and what the machine allows at this time."""
    file = written(folder, "slow", SLOW)
    ratios = []
    for repeat in range(2):
        walls = {jobs: watched(file, folder / f"slow_{repeat}_{jobs}", jobs)["wall"] for jobs in (1, 2)}
        ideal = 2 * spinning(1) / spinning(2)
        ratios.append(walls[1] / walls[2])
        rows = [row.wall_s for _, row in Store.open(folder / f"slow_{repeat}_1").rows()]
        print(f"40 cases of {np.mean(rows):.2f} s: {walls[1]:.1f} s by one, {walls[2]:.1f} s by two, ratio "
              f"{ratios[-1]:.2f}; two empty loops against one: {ideal:.2f}")  # fmt: skip
    print(f"median ratio {np.median(ratios):.2f}")


def kills(folder: Path, number: int = 25) -> None:
    """SIGKILL of the parent or of a worker at random moments, and the study's end compared with another's."""
    base = '[set]\npinion.runout = "10 um"\nfidelity.step_angle = "0.03 deg"'
    text = GRID.format(set=base, first=8, second=5, third=5, samples=181)
    file = written(folder, "kills", text)
    watched(file, folder / "undisturbed", 2)
    chance = random.Random(1)
    killed = {"parent": 0, "worker": 0}
    process = started(file, folder / "disturbed", 2)
    while sum(killed.values()) < number:
        time.sleep(chance.uniform(0.3, 3.0))
        if process.poll() is not None:
            print(f"the study was done after {sum(killed.values())} kills")
            break
        victim = chance.choice(("parent", "worker"))
        target = chance.choice(children(process.pid) or [0]) if victim == "worker" else process.pid
        if not target:  # none has been started yet
            continue
        with contextlib.suppress(ProcessLookupError):
            os.kill(target, signal.SIGKILL)
        killed[victim] += 1
        if victim == "parent":
            process.wait()
            process = started(file, folder / "disturbed", 2)
    process.wait()
    print(f"{killed} killed; then {statuses(folder / 'disturbed')}")
    print(f"against the undisturbed study's {statuses(folder / 'undisturbed')}: "
          f"{compared(folder / 'undisturbed', folder / 'disturbed')}")  # fmt: skip


def storing(folder: Path) -> None:
    """What a case costs beyond its simulation: its file's bytes, their way to the disk, log and index."""
    gear, forms = SteeringGear(), FileForms()
    results = [
        simulate.run("free-pinion-torque", gear.replace({"yoke.preload": 300.0 + k}), fidelity="quasi-static")
        for k in range(51)
    ]
    for keep in (Keep(), Keep(samples=61), Keep(signals=())):
        thin = [kept(result, keep) for result in results]
        forms.content(thin[0])
        start = time.perf_counter()
        for number, result in enumerate(thin[1:]):
            (folder / f"{number}.h5").write_bytes(forms.content(result))
        fast = (time.perf_counter() - start) / 50
        start = time.perf_counter()
        for result in thin[1:11]:
            result.save(folder / "plain.h5")
        plain = (time.perf_counter() - start) / 10
        shape = f"{len(thin[0].signals)} signals of {len(thin[0].signals.get('time', ()))}"
        print(f"one file, {shape}: {1e3 * fast:.2f} ms, by Result.save {1e3 * plain:.1f} ms")


# --- studies -----------------------------------------------------------------------------------


def written(folder: Path, name: str, text: str) -> Path:
    file = folder / f"{name}.toml"
    file.write_text(text)
    return file


def started(file: Path, out: Path, jobs: int) -> "subprocess.Popen[bytes]":
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
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0.0
    return next((float(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM")), 0.0)


def children(pid: int) -> list[int]:
    try:
        return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []


def statuses(folder: Path) -> str:
    found: dict[str, int] = {}
    for _, row in Store.open(folder).rows():
        found[row.status] = found.get(row.status, 0) + 1
    return json.dumps(found)


def compared(first: Path, second: Path) -> str:
    """Every number of both studies."""
    one, other = Store.open(first), Store.open(second)
    differing, signals = 0, 0
    ours = {case.hash: result for case, result in other.results()}
    for case, result in one.results():
        again = ours[case.hash]
        same = result.status is again.status and dict(result.summary) == dict(again.summary)
        same &= result.signals.keys() == again.signals.keys()
        same &= all(np.array_equal(values, again.signals[name], equal_nan=True)
                    for name, values in result.signals.items())  # fmt: skip
        signals += len(result.signals)
        differing += not same
    unreadable = len(one.skipped) + len(other.skipped)
    told = f"{len(ours)} cases, {signals} signals compared bit for bit"
    return f"{told}, {differing} differ, {unreadable} unreadable"


def spinning(processes: int) -> float:
    """Time [s] for this many processes to count, one each."""
    code = "k = 0\nwhile k < 20_000_000: k += 1"
    start = time.perf_counter()
    running = [subprocess.Popen([sys.executable, "-c", code]) for _ in range(processes)]
    for process in running:
        process.wait()
    return time.perf_counter() - start


MEASUREMENTS = {
    "thousand": thousand,
    "memory": memory,
    "scaling": scaling,
    "kills": kills,
    "storing": storing,
}

if __name__ == "__main__":
    main(sys.argv[1:])
