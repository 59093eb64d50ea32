"""Runs that Exudyn ends without an error, and that `solve` must not call ok (exudyn 1.13.6)."""

from dataclasses import replace

import exudyn as exu
import numpy as np
import pytest
from exudyn.itemInterface import Force, MarkerNodePosition, NodePoint, ObjectMassPoint

import rps_exudyn as rps
from rps_exudyn.multibody import recorder
from rps_exudyn.multibody import solve as solver
from rps_exudyn.multibody.bodies import add_forces
from rps_exudyn.multibody.secant import Secant
from rps_exudyn.multibody.solve import MOST_DIVISIONS, SolverPlan, StepRefusedError, solve
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.outcome import Code, Status
from rps_exudyn.scenes.maneuver import maneuvers_of_test
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.solvers.settled_start import SteadyApproach

PLAN = SolverPlan(end_time=0.1, steps=100)


def one_mass(force) -> exu.MainSystem:  # type: ignore[no-untyped-def]
    """A free mass of 1 kg under a force along X given as a function of time."""
    mbs = exu.SystemContainer().AddSystem()
    node = mbs.AddNode(NodePoint())
    mbs.AddObject(ObjectMassPoint(mass=1.0, nodeNumber=node))
    marker = mbs.AddMarker(MarkerNodePosition(nodeNumber=node))
    mbs.AddLoad(
        Force(
            markerNumber=marker,
            loadVector=[1, 0, 0],
            loadVectorUserFunction=lambda mbs, t, load: [force(t), 0, 0],
        )
    )
    mbs.Assemble()
    return mbs


def test_a_sound_run_is_ok() -> None:
    mbs = one_mass(lambda t: 2.0)
    outcome = solve(mbs, PLAN)
    assert outcome.status is Status.OK
    assert outcome.time_reached == pytest.approx(0.1)
    assert mbs.systemData.GetODE2Coordinates()[0] == pytest.approx(0.01, rel=1e-6)  # a t^2 / 2
    assert outcome.counters["steps"] >= 100


def test_a_force_that_is_not_a_number_is_no_success() -> None:
    outcome = solve(one_mass(lambda t: float("nan") if t > 0.05 else 1.0), PLAN)
    assert outcome.status in (Status.DIVERGED, Status.NO_CONVERGENCE)
    assert outcome.message


def test_a_run_that_stops_early_is_no_success() -> None:
    """SolveDynamic returns True when a step function asks it to stop."""
    mbs = one_mass(lambda t: 1.0)
    mbs.SetPreStepUserFunction(lambda mbs, t: t < 0.05)
    outcome = solve(mbs, PLAN)
    assert outcome.status is Status.TIMEOUT
    assert outcome.time_reached < 0.06


def test_a_state_beyond_all_bounds_is_no_success() -> None:
    outcome = solve(one_mass(lambda t: 1e12), PLAN)
    assert outcome.status is Status.DIVERGED


def test_a_python_error_in_a_force_is_told() -> None:
    def broken(t: float) -> float:
        raise ZeroDivisionError("broken force")

    outcome = solve(one_mass(broken), PLAN)
    assert outcome.status is Status.NO_CONVERGENCE
    assert outcome.message == "ZeroDivisionError at 0 s: broken force"


def test_an_iteration_that_diverges_is_repeated_in_a_shorter_step() -> None:
    """A law without a value at some of its evaluations, as where Newton's method leaves its range: Exudyn
    ends with an error in the step after a Jacobian that cannot be factorized."""
    without_value = iter([0.0] * 60 + [float("nan")] * 6)
    mbs = exu.SystemContainer().AddSystem()
    node = mbs.AddNode(NodePoint())
    mbs.AddObject(ObjectMassPoint(mass=1.0, nodeNumber=node))

    def slope(q: np.ndarray, v: np.ndarray, factor_q: float, factor_v: float) -> np.ndarray:
        return (next(without_value, 0.0) - factor_q * 1e3 * np.cos(q[0])) * np.eye(3)

    def force(q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.array([next(without_value, 0.0) + 2 - 1e3 * np.sin(q[0]), 0.0, 0.0])

    add_forces(mbs, [node], 3, force, slope)
    mbs.Assemble()
    outcome = solve(mbs, PLAN)
    assert next(without_value, None) is None
    assert outcome.status is Status.OK, outcome.message


def test_corrected_tangents_find_the_rate_at_which_friction_turns_about() -> None:
    """Newton's method on -arctan(v) goes from v = 2 to and fro over ever longer ways; with the change of
    force over one of them it converges."""

    def left(plain: int) -> float:
        secant, rate = Secant(), np.array([2.0])
        for tangents in range(14):
            force = secant.recorded(0.1, rate, -np.arctan(rate))
            tangent = 0.5 * np.diag(-1 / (1 + rate**2))  # by unknowns, of which one changes the rate by 0.5
            used = tangent if tangents < plain else secant.corrected(tangent, 0.1, 0.5)
            rate = rate - 0.5 * np.linalg.solve(used, force)
            if abs(rate[0]) > 1e6:
                break
        return float(abs(rate[0]))

    assert left(plain=14) > 1e6
    assert left(plain=0) < 1e-12


def test_settings_are_complete() -> None:
    """What decides the result is kept with it."""
    settings = solve(one_mass(lambda t: 1.0), PLAN).settings
    assert settings["name"] == "generalized-alpha"
    assert {"steps", "end_time", "spectral_radius", "relative_tolerance"} <= set(settings)
    assert all(np.isscalar(value) for value in settings.values())


def test_a_run_that_would_hardly_end_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    """Far more steps than planned are an outcome with its cause, and the part until then is kept."""
    monkeypatch.setattr(recorder, "MOST_STEPS", 0)
    monkeypatch.setattr(recorder, "SPARE", 5)
    result = rps.run("free-pinion-torque", fidelity="flank")
    assert result.status is Status.NO_CONVERGENCE
    assert "6 steps instead of" in result.message
    assert "choose shorter steps" in result.message
    assert result["pinion_angle"].size


def test_a_run_that_would_hardly_end_shows_that_it_left_its_contact_law(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Then its steps are not what to change."""
    monkeypatch.setattr(recorder, "MOST_STEPS", 0)
    monkeypatch.setattr(recorder, "SPARE", 5)
    gear = {"mesh.law": "line", "mesh.stiffness": "1e12 N/m^3", "yoke.preload": "20000 N"}
    result = rps.run("free-pinion-torque", rps.SteeringGear().replace(gear), fidelity="flank")
    assert result.status is Status.INVALID
    assert result.codes == (Code.BEYOND_LAW,)
    assert len(result["pinion_angle"]) <= 6


def refusing(monkeypatch: pytest.MonkeyPatch, times: int, after: int = 40) -> None:
    """Let the rack seem out of mesh in a step, so many times."""
    left = [times]

    def refuse(self: recorder.Recorder, t: float) -> None:
        if left[0] and len(self.steps) > after:
            left[0] -= 1
            raise StepRefusedError("refused", Status.CONTACT_LOST, Code.RACK_OUT_OF_MESH)

    monkeypatch.setattr(recorder.Recorder, "_stop_out_of_mesh", refuse)


@pytest.mark.parametrize("law", ["coulomb", "bristle"])
def test_a_run_is_restarted_before_a_step_that_fails(law: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Once, a few steps back and in a quarter of the steps, with the state that friction had there: the
    torque of a swing is that of a run without failure, to 1 % in the mean; the outcome counts it."""
    gear = rps.SteeringGear().replace(
        {"test.amplitude": "5 deg"} | {f"{part}.friction_law": law for part in ("mesh", "yoke", "bush")}
    )
    undisturbed = rps.run("reversal", gear, fidelity="flank")
    refusing(monkeypatch, 1)
    restarted = rps.run("reversal", gear, fidelity="flank")
    assert undisturbed.status is restarted.status is Status.OK, restarted.message
    assert "restarts" not in undisturbed.counters
    assert restarted.counters["restarts"] == 1
    time, torque = undisturbed["time"], undisturbed["pinion_torque"]
    assert (np.diff(restarted["time"]) > 0).all()
    found = np.interp(time, restarted["time"], restarted["pinion_torque"])
    assert np.abs(found - torque).mean() < 0.01 * np.abs(torque).max()


def test_a_step_that_always_fails_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """After three restarts, each in a quarter of the steps, with the status and sentence of the cause."""
    refusing(monkeypatch, 1000, after=0)
    result = rps.run("free-pinion-torque", fidelity="flank")
    assert (result.status, result.message) == (Status.CONTACT_LOST, "refused")
    assert result.counters["restarts"] == MOST_DIVISIONS


@pytest.mark.parametrize("hand", [1, -1])
def test_no_step_leads_into_another_tooth_space(hand: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Over 1 degree a line of these nearly straight teeth enters, and a step's first guess parts all flanks:
    Newton's method ends two pitches on, where forces balance as well. A restart resolves the entry, and the
    mean is that of equilibria, to 1 % after a run-in of one step; without restarts the run diverges there."""
    angles = dict.fromkeys(("pinion.helix_angle", "rack.tooth_angle"), f"{0.5 * hand} deg")
    teeth = {"pinion.teeth": 8, "pinion.normal_module": "1.7 mm", "pinion.profile_shift": 0.6}
    gear = rps.SteeringGear().replace({**angles, **teeth, "mesh.law": "line", "test.turns": 0.25})
    maneuver, step = maneuvers_of_test(gear, "pinion", np.deg2rad(1))[0], np.deg2rad(1)
    drive = replace(maneuver.drive, start=-step)
    assert isinstance(maneuver.approach, SteadyApproach)
    time_step = step / gear.test.speed
    approach = replace(maneuver.approach, step=time_step)
    maneuver = replace(maneuver, time_step=time_step, lead=1, steps=90, drive=drive, approach=approach)
    still, run = (run_maneuver(gear, Fidelity.preset(name), maneuver) for name in ("quasi-static", "flank"))
    assert run.outcome.status is Status.OK, run.outcome.message
    means = [each.signals["pinion_torque"].mean() for each in (still, run)]
    assert means[1] == pytest.approx(means[0], rel=1e-2)
    monkeypatch.setattr(solver, "MOST_RESTARTS", 0)
    outcome = run_maneuver(gear, Fidelity.preset("flank"), maneuver).outcome
    assert (outcome.status, outcome.codes) == (Status.DIVERGED, (Code.OUT_OF_BOUNDS,))
    assert "lower fidelity.step_angle" in outcome.message
