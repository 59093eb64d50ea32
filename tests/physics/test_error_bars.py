"""Error bars: two levels of one ladder, and what both levels share."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Outcome, Status
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.error_bars import FACTOR, FLOOR, error_bars
from rps_exudyn.scenes.ladder import KNOBS, cycles_before, gear_at, model_at
from rps_exudyn.scenes.maneuver import maneuvers_of_test, swing_maneuver
from rps_exudyn.scenes.rattle import shaken_by_road
from rps_exudyn.scenes.scene import DEFAULT_OPTIONS, RunOptions
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.scenes.steering_torque import torque_maneuver
from rps_exudyn.scenes.stick_slip import set_off
from rps_exudyn.scenes.two_levels import Levels
from rps_exudyn.scenes.yoke_impact import shaken

STILL = Fidelity.preset("quasi-static")
SHORT = {"test.turns": 1 / 6}  # a tooth pitch
ODD = SteeringGear().replace({"pinion.teeth": 7, "pinion.runout": "20 um", "test.tyre_stiffness": "50 N/mm"})


# --- the ladder --------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "maneuver",
    [
        lambda: maneuvers_of_test(ODD, "pinion", np.deg2rad(1.3))[0],
        lambda: maneuvers_of_test(ODD.replace({"test.turns": 0.31}), "rack", np.deg2rad(0.7))[0],
        lambda: swing_maneuver(ODD, np.deg2rad(1.3)),
        lambda: torque_maneuver(ODD),
        lambda: set_off(ODD),
        lambda: shaken(ODD),
        lambda: next(shaken_by_road(ODD)),
    ],
)
@pytest.mark.quick
def test_a_level_has_all_instants_of_the_level_below(maneuver: Callable[[], Any]) -> None:
    """So that signals of two levels are compared where both have a value; the record keeps its ends."""
    usual = maneuver()
    levels = [usual.halved(level - 1) for level in range(3)]
    for coarse, fine in pairwise(levels):
        assert fine.time[::2] == pytest.approx(coarse.time, abs=1e-12 * coarse.time[-1])
        assert fine.record_start == pytest.approx(coarse.record_start)


@pytest.mark.quick
@pytest.mark.parametrize("preset", ["quasi-static", "flank", "full"])
def test_each_level_is_finer_in_every_knob(preset: str) -> None:
    fidelity = Fidelity.preset(preset)
    levels = [model_at(level, fidelity) for level in range(4)]
    for coarse, fine in pairwise(levels):
        for name in {"tolerance", "zone_ratio"}:
            assert getattr(fine, name) == pytest.approx(getattr(coarse, name) / 2)
        assert fine.chord_error == pytest.approx(coarse.chord_error / 4)
        for name in {*KNOBS} - {"tolerance", "zone_ratio", "chord_error", "step_angle", "swing_steps"}:
            assert getattr(fine, name) > getattr(coarse, name), name
    assert model_at(1, fidelity) == fidelity
    modes = [gear_at(level, SteeringGear()).rack.modes for level in range(4)]
    assert modes == [4, 8, 16, 32]
    assert [cycles_before(level) for level in range(5)] == [0, 1, 2, 4, 8]


# --- the rule ----------------------------------------------------------------------------------------
TIME = np.linspace(0.0, 1.0, 65)


def record(error: Callable[[np.ndarray], np.ndarray], step: int) -> dict[str, np.ndarray]:
    """A torque over a turn, off by an error times the steps' length, at every instant of so many."""
    time = TIME[::step]
    torque = 1 + 0.1 * np.sin(4 * np.pi * time) + step * error(time)
    return {"time": time, "pinion_angle": 2 * np.pi * time, "pinion_torque": torque}


def metrics(signals: Any) -> dict[str, Any]:
    torque = signals["pinion_torque"]
    return {
        "torque_mean": np.trapezoid(torque, signals["time"], axis=-1),
        "torque_peak_to_peak": np.ptp(torque, axis=-1),
    }


def bars(error: Callable[[np.ndarray], np.ndarray], scale: float = 1.0) -> dict[str, Any]:
    fine, coarse = (
        {name: values * (scale if name == "pinion_torque" else 1.0) for name, values in each.items()}
        for each in (record(error, 1), record(error, 2))
    )
    return error_bars(metrics, fine, metrics(fine), coarse, metrics(coarse))


@pytest.mark.quick
def test_errors_of_first_order_are_covered_twice() -> None:
    """The error of the finer level is the change between both, and the bar twice that."""
    found = bars(lambda time: np.full(time.size, 0.01))
    assert found["torque_mean"] == pytest.approx(FACTOR * 0.01)


@pytest.mark.quick
def test_an_error_of_one_instant_counts_for_extremes_though_they_agree_by_chance() -> None:
    """An error at the zeros of the ripple leaves its peaks, and the mean, on both levels."""
    found = bars(lambda time: 0.02 * np.sin(2 * np.pi * time) * np.cos(4 * np.pi * time) ** 8)
    assert found["torque_peak_to_peak"] >= FACTOR * 0.009
    assert found["torque_mean"] < 0.3 * found["torque_peak_to_peak"]


@pytest.mark.quick
def test_levels_that_agree_have_the_least_bar() -> None:
    found = bars(np.zeros_like)
    assert found["torque_mean"] == pytest.approx(FLOOR, rel=1e-9)


@pytest.mark.quick
def test_bars_grow_as_their_signals() -> None:
    """Similarity: a torque ten times as large has bars ten times as large."""

    def error(time: np.ndarray) -> np.ndarray:
        return 0.01 * np.cos(9 * time)

    once, tenfold = bars(error), bars(error, 10.0)
    assert all(tenfold[name] == pytest.approx(10 * once[name]) for name in once)


@pytest.mark.quick
def test_bars_of_many_records_are_those_of_each() -> None:
    errors = [lambda time: 0.01 * np.cos(9 * time), np.zeros_like]
    each = [bars(error) for error in errors]
    fine, coarse = (
        {**record(np.zeros_like, step)}
        | {"pinion_torque": np.stack([record(error, step)["pinion_torque"] for error in errors])}
        for step in (1, 2)
    )
    many = error_bars(metrics, fine, metrics(fine), coarse, metrics(coarse))
    for name in many:
        assert many[name] == pytest.approx([one[name] for one in each])


# --- runs --------------------------------------------------------------------------------------------
@pytest.mark.parametrize("scene", ["free-pinion-torque", "reversal", "rack-lift"])
def test_metrics_of_a_finer_level_lie_within_the_bars(scene: str) -> None:
    """Level 3 halves the steps twice more; its bar of the main metric is no wider than that of level 1."""
    gear = SteeringGear().replace(SHORT | {"pinion.runout": "20 um"})
    usual, fine = (rps.run(scene, gear, fidelity="quasi-static", level=level) for level in (1, 3))
    assert (usual.findings["level"], fine.findings["level"]) == (1, 3)
    assert usual.errors.keys() == {name for name in usual.summary if SUMMARY[name].simulated}
    main = scene_named(scene).main_metric
    off = {name: abs(usual.summary[name] - fine.summary[name]) / bar for name, bar in usual.errors.items()}
    assert off[main] <= 1
    assert np.quantile([*off.values()], 0.9) <= 1, off
    assert fine.errors[main] <= 1.01 * usual.errors[main]


def test_level_0_has_the_bar_of_levels_0_and_1() -> None:
    gear = SteeringGear().replace(SHORT)
    coarse, usual = (
        rps.run("free-pinion-torque", gear, fidelity="quasi-static", level=level) for level in (0, 1)
    )
    assert coarse["time"].size == usual["time"].size // 2 + 1
    assert coarse.findings["level"] == 0
    assert coarse.errors["torque_peak_to_peak"] == pytest.approx(
        usual.errors["torque_peak_to_peak"], rel=0.05
    )


@pytest.mark.parametrize(("lost", "printed", "known"), [((0,), 2, True), ((0, 2), 1, False)])
def test_the_next_level_serves_where_the_companion_is_lost(
    lost: tuple[int, ...], printed: int, known: bool
) -> None:
    scene = scene_named("free-pinion-torque")

    def run(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
        if options.level in lost:
            return SceneRun(Outcome(Status.NO_CONVERGENCE, "lost"))
        return scene.run(gear, fidelity, options)

    gear = SteeringGear().replace(SHORT)
    found = Levels(replace(scene, run=run), gear, STILL, DEFAULT_OPTIONS).with_bars(1)
    assert found.ok
    assert found.outcome.findings["level"] == printed
    assert np.isfinite(found.errors["torque_mean"]) == known


def test_inertia_that_equilibria_leave_out_is_in_their_bars() -> None:
    """At 600 rpm the first order of the runout is 10 % below that of dynamics."""
    gear = SteeringGear().replace({"pinion.runout": "20 um", "test.speed": "600 rpm"})
    still, moving = (rps.run("free-pinion-torque", gear, fidelity=name) for name in ("quasi-static", "flank"))
    lacking = abs(still.summary["torque_first_order"] - moving.summary["torque_first_order"])
    assert 0.08 * moving.summary["torque_first_order"] < lacking <= still.errors["torque_first_order"]


def test_a_motion_that_inertia_changes_altogether_is_no_equilibrium() -> None:
    gear = SteeringGear().replace({"pinion.runout": "60 um", "test.speed": "12000 rpm"})
    result = rps.run("free-pinion-torque", gear, fidelity="quasi-static")
    assert result.status is Status.INVALID
    assert Code.TURN_TOO_FAST in result.codes


@pytest.mark.parametrize(
    ("fidelity", "law", "is_marked"),
    [("quasi-static", "stribeck", True), ("quasi-static", "coulomb", False), ("flank", "stribeck", False)],
)
def test_equilibria_with_friction_larger_at_rest_are_marked(fidelity: str, law: str, is_marked: bool) -> None:
    gear = SteeringGear().replace(SHORT | {"yoke.friction_law": law, "yoke.static_ratio": 1.2})
    result = rps.run("free-pinion-torque", gear, fidelity=fidelity)
    assert (Code.BARS_SHORT in result.codes) == is_marked
    assert result.errors["torque_mean"] > 0


def test_formulas_have_the_bar_of_their_model() -> None:
    formula, still = (
        rps.run("free-pinion-torque", fidelity=name) for name in ("closed-form", "quasi-static")
    )
    off = abs(formula.summary["torque_mean"] - still.summary["torque_mean"])
    assert 0 < off <= formula.errors["torque_mean"]


def test_bars_of_gears_together_are_those_of_single_runs() -> None:
    gear, values = SteeringGear().replace(SHORT), {"yoke.preload": np.linspace(250.0, 350.0, 12)}
    found = rps.batch("free-pinion-torque", gear, values)
    assert found.in_loop.all()
    alone = rps.run("free-pinion-torque", gear.replace({"yoke.preload": 250.0}), fidelity="quasi-static")
    for name in ("torque_mean", "torque_peak_to_peak", "rack_roll_range"):
        assert found.errors[name][0] == pytest.approx(alone.errors[name], rel=0.1), name


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"level": -1}, "level is -1; it must be a whole number from 0 to 8"),
        ({"level": 1.5}, "level is 1.5; it must be a whole number"),
        ({"level": True}, "level is True; it must be a whole number"),
        ({"level": 1, "fidelity": "closed-form"}, "closed-form, which has no level"),
        ({"level": 1, "accuracy": "1%"}, "accuracy chooses the level itself"),
        (
            {"level": 1, "fidelity": STILL.replace({"step_angle": "2 deg"})},
            "level decides fidelity.step_angle",
        ),
    ],
)
def test_wrong_levels_get_one_sentence(asked: dict[str, Any], said: str) -> None:
    with pytest.raises(rps.InputError, match=said):
        rps.run("free-pinion-torque", **asked)
