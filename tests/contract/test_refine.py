"""`refine`: estimate, confirm, halve. Runs are numbers here, wrong by a quarter of the error before."""

import numpy as np
import pytest

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Outcome, Status
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.metric_confirmation import (
    changes,
    confirmed,
    every_second,
    may_close,
    rolls_late,
    to_come,
    with_midpoints,
)
from rps_exudyn.scenes.refine import refine
from rps_exudyn.scenes.scene import RunOptions
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.simulate.run_plan import run_unchecked


def halved(error: float, times: int) -> float:
    assert error == pytest.approx(4.0 ** (1 - times))
    return error / 4


def difference(coarse: float, fine: float) -> float:
    return abs(coarse - fine)


def test_a_record_that_asks_for_nothing_is_not_made_again() -> None:
    refined = refine(1.0, halved, 5, asks=lambda error: error > 2)
    assert (refined.runs, refined.times, refined.confirmed) == ((1.0,), 0, False)


def test_a_run_is_refined_until_its_record_asks_for_no_more() -> None:
    refined = refine(1.0, halved, 5, asks=lambda error: error > 0.05)
    assert (refined.finest, refined.times) == (1 / 64, 3)


def test_a_finer_run_that_changes_little_confirms() -> None:
    """1 -> 1/4 changes 3/4, 1/4 -> 1/16 changes 3/16."""
    refined = refine(1.0, halved, 5, change=difference, allowed=0.2)
    assert (refined.runs, refined.confirmed) == ((1.0, 1 / 4, 1 / 16), True)
    assert refined.change == pytest.approx(3 / 16)


def test_too_few_refinements_confirm_nothing_and_say_what_is_left() -> None:
    refined = refine(1.0, halved, 2, change=difference, allowed=0.01)
    assert (refined.times, refined.confirmed, refined.change) == (2, False, pytest.approx(3 / 16))


def test_a_finer_run_that_fails_ends_it_beside_the_last_that_did_not() -> None:
    refined = refine(1.0, halved, 5, usable=lambda error: error > 0.1, change=difference)
    assert (refined.runs, refined.failed) == ((1.0, 1 / 4), 1 / 16)


def test_a_run_that_cannot_be_used_is_not_refined() -> None:
    refined = refine(1.0, halved, 5, usable=lambda error: False)
    assert (refined.runs, refined.failed) == ((1.0,), None)


# --- metrics that stand ----------------------------------------------------------------------------
def recorded(steps: int = 1, status: Status = Status.OK) -> SceneRun:
    """A run whose record has twice the instants each time that its steps are halved."""
    time = np.linspace(0.0, 1.0, 40 * steps + 1)
    return SceneRun(Outcome(status), {"time": time, "pinion_torque": 1 + 0.1 * np.sin(6 * time)})


def test_every_second_instant_keeps_the_ends_of_each_maneuver() -> None:
    """Two maneuvers of 5 and 4 instants, joined without a pause."""
    time = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 5.0, 6.0, 7.0])
    kept = every_second({"time": time, "place": np.stack([time, -time])})
    assert kept["time"] == pytest.approx([0.0, 2.0, 4.0, 4.0, 6.0, 7.0])
    assert kept["place"][1] == pytest.approx(-kept["time"])


@pytest.mark.parametrize(
    ("by", "left_out", "status"),
    [(0.01, False, Status.OK), (0.2, True, Status.OK), (0.2, True, Status.INVALID)],
)
def test_a_metric_that_half_the_steps_change_is_left_out(by: float, left_out: bool, status: Status) -> None:
    """A peak to peak that each halving changes by 1 % stands, by 20 % not; a run of which it is the figure is
    invalid. The mean stays."""

    def metrics(signals: dict[str, np.ndarray]) -> dict[str, float]:
        halvings = np.log2((signals["time"].size - 1) / 40)
        return {"torque_mean": 1.0, "torque_peak_to_peak": 0.2 * (1 + by) ** max(halvings, 0.0)}

    figure = "torque_peak_to_peak" if status is Status.INVALID else "torque_mean"
    run = confirmed(recorded(), metrics, lambda n: recorded(2**n), figure, most=2, always=True)
    assert run.outcome.status is status
    if status is Status.OK:
        assert ("torque_peak_to_peak" not in run.summary) == left_out
        assert (Code.METRIC_NOT_CONFIRMED in run.outcome.codes) == left_out
        assert run.summary["torque_mean"] == 1.0
        assert ("halvings" in run.outcome.findings) == left_out


def test_every_metric_declares_its_confirmation() -> None:
    """But for formulas, settings, checks, and those of rattle, which are given with their scatter."""
    without = {name for name, each in SUMMARY.items() if each.confirmed is None}
    shown = ("closed_form", "_set", "residual", "sticking_speed", "sliding_damping", "margin", "cap_force")
    assert all(name.endswith(shown) or name.startswith("rattle_") for name in without), without


def test_midpoints_lie_on_the_curve_of_each_maneuver() -> None:
    """A cubic exactly but beside the ends, where the parabola through three misses h^3 / 16 of its third
    derivative; nothing is added between two maneuvers."""
    time = np.linspace(0.0, 1.0, 9)
    both = {"time": np.append(time, 1 + time), "place": np.append(time**3, [0.0] * 9)}
    found = with_midpoints(both)
    assert found["time"] == pytest.approx([*np.linspace(0, 1, 17), *np.linspace(1, 2, 17)])
    missed = np.abs(found["place"][:17] - np.linspace(0, 1, 17) ** 3)
    assert missed[[1, -2]] == pytest.approx(6 / 8**3 / 16)
    assert missed[2:-2].max() < 1e-12
    assert not found["place"][17:].any()


@pytest.mark.parametrize("smooth", [False, True])
def test_extremes_that_every_second_instant_shows_too_may_lie_between_instants(smooth: bool) -> None:
    """The vertex of a parabola lies between two of four instants, of which one in two shows the same: 2 of
    2.25."""

    def made(halvings: int) -> SceneRun:
        time = np.linspace(0.0, 3.0, 3 * 2**halvings + 1)
        return SceneRun(Outcome(Status.OK), {"time": time, "pinion_torque": -((time - 1.5) ** 2)})

    def metrics(signals: dict[str, np.ndarray]) -> dict[str, float]:
        return {"torque_peak_to_peak": float(np.ptp(signals["pinion_torque"])), "torque_mean": 1.0}

    run = confirmed(made(0), metrics, made, "torque_mean", most=4, smooth=smooth)
    assert (run.outcome.findings.get("halvings", 0) > 0) == smooth
    assert run.summary["torque_peak_to_peak"] == pytest.approx(2.25 if smooth else 2.0)


@pytest.mark.parametrize("place", [3.2, 3.5, 3.9])
@pytest.mark.parametrize("sign", [1, -1])
def test_kinks_between_instants_are_seen(place: float, sign: int) -> None:
    """The peak of two slopes that meet between two of nine instants; a slope that only grows there leaves the
    cubic by as much as the kink stands out. Of two racks each its own."""
    time = np.arange(9.0)
    peak = sign * np.minimum(2 * (time - place), place - time)
    grows = sign * np.minimum(3 * (time - place), time - place)
    found = with_midpoints({"time": time, "place": np.stack([peak, grows])})
    assert found["time"] == pytest.approx(np.arange(0.0, 8.1, 0.5))
    top, beside = found["place"][:, 7]
    assert top == pytest.approx(0.0, abs=1e-12)
    s, t, cubic = place - 3, 4 - place, (9 * (grows[3] + grows[4]) - grows[2] - grows[5]) / 16
    assert sign * (beside - cubic) == pytest.approx(s * t * (1 + s) * (1 + t) * 2 / 3)


def test_half_of_the_instants_may_miss_twice_as_much_of_a_steady_motion() -> None:
    """A mean that every second instant moves by 3 % is not made again, one that it moves by 5 % is."""

    def halvings(moved: float) -> int:
        def made(times: int) -> SceneRun:
            time = np.arange(0.0, 40.0)
            return SceneRun(Outcome(Status.OK), {"time": time, "pinion_torque": np.full(40, 1.0)})

        def metrics(signals: dict[str, np.ndarray]) -> dict[str, float]:
            return {"torque_mean": 1.0 + (moved if signals["time"].size < 40 else 0.0)}

        run = confirmed(made(0), metrics, made, "torque_mean", most=2, smooth=True)
        return int(run.outcome.findings.get("halvings", 0))

    assert (halvings(0.03), halvings(0.05)) == (0, 1)


def test_metrics_that_are_asked_for_are_those_of_a_run_that_has_all() -> None:
    """What is not asked for is neither there nor a reason for finer steps; a scene's own figure always is."""
    gear, model = (
        SteeringGear().replace({"mesh.law": "teeth", "test.turns": 1 / 6}),
        Fidelity.preset("quasi-static"),
    )
    some = RunOptions(figures=frozenset({"efficiency_ratio"}))
    whole, part = (run_unchecked("load-test", gear, model, each) for each in (RunOptions(), some))
    assert set(part.summary) == {"efficiency_ratio", scene_named("load-test").figure}
    assert part.findings.get("halvings", 0) < whole.findings["halvings"]
    for name, value in part.summary.items():
        assert value == pytest.approx(whole.summary[name], rel=1e-3)


def test_a_finer_run_that_fails_midway_needs_no_metrics() -> None:
    """Its record holds only a part of the motion; the coarse run, which it does not confirm, is invalid."""

    def made(times: int) -> SceneRun:
        outcome = Outcome(Status.NO_CONVERGENCE, "no equilibrium") if times else Outcome(Status.OK)
        return SceneRun(outcome, {"time": np.arange(4.0 if times else 40.0)})

    def metrics(signals: dict[str, np.ndarray]) -> dict[str, float]:
        if signals["time"].size < 10:
            raise ValueError("a load test needs a record of raising and of lowering")
        return {"efficiency_forward": 1.0 + (0.2 if signals["time"].size < 40 else 0.0)}

    run = confirmed(made(0), metrics, made, "torque_mean", most=2, smooth=True)
    assert run.outcome.status is Status.INVALID
    assert run.outcome.codes == (Code.STEPS_NOT_CONFIRMED,)
    assert run.outcome.message.endswith("fails: no equilibrium")


def test_a_late_rolling_is_half_a_step_of_its_fastest_over_its_range() -> None:
    """Of a sine with n steps in a period pi / n; of many racks one each."""
    time = np.linspace(0.0, 1.0, 41)
    roll = np.stack([np.sin(2 * np.pi * time), np.sin(4 * np.pi * time)])
    assert rolls_late({"time": time, "rack_roll": roll}) == pytest.approx(
        np.pi / np.array([40, 20]), rel=0.02
    )
    assert rolls_late({"time": time}) == 0


@pytest.mark.parametrize(
    ("found", "ahead"),
    [
        ((0.4,), 0.4),  # of first order as much again is left
        ((1.6, 0.4), 0.4),
        ((0.5, 0.4), 1.2),  # it hardly shrinks
        ((1.5, 0.0, 0.3), 0.3),  # by two halvings it does
        ((0.6, 0.2, 0.4), 1.2),
        ((0.0, 0.1), 0.1),  # there is nothing to compare it with
    ],
)
def test_what_is_to_come_follows_from_how_changes_shrink(found: tuple[float, ...], ahead: float) -> None:
    assert to_come([{"torque_mean": each} for each in found])["torque_mean"] == pytest.approx(ahead)


@pytest.mark.parametrize(
    ("drifts", "may"),
    [
        ([9.0], True),  # too few to see
        ([3.3, 3.1, 3.0, 2.6], False),  # 48 cycles would leave 1.8
        ([4.5, 9.0, 15.0, 3.0], True),
        ([12.0, 29.0, 36.0, 40.0], False),
    ],
)
def test_a_swing_that_drifts_on_is_not_begun_once_more(drifts: list[float], may: bool) -> None:
    assert may_close(drifts, (0, 1, 4, 16, 48)) is may


@pytest.mark.quick
def test_a_metric_that_scatters_may_change_by_twice_its_uncertainty() -> None:
    """Without an uncertainty by 5 %; an uncertainty itself by a quarter, beside a tenth of the metric."""
    coarse = {"rattle_force_rms": 100.0, "rattle_force_rms_uncertainty": 10.0}
    finer = {"rattle_force_rms": 120.0, "rattle_force_rms_uncertainty": 12.5}
    assert changes(coarse, finer, {}) == pytest.approx(
        {"rattle_force_rms": 0.8, "rattle_force_rms_uncertainty": 2.5 / 12.5 / 0.25}
    )
    alone = {"rattle_force_rms": 100.0}, {"rattle_force_rms": 105.0}
    assert changes(*alone, {})["rattle_force_rms"] == pytest.approx(5 / 105 / 0.05)
