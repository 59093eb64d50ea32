"""Gears that cannot be are refused with quantity, value, limit and a value that is admissible."""

import dataclasses
import json
from typing import Any

import numpy as np
import pytest

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_limits import pinion_tip_interference, violations
from rps_exudyn.gears.geometry_report import check_gear, geometry_report
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import GEOMETRY

GEAR = SteeringGear()
SLIM_SHAFT = {"pinion.shaft_diameter": "6 mm"}
MANY_TEETH = {"pinion.teeth": 20, "pinion.profile_shift": 0.0, "pinion.shaft_diameter": "20 mm"}

# wrong parameters -> the parameter to change, and words of the sentence
WRONG: dict[str, tuple[dict[str, Any], str, str]] = {
    "undercut": (
        {"pinion.profile_shift": 0.4, "pinion.tip_diameter": "17 mm", **SLIM_SHAFT},
        "pinion.profile_shift",
        "undercut: the profile shift coefficient is 0.4; it must be at least 0.5403",
    ),
    "pointed": ({"pinion.tip_diameter": "19 mm"}, "pinion.tip_diameter", "the crest is -0.3369 mm wide"),
    "no involute": ({"pinion.tip_diameter": "11 mm"}, "pinion.tip_diameter", "the form diameter 12.12 mm"),
    "relief": (
        {"pinion.tip_relief": "0.1 mm", "pinion.tip_diameter": "18.6 mm"},
        "pinion.tip_relief",
        "more than the crest",
    ),
    "relief too long": (
        {"pinion.tip_relief": "20 um", "pinion.tip_relief_length": "20 mm"},
        "pinion.tip_relief_length",
        "beyond the active flank, which is 4.899 mm of roll long",
    ),
    "pointed rack": (
        {"basic_rack.addendum": 1.5, "pinion.pressure_angle": "27 deg", "basic_rack.dedendum": 1.5,
         "basic_rack.fillet_radius": 0.0},
        "basic_rack.addendum",
        "rack's teeth are pointed",
    ),
    "contact lost": (
        {"pinion.face_width": "2 mm"},
        "pinion.face_width",
        "total contact ratio is 0.9792 (transverse 0.8322, overlap 0.147); it must be at least 1",
    ),
    "straight teeth": ({"pinion.helix_angle": 0.0}, "pinion.helix_angle", "overlap 0); it must be at least"),
    "teeth apart": (
        {"basic_rack.addendum": 0.5, "pinion.tip_diameter": "12.4 mm"},
        "pinion.tip_diameter",
        "do not meet",
    ),
    "tips in the root": (
        {**MANY_TEETH, "pinion.tip_diameter": "46 mm"}, "pinion.tip_diameter", "into the rack's root",
    ),
    "tips in the fillets": (
        {**MANY_TEETH, "pinion.tip_diameter": "44.9 mm"}, "pinion.tip_diameter", "into the fillets",
    ),
    "runout": (
        {"pinion.runout": "0.5 mm", **SLIM_SHAFT}, "pinion.runout", "runout is 0.5 mm; it must be at most",
    ),
    "shaft": ({"pinion.shaft_diameter": "14 mm"}, "pinion.shaft_diameter", "cut into the pinion's shaft"),
    "cutter too short": ({"basic_rack.dedendum": 1.1}, "basic_rack.dedendum", "cutter does not reach"),
    "cutter pointed": (
        {"basic_rack.fillet_radius": 0.5, "basic_rack.dedendum": 1.34}, "basic_rack.fillet_radius", "overlap",
    ),
    "no root": (
        {"pinion.teeth": 3, "pinion.profile_shift": -0.5}, "pinion.profile_shift", "root radius",
    ),
    "bar too short": ({"rack.length": "500 mm"}, "rack.length", "more than the bar offers"),
    "seat too long": ({"yoke.seat_length": "25 mm"}, "yoke.seat_length", "its radius is 15 mm"),
    "plunger too short": ({"yoke.plunger_length": "4 mm"}, "yoke.plunger_length", "deep"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_wrong_gear_is_refused_with_a_value_that_is_admissible(name: str) -> None:
    """The sentence names value and limit; the value it offers is admissible for that parameter."""
    settings, path, words = WRONG[name]
    gear = GEAR.replace(settings)
    with pytest.raises(InputError) as refusal:
        check_gear(gear)
    sentence = next(line for line in refusal.value.problems if words in line)
    assert f"{path} is" in sentence
    found = next(item for item in violations(gear) if words in item.what)
    assert found.path == path
    assert found.nearest is not None
    mended = violations(gear.replace({path: found.nearest}))
    assert found.what.split(":")[0] not in [item.what.split(":")[0] for item in mended]
    assert path not in [item.path for item in mended]


def test_default_gear_is_admissible() -> None:
    check_gear(GEAR)


def test_remedy_that_does_not_exist_is_not_invented() -> None:
    """A spur gear has no overlap, whatever its width, and a slim one too little, whatever its helix."""
    slim = {"pinion.tip_diameter": "16.5 mm", "pinion.face_width": "0.5 mm", **SLIM_SHAFT}
    gear = GEAR.replace({"pinion.helix_angle": 0.0, **slim})
    with pytest.raises(InputError, match=r"contact ratio is 0.8441.*changing this parameter does not help"):
        check_gear(gear)


def test_force_builds_undercut_gears_with_a_warning() -> None:
    gear = GEAR.replace(WRONG["undercut"][0])
    report = geometry_report(gear, force=True)
    assert any("undercut" in warning for warning in report.warnings)
    assert report.undercut_margin == pytest.approx(0.4 - 0.5403, abs=1e-4)
    assert report.form_diameter > report.base_diameter


def test_force_forgives_nothing_else() -> None:
    with pytest.raises(InputError, match="pointed"):
        check_gear(GEAR.replace(WRONG["pointed"][0]), force=True)


def test_tips_just_inside_the_limit_touch_the_fillet() -> None:
    """The nearest tip diameter is the largest: 0.1 um more cuts into the fillets."""
    gear = GEAR.replace(WRONG["tips in the fillets"][0])
    nearest = violations(gear)[0].nearest
    assert nearest is not None
    pair = dataclasses.replace(GearPair.of(gear), tip_radius=nearest / 2)
    assert -1e-6 < pinion_tip_interference(pair) < 1e-9
    assert pinion_tip_interference(dataclasses.replace(pair, tip_radius=nearest / 2 + 1e-6)) > 1e-8


def test_report_of_the_papers_gear() -> None:
    """Hand-checkable numbers: 6 pi m_n / cos(10 deg) per turn, clearances 0.25 m_n and from the diameters."""
    report = geometry_report(GEAR)
    m = 1.83e-3
    assert report.travel_per_turn == pytest.approx(6 * np.pi * m / np.cos(np.radians(10)))
    assert report.pinion_root_clearance == pytest.approx(0.25 * m)
    assert report.rack_root_clearance == pytest.approx(12.11509e-3 / 2 + 2.25 * m - 9.1e-3, abs=1e-9)
    assert report.overlap_ratio == pytest.approx(14e-3 * np.sin(np.radians(25)) / (np.pi * m))
    assert report.transverse_contact_ratio == pytest.approx(0.832, abs=1e-3)
    assert report.interference <= 1e-4 * m  # the rounding of rho_fP in ISO 53
    assert report.mass_properties["rack"].mass == pytest.approx(2.24, abs=0.01)
    assert report.warnings == (
        "The round bar is narrower at the rack's tips (12.2 mm) than the pinion's face (14 mm); "
        "with that width the total contact ratio is 1.73.",
    )


def test_report_as_plain_data() -> None:
    """Every quantity by name, in SI, ready for JSON."""
    report = geometry_report(GEAR)
    plain = json.loads(json.dumps(report.as_dict()))
    assert plain["tip_diameter"] == pytest.approx(18.2e-3)
    assert np.shape(plain["mass_properties"]["pinion"]["inertia"]) == (3, 3)
    assert set(GEOMETRY) < set(plain)
