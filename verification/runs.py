"""Runs of a scene that are to be measured: their curve, their errors, and how many turns they make.

The geometry report and provenance of `simulate.run` are left out: what is measured is the model.
"""

from dataclasses import dataclass, replace

import numpy as np

from rps_exudyn.analysis.curve import Curve
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.scene import DEFAULT_OPTIONS, RunOptions
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from verification.work_precision import Errors, Reference, curve_errors


@dataclass(frozen=True, eq=False)
class SceneReference:
    """The reference of one scene of one gear: of its headline signal, and of the rack's lift."""

    scene: str
    gear: SteeringGear
    headline: Reference
    lift: Curve  # `rack_y` [m]

    def errors_of(self, signals: Signals, fidelity: Fidelity) -> tuple[Errors, float | None]:
        """Errors of the headline signal [%], and the RMS of the lift [m] or None if there is no lift."""
        turned = self._turned if self.scene == "free-pinion-torque" else None
        curve = scene_named(self.scene).curve(signals, self.gear, fidelity)
        errors = curve_errors(curve, self.headline, turned, self.gear.pinion.teeth)
        if scene_named(self.scene).at_rest:  # the same loads in every run, between which nothing is asked
            errors = replace(errors, rms_linear=errors.rms)
        if "rack_y" not in signals:
            return errors, None
        lift = scene_named(self.scene).curve(signals, self.gear, fidelity, "rack_y")
        as_reference = Reference(self.lift, 0.0, {})
        fraction = curve_errors(lift, as_reference).rms / 100
        return errors, fraction * float(np.mean(np.abs(self.lift.values)))

    @property
    def _turned(self) -> float:
        return self.gear.test.direction * 2 * np.pi * self.gear.test.turns


def run_scene(
    scene: str, gear: SteeringGear, fidelity: Fidelity, options: RunOptions = DEFAULT_OPTIONS
) -> SceneRun:
    """One checked run, whatever its outcome."""
    return scene_named(scene).run(gear, fidelity, options)


def revolutions(scene: str, gear: SteeringGear) -> float:
    """Turns of the pinion in a run of the scene, by which its cost is counted; 1 where the pinion is held."""
    turned = scene_named(scene).revolutions
    return turned(gear) if turned else 1.0
