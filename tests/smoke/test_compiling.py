"""What is compiled is shown: with its total, in every command, in a terminal and in lines; never silently."""

import io
import re
import subprocess
import sys
from collections import Counter
from itertools import pairwise
from pathlib import Path
from time import monotonic, sleep

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rps_exudyn.base import compiling_progress
from rps_exudyn.base.compiling import Step, begin_work, listening, publish
from rps_exudyn.base.compiling_progress import CompilingProgress
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.kernel_table import KernelTable, kernel_table
from rps_exudyn.base.progress import Progress, passed_on
from rps_exudyn.base.screen import TextRow, open_screen
from rps_exudyn.cli.progress import shown_progress
from rps_exudyn.explore.server import Explorer
from rps_exudyn.results.result import Result
from shell import Command, reader_environment

TABLE = KernelTable.of(
    {"a": 1.0, "b": 2.0, "c": 3.0, "d": 4.0},
    {"one": Counter("ab"), "two": Counter("bcd"), "three": Counter("aabb")},
)
COUNT = re.compile(r"Compiling force laws, once: (\d+) of (\d+), .* left")
SILENCE = 6.0  # [s] at most between lines, which come every 2 s where nothing else is done


def compiled(progress: CompilingProgress, *names: str) -> None:
    """Let kernels be compiled one after the other, each as fast as in the table."""
    for name in names:
        progress.take(Step("begun", name))
        progress.take(Step("done", name, TABLE.seconds.get(name, 0.1)))


def begun(work: str, *before: str) -> CompilingProgress:
    progress = CompilingProgress(TABLE, Counter(before))
    progress.take(Step("work", work))
    return progress


def test_total_is_that_of_the_table_without_what_is_compiled() -> None:
    fresh, partly = begun("one"), begun("two", "b")
    compiled(fresh, "a")
    compiled(partly, "c")
    assert (fresh.done, fresh.total, fresh.fraction) == (1, 2, 0.5)
    assert (partly.done, partly.total) == (1, 2)
    assert re.fullmatch("Compiling force laws, once: 1 of 2, [23] s left", fresh.text)


def test_work_after_work_adds_what_it_needs_beside() -> None:
    progress = begun("one")
    compiled(progress, "a")
    progress.take(Step("work", "two"))
    assert progress.total == 4
    progress.take(Step("work", "one"))
    assert progress.total == 4


def test_other_kernels_than_expected_are_those_of_the_likeliest_work() -> None:
    """A gear whose parameters ask for other kernels than its preset usually does."""
    progress = begun("one with other parts")
    compiled(progress, "c")
    assert progress.total == 3
    compiled(progress, "unheard-of")
    assert (progress.done, progress.total) == (2, 4)


@pytest.mark.parametrize(("slowness", "first"), [(1.0, 1.0), (3.0, 0.4)])
def test_time_left_follows_the_speed_of_the_machine(
    slowness: float, first: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Kernels within kernels, as numba compiles them; on a slow machine the first estimate is too low."""
    now = [100.0]
    monkeypatch.setattr(compiling_progress, "monotonic", lambda: now[0])
    progress = begun("two")
    shares = []  # time left as it is said, over that as it is
    for what, name, until in (
        ("begun", "d", 2.0),
        ("begun", "b", 4.0),
        ("done", "b", 5.0),
        ("begun", "c", 8.0),
        ("done", "c", 8.5),
    ):
        progress.take(Step(what, name, slowness * TABLE.seconds[name]))  # type: ignore[arg-type]
        now[0] = 100.0 + slowness * until
        shares.append(progress.left / (slowness * (9.0 - until)))
    assert shares[0] == pytest.approx(first, abs=0.2)
    assert shares[2] == pytest.approx(1.0, abs=0.3)
    assert progress.left > 0


def test_unknown_work_has_no_total() -> None:
    progress = begun("a scene of its own")
    compiled(progress, "a")
    assert progress.fraction is None
    assert progress.text == "Compiling force laws, once: 1"


STEPS = st.lists(
    st.one_of(
        st.tuples(st.just("work"), st.sampled_from(("one", "two", "three", "x"))),
        st.tuples(st.sampled_from(("begun", "done")), st.sampled_from("abcdz")),
    ),
    max_size=40,
)


@given(STEPS, st.text("abcd", max_size=4))
def test_count_never_exceeds_its_total(steps: list[tuple[str, str]], before: str) -> None:
    """Whatever comes, also what the table does not expect, in any number."""
    progress, still_open = CompilingProgress(TABLE, Counter(before)), Counter[str]()
    for what, name in steps:
        if what == "done" and not still_open[name]:
            continue
        still_open[name] += {"work": 0, "begun": 1, "done": -1}[what]
        progress.take(Step(what, name))  # type: ignore[arg-type]
        assert progress.done <= progress.total
        assert progress.left >= 0
        assert progress.fraction is None or 0 <= progress.fraction <= 1


# --- on the screen ---


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_terminal_shows_a_bar_that_goes_away(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")
    progress = begun("two")
    with open_screen() as screen, screen.row(progress), screen.row(TextRow("sample 3 of 20", 0.15)):
        compiled(progress, "b")
        sleep(0.6)
    shown = terminal.getvalue()
    assert re.search("Compiling force laws, once: 1 of 3, [789] s left", shown)
    assert "sample 3 of 20" in shown
    assert "━" in shown
    *_, last = shown.partition(" 20")
    assert last.rstrip().endswith("\x1b[2K\x1b[1A\x1b[2K\x1b[?25h")  # both lines are empty again


def test_lines_elsewhere_only_where_they_are_wanted(capsys: pytest.CaptureFixture[str]) -> None:
    with open_screen() as screen, screen.row(TextRow("12 deg, 3 %, 5 s left")):
        pass
    assert capsys.readouterr().err == ""
    with open_screen(asked=True) as screen, screen.row(TextRow("12 deg, 3 %, 5 s left")):
        sleep(0.2)
    assert capsys.readouterr().err == "rps-exudyn: 12 deg, 3 %, 5 s left\n"


def test_a_command_of_several_runs_shows_what_it_does_itself(capsys: pytest.CaptureFixture[str]) -> None:
    with shown_progress(asked=True) as show:
        passed_on(Progress("12 deg", 0.03, 3.0, 5.0))
        sleep(0.2)
        show("sample 3 of 20", 0.15)
        passed_on(Progress("360 deg", 1.0, 3.0, 0.0))
        sleep(2.2)
    assert capsys.readouterr().err.splitlines() == [
        "rps-exudyn: 12 deg, 3 %, 5 s left",
        "rps-exudyn: sample 3 of 20",
    ]


# --- every command ---


@pytest.fixture
def compiling(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that compiles two kernels, of those that it needs, and then cannot go on."""

    def begin(work: str) -> None:
        begin_work(work)
        for name in list(kernel_table().kernels("free-pinion-torque flank"))[:2]:
            publish(Step("begun", name))
            publish(Step("done", name, 0.1))
        sleep(0.1)  # for the thread that writes
        raise InputError("this is enough.")

    monkeypatch.setattr(compiling_progress, "compiled_names", Counter)
    for module in ("simulate.checked_run", "simulate.viewer", "fitting.prediction"):
        monkeypatch.setattr(f"rps_exudyn.{module}.begin_work", begin)
    for writes in ("cli.animate_command.write_page", "report.report.write_report"):
        monkeypatch.setattr(f"rps_exudyn.{writes}", lambda *_: begin("animate"))
    monkeypatch.setattr("rps_exudyn.cli.view_command.has_display", lambda: True)
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
    at, lines = [monotonic()], []
    with subprocess.Popen(
        [sys.executable, "-m", "rps_exudyn", "animate", "r.h5"],
        env={**reader_environment(), "XDG_CACHE_HOME": str(tmp_path / "cache")},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout
        assert process.stderr
        for line in process.stderr:
            at.append(monotonic())
            lines.append(line)
        at.append(monotonic())
        out = process.stdout.read()
    assert (process.returncode, out) == (0, "written: r-animation.html\n")
    silence = max(later - earlier for earlier, later in pairwise(at))
    assert silence < SILENCE, lines
    expected = kernel_table().kernels("animate").total()
    counts = [tuple(map(int, found.groups())) for line in lines if (found := COUNT.search(line))]
    assert {total for _, total in counts} == {expected}
    assert [done for done, _ in counts] == sorted(done for done, _ in counts)
    assert re.match(rf"rps-exudyn: {expected} force laws compiled in \d+ s, once; later runs load", lines[-1])


def test_listener_ends_with_its_block() -> None:
    heard: list[Step] = []
    with listening(heard.append):
        begin_work("one")
    begin_work("two")
    assert heard == [Step("work", "one")]
