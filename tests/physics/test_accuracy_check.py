"""Runs that `--accuracy` chose give way to finer ones until two in a row agree."""

from functools import partial

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.analysis.curve import difference
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Outcome, Status
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.simulate.accuracy_check import SLOW, Wanted, error_between, finer_than, kept_by, taken_step
from rps_exudyn.simulate.run import simulate
from verification.law_area import by_law

SCENE, SIGNAL = "free-pinion-torque", "pinion_torque"
GEAR = SteeringGear().replace({"mesh.law": "teeth", "test.turns": 0.3})
STILL = Fidelity.preset("quasi-static")
RUN = partial(simulate, SCENE)


@pytest.mark.parametrize("wanted", [0.1])
def test_a_first_choice_that_is_too_coarse_is_refined_until_it_keeps_what_is_wanted(wanted: float) -> None:
    """Steps of 12 degrees miss 0.85 %; the reference has steps of a tenth of a degree."""
    coarse, fine = (STILL.replace({"step_angle": step}) for step in ("12 deg", "0.1 deg"))
    result = kept_by(RUN, Wanted(SCENE, SIGNAL, wanted), GEAR, coarse)
    taken = STILL.replace({name: result.fidelity[name] for name in ("step_angle", "strip_stations")})
    runs = (RUN(GEAR, coarse), result, RUN(GEAR, fine))
    curves = [scene_named(SCENE).curve(each.signals, GEAR, taken) for each in runs]
    assert difference(curves[0], curves[2]) > wanted
    assert difference(curves[1], curves[2]) <= wanted
    assert "half the steps" in result.findings["accuracy_checked"]


def test_a_first_choice_that_is_confirmed_is_kept() -> None:
    first = STILL.replace({"step_angle": "1 deg"})
    result = kept_by(RUN, Wanted(SCENE, SIGNAL, 1.0), GEAR, first)
    assert result.fidelity == first.model_dump()


def test_a_number_of_the_summary_is_confirmed_by_itself() -> None:
    """The mean of steps of 12 degrees is right to 1 %, the curve is not to 0.2 %."""
    coarse, wanted = STILL.replace({"step_angle": "12 deg"}), 0.2
    mean = kept_by(RUN, Wanted(SCENE, "torque_mean", wanted), GEAR, coarse)
    curve = kept_by(RUN, Wanted(SCENE, SIGNAL, wanted), GEAR, coarse)
    assert "torque_mean differs by" in mean.findings["accuracy_checked"]
    assert mean.fidelity["step_angle"] > curve.fidelity["step_angle"]


def test_a_scene_with_steps_of_its_own_is_run_once() -> None:
    runs = []

    def run(gear: SteeringGear, fidelity: Fidelity) -> rps.Result:
        runs.append(fidelity)
        return RUN(GEAR, STILL)

    kept_by(run, Wanted("yoke-impact", "impact_peak_force", 1.0), GEAR, Fidelity.preset("flank"))
    assert len(runs) == 1


SHORT = SteeringGear().replace({"test.pulse_duration": "4 ms", "test.pulse_period": "4 ms"})


def test_an_impact_is_confirmed_by_half_the_steps_of_a_swing() -> None:
    """8 steps per swing of the plunger against 16, the peak to 1 %; what is kept is that near to 40 steps."""
    first = Fidelity.preset("flank").replace({"swing_steps": 8})
    run, taken = partial(simulate, "yoke-impact"), []

    def noted(gear: SteeringGear, fidelity: Fidelity) -> rps.Result:
        taken.append((fidelity.swing_steps, fidelity.step_angle))
        return run(gear, fidelity)

    result = kept_by(noted, Wanted("yoke-impact", "impact_peak_force", 1.0), SHORT, first)
    assert [steps for steps, _ in taken][:2] == [8, 16]
    assert {angle for _, angle in taken} == {first.step_angle}
    assert "impact_peak_force differs by" in result.findings["accuracy_checked"]
    fine = run(SHORT, first.replace({"swing_steps": 40}))
    peak = fine.summary["impact_peak_force"]
    assert result.summary["impact_peak_force"] == pytest.approx(peak, rel=0.01)


@pytest.mark.quick
def test_where_nothing_is_hit_there_is_no_error() -> None:
    """Neither run has a peak: no error; one of two has one: no number says how large it is."""
    hit, missed = (SceneRun(Outcome(Status.OK), {}, figures) for figures in ({"impact_peak_force": 2.0}, {}))
    model = Fidelity.preset("flank")
    both = partial(error_between, "impact_peak_force", "yoke-impact", GEAR)
    assert both((missed, model), (missed, model)) == both((hit, model), (hit, model)) == 0
    assert np.isnan(both((hit, model), (missed, model)))
    assert np.isnan(both((missed, model), (hit, model)))


def test_a_choice_whose_finer_run_fails_says_that_it_is_not_confirmed() -> None:
    first = STILL.replace({"step_angle": "1 deg"})

    def run(gear: SteeringGear, fidelity: Fidelity) -> rps.Result:
        gear = GEAR if fidelity == first else by_law(GEAR.replace({"mesh.stiffness": 1e11}), "area")
        return simulate(SCENE, gear, fidelity)

    result = kept_by(run, Wanted(SCENE, SIGNAL, 1.0), GEAR, first)
    assert result.status == "ok"
    assert result.findings["accuracy_checked"].startswith("not confirmed: in finer steps it ends invalid")
    assert "the accuracy asked for is in doubt: not confirmed: in finer steps" in result.message


@pytest.mark.parametrize(
    ("rpm", "moved_by", "said"),
    [
        (15, 0.1, ""),
        (120, 0.003, ", dynamics by 0.3 %"),
        (120, 0.1, "NOT promised: the gear vibrates at this speed: dynamics differ by 9.1 %"),
    ],
)
def test_equilibria_of_a_fast_test_are_compared_with_dynamics(rpm: float, moved_by: float, said: str) -> None:
    """What dynamics find is made up: the equilibria's torque, by a share larger."""
    gear, first = GEAR.replace({"test.speed": f"{rpm} rpm"}), STILL.replace({"step_angle": "1 deg"})
    still = RUN(GEAR, first)
    asked = []

    def run(gear: SteeringGear, fidelity: Fidelity) -> rps.Result:
        if fidelity.solver == "equilibrium":
            return still
        asked.append(gear.test.turns * gear.pinion.teeth)
        moved = {**still.signals, SIGNAL: (1 + moved_by) * still.signals[SIGNAL]}
        return rps.Result(**{**vars(still), "signals": moved})

    found = kept_by(run, Wanted(SCENE, SIGNAL, 1.0), gear, first).findings["accuracy_checked"]
    assert said in found
    assert ("dynamics" in found) == bool(asked) == (gear.test.speed > 3 * SLOW)
    assert all(pitches <= 2 for pitches in asked)


def test_dynamics_take_the_place_of_equilibria_that_do_not_run() -> None:
    """A heavy rack over 50 um of runout, too fast for equilibria; asked for by name they are not replaced."""
    heavy = {
        "pinion.runout": "50 um",
        "rack.density": "40000 kg/m^3",
        "test.turns": 2,
        "test.speed": "2400 rpm",
    }
    gear = SteeringGear().replace(heavy)
    result = rps.run(SCENE, gear, accuracy="4%")
    assert result.fidelity["solver"] == "generalized-alpha"
    assert result.findings["accuracy"].startswith("quasi-static ends invalid: the motion is too fast")
    assert rps.run(SCENE, gear, accuracy="4%", fidelity="quasi-static").status == "invalid"


def test_a_run_in_halved_steps_is_not_confirmed_by_those_that_it_took() -> None:
    """Steps of 8 degrees halved to 4 on the way there, to 2 on the way back: the finer run must be below."""
    angle = np.radians(np.concatenate([np.arange(0, 61, 4.0), np.arange(60, -1, -2.0)]))
    time = np.concatenate([np.arange(16) * 4.0, np.arange(31) * 2.0 + 60])
    made = RUN(GEAR, STILL)
    signals = {"time": time, "pinion_angle": angle, SIGNAL: np.ones(angle.size)}
    result = rps.Result(**{**vars(made), "signals": signals, "findings": {"halvings": 1}})
    model = STILL.replace({"step_angle": "8 deg"})
    assert taken_step(result, SCENE, model) == pytest.approx(np.radians(2))
    assert taken_step(result, "reversal", model) == pytest.approx(np.radians(4))


@pytest.mark.quick
def test_strips_are_refined_up_to_the_finest_that_show_anything() -> None:
    model = STILL
    for _ in range(6):
        model = finer_than(model, model.step_angle)
    assert (model.strip_stations, model.strip_points) == (12, 6)
    assert finer_than(model, model.step_angle).strip_stations == 12
