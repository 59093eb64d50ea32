"""Random gears, tests and models over every declared parameter; the declaration drives the draw.

    rng = np.random.default_rng(1)
    gear, scene = random_gear(rng, "free-pinion-torque")
    fidelity = random_fidelity(rng)

A parameter that is declared anew gets a range from its declaration, or none and then a test fails
(`ranges.range_of`). What cannot exist, leaves the rack's teeth or contradicts itself is drawn again.
"""

from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any
from zlib import crc32

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.basic_rack import pointed_radius, undercut_limit
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_report import check_gear
from rps_exudyn.gears.trochoid import form_point
from rps_exudyn.parameters.declaration import Table
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import PLAIN_LAW, RUBBING_PARTS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes import SCENE_NAMES, scene_named
from rps_exudyn.scenes.at_rest import FREE_RACK_MODELS
from rps_exudyn.scenes.checks.before_run import check_travel, largest_angle
from rps_exudyn.scenes.maneuver import maneuvers_of_test, swing_maneuver
from rps_exudyn.scenes.steering_torque import torque_maneuver
from rps_exudyn.scenes.stick_slip import set_off
from rps_exudyn.scenes.yoke_impact import shaken
from rps_exudyn.solvers.closed_form import free_torque
from verification.ranges import Range, range_of, scaled, within
from verification.stability import ScenePlan
from verification.stated_ranges import (
    FIDELITY,
    GEAR,
    SCALE,
    USUAL_SCALE,
    USUAL_SHARE,
)

SCENE_WEIGHTS = {
    "free-pinion-torque": 0.25,
    "rack-push": 0.05,
    "rack-on-rollers": 0.03,
    "load-test": 0.08,
    "reversal": 0.14,
    "steering-feel": 0.1,
    "steering-torque": 0.1,
    "stick-slip": 0.08,
    "yoke-impact": 0.03,
    "radial-play": 0.03,
    "rack-lift": 0.02,
    "input-shaft-play": 0.01,
    "rattle": 0.03,
    "yoke-setting": 0.05,
}
PRESET_WEIGHTS = {"quasi-static": 0.4, "flank": 0.4, "full": 0.08, "closed-form": 0.08, "reduced": 0.04}
ONE_LAW = 0.6  # of the gears: all their parts have the same friction law
BY_FORMULA = (
    "free-pinion-torque",
    "rack-push",
    "rack-on-rollers",
    "load-test",
)  # scenes that the preset closed-form has
REDUCED = ("reversal", "steering-feel", "steering-torque", "stick-slip")  # ... and the preset reduced


COARSE = np.deg2rad(10)  # steps by which a test is tried
MOST_STEPS = 1200  # of a plan
UNEVEN = (
    "reversal", "steering-feel", "steering-torque", "stick-slip", "yoke-impact", "radial-play", "rack-lift",
    "input-shaft-play", "rattle",
)  # fmt: skip
"""Scenes whose steps do not follow from the angle turned."""
PART_OF_PITCH = 0.2  # that a plan with general contact turns


def random_scene(rng: np.random.Generator) -> str:
    """Return the name of a scene."""
    return str(rng.choice(list(SCENE_WEIGHTS), p=list(SCENE_WEIGHTS.values())))


def random_gear(rng: np.random.Generator, scene: str) -> SteeringGear:
    """Return a gear that can exist, with a test of the scene that stays on its teeth."""
    while True:
        try:
            gear = placed(_drawn_gear(rng))
            check_gear(gear)
            REACHES[scene](gear)
        except InputError:
            continue
        return gear


def random_fidelity(rng: np.random.Generator, fixed: Mapping[str, Any] | None = None) -> Fidelity:
    """Return a model without contradictions, some of its choices fixed."""
    while True:
        values = drawn(rng, Fidelity, FIDELITY)
        try:
            return Fidelity().replace({**values, **(fixed or {})})
        except InputError:
            continue


def drawn(rng: np.random.Generator, table: type[Table], stated: Mapping[str, Range]) -> dict[str, Any]:
    """Draw every parameter, in an order in which those that others need come first.

    Each has a generator of its own, so that one declared anew changes none of the others.

    Raises:
        LookupError: a parameter has no range, or ranges need each other.
    """
    seed = int(rng.integers(2**32))
    items = {item.path: item for item in table.declared()}
    ranges = {path: range_of(item, stated) for path, item in items.items()}
    values: dict[str, Any] = {}
    while missing := [path for path in ranges if path not in values]:
        for path in missing:
            with suppress(KeyError):  # of a parameter that is not drawn yet
                values[path] = ranges[path].draw(np.random.default_rng([seed, crc32(path.encode())]), values)
        if not values.keys() & set(missing):
            raise LookupError(f"the ranges of {', '.join(missing)} need each other")
    return values


def _drawn_gear(rng: np.random.Generator) -> SteeringGear:
    """Draw a gear of the default's size and scale it.

    Raises:
        InputError: the numbers drawn make no gear.
    """
    items = {item.path: item for item in SteeringGear.declared()}
    values = drawn(rng, SteeringGear, GEAR)
    scale = (USUAL_SCALE if rng.random() < USUAL_SHARE else SCALE).draw(rng, values)
    shift, tip = values.pop("pinion.profile_shift"), values.pop("pinion.tip_diameter")
    of_friction = values.pop("test.steer_torque")
    values["test.turns"] /= values["pinion.teeth"]
    settings = {
        path: within(items[path], scaled(items[path], value, scale)) for path, value in values.items()
    }
    gear = with_teeth(SteeringGear().replace(settings), shift, tip)
    return gear.replace({"test.steer_torque": of_friction * abs(free_torque(gear))})


def with_teeth(gear: SteeringGear, margin: float, fraction: float) -> SteeringGear:
    """Return the gear without undercut: `margin` above the least profile shift, its tip circle at a
    fraction of the way from the form circle to the point.

    Raises:
        InputError: there is no such tooth.
    """
    shifted = gear.replace({"pinion.profile_shift": float(undercut_limit(GearPair.of(gear)) + margin)})
    pair = GearPair.of(shifted)
    try:
        form, pointed = form_point(pair).radius, pointed_radius(pair)
    except ValueError as error:
        raise InputError([str(error)]) from None
    return shifted.replace({"pinion.tip_diameter": 2 * float(form + fraction * (pointed - form))})


def placed(gear: SteeringGear) -> SteeringGear:
    """Return the gear whose start angle was a share of what its teeth allow."""
    return gear.replace({"test.start_angle": gear.test.start_angle * largest_angle(gear)})


# --- plans -------------------------------------------------------------------------------------------
def random_plan(rng: np.random.Generator) -> ScenePlan:
    """Return a random gear and test in a random scene, in a random model that the scene can have."""
    scene = random_scene(rng)
    gear = with_laws(rng, random_gear(rng, scene))
    fixed: dict[str, Any] = {}
    if scene_named(scene).needs_inertia:
        fixed = {"solver": "generalized-alpha"}
    fidelity = random_fidelity(rng, fixed)
    while scene_named(scene).at_rest and fidelity.rack not in FREE_RACK_MODELS:
        fidelity = random_fidelity(rng, fixed)
    if fidelity.mesh == "triangles":  # which have one law each of contact and friction
        gear = gear.replace({"mesh.law": "line", "mesh.friction_law": PLAIN_LAW})
    return ScenePlan(scene, gear, affordable(gear, scene, fidelity))


def usual_plan(rng: np.random.Generator) -> ScenePlan:
    """Return a random gear and test as its user would run it: in a preset that its scene has.

    Formulas are those of three scenes; general contact, which costs much, turns a part of a pitch, and has
    Coulomb's friction and law `line`.
    """
    preset = str(rng.choice(list(PRESET_WEIGHTS), p=list(PRESET_WEIGHTS.values())))
    if preset == "full":
        gear = random_gear(rng, "free-pinion-torque")
        part = {"test.path": "one-way", "test.turns": PART_OF_PITCH / gear.pinion.teeth}
        plain = {f"{name}.friction_law": PLAIN_LAW for name in RUBBING_PARTS} | {"mesh.law": "line"}
        return ScenePlan("free-pinion-torque", gear.replace(part | plain), Fidelity.preset(preset))
    scene = random_scene(rng)
    only = {"closed-form": BY_FORMULA, "reduced": REDUCED}.get(preset, SCENE_NAMES)
    while scene not in only:
        scene = random_scene(rng)
    inert = scene_named(scene).needs_inertia and preset != "reduced"
    fidelity = Fidelity.preset("flank" if inert else preset)
    gear = with_laws(rng, random_gear(rng, scene))
    return ScenePlan(scene, gear, affordable(gear, scene, fidelity))


def with_laws(rng: np.random.Generator, gear: SteeringGear) -> SteeringGear:
    """Return the gear, in most draws with the teeth's friction law for all its parts."""
    if rng.random() > ONE_LAW:
        return gear
    return gear.replace({f"{part}.friction_law": gear.mesh.friction_law for part in RUBBING_PARTS})


def affordable(gear: SteeringGear, scene: str, fidelity: Fidelity) -> Fidelity:
    """Return the model, in steps as long as a plan can afford."""
    if scene in UNEVEN:
        return fidelity
    steps = sum(
        maneuver.lead + maneuver.steps for maneuver in maneuvers_of_test(gear, "pinion", fidelity.step_angle)
    )
    return fidelity.replace({"step_angle": fidelity.step_angle * max(1.0, steps / MOST_STEPS)})


# --- whether a test stays on the teeth -----------------------------------------------------------------
def _turning(gear: SteeringGear) -> None:
    maneuvers_of_test(gear, "pinion", COARSE)


def _loading(gear: SteeringGear) -> None:
    if not gear.test.load_mass > 0:
        raise InputError("no weight")
    maneuvers_of_test(gear.replace({"test.path": "there-and-back"}), "pinion", COARSE)


def _steering(gear: SteeringGear) -> None:
    swing_maneuver(gear, COARSE)


def _resting(gear: SteeringGear) -> None:
    check_travel(gear, (gear.test.start_angle,), "test.start_angle")


def _setting_off(gear: SteeringGear) -> None:
    set_off(gear)


def _shaking(gear: SteeringGear) -> None:
    shaken(gear)


def _giving_torque(gear: SteeringGear) -> None:
    torque_maneuver(gear)


REACHES: dict[str, Callable[[SteeringGear], None]] = {
    "free-pinion-torque": _turning,
    "rack-push": _turning,
    "rack-on-rollers": _turning,
    "load-test": _loading,
    "reversal": _steering,
    "steering-feel": _steering,
    "steering-torque": _giving_torque,
    "stick-slip": _setting_off,
    "yoke-impact": _shaking,
    "radial-play": _resting,
    "rack-lift": _resting,
    "input-shaft-play": _resting,
    "rattle": _resting,
    "yoke-setting": _turning,
}
"""Scene -> what raises InputError where its test leaves the rack's teeth."""
