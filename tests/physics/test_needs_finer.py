"""Equilibria that are too far apart for what they show are made again, closer together."""

import numpy as np
import pytest

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.scenes.checks.needs_finer import needs_finer
from rps_exudyn.scenes.maneuver import StepLimits
from rps_exudyn.scenes.metric_confirmation import FEW_INSTANTS
from rps_exudyn.scenes.scene import RunOptions
from rps_exudyn.simulate.run_plan import run_unchecked

STOPPED = SteeringGear().replace(
    {
        "mesh.law": "teeth",
        "pinion.teeth": 10,
        "pinion.normal_module": 0.002187,
        "pinion.pressure_angle": 0.3855,
        "pinion.helix_angle": 0.2894,
        "pinion.profile_shift": 0.4344,
        "pinion.tip_diameter": 0.02729,
        "pinion.face_width": 0.01206,
        "pinion.runout": 1.163e-05,
        "pinion.crowning": 2.574e-06,
        "pinion.pitch_error": 3.253e-06,
        "rack.tooth_angle": -0.1366,
        "rack.reference_height": 8.5e-3,
        "yoke.preload": 558.6,
        "yoke.spring_rate": 85740.0,
        "yoke.friction": 0.1506,
        "bush.drag": 36.36,
        "bearing.friction_torque": 0.05345,
        "mesh.friction": 0.1884,
    }
)
"""Its pinion rides up on the rack and presses the yoke on its nut over a few degrees of each tooth pitch."""

STILL = Fidelity.preset("quasi-static")
COARSE, FINE = (STILL.replace({"step_angle": step}) for step in ("4.5 deg", "0.5 deg"))
ASKED = RunOptions(least_steps=StepLimits(halvings=0))


def test_a_yoke_that_stops_briefly_is_seen_in_coarse_steps() -> None:
    """Eight steps in a tooth pitch against 72: the mean to 1 %, the peak to 5 % of it, for which steps are
    made finer. In the steps asked for the peak misses half of the mean."""
    right, coarse = (run_unchecked("free-pinion-torque", STOPPED, each) for each in (FINE, COARSE))
    asked = run_unchecked("free-pinion-torque", STOPPED, COARSE, ASKED)
    mean = right.summary["torque_mean"]
    peak, seen, missed = (float(each["pinion_torque"].max()) for each in (right, coarse, asked))
    assert coarse.findings["halvings"] > 0
    assert coarse.summary["torque_mean"] == pytest.approx(mean, rel=0.01)
    assert seen == pytest.approx(peak, abs=0.05 * mean)
    assert missed < peak - 0.3 * mean


def test_an_ordinary_gear_keeps_the_steps_asked_for() -> None:
    asked = run_unchecked("free-pinion-torque", SteeringGear(), Fidelity.preset("quasi-static"))
    assert "halvings" not in asked.findings


def test_metrics_that_coarse_steps_miss_come_from_finer_ones() -> None:
    """A peak to peak by 13 angles per pitch lies up to 5 % beside that by 60; the metrics printed do not."""
    coarse = run_unchecked("free-pinion-torque", SteeringGear(), COARSE)
    fine = run_unchecked("free-pinion-torque", SteeringGear(), Fidelity.preset("quasi-static"))
    assert coarse.findings["halvings"] > 0
    for name, value in fine.summary.items():
        assert SUMMARY[name].change(coarse.summary[name], value, fine.summary["torque_mean"]) < 1, name


def test_a_short_record_of_dynamics_is_made_again() -> None:
    """Half of its few instants show nothing: a random gear's lift over 14 of them was 13 % off."""
    short = run_unchecked("free-pinion-torque", SteeringGear().replace({"test.turns": 0.02}), Fidelity())
    assert len(short.signals["time"]) < 2 * FEW_INSTANTS
    assert short.findings["halvings"] == 1


@pytest.mark.quick
def test_a_record_that_is_not_finite_is_not_made_again() -> None:
    angle = np.linspace(0, 1, 9)
    signals = {"pinion_angle": angle, "pinion_torque": np.full(9, np.nan)}
    assert not needs_finer(signals, SteeringGear())
