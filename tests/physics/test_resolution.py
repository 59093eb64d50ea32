"""A peak to peak that the steps do not resolve is left out, with a remark; a resolved one stays."""

import numpy as np
import pytest

from rps_exudyn.analysis.curve import UNRESOLVED, missed, unresolved
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from verification.runs import run_scene

TURN = np.linspace(0, 1, 61)


def test_a_cubic_is_missed_nowhere() -> None:
    x = np.sort(np.random.default_rng(1).uniform(0, 1, 30))
    assert missed(x, 1 - 2 * x + 3 * x**2 - x**3).max() < 1e-12


@pytest.mark.parametrize("steps", [6.5, 8.0, 15.0])
def test_vibration_in_many_steps_is_resolved(steps: float) -> None:
    """A sine of an amplitude of 0.1 of the mean."""
    assert unresolved(TURN, 1 + 0.1 * np.sin(2 * np.pi * np.arange(61) / steps), size=1.0) < UNRESOLVED


@pytest.mark.parametrize("steps", [2.0, 2.5, 3.0])
def test_vibration_as_fast_as_the_steps_is_not(steps: float) -> None:
    """Implicit methods show what is faster than their steps between 2 and 2.5 steps a period."""
    assert unresolved(TURN, 1 + 0.1 * np.cos(2 * np.pi * np.arange(61) / steps), size=1.0) > UNRESOLVED


def test_what_is_missed_is_a_share_of_the_size() -> None:
    """Of values around a mean of zero too; a size of zero has none."""
    values = 0.1 * np.cos(np.pi * np.arange(61))
    assert unresolved(TURN, values, size=2.0) == pytest.approx(unresolved(TURN, values, size=1.0) / 2)
    assert unresolved(TURN, values, size=0.0) == 0.0


def test_a_gear_that_vibrates_faster_than_its_steps_says_so() -> None:
    """One tooth stands out by 20 um and strikes a rack that is hardly pressed; steps of 3 ms."""
    gear = SteeringGear().replace(
        {"test.turns": 0.5, "test.speed": "60 rpm", "pinion.pitch_error": "0.02 mm", "yoke.preload": "60 N"}
    )
    moving, still = (
        run_scene("free-pinion-torque", gear, Fidelity.preset(name)) for name in ("flank", "quasi-static")
    )
    assert moving.ok
    assert "torque_peak_to_peak" not in moving.summary
    assert "vibration" in moving.outcome.message
    assert "torque_peak_to_peak" not in still.summary
    assert "inertia" in still.outcome.message
    assert moving.summary["torque_mean"] == pytest.approx(still.summary["torque_mean"], rel=5e-3)
