"""The cheapest model that keeps a wanted accuracy, from the table that was measured and published with it.

    choice = choose("free-pinion-torque", gear, percent("1%"))
    choice.fidelity, choice.why

`rps.run(..., accuracy="1%")` and `rps-exudyn run --accuracy 1%` use it.

The error is that of a quantity: the scene's torque or force, RMS over the motion in % of its mean, or a
number of its summary where that curve jumps (`accuracy_check.error_between`). What a setting promises is its
worst error on many random gears and tests, with a margin, and what the reference itself leaves open.
docs/accuracy.md describes the method.
"""

import json
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import short
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import PRESETS, Fidelity, unknown_preset
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.law_error import law_error
from rps_exudyn.scenes import SCENE_NAMES, scene_named
from rps_exudyn.scenes.maneuver import whole_periods

LEAST_SLIDING = 0.2  # of the mean, somewhere in mesh: below it references of random gears do not agree

TABLE = Path(__file__).with_name("table.json")


@dataclass(frozen=True)
class Setting:
    """A row of the table."""

    preset: str
    angles_per_pitch: int | None  # None: steps are the scene's own
    settings: Mapping[str, Any]  # of the fidelity, besides the step
    promised: float  # error [%]
    median: float  # error on the gears it was tried on [%]
    cost: float  # CPU seconds of the solver per revolution where all teeth are alike, median of gears
    cost_of_turn: float  # the same where errors single out a tooth, so that no pitch stands for another
    failed: float  # fraction of these gears on which it gave no result

    def angles_for(self, gear: SteeringGear) -> int | None:
        """Return the angles on a tooth pitch that keep the promise by the gear's contact law."""
        if self.angles_per_pitch is None:
            return None
        return ceil(denser(gear.mesh.contact_law) * self.angles_per_pitch)

    def cost_for(self, gear: SteeringGear) -> float:
        """Return about how many CPU seconds of the solver a revolution of this gear costs."""
        alike = whole_periods(gear, 2 * np.pi) == gear.pinion.teeth
        return denser(gear.mesh.contact_law) * (self.cost if alike else self.cost_of_turn)

    def for_gear(self, gear: SteeringGear) -> Fidelity:
        """Return the fidelity, with the step that has the setting's angles on this gear's tooth pitch."""
        settings = dict(self.settings)
        if angles := self.angles_for(gear):
            settings = {"step_angle": 2 * np.pi / gear.pinion.teeth / angles, **settings}
        return Fidelity.preset(self.preset).replace(settings)


@dataclass(frozen=True)
class SceneTable:
    """Settings measured on one quantity of a scene."""

    scene: str
    quantity: str  # name of its signal, or of a number of its summary
    floor: float  # below it the references' methods disagree [%]
    gears: int  # on which the settings were tried
    settings: tuple[Setting, ...]

    def known(self, gear: SteeringGear, presets: Collection[str]) -> list[Setting]:
        """Return the settings of these presets whose model has the gear's contact law."""
        return [each for each in self.settings if each.preset in presets and knows_law(each, gear)]


@dataclass(frozen=True)
class Choice:
    """Setting chosen, its fidelity, what it promises, and why."""

    fidelity: Fidelity
    setting: Setting
    quantity: str  # whose error is promised
    why: str
    beside: str  # what the promise leaves out: the error of the contact law
    promised: bool  # False of a gear for which the table promises nothing


def choose(
    scene: str,
    gear: SteeringGear,
    wanted: float,
    preset: str | None = None,
    without: Collection[str] = (),
) -> Choice:
    """Return the cheapest setting that promises `wanted` [%], of all or of one preset.

    Where none promises it of the scene's signal, one that promises it of a number of the summary is taken.
    `without` names presets that were tried and did not run.

    Raises:
        InputError: the accuracy is below the floor, no setting promises it, or nothing is known of the scene
            or its test.
    """
    if why := scene_named(scene).unpromised(gear):
        raise InputError(_nothing_promised(scene, why))
    tables = scene_tables(scene)
    if preset is not None and preset not in PRESETS:
        raise InputError(unknown_preset(preset))
    presets = {preset} if preset else PRESETS.keys() - set(without)
    _check_reach(tables, gear, wanted, preset, presets)
    for table in tables:
        enough = [each for each in table.known(gear, presets) if each.promised <= wanted]
        if enough and wanted >= table.floor:
            break
    taken = min(enough, key=lambda each: each.cost_for(gear))
    why, beyond = _why(taken, table, gear, wanted, len(enough)), beyond_promise(gear)
    why += _instead_of(tables[0], table) + beyond
    fidelity = taken.for_gear(gear)
    return Choice(fidelity, taken, table.quantity, why, _beside(gear, fidelity), not beyond)


def _check_reach(
    tables: Sequence[SceneTable],
    gear: SteeringGear,
    wanted: float,
    preset: str | None,
    presets: Collection[str],
) -> None:
    """Check that a setting promises what is wanted of one of the quantities.

    Raises:
        InputError: none does; the sentence states how far they go.
    """
    scene, floor = tables[0].scene, min(table.floor for table in tables)
    if wanted < floor:
        raise InputError(
            f"--accuracy is {wanted:g} %; the references of {scene} are known to {floor:.2g} %, and no "
            f"stricter accuracy can be promised."
        )
    known = [(each, table) for table in tables for each in table.known(gear, presets)]
    if not known:
        measured = ", ".join(sorted({each.preset for table in tables for each in table.settings}))
        raise InputError(f"fidelity is {preset}; for {scene} accuracies are known of {measured}.")
    if not any(each.promised <= wanted and wanted >= table.floor for each, table in known):
        best = min(max(each.promised, table.floor) for each, table in known)
        of = f"of {preset} " if preset else ""
        raise InputError(
            f"--accuracy is {wanted:g} %; the most exact setting {of}in the table for {scene} "
            f"promises {best:.2g} %."
        )


def _instead_of(first: SceneTable, taken: SceneTable) -> str:
    """Return a note that another quantity than the scene's signal is promised; empty if it is the signal."""
    if taken is first:
        return ""
    best = min(each.promised for each in first.settings)
    return f"; the promise is for {taken.quantity}; for {first.quantity} it is {best:.2g} % at best"


def beyond_promise(gear: SteeringGear) -> str:
    """Return why the table promises nothing for this gear; empty if it does."""
    if GearPair.of(gear).slowest_sliding < LEAST_SLIDING:
        return "; NOT promised for this gear: its teeth hardly slide at the pitch point, where friction jumps"
    return ""


def beyond_in_run(scene: str, signals: Mapping[str, np.ndarray]) -> str:
    """Return why the table promises nothing for what a run has shown; empty if it does.

    Where the pinion is held the yoke may stop: that is what such scenes are for.
    """
    stopped = (signals.get("yokenut_force", np.zeros(1)) > 0).any()
    if scene_named(scene).revolutions and stopped:
        return "; NOT promised for this run, in which the yoke stops at its nut"
    return ""


def knows_law(setting: Setting, gear: SteeringGear) -> bool:
    """Return whether a setting's model has the gear's contact law; formulas and spheres have no teeth that
    bend."""
    return gear.mesh.contact_law != "teeth" or Fidelity.preset(setting.preset).bends_teeth


def _beside(gear: SteeringGear, fidelity: Fidelity) -> str:
    """Return what the promise leaves out: the error of the contact law, and models that do not have it."""
    law = law_error(gear, fidelity.model_dump())
    if law is None:
        return ""
    only = "; closed form and general contact do not model it and are not considered"
    left_out = only if gear.mesh.contact_law == "teeth" else ""
    return f"; this is the numerical error; in addition, {law.clause}{left_out}"


def _why(taken: Setting, table: SceneTable, gear: SteeringGear, wanted: float, enough: int) -> str:
    angles, cost = taken.angles_for(gear), taken.cost_for(gear)
    knobs = [f"{angles} angles per tooth pitch"] if angles is not None else []
    knobs += [f"{name} {value:g}" for name, value in taken.settings.items()]
    per = scene_named(table.scene).unit_of_cost
    return (
        f"{taken.preset}, {', '.join(knobs) or 'unmodified'}: the cheapest of {enough} settings within "
        f"{wanted:g} %; it promises {taken.promised:.2g} % of {table.quantity} (half of {table.gears} "
        "random gears stay below "
        f"{taken.median:.2g} %) at about {1e3 * cost:.2g} ms of CPU time per {per}"
    )


def percent(text: str) -> float:
    """Return the number in "1%" or "0.1 %".

    Raises:
        InputError: anything else, or not above zero.
    """
    match = re.fullmatch(r"\s*([0-9.eE+-]+)\s*%\s*", str(text))
    try:
        value = float(match[1]) if match else np.nan
    except ValueError:
        value = np.nan
    if not (0 < value < np.inf):
        raise InputError(
            f"--accuracy is {short(str(text))}; it must be a percentage greater than 0, for instance 1%."
        )
    return value


def known_scenes() -> list[str]:
    """Return the scenes that have a table."""
    return [name for name in SCENE_NAMES if _measured_as(name) in _tables()["scenes"]]


def _measured_as(scene: str) -> str:
    """Return the name under which the table has a scene."""
    return scene_named(scene).promised_as or scene


def _nothing_promised(scene: str, why: str) -> str:
    known = ", ".join(known_scenes())
    return (
        f"--accuracy has tables for {known}; for {scene} nothing can be promised{f': {why}' if why else ''}."
    )


def scene_tables(scene: str) -> list[SceneTable]:
    """Return the published tables of a scene, that of its signal first if there is one.

    Raises:
        InputError: there is none.
    """
    measured = _measured_as(scene)
    if measured not in _tables()["scenes"]:
        raise InputError(_nothing_promised(scene, ""))
    return [
        SceneTable(
            scene,
            table["quantity"],
            table["floor"],
            table["gears"],
            tuple(Setting(**row) for row in table["settings"]),
        )
        for table in _tables()["scenes"][measured]["quantities"]
    ]


def denser(law: str) -> float:
    """Return how many times the angles of the table a contact law needs, as measured."""
    return float(_tables()["laws"].get(law, 1.0))


@cache
def _tables() -> dict[str, Any]:
    tables: dict[str, Any] = json.loads(TABLE.read_text(encoding="utf-8"))
    return tables
