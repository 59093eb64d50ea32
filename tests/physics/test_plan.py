"""Plans of tests: what they promise is what fits of synthetic benches print, and no cheaper programme "
"keeps it."""

from pathlib import Path

import numpy as np
import pytest

from rps_exudyn.base.errors import InputError
from rps_exudyn.inference.fitting.bench_tests import measurement_of, named_test
from rps_exudyn.inference.fitting.fit import fit
from rps_exudyn.inference.fitting.plan import (
    MINUTES,
    USUAL_TARGETS,
    parse_targets,
    plan,
    programme,
    read_minutes,
)
from rps_exudyn.parameters.gear import SteeringGear
from shell import Command, refusal_of
from verification.made_up_curves import BenchNoise, measured_curve, true_curve, with_noise

NOISE = BenchNoise(repeatability=0.02, zero=0.02, white=0.005)
WITH_ROLLERS = ("free", "yoke-out", "bearing", "rack-on-rollers", "load-test@150kg")
BY_WEIGHTS = tuple(
    f"{each} x 3"
    for each in ("free", "yoke-out", "bearing", "load-test@40kg", "load-test@80kg", "load-test@150kg")
)


def halves_of_fit(tests: dict[str, int], seed: int, gear: SteeringGear) -> dict[str, float]:
    """Half intervals of the value that a fit prints of a synthetic bench."""
    random, curves = np.random.default_rng(seed), []
    for name, runs in tests.items():
        test, _ = named_test(f"{name}=none")
        curve = true_curve(gear, test)
        curves += [measured_curve(with_noise(curve, NOISE, random), test) for _ in range(runs)]
    found = fit(measurement_of(curves), gear)
    return {path: found.estimate(path).high / found.estimate(path).value - 1 for path in USUAL_TARGETS}


@pytest.mark.parametrize(
    "changed",
    [
        {},
        pytest.param(
            {"yoke.preload": 400.0, "yoke.friction": 0.08, "bush.drag": 30.0}, marks=pytest.mark.long
        ),
    ],
)
def test_a_plan_keeps_its_promise_on_synthetic_benches(changed: dict[str, float]) -> None:
    """Within a fifth, the other contact law and the nuisances included."""
    gear = SteeringGear().replace(changed)
    planned = plan(USUAL_TARGETS, gear)
    assert not planned.missed
    printed = halves_of_fit({each.test.title: each.runs for each in planned.tests}, 3, gear)
    for path, half in printed.items():
        assert half == pytest.approx(planned.half_intervals[path], rel=0.2), path


def test_rollers_beat_weights_in_both_frictions() -> None:
    """Five tests, one run each, against six tests, three runs each."""
    rollers, weights = programme(WITH_ROLLERS), programme(BY_WEIGHTS)
    assert rollers.minutes < 0.7 * weights.minutes
    for path in ("mesh.friction", "yoke.friction"):
        assert rollers.half_intervals[path] < 0.6 * weights.half_intervals[path]


def test_no_run_of_a_plan_can_be_left_out() -> None:
    planned = plan(USUAL_TARGETS)
    runs = {each.test.title: each.runs for each in planned.tests}
    for title in runs:
        if title == "free" and runs[title] == 1:
            continue
        fewer = {**runs, title: runs[title] - 1}
        without = programme([f"{name} x {count}" for name, count in fewer.items() if count])
        assert any(without.half_intervals[path] > target for path, target in USUAL_TARGETS.items()), title


def test_times_decide_which_test_is_planned(tmp_path: Path) -> None:
    """Where turning without the yoke takes a day, another programme is planned if one reaches the target."""
    table = tmp_path / "bench.toml"
    table.write_text("[rack-on-rollers]\nsetup = 2000\n[free]\nrun = 9\n")
    minutes = read_minutes(table)
    assert minutes["free"].run == 9
    assert minutes["free"].setup == MINUTES["free"].setup
    target = {"yoke.preload": 0.25}
    cheap, dear = plan(target), plan(target, minutes=minutes)
    assert "rack-on-rollers" not in {each.test.title for each in dear.tests}
    assert dear.minutes >= cheap.minutes


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("yoke.preload", "write half of the 95 % interval"),
        ("yoke.preload=0%", "more than 0 and at most 100 %"),
        ("yoke.preload=nan", "more than 0 and at most 100 %"),
        ("rack.bow=5%", "rack.bow is no target; there are yoke.preload"),
    ],
)
def test_targets_that_cannot_be_are_refused(text: str, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        parse_targets([text])


def test_tables_of_minutes_that_cannot_be_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "bench.toml"
    for text, sentence in (
        ("[walk]\nrun = 1\n", r"\[walk\] is no test; there are free"),
        ("[free]\nrun = 0\n", "free.run is 0; it must be a number of minutes"),
        ("[free]\nrun = true\n", "free.run is True"),
        ("[free]\nhours = 1\n", "free.hours is no time; there are setup and run"),
    ):
        path.write_text(text)
        with pytest.raises(InputError, match=sentence):
            read_minutes(path)


def test_the_command_prints_the_plan_and_says_what_cannot_be_reached(command: Command) -> None:
    done = command(["plan-tests", "yoke.preload=20%", "mesh.friction=35%"])
    assert done.status == 0, done.err
    assert "plan · wanted: yoke.preload +-20 %, mesh.friction +-35 %" in done.out
    assert "load-test@" in done.out
    missed = command(["plan-tests", "bush.drag=20%"])
    assert missed.status == 1
    assert "no number of runs brings bush.drag below" in missed.out
    assert "use rps-exudyn plan-tests" in refusal_of(command(["fit", "--plan", "bush.drag=20%"]))
