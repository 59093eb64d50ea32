"""Parameters that follow from others where they are not given: teeth and module can be varied alone."""

from pathlib import Path

import pytest

import rps_exudyn as rps
from rps_exudyn.gears.basic_rack import crest_width
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_report import check_gear
from rps_exudyn.gears.solids import plunger_ends
from rps_exudyn.parameters.derived import DEFAULT, DERIVED, SOURCES, derived_values

ROOT = Path(__file__).parents[2]
ALONE: list[dict[str, object]] = [
    *({"pinion.teeth": z} for z in (5, 7, 8, 10, 12)),
    *({"pinion.normal_module": f"{m} mm"} for m in (1.4, 1.6, 2.0, 2.4)),
    {"pinion.profile_shift": 0.7},
    {"pinion.helix_angle": "15 deg"},
    {"rack.bar_diameter": "22 mm"},
]
PAPER = ROOT / "studies" / "gears" / "paper.toml"


def test_default_gear_has_what_follows_from_it() -> None:
    gear = rps.SteeringGear()
    assert derived_values(gear.model_dump()) == {path: gear.value_at(path) for path in DERIVED}
    assert {name: gear.value_at(path) for path, name in SOURCES.items()} == DEFAULT._asdict()


@pytest.mark.parametrize("setting", ALONE, ids=str)
def test_one_parameter_alone_leaves_a_gear_that_can_be_built(setting: dict[str, object]) -> None:
    """Its crest is no narrower than the default gear's, and its shaft leaves the roots free."""
    gear = rps.SteeringGear().replace(setting)
    check_gear(gear)
    pair, usual = GearPair.of(gear), GearPair.of(rps.SteeringGear())
    crest = crest_width(pair, pair.tip_radius) / pair.module
    assert crest > crest_width(usual, usual.tip_radius) / usual.module - 1e-4  # of 10 nm rounding
    assert gear.pinion.shaft_diameter < 2 * pair.root_radius
    assert plunger_ends(gear)[1] > 0


def test_standard_gear_has_the_standard_addendum() -> None:
    """20 teeth without profile shift are thick enough: d_a = d + 2 m_n."""
    gear = rps.SteeringGear().replace({"pinion.teeth": 20, "pinion.profile_shift": 0})
    pair = GearPair.of(gear)
    assert gear.pinion.tip_diameter == pytest.approx(2 * (pair.reference_radius + pair.module), abs=1e-8)


def test_what_is_given_stays() -> None:
    usual = rps.SteeringGear()
    given = usual.replace({"pinion.teeth": 7, "pinion.tip_diameter": "19.1 mm"})
    assert given.pinion.tip_diameter == pytest.approx(0.0191, rel=1e-12)
    again = given.replace({"pinion.normal_module": "1.85 mm"})
    assert again.pinion.tip_diameter == given.pinion.tip_diameter
    assert rps.SteeringGear(pinion={"teeth": 7, "tip_diameter": 0.0191}) == rps.SteeringGear(
        pinion={"tip_diameter": 0.0191, "teeth": 7, "shaft_diameter": given.pinion.shaft_diameter}
    )
    assert usual.replace({"yoke.preload": 400}).pinion == usual.pinion


def test_shipped_gear_follows_a_setting_and_the_way_back() -> None:
    gear = rps.SteeringGear.from_toml(PAPER, {"pinion.teeth": 8})
    assert gear.pinion.tip_diameter == rps.SteeringGear(pinion={"teeth": 8}).pinion.tip_diameter > 0.022
    assert gear.replace({"pinion.teeth": 6}) == rps.SteeringGear()


def test_wrong_values_get_the_sentences_of_their_own() -> None:
    for settings, sentence in (
        ({"pinion.teeth": "many"}, "pinion.teeth is 'many'; it must be a whole number"),
        ({"pinion.teeth": 0}, "pinion.teeth is 0; it must be"),
        ({"pinion.normal_module": "2 kg"}, "pinion.normal_module is '2 kg', which is no quantity in m"),
        ({"pinion.helix_angle": "90 deg"}, "pinion.helix_angle is '90 deg'; it must be"),
    ):
        with pytest.raises(rps.InputError, match=sentence):
            rps.SteeringGear().replace(settings)
    with pytest.raises(rps.InputError, match="pinion is 7; it must be a table of parameters"):
        rps.SteeringGear.from_tables({"pinion": 7}, {"rack.bar_diameter": "22 mm"})


def test_file_of_a_spreadsheet(tmp_path: Path) -> None:
    """A byte order mark at the beginning, decimal commas in texts."""
    (tmp_path / "gear.toml").write_text('[yoke]\npreload = "412,5 N"\n', encoding="utf-8-sig")
    assert rps.SteeringGear.from_toml(tmp_path / "gear.toml").yoke.preload == 412.5
