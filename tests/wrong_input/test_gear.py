"""A wrong gear is refused in sentences: parameter, value, what is allowed; all of them at once."""

import contextlib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rps_exudyn.base import units
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.declaration import Declared
from rps_exudyn.parameters.gear import SteeringGear

TABLES = ", ".join(SteeringGear.model_fields)

TEMPERATURES = "it must be at least -40 degC and at most 100 degC."
CLASSES = 'write "ISO 1328 class 8, seed 3", with a class of 1 to 11 and a whole number as seed.'

# path, value, what the sentence says behind the path
ONE_PROBLEM = [
    ("yoke.preloda", 3, "is no parameter; the nearest one is yoke.preload."),
    ("brake", {"force": 3}, f"is no table of parameters; there are {TABLES}."),
    ("brake", 3, f"is no parameter; there are {TABLES}."),
    ("yoke", 3, "is 3; it must be a table of parameters."),
    ("yoke.preload", "3 kg", "is '3 kg', which is no quantity in N; write for instance \"300 N\"."),
    ("yoke.preload", "-3 N", "is '-3 N'; it must be at least 0 N."),
    ("pinion.normal_module", "-1 mm", "is '-1 mm'; it must be more than 0 mm and at most 20 mm."),
    ("pinion.teeth", "six", "is 'six'; it must be a whole number, at least 3 and at most 40."),
    ("pinion.teeth", 6.5, "is 6.5; it must be a whole number, at least 3 and at most 40."),
    ("bush.length", "nan", "is 'nan'; it must be finite."),
    ("test.direction", 3, "is 3; it must be -1 or 1."),
    ("mesh.friction", "6 deg", "is '6 deg', which is no quantity in plain numbers; write for instance 0.1."),
    ("test.speed", "1 Hz", "is '1 Hz', which is no quantity in rad/s; write for instance \"15 rpm\"."),
    ("test.turns", 1e-4, "is 0.0001; it must be at least 0.001."),
    ("pinion.tip_relief", "1 mm", "is '1 mm'; it must be at least 0 mm and at most 0.1 mm."),
    ("pinion.crowning", "1 mm", "is '1 mm'; it must be at least 0 mm and at most 0.1 mm."),
    ("pinion.pitch_error", "1 mm", "is '1 mm'; it must be at least -0.1 mm and at most 0.1 mm."),
    ("pinion.profile_slope", "-1 mm", "is '-1 mm'; it must be at least -0.1 mm and at most 0.1 mm."),
    ("bearing.upper_clearance", "-1 um", "is '-1 um'; it must be at least 0 mm and at most 1 mm."),
    ("bearing.lower_clearance", "-1 um", "is '-1 um'; it must be at least 0 mm and at most 1 mm."),
    ("pinion.axial_float", "-1 um", "is '-1 um'; it must be at least 0 mm and at most 10 mm."),
    ("yoke.seat_clearance", "-1 um", "is '-1 um'; it must be at least 0 mm and at most 1 mm."),
    ("yoke.seat_form", "oval", "is 'oval'; it must be round or gothic."),
    ("conditions.temperature", "-60 degC", f"is '-60 degC'; {TEMPERATURES}"),
    ("conditions.temperature", "150 degC", f"is '150 degC'; {TEMPERATURES}"),
    ("conditions.temperature", 20.0, f"is 20.0; {TEMPERATURES}"),
    ("conditions.steering_cycles", -1, "is -1; it must be at least 0 and at most 1e+08."),
    ("grease.base_oil", "honey", "is 'honey'; it must be none or PAO 32 or VG 68 or VG 100 or VG 150."),
    ("yoke.liner", "oak", "is 'oak'; it must be ptfe or pom or none."),
    ("pinion.pitch_errors", "ISO 1328 class 14, seed 1", f"is 'ISO 1328 class 14, seed 1'; {CLASSES}"),
    ("rack.pitch_errors", "ISO 1328 class 8", f"is 'ISO 1328 class 8'; {CLASSES}"),
    ("rack.pitch_errors", ["1 mm"], "has the number 0.001; each must be at most 0.0001 m either way."),
    ("rack.pitch_errors", "8 kg", "is '8 kg', which is no quantity in m; write for instance \"1.83 mm\"."),
    (
        "rack.back_parallelism",
        "1 deg",
        "is '1 deg'; it must be at least -0.286479 deg and at most 0.286479 deg.",
    ),
    ("bush.clearance", "-1 um", "is '-1 um'; it must be at least 0 mm and at most 1 mm."),
    ("housing.mount_stiffness", -1.0, "is -1.0; it must be at least 0 N/mm."),
    ("housing.seat_stiffness", [1e8, 1e8], "has 2 numbers; it must have 6 or 36."),
    ("test.band_low", "2 kHz", "is 2000 Hz; it must be below test.band_high = 1000 Hz."),
    ("pinion.lead_error", "-1 mm", "is '-1 mm'; it must be at least -0.1 mm and at most 0.1 mm."),
    (
        "pinion.shaft_length",
        "5 mm",
        "is 5 mm; it carries the whole gear and must be at least as long as pinion.face_width = 14 mm.",
    ),
    ("bush.inner_diameter", 0.04, "is 40 mm; it must be smaller than bush.outer_diameter = 30 mm."),
    (
        "bush.distance",
        1.0,
        "is 1000 mm; it must be at most 550 mm, or the rack leaves the bush within half its travel.",
    ),
]


@pytest.mark.parametrize(("path", "value", "sentence"), ONE_PROBLEM)
def test_one_wrong_parameter_gives_one_sentence(path: str, value: object, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        SteeringGear().replace({path: value})
    assert caught.value.problems == [f"{path} {sentence}"]


def test_table_without_nested_ones_is_validated_alike() -> None:
    """The mesh alone, as a table of its own."""
    with pytest.raises(InputError) as caught:
        SteeringGear().mesh.replace({"friction": 2, "glue": 1})
    assert caught.value.problems == [
        "friction is 2; it must be at least 0 and at most 1.",
        "glue is no parameter; there are friction_law, static_ratio, stribeck_speed, stribeck_exponent, "
        "bristle_travel, bristle_damping, load_exponent, friction, stiffness, damping, law, tooth_wear, "
        "line_stiffness.",
    ]


def test_all_problems_of_a_file_at_once_also_between_parameters(tmp_path: Path) -> None:
    path = tmp_path / "gear.toml"
    path.write_text(
        '[yoke]\npreload = "3 kg"\nstrength = 1\n[rack]\nlength = -1\n[bush]\ninner_diameter = "40 mm"\n'
    )
    with pytest.raises(InputError) as caught:
        SteeringGear.from_toml(path)
    assert [problem.removeprefix(f"{path}: ").split()[0] for problem in caught.value.problems] == [
        "rack.length", "yoke.preload", "yoke.strength", "bush.inner_diameter",
    ]  # fmt: skip
    assert all(problem.startswith(f"{path}: ") for problem in caught.value.problems)


MISFITS: list[tuple[dict[str, object], str]] = [
    (  # 12 mrad, where flanks are described as helicoids nearly like the designed ones
        {"pinion.lead_error": "-60 um", "pinion.face_width": "5 mm"},
        "pinion.lead_error is -0.06 mm; over pinion.face_width = 5 mm it must be at most 0.05 mm either way.",
    ),
    (
        {"bearing.lower_position": "10 mm"},
        "bearing.upper_position is 25 mm and bearing.lower_position 10 mm; the bearings must stand on both "
        "sides of the mesh, the upper one above 0 mm and the lower one below.",
    ),
    (
        {"bush.clearance": "20 um", "bush.interference": "10 um"},
        "bush.clearance is 0.02 mm and bush.interference 0.01 mm; the bar has room in the bush or is pressed "
        "by it: one of them must be 0 mm.",
    ),
    (
        {"pinion.axial_float": "2 mm"},
        "pinion.axial_float is 2 mm; the mesh allows at most 1.4 mm, a tenth of pinion.face_width.",
    ),
    (
        {"pinion.pitch_errors": "1 um, 2 um"},
        "pinion.pitch_errors has 2 numbers; it must have 6, one for each of pinion.teeth.",
    ),
    (
        {"yoke.seat_form": "gothic"},
        "yoke.seat_form is gothic and yoke.seat_clearance 0 mm; the arcs of a gothic arch are wider than the "
        "bar, by more than 0 mm.",
    ),
    (
        {"yoke.seat_form": "gothic", "yoke.seat_clearance": "50 um", "yoke.seat_angle": "40 deg"},
        "yoke.seat_angle is 40 deg; a gothic seat touches at 45 deg and must reach beyond.",
    ),
]


@pytest.mark.parametrize(("settings", "sentence"), MISFITS)
def test_parameters_that_do_not_fit_give_one_sentence(settings: dict[str, object], sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        SteeringGear().replace(settings)
    assert caught.value.problems == [sentence]


def test_misfit_with_a_wrong_parameter_is_not_reported() -> None:
    """Its correction may remove the conflict: only the wrong parameter itself is named."""
    with pytest.raises(InputError) as caught:
        SteeringGear().replace({"bush.outer_diameter": "30 kg", "bush.inner_diameter": "40 mm"})
    assert [problem.split()[0] for problem in caught.value.problems] == ["bush.outer_diameter"]


def test_problem_of_a_setting_does_not_blame_the_file(tmp_path: Path) -> None:
    path = tmp_path / "gear.toml"
    path.write_text("[yoke]\npreload = -1\n")
    with pytest.raises(InputError) as caught:
        SteeringGear.from_toml(path, {"bush.drag": -2})
    assert caught.value.problems == [
        f"{path}: yoke.preload is -1; it must be at least 0 N.",
        "bush.drag is -2; it must be at least 0 N.",
    ]


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"[yoke\n", "is not a TOML file"),
        (b"\xff\xfe\x00", "is not a TOML file: it is not UTF-8 text"),
        (b"yoke = 3\n", "yoke is 3; it must be a table of parameters"),
    ],
)
def test_file_that_is_no_gear(content: bytes, sentence: str, tmp_path: Path) -> None:
    path = tmp_path / "gear.toml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=sentence):
        SteeringGear.from_toml(path)


def test_file_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read: there is no such file"):
        SteeringGear.from_toml(tmp_path / "missing.toml")
    with pytest.raises(InputError, match="cannot be read: it is a folder"):
        SteeringGear.from_toml(tmp_path)


@given(text=st.text(max_size=8), item=st.sampled_from(list(SteeringGear.declared())))
def test_any_text_is_a_value_or_an_input_error(text: str, item: Declared) -> None:
    """Never another exception, whatever somebody types."""
    with contextlib.suppress(InputError):
        SteeringGear().replace({item.path: text})


@given(value=st.floats(1e-6, 1e6), unit=st.sampled_from(["um", "mm", "cm", "m", "inch"]))
def test_text_with_a_unit_is_the_number_times_the_unit(value: float, unit: str) -> None:
    assert units.to_si(f"{value!r} {unit}", "m") == pytest.approx(value * units.factor(unit, "m"), rel=1e-12)
