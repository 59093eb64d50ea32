"""A long run tells a listener how far it is, also from a process of its own; a short one tells nothing."""

from pathlib import Path

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.assessment.requirements.judging import judge
from rps_exudyn.base import progress
from rps_exudyn.base.progress import Progress, begin_part, following, passed_on, reached
from rps_exudyn.base.screen import with_time_left
from rps_exudyn.inference.uncertainty.input_sets import uncertain_inputs
from rps_exudyn.results.requirements import read_limits
from rps_exudyn.study.cases import describe
from rps_exudyn.study.study_file import read_study
from study_files import write_grid


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """A clock whose time is set by hand [s]."""
    now = [100.0]
    monkeypatch.setattr(progress, "monotonic", lambda: now[0])
    return now


def test_time_left_follows_from_what_is_done(clock: list[float]) -> None:
    told: list[Progress] = []
    with following(told.append):
        reached(0.0, lambda: "0 deg")
        clock[0] += 4
        reached(0.25, lambda: "90 deg")
    assert told == [Progress("90 deg", 0.25, 4.0, 12.0)]
    assert told[0].sentence == "90 deg, 25 %, 12 s left"


def test_nothing_is_reported_until_time_left_follows_from_what_is_done(clock: list[float]) -> None:
    """The run-in before the motion has a negative share, and the first step that is noted no duration."""
    reports: list[Progress] = []
    with following(reports.append):
        for seconds, fraction in ((30, -0.1), (31, -0.05), (32, 0.1), (33, 1.0), (40, 0.0), (42, 0.5)):
            clock[0] = 100.0 + seconds
            reached(fraction, str)
    assert [(each.fraction, each.left) for each in reports] == [
        (0.1, pytest.approx(2 * 0.9 / 0.2)),
        (1.0, 0.0),
        (0.5, pytest.approx(2.0)),  # the next run counts from its own first step
    ]


def test_short_runs_tell_nothing_and_long_ones_not_every_step(clock: list[float]) -> None:
    told: list[Progress] = []
    with following(told.append):
        for step in range(100):
            clock[0] += 0.1
            reached(step / 100, str)
    first, last = told[0], told[-1]
    assert first.elapsed >= progress.FIRST
    assert np.diff([each.elapsed for each in told]).min() >= progress.INTERVAL - 1e-9
    assert len(told) == pytest.approx((10 - progress.FIRST) / progress.INTERVAL, abs=2)
    assert last.fraction > first.fraction


def test_parts_count_as_shares_of_the_whole(clock: list[float]) -> None:
    told: list[Progress] = []
    with following(told.append):
        reached(0.0, str)
        begin_part(1, 2)
        clock[0] += 3
        reached(0.5, str)
    assert told[0].fraction == 0.75


def test_what_another_process_tells_is_passed_on() -> None:
    told: list[Progress] = []
    there = Progress("1 deg", 0.5, 3.0, 3.0)
    with following(told.append):
        passed_on(there)
    passed_on(there)  # to nobody
    assert told == [there]


def test_listener_ends_with_its_block(clock: list[float]) -> None:
    told: list[Progress] = []
    with following(told.append):
        clock[0] += 9
    reached(0.5, str)
    assert not told


def test_motion_in_exudyn_tells_how_much_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    """From the first steps to the whole run; a run whose end is unknown would stay at nothing."""
    monkeypatch.setattr(progress, "FIRST", 0.0)
    monkeypatch.setattr(progress, "INTERVAL", 0.0)
    told: list[Progress] = []
    result = rps.run("free-pinion-torque", fidelity="flank", progress=told.append, turns=0.2)
    assert result.status == "ok"
    fractions = [each.fraction for each in told if each.place.endswith("deg")]
    assert fractions == sorted(fractions)
    assert fractions[0] < 0.3
    assert fractions[-1] == pytest.approx(1.0)


def test_laying_out_many_cases_tells_how_many(clock: list[float], tmp_path: Path) -> None:
    told: list[Progress] = []
    study = read_study(write_grid(tmp_path / "s.toml", *range(100, 140)))

    def later(word: Progress) -> None:
        told.append(word)
        clock[0] += 1.0

    with following(later):
        reached(0.0, str)
        clock[0] += 3.0
        assert len(describe(study, {}).cases) == 40
    assert told[0].place == "1 cases laid out"
    assert told[-1].place == "39 cases laid out"
    assert told[-1].fraction == pytest.approx(39 / 40)


@pytest.mark.parametrize(
    ("fraction", "text"),
    [(None, "x"), (0.0, "x"), (0.25, "x, 30 s left"), (0.999, "x, 0.01 s left"), (1.0, "x")],
)
def test_every_command_shows_the_time_left_where_it_is_known(fraction: float | None, text: str) -> None:
    assert with_time_left("x", fraction, 10.0) == text


def test_check_counts_the_samples_of_all_its_bands() -> None:
    """The shares rise from 0 to 1 over three bands, whose samples count alike."""
    told: list[tuple[str, float]] = []
    gear = rps.SteeringGear()
    inputs = uncertain_inputs(gear, None, {})
    assert (
        len(list(judge(gear, inputs, read_limits(), samples=8, on_progress=lambda *each: told.append(each))))
        == 10
    )
    shares = [share for _, share in told]
    assert shares[0] == 0
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)
    assert len({text for text, _ in told}) == 3
