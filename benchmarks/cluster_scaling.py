"""A study on a Dask cluster of this machine: elapsed time over the number of workers, and a lost one.

Scheduler and workers are processes of their own, started by Dask's commands; one of the runs loses a worker,
which is killed with all its processes and not replaced.
"""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from benchmarks.study_scaling import study_of
from benchmarks.topic import Topic, digits, load_data, markdown, save_data
from rps_exudyn.study.store import Store

DATA = "cluster_scaling.json"
LOST = 2  # workers of the run that loses one


def run(folder: Path, cases: int = 4000, workers: Sequence[int] = (1, 2, 4)) -> None:
    """Do one study with each number of workers, and with two of which one is killed."""
    rows = []
    with tempfile.TemporaryDirectory() as temporary:
        for count in workers:
            rows.append(measured(Path(temporary), cases, count, lost=False))
            print(rows[-1], flush=True)
        if workers:
            rows.append(measured(Path(temporary), cases, LOST, lost=True))
            print(rows[-1], flush=True)
    save_data(folder / DATA, {"load": os.getloadavg()[0], "rows": rows})


def measured(folder: Path, cases: int, workers: int, lost: bool) -> dict[str, float | bool]:
    """Elapsed time of a study [s] on so many workers, and how many of its cases are there and ok."""
    place = folder / f"{workers}_{lost}"
    place.mkdir()
    with cluster(place, workers) as (address, running):
        command = [sys.executable, "-m", "rps_exudyn", "study", str(study_of(place, cases)), "--yes"]
        begun = time.perf_counter()
        with subprocess.Popen([*command, "--out", str(place / "out"), "--cluster", address]) as study:
            if lost:
                until_some_are_done(place / "out")
                end(running[-1])
            study.wait()
        wall = time.perf_counter() - begun
    rows = [row for _, row in Store.open(place / "out").rows()]
    ok = sum(row.status == "ok" for row in rows)
    return {"workers": workers, "lost": lost, "wall": wall, "cases": len(rows), "ok": ok}


def until_some_are_done(out: Path) -> None:
    """Wait until the study's log tells of a finished case."""
    log = out / "study.log"
    while not log.exists() or len(log.read_text().splitlines()) < 2:
        time.sleep(0.1)


@contextmanager
def cluster(folder: Path, workers: int) -> Iterator[tuple[str, "list[subprocess.Popen[bytes]]"]]:
    """A scheduler and workers of one thread each on the loopback; the address, and the workers' processes."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    scheduler = dask("scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard", folder=folder)
    options = ("--nthreads", "1", "--no-dashboard", "--host", "127.0.0.1", "--local-directory", str(folder))
    running = [dask("worker", address, *options, folder=folder) for _ in range(workers)]
    try:
        wait_for(address, workers)
        yield address, running
    finally:
        for process in (*running, scheduler):
            end(process)


def wait_for(address: str, workers: int) -> None:
    """Wait until all workers are there."""
    from distributed import Client

    with Client(address, timeout=60, set_as_default=False) as client:
        client.wait_for_workers(workers, timeout=120)


def dask(name: str, *arguments: str, folder: Path) -> "subprocess.Popen[bytes]":
    """One of Dask's commands in a process group of its own; what it says goes to a file."""
    command = [sys.executable, "-m", f"distributed.cli.dask_{name}", *arguments]
    with (folder / f"{name}.log").open("ab") as log:
        return subprocess.Popen(command, cwd=folder, stdout=log, stderr=log, start_new_session=True)


def end(process: "subprocess.Popen[bytes]") -> None:
    """Kill a process with all that it has started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def table(folder: Path) -> str:
    """Elapsed time over the workers."""
    rows = [
        (
            f"{row['workers']}, one of them killed" if row["lost"] else row["workers"],
            row["cases"],
            row["ok"],
            digits(row["wall"], 3),
        )
        for row in load_data(folder / DATA)["rows"]
    ]
    return markdown(("local workers", "cases", "of them ok", "elapsed [s]"), rows)


TOPIC = Topic(
    "a study on a Dask cluster: workers, and a lost one",
    "3 min",
    "study_runner",
    run,
    {"cases": 2, "workers": ()},
    {"cluster_scaling": table},
)
