"""A scene's reference curve and its uncertainty: independent methods that must agree about it.

    reference = reference_of("reversal", gear)
    reference.headline.uncertainty        the largest difference of two methods [% of the mean]

A method computes the signals in its own way: contact and motion are each computed in two ways at least, at
resolutions finer than any error that is to be measured.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes import SCENE_NAMES, scene_named
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.scene import DEFAULT_OPTIONS, RunOptions
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.scenes.yoke_impact import ZONE, shaken
from rps_exudyn.solvers.gear_forces import GearForces, exchanged
from rps_exudyn.tooth_contact.flank_data import pack
from verification.runge_kutta import explicit_motion
from verification.runs import SceneReference, run_scene
from verification.slow_swing import slow_swing
from verification.work_precision import agreed_reference

STRIPS = {"strip_stations": 12, "strip_points": 6}  # finer than any error seen

Method = Callable[[str, SteeringGear], tuple[Signals, Fidelity]]
"""(scene, gear) -> signals, and the fidelity whose steps they have. It raises ArithmeticError if it fails."""


# --- models ----------------------------------------------------------------------------------------
def over_generators(number: int, method: Method) -> Method:
    """Method whose contact, of law "area", is integrated over generators in place of strips, each with as
    many Gauss points as the strips' stations."""

    def exchange(forces: GearForces, gear: SteeringGear, fidelity: Fidelity) -> GearForces:
        gears, along = forces.gears.copy(), fidelity.strip_stations
        gears["mesh"]["flank"] = pack(gear, zone=forces.friction_zone, generators=number, along=along)
        return replace(forces, gears=gears)

    def exchanging(scene: str, gear: SteeringGear) -> tuple[Signals, Fidelity]:
        with exchanged(exchange):
            return method(scene, gear)

    return exchanging


def still(step: str) -> Fidelity:
    """Model of equilibria."""
    return Fidelity.preset("quasi-static").replace({"step_angle": step})


def by_strips(step: str) -> Fidelity:
    """Model of equilibria with the contact integrated over fine strips."""
    return Fidelity.preset("quasi-static").replace({"step_angle": step, **STRIPS})


def moving(step: str, tolerance: float) -> Fidelity:
    """Model in Exudyn with the contact integrated over fine strips."""
    return Fidelity.preset("flank").replace({"step_angle": step, "tolerance": tolerance, **STRIPS})


# --- methods -----------------------------------------------------------------------------------------
def as_run(fidelity: Fidelity, options: RunOptions = DEFAULT_OPTIONS) -> Method:
    """Method: a run of the package."""

    def method(scene: str, gear: SteeringGear) -> tuple[Signals, Fidelity]:
        return _sound(run_scene(scene, gear, fidelity, options)).signals, fidelity

    return method


def slowly(fidelity: Fidelity) -> Method:
    """Method: a reversal in the limit of slow motion."""

    def method(scene: str, gear: SteeringGear) -> tuple[Signals, Fidelity]:
        return _sound(slow_swing(gear, fidelity)).signals, fidelity

    return method


SHAKEN = Fidelity.preset("flank").replace(
    {**STRIPS, "tolerance": 1e-6, "rack": "flexible", "zone_ratio": ZONE}
)


def explicitly(step: float) -> Method:
    """Method: an impact by classical Runge-Kutta (RK4) in steps of `step` [s]."""

    def method(scene: str, gear: SteeringGear) -> tuple[Signals, Fidelity]:
        maneuver = shaken(gear)
        steps = round(maneuver.steps * maneuver.time_step / step)
        return explicit_motion(
            gear, SHAKEN, maneuver.drive, step=step, steps=steps, pulse=maneuver.pulse
        ), SHAKEN

    return method


def finer(parts: int) -> Method:
    """Method: an impact in Exudyn, each step of the scene in `parts` steps."""

    def method(scene: str, gear: SteeringGear) -> tuple[Signals, Fidelity]:
        maneuver = shaken(gear)
        cut = replace(maneuver, time_step=maneuver.time_step / parts, steps=maneuver.steps * parts)
        return _sound(run_maneuver(gear, SHAKEN, cut)).signals, SHAKEN

    return method


def _sound(run: SceneRun) -> SceneRun:
    if not run.ok:
        raise ArithmeticError(f"{run.outcome.status}: {run.outcome.message}")
    return run


# --- the references --------------------------------------------------------------------------------
STEADY: dict[str, Method] = {
    "equilibria, 640 generators, 0.1 deg": over_generators(640, as_run(still("0.1 deg"))),
    "equilibria, 320 generators, 0.2 deg": over_generators(320, as_run(still("0.2 deg"))),
    "Exudyn, strips of 12 x 6, 0.25 deg": as_run(moving("0.25 deg", 1e-5)),
    "Exudyn, strips of 12 x 6, 0.5 deg": as_run(moving("0.5 deg", 1e-5)),
}

TURNING_BACK: dict[str, Method] = {
    "Exudyn, strips of 12 x 6, 0.005 deg": as_run(moving("0.005 deg", 1e-5)),
    "Exudyn, strips of 12 x 6, 0.01 deg": as_run(moving("0.01 deg", 1e-5)),
    "equilibria and inertia, 160 generators, 0.01 deg": over_generators(160, slowly(by_strips("0.01 deg"))),
    "equilibria and inertia, strips of 12 x 6, 0.01 deg": slowly(by_strips("0.01 deg")),
}
"""The torque jumps within 0.06 degrees of the turning points: what is left of its RMS is where in a step."""

UNDER_LOADS: dict[str, Method] = {
    "equilibria, 640 generators": over_generators(640, as_run(still("1 deg"))),
    "equilibria, 320 generators": over_generators(320, as_run(still("1 deg"))),
    "equilibria, strips of 12 x 6": as_run(by_strips("1 deg")),
}

IMPACTS: dict[str, Method] = {
    "Runge-Kutta, 2 us": explicitly(2e-6),
    "Exudyn, a sixteenth of the scene's step": finer(16),
    "Exudyn, an eighth of the scene's step": finer(8),
}

METHODS = {"reversal": TURNING_BACK, "yoke-impact": IMPACTS}
METHODS |= {name: UNDER_LOADS for name in SCENE_NAMES if scene_named(name).at_rest}


def reference_of(
    scene: str, gear: SteeringGear, methods: Mapping[str, Method] | None = None
) -> SceneReference:
    """The reference on which the methods agree, by default those of the scene.

    Raises:
        ArithmeticError: one of them failed; its message says which and how.
    """
    curves, lifts = {}, []
    for name, method in (methods or METHODS.get(scene, STEADY)).items():
        try:
            signals, fidelity = method(scene, gear)
        except ArithmeticError as error:
            raise ArithmeticError(f"{name}: {error}") from error
        curves[name] = scene_named(scene).curve(signals, gear, fidelity)
        lifts.append(scene_named(scene).curve(signals, gear, fidelity, "rack_y"))
    return SceneReference(scene, gear, agreed_reference(curves), lifts[0])
