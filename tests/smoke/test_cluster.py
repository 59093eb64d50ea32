"""Cases on a real Dask cluster on the loopback: a scheduler and two workers in processes of their own."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from reader import Server
from rps_exudyn.results.outcome import Status
from rps_exudyn.study.store import Store
from shell import Command, refusal_of
from study_files import write_grid, write_stand_in

LOCAL = "--host 127.0.0.1 --no-dashboard"


def worker(address: str, folder: Path) -> Server:
    """One that is connected."""
    options = f"--nthreads 1 --local-directory {folder} {LOCAL}"
    return Server(f"dask worker {address} {options}", folder, "Registered to:", **stand_in())


def stand_in() -> dict[str, str]:
    return {name: os.environ[name] for name in ("PYTHONPATH", "STAND_IN_SECONDS")}


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A scheduler with two workers, which simulate nothing."""
    folder = tmp_path_factory.mktemp("cluster")
    with ExitStack() as running:
        environment = running.enter_context(pytest.MonkeyPatch.context())
        environment.setenv("PYTHONPATH", str(write_stand_in(folder)), prepend=os.pathsep)
        environment.setenv("STAND_IN_SECONDS", "0.4")
        started = f"dask scheduler --port 0 {LOCAL}"
        scheduler = Server(started, folder, r"Scheduler at: *(tcp://\S+)", **stand_in())
        running.callback(scheduler.end)
        for _ in range(2):
            running.callback(worker(scheduler.answer[1], folder).end)
        yield scheduler.answer[1]


@pytest.mark.filterwarnings("ignore")  # of Dask and its libraries
def test_cases_come_back_and_failures_are_rows(command: Command, tmp_path: Path, address: str) -> None:
    file = write_grid(tmp_path / "s.toml", 100, 200, 901, 904)
    answer = command(["study", str(file), "--cluster", address])
    assert answer.status == 1, answer.err
    store = Store.open(tmp_path / "s")
    assert [row.status for _, row in store.rows()] == [
        Status.OK, Status.OK, Status.CRASHED, Status.DIVERGED,
    ]  # fmt: skip
    for case, result in store.results():
        if result.status is Status.OK:
            assert result["pinion_torque"][0] == case.values["yoke.preload"]


@pytest.mark.filterwarnings("ignore")
def test_lost_worker_is_replaced(command: Command, tmp_path: Path, address: str) -> None:
    """One of the two is killed with all its processes in the middle, and another one comes."""
    file = write_grid(tmp_path / "s.toml", *range(911, 931))
    started = [sys.executable, "-m", "rps_exudyn", "study", str(file), "--cluster", address]
    with subprocess.Popen(started, cwd=tmp_path, stdout=subprocess.DEVNULL) as study:
        until = time.monotonic() + 300
        while not list((tmp_path / "s" / "blocks").glob("[!.]*.h5")):
            assert time.monotonic() < until
            time.sleep(0.1)
        killed = first_worker(address)
        os.killpg(killed, signal.SIGKILL)
        another = worker(address, tmp_path)
        try:
            assert study.wait(600) == 0
        finally:
            another.end()
    assert len(list(Store.open(tmp_path / "s").rows())) == 20


@pytest.mark.filterwarnings("ignore")
def test_groups_come_back_from_a_cluster(command: Command, tmp_path: Path, address: str) -> None:
    """Into blocks; the group with a case that ends its process, the second one, comes back case by case."""
    file = write_grid(tmp_path / "s.toml", *range(100, 400), 901)
    file.write_text(file.read_text() + "[keep]\nblocks = true\nsamples = 11\n")
    answer = command(["study", str(file), "--cluster", address, "--json"])
    assert answer.json["statuses"] == {"ok": 300, "crashed": 1}, answer.err
    assert 0 < answer.json["in_groups"] <= 300
    assert len(list(Store.open(tmp_path / "s").results())) == 301


def first_worker(address: str) -> int:
    """Its process group: the nanny's, which started it."""
    from distributed import Client

    with Client(address, timeout=60, set_as_default=False) as client:
        return min(client.run(os.getpgrp).values())


@pytest.mark.filterwarnings("ignore")
def test_missing_cluster_is_reported(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rps_exudyn.simulate.cases.cluster.CONNECTING", 1)
    file = write_grid(tmp_path / "s.toml", 100)
    assert "--cluster tcp://127.0.0.1:9: no scheduler answers" in refusal_of(
        command(["study", str(file), "--cluster", "tcp://127.0.0.1:9"])
    )
