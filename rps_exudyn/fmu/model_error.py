"""What the reduced gear differs by from `flank`: in a swing, and at a wheel that a torque turns."""

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import Result
from rps_exudyn.scenes.checks.before_run import largest_angle
from rps_exudyn.scenes.reversal import SCENE as SWUNG
from rps_exudyn.scenes.scene import WITHOUT_BARS
from rps_exudyn.scenes.steering_torque import SCENE as TURNED
from rps_exudyn.simulate.run_plan import run_unchecked
from rps_exudyn.solvers.closed_form import free_torque

REFERENCE = "flank"
PULLED = 6.0  # times the gear's own friction that the hand's torque has at its peak
SLOWER = 5.0  # times than the wheel would swing on the tyres: models differ, not a resonance
REACH, SWING = 0.25, 0.5236  # of the angle that the teeth allow; of a swing [rad]
METRICS = {
    SWUNG.name: ("hysteresis_area", "torque_jump"),
    TURNED.name: ("feel_area", "angle_dead_band", "torque_dead_band", "steering_gradient"),
}
"""Scene -> metrics that are compared."""


def compared_test(gear: SteeringGear) -> SteeringGear:
    """Return the gear with a test that both models run: tyres by which the torque turns it over half its
    teeth."""
    free, gain = abs(free_torque(gear)), float(GearPair.of(gear).gain)
    turn = REACH * largest_angle(gear)
    torque = PULLED * max(free, 1e-3)
    swings = np.sqrt(torque / turn / gear.column.wheel_inertia) / (2 * np.pi)
    return gear.replace(
        {
            "test.start_angle": 0.0,
            "test.amplitude": min(SWING, turn),
            "test.steer_torque": torque,
            "test.steer_frequency": min(SteeringGear().test.steer_frequency, float(swings) / SLOWER),
            "test.steer_shape": "sine",
            "test.tyre_stiffness": torque / (turn * gain**2),
            "test.cycles": 1,
        }
    )


def runs_of(gear: SteeringGear, fidelity: str) -> dict[str, Result]:
    """Return the runs of the compared scenes.

    Raises:
        InputError: a run that does not end well.
    """
    tested, model = compared_test(gear), Fidelity.preset(fidelity)
    runs = {scene: run_unchecked(scene, tested, model, WITHOUT_BARS) for scene in METRICS}
    for scene, run in runs.items():
        if run.status.value != "ok":
            raise InputError(f"{scene} of this gear by {fidelity} ends {run.status.value}: {run.message}.")
    return runs


def model_error(gear: SteeringGear) -> dict[str, float]:
    """Return the relative difference of each metric, and of the wheel's angle over the time (RMS).

    Examples:
        >>> from rps_exudyn.fmu.model_error import model_error
        >>> abs(model_error(rps.SteeringGear())["hysteresis_area"]) < 0.01
        True
    """
    reduced, reference = runs_of(gear, "reduced"), runs_of(gear, REFERENCE)
    errors = {
        name: reduced[scene].summary[name] / reference[scene].summary[name] - 1
        for scene, names in METRICS.items()
        for name in names
        if name in reduced[scene].summary and reference[scene].summary.get(name)
    }
    own, other = (runs[TURNED.name] for runs in (reduced, reference))
    expected = other["wheel_angle"]
    there = np.interp(other["time"], own["time"], own["wheel_angle"])
    rms = float(np.sqrt(np.mean((there - expected) ** 2) / np.mean(expected**2)))
    return {**errors, "wheel_angle_rms": rms}
