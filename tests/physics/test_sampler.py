"""Random gears and models come from every declared parameter, and are similar gears in every size."""

from collections.abc import Mapping
from typing import get_args

import numpy as np
import pytest

from rps_exudyn.gears.geometry_report import check_gear
from rps_exudyn.parameters.declaration import Length, Number, Table, parameter
from rps_exudyn.parameters.fidelity import PRESETS, Fidelity
from rps_exudyn.parameters.friction_law import LAWS, RUBBING_PARTS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes import SCENE_NAMES
from verification.ranges import Logarithmic, Range, range_of, scaled
from verification.runs import run_scene
from verification.sampler import drawn, random_gear, random_plan, usual_plan
from verification.stated_ranges import FIDELITY, GEAR

FIXED = {
    "pinion.normal_module",  # the scale of the whole gear makes others of it
    "mesh",  # general contact is drawn apart
    "swing_steps",  # 0: published plans of impacts are in the steps of their scene
    "pinion.deviation",  # a grid is measured on one gear
    "rack.deviation",
    "pinion.surface",
    "rack.surface",
    "rack.ratio.centre",  # a course is that of one gear
    "rack.ratio.lock",
    "rack.ratio.angle",
    "rack.ratio.travel_per_turn",
}


class Newer(Table):
    """Parameters as one may declare them some day."""

    width: Length = parameter("4 mm", "a part's width", "estimate", gt=0, le=0.006)
    kind: Number = parameter(0.0, "an error", "estimate")


@pytest.mark.parametrize(("table", "stated"), [(SteeringGear, GEAR), (Fidelity, FIDELITY)])
def test_every_declared_parameter_is_drawn_and_varies(
    table: type[Table], stated: Mapping[str, Range]
) -> None:
    several = [drawn(np.random.default_rng(seed), table, stated) for seed in range(40)]
    declared = {item.path for item in table.declared()}
    assert {path for draw in several for path in draw} == declared
    varied = {path for path in declared if len({draw[path] for draw in several}) > 1}
    assert declared - varied <= FIXED


def test_no_range_is_stated_for_what_is_not_declared() -> None:
    assert GEAR.keys() <= {item.path for item in SteeringGear.declared()}
    assert FIDELITY.keys() <= {item.path for item in Fidelity.declared()}


def test_a_parameter_declared_anew_gets_a_range_about_its_default_or_none() -> None:
    width, kind = Newer.declared()
    assert range_of(width, {}) == Logarithmic(0.002, 0.006)  # half the default to its upper limit
    with pytest.raises(LookupError, match="kind has no range"):
        range_of(kind, {})


def test_a_parameter_declared_anew_changes_none_of_the_others() -> None:
    """Plans that are published stay what they are."""
    fewer = {path: item for path, item in GEAR.items() if path != "mesh.friction"}  # another range follows
    before, after = (drawn(np.random.default_rng(3), SteeringGear, stated) for stated in (GEAR, fewer))
    assert {path for path in before if before[path] != after[path]} == {"mesh.friction"}


def test_random_gears_can_exist_in_any_size() -> None:
    gears = [random_gear(np.random.default_rng(seed), "free-pinion-torque") for seed in range(40)]
    for gear in gears:
        check_gear(gear)  # raises
    modules = [gear.pinion.normal_module for gear in gears]
    assert min(modules) < 1e-3
    assert max(modules) > 5e-3


def test_every_scene_law_and_choice_is_drawn_in_plans() -> None:
    """General contact and formulas are drawn as presets: the one costs much, the others have no error of
    method."""
    plans = [random_plan(np.random.default_rng([3, seed])) for seed in range(150)]
    plans += [usual_plan(np.random.default_rng([4, seed])) for seed in range(60)]
    assert {plan.scene for plan in plans} == set(SCENE_NAMES)
    for part in RUBBING_PARTS:
        assert {getattr(plan.gear, part).friction_law for plan in plans} == set(LAWS)
    for table, of_plan in ((SteeringGear, "gear"), (Fidelity, "fidelity")):
        for item in table.declared():
            if choices := get_args(item.field.annotation):
                drawn_ones = {getattr(plan, of_plan).value_at(item.path) for plan in plans}
                assert drawn_ones >= set(choices), item.path
    assert {plan.fidelity.based_on for plan in plans} == set(PRESETS)


def test_a_plan_is_that_of_its_seed() -> None:
    first, second = (random_plan(np.random.default_rng([1, 2])) for _ in range(2))
    assert (first.scene, first.gear, first.fidelity) == (second.scene, second.gear, second.fidelity)


@pytest.mark.parametrize("scale", [0.2, 5.0])
def test_a_scaled_gear_is_similar(scale: float) -> None:
    """Torques grow with the cube of the length where stresses and speeds are the same.

    Unbalanced forces are accepted to 1e-3 N whatever the size: 1e-4 of the smaller gear's.
    """
    gear = SteeringGear().replace({"test.turns": 1 / 6, "mesh.law": "line", "installation.axis_offset": 1e-5})
    larger = gear.replace(
        {
            item.path: scaled(item, gear.value_at(item.path), scale)
            for item in SteeringGear.declared()
            if item.unit
        }
    )
    ours, theirs = (
        run_scene("free-pinion-torque", each, Fidelity.preset("quasi-static")).summary["torque_mean"]
        for each in (gear, larger)
    )
    assert theirs == pytest.approx(scale**3 * ours, rel=1e-3)
