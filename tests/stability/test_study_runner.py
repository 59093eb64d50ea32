"""Whatever happens to a case, a worker or the runner itself: every case ends as one row, and none is lost."""

import errno
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from edited import edited
from rps_exudyn.results.block import CaseRow
from rps_exudyn.results.outcome import Status
from rps_exudyn.simulate.cases.processes import Processes
from rps_exudyn.simulate.cases.task import Task
from rps_exudyn.study.store import Store
from shell import Command, refusal_of
from study_files import write_grid, write_stand_in


@pytest.fixture(autouse=True)
def stand_in(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """Worker processes simulate nothing."""
    monkeypatch.setenv("PYTHONPATH", str(write_stand_in(tmp_path_factory.mktemp("stand_in"))))


def rows(folder: Path) -> dict[float, CaseRow]:
    """Preload -> row."""
    return {case.values["yoke.preload"]: row for case, row in Store.open(folder).rows()}


def test_crash_hang_and_failure_are_rows_and_the_rest_goes_on(command: Command, tmp_path: Path) -> None:
    file = write_grid(tmp_path / "s.toml", 100, 901, 902, 903, 904, 905, 200)
    file.write_text(file.read_text().replace("20 s", "2 s"))
    assert command(["study", str(file), "--jobs", "2"]).status == 1
    found = rows(tmp_path / "s")
    assert {preload: row.status for preload, row in found.items()} == {
        100: Status.OK,
        200: Status.OK,
        901: Status.CRASHED,
        902: Status.TIMEOUT,
        903: Status.CRASHED,
        904: Status.DIVERGED,
        905: Status.CRASHED,
    }
    assert "SIGSEGV" in found[901].message
    assert "time limit of 2 s" in found[902].message
    assert found[903].message == "RuntimeError: on purpose"
    assert "status 7" in found[905].message
    log = (tmp_path / "s" / "study.log").read_text()
    assert log.count(" s yoke.preload=") == 7
    # crashed cases are tried again; the timeout is not, with the same limit
    assert command(["study", str(file), "--dry-run", "--json"]).json["missing"] == 3


def test_repeated_study_does_nothing_and_extended_one_only_what_is_new(
    command: Command, tmp_path: Path
) -> None:
    file = write_grid(tmp_path / "s.toml", 100, 200)
    assert command(["study", str(file), "--json"]).json["done_now"] == 2
    before = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "s" / "blocks").iterdir()}
    assert command(["study", str(file), "--json"]).json["done_now"] == 0
    write_grid(file, 100, 150, 200)
    assert command(["study", str(file), "--json"]).json == {
        "folder": "s",
        "cases": 3,
        "statuses": {"ok": 3},
        "said": [],
        "done_now": 1,
        "in_groups": 0,
        "in_loop": 0,
        "not_in_loop": "",
    }
    after = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "s" / "blocks").iterdir()}
    assert before.items() <= after.items()


def test_damaged_foreign_and_newer_files_are_named_set_aside_and_done_again(
    command: Command, tmp_path: Path
) -> None:
    file = write_grid(tmp_path / "s.toml", 100, 200, 300, 400)
    file.write_text(f"{file.read_text()}[keep]\nblocks = false\n")
    command(["study", str(file)])
    store = Store.open(tmp_path / "s")
    paths = [store.path_of(case.hash) for case in store.description.cases]
    paths[0].write_bytes(paths[0].read_bytes()[:3000])
    paths[1].write_bytes(paths[2].read_bytes())
    with edited(paths[3]) as content:
        content.attrs["version"] = [9, 0]
    assert [case.hash for case, _ in store.rows()] == [paths[2].stem]
    sentences = " ".join(sentence for _, sentence in store.skipped)
    assert [path for path, _ in store.skipped] == [paths[0], paths[1], paths[3]]
    for word in ("damaged", "another case: yoke.preload is 300.0, not 200.0", "format version 9.0"):
        assert word in sentences
    answer = command(["study", str(file), "--json"])
    assert answer.json["done_now"] == 3
    assert "set aside" in answer.err
    assert len(list((tmp_path / "s" / "cases").glob("*.set-aside"))) == 3
    assert len(rows(tmp_path / "s")) == 4


def test_second_runner_is_refused_and_the_first_undisturbed(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = write_grid(tmp_path / "s.toml", 911, 912)
    with Running(file, 1.5, monkeypatch) as first:
        wait_for(lambda: (tmp_path / "s" / "study.json").exists())
        assert f"s is in use by process {first.pid}" in refusal_of(command(["study", str(file)]))
        assert first.wait(300) == 0
    assert len(rows(tmp_path / "s")) == 2


def test_ctrl_c_stops_at_once_and_keeps_what_is_done(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = write_grid(tmp_path / "s.toml", 100, 911, 912)
    with Running(file, 1000, monkeypatch) as process:
        wait_for(lambda: (tmp_path / "s" / "study.json").exists() and rows(tmp_path / "s"))
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=300)  # a case takes 1000 s
    assert process.returncode == 130
    assert "finished cases are kept in s; the same command runs the others" in err
    assert "Traceback" not in err
    assert list(rows(tmp_path / "s")) == [100]


@pytest.mark.parametrize("name", [".study.4711.json", ".study.4711.toml"])
def test_a_study_killed_while_its_first_file_was_written_begins_again(
    command: Command, tmp_path: Path, name: str
) -> None:
    file = write_grid(tmp_path / "s.toml", 100, 200)
    (tmp_path / "s" / "blocks").mkdir(parents=True)
    (tmp_path / "s" / name).write_text("{", encoding="utf-8")
    assert command(["study", str(file)]).status == 0
    assert len(rows(tmp_path / "s")) == 2
    assert not (tmp_path / "s" / name).exists()


def test_killed_at_random_moments_it_ends_as_if_undisturbed(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """SIGKILL of runner and workers in turn; benchmarks/study_runner.py does it with real simulations."""
    preloads = [*range(100, 140), *range(911, 931)]
    whole = write_grid(tmp_path / "whole.toml", *preloads)
    command(["study", str(whole), "--jobs", "2"])
    file = write_grid(tmp_path / "s.toml", *preloads)
    for victim, moment in enumerate((0.6, 1.3, 1.5, 1.2, 0.9)):
        with Running(file, 0.05, monkeypatch) as process:
            time.sleep(moment)
            children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
            os.kill(int(children[0]) if victim % 2 and children else process.pid, signal.SIGKILL)
            time.sleep(0.2)
    assert command(["study", str(file), "--jobs", "2"]).status == 0
    first, second = Store.open(tmp_path / "whole"), Store.open(tmp_path / "s")
    results = {case.hash: result for case, result in second.results()}
    assert len(results) == len(preloads)
    for case, result in first.results():
        assert results[case.hash].summary == result.summary
        for name, values in result.signals.items():
            assert np.array_equal(values, results[case.hash][name])
    assert not list((tmp_path / "s").rglob(".*.h5"))


def test_storing_that_fails_ends_the_study_in_a_sentence(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on a full disk; cases done by then are kept."""

    def full(written: int) -> None:
        path = Path(f"/proc/self/fd/{written}").readlink()
        if len(list(path.parent.glob("[!.]*.h5"))) >= 2 and path.parent.name == "cases":
            raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("rps_exudyn.base.files.os.fsync", full)
    file = write_grid(tmp_path / "s.toml", 100, 200, 300, 400)
    file.write_text(f"{file.read_text()}[keep]\nblocks = false\n")
    said = refusal_of(command(["study", str(file), "--jobs", "1"]))
    assert "A result cannot be stored" in said
    assert "No space left on device. Finished cases are kept in s" in said
    assert len(rows(tmp_path / "s")) == 2


class Running:
    """`rps-exudyn study FILE` in a process of its own, cases above 910 N taking so many seconds."""

    def __init__(self, file: Path, seconds: float, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setenv("STAND_IN_SECONDS", str(seconds))
        command = [sys.executable, "-m", "rps_exudyn", "study", str(file), "--jobs", "2"]
        self.process = subprocess.Popen(
            command,
            cwd=file.parent,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            # a shell that runs the tests in the background makes them, and all they start, ignore Ctrl-C
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        )

    def __enter__(self) -> "subprocess.Popen[str]":
        return self.process

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.communicate()


def wait_for(condition: Callable[[], object], seconds: float = 300) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not happen"
        time.sleep(0.05)


@pytest.mark.parametrize(("compiled", "at_once"), [(True, 3), (False, 1)])
def test_workers_start_together_unless_the_first_has_to_compile(
    monkeypatch: pytest.MonkeyPatch, compiled: bool, at_once: int
) -> None:
    """Also where this process has compiled some kernels of its own before it hands out the first case."""
    started: list[Task] = []
    case = Task(int)

    def first_event(processes: Processes) -> float:
        raise InterruptedError

    monkeypatch.setattr("rps_exudyn.base.kernel_code.object_files", lambda: [1] * compiled)
    monkeypatch.setattr(Processes, "_start", lambda _, warm_up: started.append(warm_up))
    monkeypatch.setattr(Processes, "_until_deadline", first_event)
    processes = Processes(3, 1.0)
    monkeypatch.setattr("rps_exudyn.base.kernel_code.object_files", lambda: [1])
    with pytest.raises(InterruptedError):
        list(processes.run(iter([case])))
    assert len(started) == at_once


def test_workers_killed_in_quick_succession_are_replaced_and_the_study_goes_on(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first five processes end at once, as where the system runs out of memory for a while."""
    _end_at_once(tmp_path, "5", monkeypatch)
    file = write_grid(tmp_path / "s.toml", 100, 200)
    answer = command(["study", str(file), "--jobs", "1", "--json"])
    assert answer.json["statuses"] == {"ok": 2}


def test_study_whose_workers_never_start_stops_in_a_sentence(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = write_grid(tmp_path / "s.toml", 100)
    command(["study", str(file), "--jobs", "1"])
    _end_at_once(tmp_path, "1000", monkeypatch)
    write_grid(file, 100, 200)
    said = refusal_of(command(["study", str(file), "--jobs", "1"]))
    assert said == (
        "rps-exudyn: 8 processes in a row ended before they had done anything (its process was ended by "
        "SIGKILL); s/messages.log holds their output. Finished cases are kept in s; the same command "
        "runs the others.\n"
    )
    assert list(rows(tmp_path / "s")) == [100]


def test_study_without_a_finished_case_does_not_say_that_cases_are_kept(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _end_at_once(tmp_path, "1000", monkeypatch)
    answer = command(["study", str(write_grid(tmp_path / "s.toml", 100)), "--jobs", "1"])
    assert answer.err.endswith("No case is finished; the same command runs all of them.\n")


def _end_at_once(folder: Path, count: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """So many worker processes, counted in a file, kill themselves when they start."""
    monkeypatch.setattr("rps_exudyn.simulate.cases.processes.FIRST_PAUSE", 0.01)
    counted = folder / "started"
    stand_in = Path(os.environ["PYTHONPATH"]) / "sitecustomize.py"
    stand_in.write_text(
        f"import os, signal\nwith open({str(counted)!r}, 'a') as file:\n    file.write('x')\n"
        f"if os.path.getsize({str(counted)!r}) <= {count}:\n    os.kill(os.getpid(), signal.SIGKILL)\n"
        + stand_in.read_text()
    )
