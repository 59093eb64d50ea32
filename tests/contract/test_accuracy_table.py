"""The tables behind `--accuracy`: what is stricter costs more, and settings follow the tooth pitch."""

import numpy as np
import pytest

from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import SIGNALS, SUMMARY
from rps_exudyn.scenes import SCENE_NAMES
from rps_exudyn.simulate.accuracy_check import is_signal
from rps_exudyn.simulate.by_accuracy import choose, denser, known_scenes, scene_tables

GEAR = SteeringGear()
STEADY = ("free-pinion-torque", "load-test", "rack-push", "yoke-setting")


@pytest.mark.parametrize("scene", STEADY)
def test_stricter_is_never_cheaper(scene: str) -> None:
    table = scene_tables(scene)[0]
    strictest = min(each.promised for each in table.settings)
    wanted = np.geomspace(max(strictest, table.floor), 10.0, 12)
    costs = [choose(scene, GEAR, float(each)).setting.cost for each in wanted * (1 + 1e-9)]
    assert costs == sorted(costs, reverse=True)
    assert costs[0] > costs[-1]


@pytest.mark.parametrize("scene", STEADY)
def test_forty_gears_stand_behind_a_steady_scene_and_a_tenth_of_a_percent_is_promised(scene: str) -> None:
    table = scene_tables(scene)[0]
    assert table.gears >= 40
    assert min(each.promised for each in table.settings) <= 0.1


@pytest.mark.parametrize(
    ("scene", "quantity"),
    [
        ("reversal", "hysteresis_area"),
        ("yoke-impact", "impact_force_rms"),
        ("rack-lift", "rack_lift"),
        ("radial-play", "radial_play_y"),
    ],
)
def test_forty_gears_stand_behind_a_number_and_a_tenth_of_a_percent_is_promised(
    scene: str, quantity: str
) -> None:
    (table,) = (each for each in scene_tables(scene) if each.quantity == quantity)
    assert table.gears >= 40
    assert min(each.promised for each in table.settings) <= 0.1


@pytest.mark.parametrize(
    ("quantity", "promised"), [("rattle_force_rms", 1.0), ("rattle_impulse_per_cycle", 1.2)]
)
def test_rattle_is_promised_to_what_creep_in_the_friction_zone_leaves(quantity: str, promised: float) -> None:
    """Of 408 gears 38 are hit, in a test that is short enough for a reference."""
    (table,) = (each for each in scene_tables("rattle") if each.quantity == quantity)
    assert table.gears == 38
    assert min(each.promised for each in table.settings) <= promised


def test_quantities_are_the_scenes_signal_or_numbers_of_a_summary() -> None:
    assert set(known_scenes()) <= set(SCENE_NAMES)
    for scene in known_scenes():
        for table in scene_tables(scene):
            assert table.quantity in (SIGNALS if is_signal(scene, table.quantity) else SUMMARY)
            assert all(each.promised >= table.floor for each in table.settings)


def test_what_the_signal_does_not_promise_is_promised_of_a_number_and_said() -> None:
    signal, number = scene_tables("reversal")
    best = min(each.promised for each in signal.settings)
    strict = min(each.promised for each in number.settings)
    assert strict < best
    assert choose("reversal", GEAR, best).quantity == signal.quantity
    choice = choose("reversal", GEAR, (strict + best) / 2)
    assert choice.quantity == number.quantity == "hysteresis_area"
    assert f"the promise is for hysteresis_area; for pinion_torque it is {best:.2g} % at best" in choice.why


def test_the_step_follows_the_tooth_pitch() -> None:
    few, many = (choose("free-pinion-torque", GEAR.replace({"pinion.teeth": z}), 1.0) for z in (6, 8))
    assert few.fidelity.step_angle * 6 == pytest.approx(many.fidelity.step_angle * 8)


def test_the_step_follows_what_the_contact_law_needs() -> None:
    by = {
        law: choose("free-pinion-torque", GEAR.replace({"mesh.law": law}), 1.0) for law in ("line", "teeth")
    }
    shared = by["line"].setting == by["teeth"].setting
    ratio = by["line"].fidelity.step_angle / by["teeth"].fidelity.step_angle
    assert denser("line") == 1 <= denser("teeth")
    assert not shared or ratio == pytest.approx(denser("teeth"), rel=0.1)  # angles are whole numbers
