"""Runs of a scene that are to be measured: their curve, their reference, and what they cost.

Geometry report and provenance of `simulate.run` are left out: what is measured is the model.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from rps_exudyn.accuracy.explicit import explicit_motion
from rps_exudyn.analysis.work_precision import Curve, Errors, Reference, agreed_reference, curve_errors
from rps_exudyn.fidelity import Fidelity
from rps_exudyn.parameters import SteeringGear
from rps_exudyn.scenes.make_trip import make_trip
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.scenes.trip import swing_trip
from rps_exudyn.scenes.yoke_impact import shaken
from rps_exudyn.simulate import SCENES

JUDGED = {
    "free-pinion-torque": "pinion_torque",
    "load-test": "pinion_torque",
    "rack-push": "rack_force",
    "reversal": "pinion_torque",
    "yoke-impact": "yokenut_force",
}
"""Scene -> the signal whose error counts."""

STRIPS = {"strip_stations": 12, "strip_points": 6}  # finer than any error seen


def still(generators: int, step: str) -> Fidelity:
    """Equilibria, the contact integrated over generators."""
    settings = {"mesh": "flank-generators", "generators": generators, "step_angle": step}
    return Fidelity.preset("quasi-static").replace(settings)


def moving(step: str, tolerance: float) -> Fidelity:
    """Exudyn, the contact integrated over fine strips."""
    return Fidelity.preset("flank").replace({"step_angle": step, "tolerance": tolerance, **STRIPS})


METHODS: dict[str, Fidelity] = {
    "equilibria, 640 generators, 0.1 deg": still(640, "0.1 deg"),
    "equilibria, 320 generators, 0.2 deg": still(320, "0.2 deg"),
    "Exudyn, strips of 12 x 6, 0.25 deg": moving("0.25 deg", 1e-5),
    "Exudyn, strips of 12 x 6, 0.5 deg": moving("0.5 deg", 1e-5),
}
"""What must agree about a reference: contact and motion each computed in two ways, at two resolutions."""


TURNING_BACK: dict[str, Fidelity] = {
    "equilibria, 160 generators, 0.02 deg": still(160, "0.02 deg"),
    "equilibria, strips of 12 x 6, 0.02 deg": Fidelity.preset("quasi-static").replace(
        {"step_angle": "0.02 deg", **STRIPS}
    ),
    "Exudyn, 160 generators, 0.05 deg": moving("0.05 deg", 1e-5).replace(
        {"mesh": "flank-generators", "generators": 160}
    ),
    "Exudyn, strips of 12 x 6, 0.05 deg": moving("0.05 deg", 1e-4),
}
"""The same for a reversal: the torque jumps within 0.06 degrees of the turning points."""


@dataclass(frozen=True, eq=False)
class Truth:
    """The reference of one scene of one gear."""

    scene: str
    gear: SteeringGear
    judged: Reference  # of the signal that counts
    lift: Curve  # of the rack, `rack_y`

    def errors_of(self, run: SceneRun, fidelity: Fidelity) -> tuple[Errors, float | None]:
        """Of the judged signal [%], and RMS of the rack's lift [m]; None where the model knows no lift."""
        turned = self._turned if self.scene == "free-pinion-torque" else None
        curve = curve_of(self.scene, run, self.gear, fidelity)
        errors = curve_errors(curve, self.judged, turned, self.gear.pinion.teeth)
        if "rack_y" not in run.signals:
            return errors, None
        lift = curve_of(self.scene, run, self.gear, fidelity, "rack_y")
        as_reference = Reference(self.lift, 0.0, {})
        share = curve_errors(lift, as_reference).rms / 100
        return errors, share * float(np.mean(np.abs(self.lift.values)))

    @property
    def _turned(self) -> float:
        return self.gear.test.direction * 2 * np.pi * self.gear.test.turns


def run_scene(scene: str, gear: SteeringGear, fidelity: Fidelity) -> SceneRun:
    """One run with its judgement, whatever comes out."""
    return SCENES[scene](gear, fidelity)


def truth_of(scene: str, gear: SteeringGear, methods: Mapping[str, Fidelity] | None = None) -> Truth:
    """The reference on which the methods agree, by default those of `METHODS`, or of an impact's own.

    Raises:
        ArithmeticError: one of them failed; its message says which and how.
    """
    if scene == "yoke-impact":
        return _agreed(scene, gear, _impacts(gear))
    if methods is None:
        methods = TURNING_BACK if scene == "reversal" else METHODS
    told = {}
    for name, fidelity in methods.items():
        run = _sound(name, run_scene(scene, gear, fidelity))
        told[name] = tuple(curve_of(scene, run, gear, fidelity, each) for each in (JUDGED[scene], "rack_y"))
    return _agreed(scene, gear, told)


Told = dict[str, tuple[Curve, ...]]  # method -> judged signal, lift


def _agreed(scene: str, gear: SteeringGear, told: Told) -> Truth:
    judged = {name: curves[0] for name, curves in told.items()}
    return Truth(scene, gear, agreed_reference(judged), next(iter(told.values()))[1])


def _sound(name: str, run: SceneRun) -> SceneRun:
    if not run.ok:
        raise ArithmeticError(f"{name}: {run.outcome.status}: {run.outcome.message}")
    return run


def _impacts(gear: SteeringGear) -> Told:
    """An explicit method of the package's own, and Exudyn's with a fraction of the scene's step."""
    trip, fidelity = shaken(gear), Fidelity.preset("flank").replace({**STRIPS, "tolerance": 1e-6})
    told: Told = {}
    step = 2e-6
    steps = round(trip.steps * trip.time_step / step)
    signals = explicit_motion(gear, fidelity, trip.drive, step=step, steps=steps, pulse=trip.pulse)
    told[f"Runge-Kutta, {1e6 * step:g} us"] = _of_impact(signals)
    for part in (16, 8):
        finer = replace(trip, time_step=trip.time_step / part, steps=trip.steps * part)
        name = f"Exudyn, {1e6 * finer.time_step:.2g} us"
        told[name] = _of_impact(_sound(name, make_trip(gear, fidelity, finer)).signals)
    return told


def _of_impact(signals: Signals) -> tuple[Curve, ...]:
    return tuple(Curve(signals["time"], signals[name]) for name in (JUDGED["yoke-impact"], "rack_y"))


def curve_of(scene: str, run: SceneRun, gear: SteeringGear, fidelity: Fidelity, name: str = "") -> Curve:
    """A signal over the time of the rig's motion, by default the one that counts."""
    start = 0.0
    if scene == "reversal":  # recording begins at another phase with every step
        trip = swing_trip(gear, fidelity.step_angle)
        start = trip.lead * trip.time_step
    return Curve(start + run.signals["time"], run.signals[name or JUDGED[scene]])


def revolutions(scene: str, gear: SteeringGear) -> float:
    """How many turns of the pinion a run of the scene makes; of yoke-impact, 1."""
    return REVOLUTIONS[scene](gear) if scene in REVOLUTIONS else 1.0


REVOLUTIONS: dict[str, Callable[[SteeringGear], float]] = {
    "free-pinion-torque": lambda gear: gear.test.turns,
    "load-test": lambda gear: 2 * gear.test.turns,
    "rack-push": lambda gear: gear.test.turns,
    "reversal": lambda gear: 4 * gear.test.amplitude * gear.test.cycles / (2 * np.pi),
}
"""Of trips one way."""
