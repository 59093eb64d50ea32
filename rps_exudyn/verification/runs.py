"""Runs of a scene that are to be measured: their curve, their errors, and how many turns they make.

Geometry report and provenance of `simulate.run` are left out: what is measured is the model.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.maneuver import swing_maneuver
from rps_exudyn.scenes.run_options import DEFAULT
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.verification.work_precision import Curve, Errors, Reference, curve_errors

JUDGED = {
    "free-pinion-torque": "pinion_torque",
    "load-test": "pinion_torque",
    "rack-push": "rack_force",
    "reversal": "pinion_torque",
    "yoke-impact": "yokenut_force",
}
"""Scene -> the signal whose error counts."""


@dataclass(frozen=True, eq=False)
class Truth:
    """The reference of one scene of one gear."""

    scene: str
    gear: SteeringGear
    judged: Reference  # of the signal that counts
    lift: Curve  # of the rack, `rack_y`

    def errors_of(self, signals: Signals, fidelity: Fidelity) -> tuple[Errors, float | None]:
        """Of the judged signal [%], and RMS of the rack's lift [m]; None where the model knows no lift."""
        turned = self._turned if self.scene == "free-pinion-torque" else None
        curve = curve_of(self.scene, signals, self.gear, fidelity)
        errors = curve_errors(curve, self.judged, turned, self.gear.pinion.teeth)
        if "rack_y" not in signals:
            return errors, None
        lift = curve_of(self.scene, signals, self.gear, fidelity, "rack_y")
        as_reference = Reference(self.lift, 0.0, {})
        share = curve_errors(lift, as_reference).rms / 100
        return errors, share * float(np.mean(np.abs(self.lift.values)))

    @property
    def _turned(self) -> float:
        return self.gear.test.direction * 2 * np.pi * self.gear.test.turns


def run_scene(scene: str, gear: SteeringGear, fidelity: Fidelity) -> SceneRun:
    """One run with its judgement, whatever comes out."""
    return scene_named(scene).run(gear, fidelity, DEFAULT)


def curve_of(scene: str, signals: Signals, gear: SteeringGear, fidelity: Fidelity, name: str = "") -> Curve:
    """A signal over the time of the rig's motion, by default the one that counts."""
    start = 0.0
    if scene == "reversal":  # recording begins at another phase with every step
        maneuver = swing_maneuver(gear, fidelity.step_angle)
        start = maneuver.lead * maneuver.time_step
    return Curve(start + signals["time"], signals[name or JUDGED[scene]])


def revolutions(scene: str, gear: SteeringGear) -> float:
    """How many turns of the pinion a run of the scene makes; of yoke-impact, 1."""
    return REVOLUTIONS[scene](gear) if scene in REVOLUTIONS else 1.0


REVOLUTIONS: dict[str, Callable[[SteeringGear], float]] = {
    "free-pinion-torque": lambda gear: gear.test.turns,
    "load-test": lambda gear: 2 * gear.test.turns,
    "rack-push": lambda gear: gear.test.turns,
    "reversal": lambda gear: 4 * gear.test.amplitude * gear.test.cycles / (2 * np.pi),
}
"""Of maneuvers one way."""
