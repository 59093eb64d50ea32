"""That machine code is made is shown: in every command, in a terminal and in lines; never silently."""

import io
import re
import sys
from pathlib import Path
from time import monotonic, sleep

import pytest

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.progress import Making, Progress, listening, making, passed_on, publish
from rps_exudyn.base.screen import TextRow, open_screen, shown_progress
from rps_exudyn.pages.explore.server import Explorer
from rps_exudyn.results.result import Result
from shell import Command

SENTENCE = "Preparing force laws for this machine, once"
PATIENCE = 60.0  # [s] for a thread on a busy machine


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
    with open_screen() as screen, screen.row(TextRow(SENTENCE)), screen.row(TextRow("sample 3 of 20", 0.15)):
        end = monotonic() + PATIENCE
        while "sample 3 of 20" not in terminal.getvalue() and monotonic() < end:
            sleep(0.01)
    shown = terminal.getvalue()
    assert SENTENCE in shown
    assert "sample 3 of 20" in shown
    assert "━" in shown
    *_, last = shown.partition(" 20")
    erased = r"\x1b\[2K\x1b\[1A\x1b\[2K\n?\x1b\[\?25h$"  # rich before 15 ends the line, too
    assert re.search(erased, last.rstrip())  # both lines are empty again


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
def preparing(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that makes machine code, and then cannot go on."""

    def begin(*_: object, **__: object) -> None:
        with making(SENTENCE):
            end = monotonic() + PATIENCE
            while SENTENCE not in sys.stderr.getvalue() and monotonic() < end:  # type: ignore[attr-defined]
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


@pytest.mark.usefixtures("preparing")
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
def test_every_command_says_that_it_makes_code(line: str, command: Command, made_up_result: Result) -> None:
    made_up_result.save("r.h5")
    table = "".join(f"{angle},0.6\n" for angle in range(361))
    Path("measured.csv").write_text(f"pinion_angle [deg], pinion_torque [N m]\n{table}")
    answer = command(line.split())
    assert answer.err.count(SENTENCE) == 1, answer.err
    assert SENTENCE not in answer.out


def test_listener_ends_with_its_block() -> None:
    heard = []
    with listening(heard.append), making(SENTENCE):
        pass
    publish(Making("another"))
    assert heard == [Making(SENTENCE), Making("")]
