"""Measured curves and beliefs that cannot be fitted: one sentence each, before anything is simulated.

All curves here are made up.
"""

from pathlib import Path

import numpy as np
import pytest

from rps_exudyn.analysis.passes import passes
from rps_exudyn.base.errors import InputError
from rps_exudyn.cli.fit import parse_priors
from rps_exudyn.cli.run import read_measured
from rps_exudyn.inference.fitting.bench_tests import mixed_speeds, named_test, read_measurement
from rps_exudyn.inference.fitting.fit import beyond_the_teeth, check_sizes, doubts, fit
from rps_exudyn.inference.fitting.level import levels_of
from rps_exudyn.inference.fitting.production import measured_gear
from rps_exudyn.inference.fitting.series import read_series
from rps_exudyn.inference.measured.reading import read_measured_torque
from rps_exudyn.parameters.gear import SteeringGear
from shell import Command, refusal_of

HEADER = "pinion_angle [deg], pinion_torque [N m]\n"


@pytest.fixture
def short(tmp_path: Path) -> Path:
    """Twenty degrees of a made-up curve."""
    path = tmp_path / "short.csv"
    path.write_text(HEADER + "".join(f"{a},0.6\n" for a in range(21)))
    return path


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("load-test=a.csv", "must state a weight exactly if it is a load test"),
        ("bearing@3kg=a.csv", "must state a weight exactly if it is a load test"),
        ("load-test@heavy=a.csv", "the weight is 'heavy', which is no quantity in kg"),
        ("load-test@-3kg=a.csv", "the weight is -3 kg; it must be more than 0"),
    ],
)
def test_tests_that_do_not_exist_are_refused(text: str, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        named_test(text)


def test_rows_that_are_left_out_are_named_with_the_reason(tmp_path: Path) -> None:
    """A header in line 1, a way to the start, a rest at both turns, a jerk back, missing values, a footer."""
    way = [(a, 0.1) for a in range(0, -40, -1)]  # lines 2 to 41: falls by 39 deg
    forth = [(a, 0.6) for a in range(-40, 200)]  # lines 42 to 281; the motion turns about in line 42
    rest = [(199, 0.3)] * 4  # lines 282 to 285
    back = [(a, -0.6) for a in range(198, -41, -1)]  # lines 286 to 524
    rows = [f"{angle},{torque}" for angle, torque in [*way, *forth, *rest, *back]]
    rows[100], rows[103] = "60,n/a", "63,"  # lines 102 and 105
    rows[200:202] = [rows[201], rows[200]]  # line 203 jerks back
    path = tmp_path / "bench.csv"
    path.write_text(HEADER + "\n".join([*rows, "end of test", ""]))
    assert read_measurement([path]).left_out == (
        "bench: 2 rows without a value are left out: lines 102, 105",
        "bench: 1 line without numbers is left out: line 525",
        "bench: 4 rows are left out, lines 282 to 285, where the angle rests",
        "bench: 1 row is left out, line 203, where the angle stands still or jumps back",
        "bench: 41 rows are left out, lines 2 to 42, a pass shorter than 80 % of the longest its way",
    )


def test_rows_of_a_reversal_and_of_long_passes_are_named_too(tmp_path: Path) -> None:
    """Friction turns about within 3 deg of each end; more than 720 rows of a pass become medians."""
    angle = np.linspace(-10, 10, 2001)
    path = tmp_path / "bench.csv"
    path.write_text(HEADER + "".join(f"{a:.2f},0.6\n" for a in angle))
    assert read_measurement([f"reversal={path}"]).left_out == (
        "bench: 602 rows are left out, lines 2 to 302, 1702 to 2002, within 3 deg of a reversal of the "
        "motion",
        "bench: 1399 rows of a pass are reduced to 720 medians",
    )


def test_a_file_whose_name_has_a_sign_is_a_file(tmp_path: Path) -> None:
    path = tmp_path / "free=1.csv"
    path.write_text("x")
    assert named_test(str(path))[1] == path


def test_all_files_are_looked_at(tmp_path: Path) -> None:
    with pytest.raises(InputError) as refused:
        read_measurement([tmp_path / "a.csv", f"bearing={tmp_path / 'b.csv'}"])
    assert ["a.csv" in each or "b.csv" in each for each in refused.value.problems] == [True, True]


def test_curves_too_short_and_parameters_without_belief_are_refused(short: Path) -> None:
    with pytest.raises(InputError, match="covers 20 deg in a pass; a level needs a tooth pitch, 60 deg"):
        fit([short])
    long = short.with_name("long.csv")
    long.write_text(HEADER + "".join(f"{a},0.6\n" for a in range(100)))
    with pytest.raises(InputError, match=r"yoke\.clearance cannot be fitted, because it has no prior"):
        fit([long], free=("yoke.clearance",))
    with pytest.raises(InputError, match="needs at least one free parameter"):
        fit([long], free=("pinion.runout",))
    with pytest.raises(InputError, match=r"yoke\.friction is 0; a fitted parameter must start"):
        fit([long], SteeringGear().replace({"yoke.friction": 0.0}))
    with pytest.raises(InputError, match="at least one measured curve"):
        fit([])


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("yoke.preload=300 N", "is no prior; write PATH=VALUE"),
        ("yoke.nut_diameter=30 mm +- 1 mm", "yoke.nut_diameter cannot be fitted; there are yoke.preload"),
        ("yoke.preload=300 N +- 0 N", "has the standard deviation 0 N, which must be more than 0"),
        ("yoke.preload=300 N +- -5 N", "which must be more than 0"),
        ("yoke.preload=300 mm +- 5 N", "no quantity in N"),
        ("mesh.friction=1.5 +- 0.1", "mesh.friction is 1.5; it must be at least 0 and at most 1"),
    ],
)
def test_priors_that_cannot_be_are_refused(text: str, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        parse_priors([text])


def test_priors_are_read_with_units() -> None:
    priors = parse_priors(
        ["yoke.preload=300 N +- 10 %", "mesh.friction = 0.1 ± 0.02", "pinion.runout=0 um +- 15 um"]
    )
    assert priors == {
        "yoke.preload": pytest.approx((300.0, 30.0)),
        "mesh.friction": (0.1, 0.02),
        "pinion.runout": pytest.approx((0.0, 15e-6)),
    }
    assert np.isfinite(priors["yoke.preload"][0])


def timed(path: Path, speeds: tuple[float, float]) -> str:
    """A curve to and fro with a clock, at two speeds [deg/s]."""
    forth = np.arange(-90.0, 91.0, 2.0)
    angle = np.concatenate([forth, forth[-2::-1]])
    speed = np.where(np.arange(angle.size) < forth.size, *speeds)
    rows = zip(np.cumsum(2.0 / speed), angle, np.where(speed == speeds[0], 0.6, -0.6), strict=True)
    path.write_text(
        "time [s], angle [deg], torque [N m]\n" + "".join(f"{t:.4f},{a},{m}\n" for t, a, m in rows)
    )
    return str(path)


def test_mixed_speeds_are_said(tmp_path: Path) -> None:
    """Within a file, and between files; a speed column tells as the clock does."""
    even, uneven = timed(tmp_path / "even.csv", (5, 5.001)), timed(tmp_path / "uneven.csv", (5, 20))
    rotating = tmp_path / "rotating.csv"
    table = "".join(f"{a};{1 if a % 60 else 7};0,6\n" for a in range(0, 360, 3))
    rotating.write_text("Winkel;Drehzahl;Moment\n[°];[1/min];[Nm]\n" + table)
    gain = 5.6e-3
    assert mixed_speeds(read_measurement([even]), gain) == []
    (sentence,) = mixed_speeds(read_measurement([uneven]), gain)
    assert sentence.startswith("speeds are mixed, 5 deg/s to 20 deg/s in uneven (free):")
    (between,) = mixed_speeds(read_measurement([rotating, f"bearing={uneven}", even]), gain)
    assert "5 deg/s to 20 deg/s" in between
    assert mixed_speeds(read_measurement([rotating, even]), gain) == []


def test_a_file_that_is_no_series_is_refused(tmp_path: Path) -> None:
    for content, sentence in (
        ("[]", "is not a file that fit --series wrote"),
        ('{"what": "a gear"}', "is not a file that fit --series wrote"),
        ("{", "is not a file that fit --series wrote"),
    ):
        (tmp_path / "s.json").write_text(content)
        with pytest.raises(InputError, match=sentence):
            read_series(tmp_path / "s.json")
    with pytest.raises(InputError, match="cannot be read: there is no such file"):
        read_series(tmp_path / "none.json")


def test_command_refuses_in_one_sentence(command: Command, short: Path) -> None:
    Path("deep.json").write_text("[" * 20000 + "]" * 20000)
    for arguments, sentence in (
        ([], "fit needs at least one measured file"),
        ([str(short)], "a level needs a tooth pitch"),
        (["none.csv"], "none.csv cannot be read: there is no such file"),
        ([str(short), "--out", "a.json"], "a.json"),
        ([str(short), "--like", "none.json"], "none.json cannot be read"),
        ([str(short), "--like", "deep.json"], "deep.json is not a file that fit --series wrote"),
        ([str(short), "--prior", "x"], "--prior x: x cannot be fitted"),
    ):
        said = refusal_of(command(["fit", *arguments]))
        assert sentence in said
        assert said.count("\n") == 1


def turned(path: Path, forth: float, back: float, *, reach: float = 180.0, falls: bool = True) -> Path:
    """A file of two passes of constant torques, in degrees and N m."""
    angle = np.linspace(-reach, reach, 73)
    second = angle[-2::-1] if falls else angle
    rows = [f"{a},{t}\n" for way, t in ((angle, forth), (second, back)) for a in way]
    path.write_text(HEADER + "".join(rows))
    return path


@pytest.mark.parametrize(
    ("forth", "back", "falls", "sentence"),
    [
        (1.63, 0.39, True, r"means of 1.63 and 0.39 in both directions.*subtract the sensor's zero"),
        (-1.33, -0.09, True, r"means of -1.33 and -0.09 in both directions.*subtract the sensor's zero"),
        (0.6, -0.6, False, r"passes in one direction .* opposite signs, 0.6 and -0.6 in SI"),
    ],
)
def test_torques_that_are_no_friction_about_zero_are_refused(
    forth: float, back: float, falls: bool, sentence: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=sentence):
        read_measurement([turned(tmp_path / "a.csv", forth, back, falls=falls)])


def test_absolute_values_below_zero_are_read_as_against_the_motion(tmp_path: Path) -> None:
    measured = read_measurement([turned(tmp_path / "a.csv", -0.63, -0.61)])
    assert [each.direction * each.value.mean() > 0 for each in measured.passes] == [True, True]
    assert any("one sign in both directions" in sentence for sentence in measured.assumed)


def test_run_reads_absolute_torques_as_a_fit_does(tmp_path: Path) -> None:
    """The curve that a run is compared with has the signs of the passes that a fit compares."""
    path = turned(tmp_path / "a.csv", 0.63, 0.61)
    curve, measured = read_measured(path, (), "free-pinion-torque", SteeringGear()), read_measurement([path])
    for mine, theirs in zip(passes(curve.signals), measured.passes, strict=True):
        assert np.sign(mine.signals["pinion_torque"]).mean() == mine.direction
        assert mine.signals["pinion_torque"].mean() == pytest.approx(theirs.value.mean(), rel=1e-3)
    assert "torques with one sign in both directions are read as against the motion" in curve.assumed
    weighed = read_measured(path, (), "load-test", SteeringGear())
    assert (weighed.signals["pinion_torque"] > 0).all()


def test_values_in_a_wrong_unit_are_refused(tmp_path: Path) -> None:
    """N mm given as N m, N m as kN m, radians as turns: far from any gear like the expected one."""
    with pytest.raises(InputError) as refused:
        fit([turned(tmp_path / "a.csv", 630.0, -610.0), turned(tmp_path / "b.csv", 6e-4, -6e-4)])
    assert "mean torque of 630 N m" in refused.value.problems[0]
    assert "mean torque of 0.0006 N m" in refused.value.problems[1]
    assert all("check the unit of its torque" in each for each in refused.value.problems)
    with pytest.raises(InputError, match=r"covers 57.3 turns of the pinion .* check the unit of its angle"):
        fit([turned(tmp_path / "c.csv", 0.6, -0.6, reach=180 * 57.3)])


def wavy(path: Path, angle: np.ndarray, forth: np.ndarray) -> Path:
    """A free torque of 0.63 or -0.61 N m beside a wave of the turn, over angles [deg]."""
    torque = np.where(forth, 0.63, -0.61) + 0.02 * np.cos(np.radians(angle))
    path.write_text(HEADER + "".join(f"{a:.2f},{t:.5f}\n" for a, t in zip(angle, torque, strict=True)))
    return path


@pytest.mark.parametrize("ends_at", ["begin", "middle"])
def test_a_motion_that_begins_in_the_middle_has_whole_passes(ends_at: str, tmp_path: Path) -> None:
    """0 to 180, back to -180 and forth to 0 are one pass each way; a part without its other half is left."""
    forth, back = np.arange(-180.0, 181.0), np.arange(179.0, -181.0, -1.0)
    last = (forth[1:181],) if ends_at == "begin" else (forth[1:], back[:180])
    angle = np.concatenate([forth[180:], back, *last])
    path = wavy(tmp_path / "bench.csv", angle, np.append(True, np.diff(angle) > 0))
    measurement = read_measurement([path])
    assert sorted(each.direction for each in measurement.passes) == [-1, 1]
    assert all(np.ptp(each.angle) > np.radians(355) for each in measurement.passes)
    assert any("shorter than 80 %" in each for each in measurement.left_out) == (ends_at == "middle")


def test_a_reversal_over_less_than_a_pitch_counts_the_ripple_that_it_misses(tmp_path: Path) -> None:
    """Over 34 of 60 deg, a wave of 5 % moves a mean by up to 2.8 %."""
    levels = {}
    for reach in (20.0, 180.0):
        forth = np.arange(-reach, reach + 0.5)
        path = wavy(
            tmp_path / "bench.csv",
            np.concatenate([forth, forth[::-1]]),
            np.arange(2 * forth.size) < forth.size,
        )
        measurement = read_measurement([f"reversal={path}"])
        check_sizes(measurement, SteeringGear())
        (levels[reach],) = levels_of(measurement.passes, 6, 5.6e-3)
    rows = {row.name: row.half / levels[20.0].value for row in levels[20.0].budget}
    assert rows["ripple of the teeth"] == pytest.approx(1.96 * 0.05 / 2**0.5 * 0.55, rel=0.1)
    assert "ripple of the teeth" not in {row.name for row in levels[180.0].budget}
    with pytest.raises(InputError, match="a reversal needs 10 deg beyond its turns"):
        fit([f"reversal={wavy(path, np.arange(-5.0, 6.0), np.full(11, True))}"])


def test_a_gear_of_a_batch_with_a_wrong_unit_is_refused(tmp_path: Path) -> None:
    path = turned(tmp_path / "gear1.csv", 6.6, -6.6)
    with pytest.raises(InputError, match="check the unit of its torque"):
        measured_gear(path, SteeringGear())


def test_run_says_what_speaks_against_a_measured_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = turned(tmp_path / "a.csv", 6.6, -6.6)
    read_measured(path, (), "free-pinion-torque", SteeringGear())
    assert "Check the file: a has a mean torque of 6.6 N m" in capsys.readouterr().err


def test_angles_beyond_the_teeth_are_said(tmp_path: Path) -> None:
    """The default rack has teeth for 4.3 turns."""
    path = turned(tmp_path / "a.csv", 0.6, -0.6, reach=1800.0)
    words = (
        "a covers 10 turns of the pinion where the gear given has teeth for 4.31: check the unit of its "
        "angle or travel, and whether its encoder has a ratio"
    )
    curve = read_measured_torque(path)
    assert any(words in each for each in doubts(curve, SteeringGear()))
    assert doubts(read_measured_torque(turned(tmp_path / "b.csv", 0.6, -0.6)), SteeringGear()) == []


@pytest.mark.parametrize("test", ["rack-push", "rack-on-rollers", "yoke-out"])
def test_travels_beyond_the_teeth_are_said_of_every_test_with_a_rack(test: str, tmp_path: Path) -> None:
    """The default rack has teeth for 151 mm; ten times 30 mm are named, ten times 60 mm are refused."""
    path, mean = tmp_path / "a.csv", 80.0 if test.startswith("rack") else 0.14
    head = "rack travel [mm],force [N]" if mean > 1 else "rack travel [mm],torque [N m]"
    for travel, is_said in ((30.0, False), (300.0, True), (600.0, True)):
        way = np.linspace(0.0, travel, 200)
        rows = [f"{a:.4f},{sign * mean}" for sign in (1, -1) for a in way[::sign]]
        path.write_text("\n".join([head, *rows]))
        measurement = read_measurement([f"{test}={path}"])
        said = beyond_the_teeth(measurement, SteeringGear())
        assert ["where the gear given has teeth for" in each for each in said] == [True] * is_said, travel
    with pytest.raises(InputError, match=r"a covers .* has teeth for .*: check the unit of its .*travel"):
        check_sizes(measurement, SteeringGear())
