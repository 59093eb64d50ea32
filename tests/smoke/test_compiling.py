"""What is compiled is shown: with its total, in every command, in a terminal and in lines; never silently."""

import io
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from pathlib import Path
from threading import Barrier
from time import monotonic, sleep

import pytest

import rps_exudyn.base.compiling
from rps_exudyn.base import compiled
from rps_exudyn.base.compiled import NUMBER, kernel, kernel_of, ready
from rps_exudyn.base.compiling import CompileStep, CompilingProgress, called, listening, publish
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.progress import Progress, passed_on
from rps_exudyn.base.screen import TextRow, open_screen, shown_progress
from rps_exudyn.pages.explore.server import Explorer
from rps_exudyn.results.result import Result
from rps_exudyn.simulate.cases.processes import cpu_of
from shell import Command, reader_environment

COUNT = re.compile(r"Compiling force laws, once: (\d+) of (\d+), .* left")
SILENCE = 8.0  # [s] of CPU time at most between lines, which come every 2 s where nothing else is done
PATIENCE = 60.0  # [s] for a thread on a busy machine


@kernel
def innermost(x):  # type: ignore[no-untyped-def]
    return x + 1


@kernel
def between(x):  # type: ignore[no-untyped-def]
    return innermost(x) * innermost(x)


@kernel_of(NUMBER, result=NUMBER)
def outermost(x):  # type: ignore[no-untyped-def]
    return between(x) + innermost(x)


def test_what_a_kernel_calls_is_read_from_its_code() -> None:
    names = {name.rpartition(".")[2] for name in called(outermost)}
    assert names == {"outermost", "between", "innermost"}
    assert {name.rpartition(".")[2] for name in called(innermost)} == {"innermost"}


def test_count_rises_to_its_total(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rps_exudyn.base.compiling, "EVERY", 0.001)
    steps: list[CompileStep] = []
    with listening(steps.append):
        assert ready(outermost)(2.0) == 12.0
        ready(outermost)  # nothing more to compile
    done = [step.done for step in steps]
    assert done == sorted(done)
    assert {step.total for step in steps} == {steps[-1].done}
    assert all(step.left >= 0 for step in steps)
    assert steps[-1].left == 0


@kernel_of(NUMBER, result=NUMBER)
def shared(x):  # type: ignore[no-untyped-def]
    return innermost(x) * 3


def test_threads_may_need_the_same_kernel_first() -> None:
    begun = Barrier(16)

    def run(x: float) -> float:
        begun.wait()
        returned: float = ready(shared)(x)
        return returned

    with ThreadPoolExecutor(begun.parties) as threads:
        assert list(threads.map(run, range(begun.parties))) == [3 * (x + 1) for x in range(begun.parties)]


@kernel
def interrupted(x):  # type: ignore[no-untyped-def]
    return innermost(x) - 1


@kernel
def loaded(x):  # type: ignore[no-untyped-def]
    return innermost(x) + 2


def test_interrupted_compilation_counts_what_is_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(interrupted._compiler, "compile", interrupt)
    steps: list[CompileStep] = []
    with listening(steps.append), pytest.raises(KeyboardInterrupt):
        compiled.called(interrupted, 1.0)
    assert steps[-1].done < steps[-1].total


def test_what_is_only_loaded_is_not_counted_however_long_that_takes() -> None:
    steps: list[CompileStep] = []
    with listening(steps.append), rps_exudyn.base.compiling.compiling(loaded):
        sleep(1.1)  # as on a busy machine
    assert not steps


def test_row_says_count_and_time() -> None:
    row = CompilingProgress()
    row.take(CompileStep(46, 146, 6.0, 18.0))
    assert (row.text, row.fraction) == ("Compiling force laws, once: 46 of 146, 18 s left", 0.25)
    assert not row.is_done


# --- on the screen ---


def written_until(line: str, capsys: pytest.CaptureFixture[str]) -> list[str]:
    """Return the lines on standard error until one that matches has come."""
    end, text = monotonic() + PATIENCE, ""
    while not any(re.fullmatch(line, each) for each in text.splitlines()):
        assert monotonic() < end, text
        sleep(0.01)
        text += capsys.readouterr().err
    return text.splitlines()


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_terminal_shows_a_bar_that_goes_away(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")
    progress = CompilingProgress()
    progress.take(CompileStep(1, 3, 2.0, 7.0))
    with open_screen() as screen, screen.row(progress), screen.row(TextRow("sample 3 of 20", 0.15)):
        end = monotonic() + PATIENCE
        while "sample 3 of 20" not in terminal.getvalue() and monotonic() < end:
            sleep(0.01)
    shown = terminal.getvalue()
    assert "Compiling force laws, once: 1 of 3, 7 s left" in shown
    assert "sample 3 of 20" in shown
    assert "━" in shown
    *_, last = shown.partition(" 20")
    assert last.rstrip().endswith("\x1b[2K\x1b[1A\x1b[2K\x1b[?25h")  # both lines are empty again


def test_lines_elsewhere_only_where_they_are_wanted(capsys: pytest.CaptureFixture[str]) -> None:
    with open_screen() as screen, screen.row(TextRow("12 deg, 3 %, 5 s left")):
        pass
    assert capsys.readouterr().err == ""
    with open_screen(asked=True) as screen, screen.row(TextRow("12 deg, 3 %, 5 s left")):
        assert len(written_until("rps-exudyn: 12 deg, 3 %, 5 s left", capsys)) == 1


def test_a_command_of_several_runs_shows_what_it_does_itself(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rps_exudyn.base.screen.EVERY", 0.05)
    with shown_progress(asked=True) as show:
        passed_on(Progress("12 deg", 0.03, 3.0, 5.0))
        assert len(written_until("rps-exudyn: 12 deg, 3 %, 5 s left", capsys)) == 1
        show("sample 3 of 20", 0.15)
        passed_on(Progress("360 deg", 1.0, 3.0, 0.0))
        lines = written_until(r"rps-exudyn: sample 3 of 20, [\d.]+ s left", capsys)
        assert not any("deg" in line for line in lines)


# --- every command ---


@pytest.fixture
def compiling(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that compiles two of its kernels, and then cannot go on."""

    def begin(*_: object, **__: object) -> None:
        publish(CompileStep(2, 50, 1.0, 20.0))
        end = monotonic() + PATIENCE
        while not COUNT.search(sys.stderr.getvalue()) and monotonic() < end:  # type: ignore[attr-defined]
            sleep(0.01)  # for the thread that writes
        raise InputError("this is enough.")

    for place in (
        "simulate.run_plan.scene_named",
        "multibody.model.build_model",
        "inference.fitting.prediction.Prediction.simulated",
        "pages.animation.animation_page.write_page",
        "pages.report.write_report.write_report",
        "simulate.cases.processes.Processes.run",
    ):
        monkeypatch.setattr(f"rps_exudyn.{place}", begin)
    monkeypatch.setattr("rps_exudyn.cli.view.has_display", lambda: True)
    monkeypatch.setattr(Explorer, "serve_forever", lambda *_, **__: None)


@pytest.mark.usefixtures("compiling")
@pytest.mark.parametrize(
    "line",
    [
        "run",
        "run load-test --fidelity full --json",
        "run --band 20",
        "run --band",
        "rerun r.h5",
        "check --json",
        "validate --only maker-free-torque",
        "fit measured.csv",
        "animate r.h5",
        "view r.h5",
        "explore --no-browser",
        "report r.h5 --contact",
        "doctor",
    ],
)
def test_every_command_shows_what_it_compiles(line: str, command: Command, made_up_result: Result) -> None:
    made_up_result.save("r.h5")
    table = "".join(f"{angle},0.6\n" for angle in range(361))
    Path("measured.csv").write_text(f"pinion_angle [deg], pinion_torque [N m]\n{table}")
    answer = command(line.split())
    assert COUNT.search(answer.err), answer.err
    assert "Compiling" not in answer.out


# --- with an empty cache ---


def test_first_use_is_never_silent_and_its_total_is_right(command: Command, tmp_path: Path) -> None:
    """`animate` compiled for 30 s without a word. Lines go to standard error, results alone to the other."""
    assert command(["run", "--fidelity", "quasi-static", "--out", "r.h5"]).status == 0
    at, lines = [0.0], []
    with subprocess.Popen(
        [sys.executable, "-m", "rps_exudyn", "animate", "r.h5"],
        env={**reader_environment(), "NUMBA_CACHE_DIR": str(tmp_path / "cache")},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout
        assert process.stderr
        for line in process.stderr:
            at.append(cpu_of(process.pid))
            lines.append(line)
        at.append(cpu_of(process.pid))
        out = process.stdout.read()
    assert (process.returncode, out) == (0, "written: r-animation.html\n")
    silence = max(later - earlier for earlier, later in pairwise(at))
    assert silence < SILENCE, lines
    counts = [tuple(map(int, found.groups())) for line in lines if (found := COUNT.search(line))]
    assert all(done <= total for done, total in counts)
    assert counts == sorted(counts)
    end = r"rps-exudyn: (\d+) force laws compiled in \d+ s, once; later runs load them from "
    found = re.match(end, lines[-1])
    assert found
    assert int(found.group(1)) >= counts[-1][1]  # one may take less than the time between lines


def test_listener_ends_with_its_block() -> None:
    heard, step = [], CompileStep(1, 2, 3.0, 4.0)
    with listening(heard.append):
        publish(step)
    publish(CompileStep(2, 2, 5.0, 0.0))
    assert heard == [step]
