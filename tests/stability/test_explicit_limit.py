"""The largest step of explicit integration follows from the linearised gear, within 10 %."""

import numpy as np
import pytest

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.solvers.prescribed_motion import Steady
from verification.runge_kutta import FreeMotion
from verification.stable_step import (
    GEAR,
    DrivenGear,
    explicit_euler,
    largest_damping,
    largest_frequency,
    runge_kutta_4,
    stable_step,
    state_matrix,
)

STEPS = 120
SPEED = GEAR.test.speed
DRIVES = {
    "plunger on its seat, pinion driven": ("pinion", "fidelity.zone_ratio", Fidelity().zone_ratio),
    "light pinion on hard teeth, rack driven": ("rack", "mesh.stiffness", 5e14),
    "damped teeth, rack driven": ("rack", "mesh.damping", 1e-4),
    "stick, pinion held": ("nothing", "fidelity.zone_ratio", 0.03),
}


@pytest.mark.parametrize("case", DRIVES)
def test_disturbance_dies_below_the_predicted_step_and_grows_above(case: str) -> None:
    driven = DrivenGear.of(*DRIVES[case], {"zone_ratio": Fidelity().zone_ratio})
    assert driven.calms(0.9 * driven.predicted, STEPS)
    assert not driven.calms(1.1 * driven.predicted, STEPS)


def test_stick_is_limited_by_friction_alone_and_sliding_by_the_largest_frequency() -> None:
    """h mu N / (m_eff v_zone) where everything sticks; the zone does not matter where everything slides."""
    still, turning = (FreeMotion.of(GEAR, Fidelity(), Steady("pinion", 0.0, speed)) for speed in (0.0, SPEED))
    stick = stable_step(state_matrix(still), runge_kutta_4)
    assert stick == pytest.approx(2.785 / largest_damping(still), rel=0.02)
    slide = stable_step(state_matrix(turning), runge_kutta_4)
    assert slide == pytest.approx(2.83 / largest_frequency(turning), rel=0.1)
    assert stick < slide / 5


@pytest.mark.parametrize(
    ("growth", "matrix", "bound"),
    [
        (runge_kutta_4, [[0.0, 1.0], [-1e8, 0.0]], 2 * np.sqrt(2) / 1e4),  # an oscillator
        (runge_kutta_4, [[-1e4]], 2.7853 / 1e4),  # a damper
        (explicit_euler, [[-1e4]], 2.0 / 1e4),
    ],
)
def test_bounds_of_the_methods(growth, matrix, bound) -> None:  # type: ignore[no-untyped-def]
    assert stable_step(np.array(matrix), growth) == pytest.approx(bound, rel=5e-3)


def test_what_grows_by_itself_is_no_instability_of_the_method() -> None:
    assert stable_step(np.array([[+1.0]]), runge_kutta_4) == np.inf
