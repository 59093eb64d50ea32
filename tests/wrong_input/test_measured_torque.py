"""A CSV file of a measured torque: read in its units, compared, and refused in one sentence when it is none.

All curves here are made up; no measurement is part of this package.
"""

import re
import sys
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from measured_binary_files import READABLE as BINARY
from measured_binary_files import REFUSED as BINARY_REFUSED
from measured_files import ANGLE, READABLE, REFUSED, TORQUE
from measured_odd_files import ODD_READABLE, ODD_REFUSED
from measured_rig_files import BINARY as RIG_BINARY
from measured_rig_files import TEXTS as RIG_TEXTS
from rps_exudyn.analysis.measured import compare_with_measured, onto_simulated
from rps_exudyn.analysis.passes import is_in_random_order, passes
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.inference.fitting.bench_tests import read_measurement
from rps_exudyn.inference.fitting.fit import check_sizes
from rps_exudyn.inference.measured.numbers import Format
from rps_exudyn.inference.measured.reading import read_curve, read_measured_torque
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import MeasuredTorque
from rps_exudyn.solvers.closed_form import free_torque
from shell import Command, refusal_of

HEADER = "pinion_angle [deg], pinion_torque [N m]\n"


def written(folder: Path, text: str) -> Path:
    path = folder / "bench.csv"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("text", "torque"),
    [
        (HEADER + "0,0.5\n90,0.6\n180,0.7\n", [0.5, 0.6, 0.7]),
        (
            "# made up\n\npinion_torque [N mm];temp [C];pinion_angle [°]\n500;20;0\n600;21;90\n700;;180\n",
            [0.5, 0.6, 0.7],
        ),
        (
            "pinion_angle [rad]\tpinion_torque [mN*m]\n0\t1\n1.57079632679\t2\n3.14159265359\t3\n\n",
            [1e-3, 2e-3, 3e-3],
        ),
    ],
    ids=["comma", "other order, semicolon, comments", "tab"],
)
def test_columns_are_found_by_name_and_converted(text: str, torque: list[float], tmp_path: Path) -> None:
    measured = read_measured_torque(written(tmp_path, text))
    assert measured.name == "bench"
    np.testing.assert_allclose(measured.signals["pinion_torque"], torque)
    np.testing.assert_allclose(measured.signals["pinion_angle"], [0, np.pi / 2, np.pi], atol=1e-9)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "has no column pinion_angle with its unit"),
        ("place [deg C], pinion_torque [N m]\n0,1\n1,2\n", "has no column pinion_angle with its unit"),
        ("pinion_angle, pinion_torque [N m]\n0,1\n1,2\n", "line 1 gives no unit of pinion_angle"),
        ("pinion_angle [deg], pinion_torque [N]\n0,1\n1,2\n", r"line 1: \[N\] is no unit of pinion_torque"),
        (HEADER + "0,1\n1,1\n", "holds 2 points; a torque curve needs at least 3"),
        (HEADER + "0,1\n\n1,x1\n2,3\n", "line 4: 'x1' is no number"),
        (HEADER + "0,1\n1\n2,3\n", "holds 2 points; a torque curve needs at least 3"),
        (HEADER + "0,1\n1,1.2.3\n2,3\n3,4\n", "line 3: '1.2.3' is no number"),
        (HEADER + "5,1\n5,2\n5,3\n", "holds one pinion angle only"),
    ],
)
def test_what_is_no_curve_is_refused_in_one_sentence(text: str, sentence: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=sentence) as refused:
        read_measured_torque(written(tmp_path, text))
    assert len(refused.value.problems) == 1
    assert "\n" not in refused.value.problems[0]


def test_files_that_cannot_be_read_are_refused(tmp_path: Path) -> None:
    contents = {"a.csv": b"\x00\x01\x02", "c.csv": b"PK\x03\x04...", "d.csv": b"\xff\xfe\x00"}
    contents |= {"packed.csv": b"\x1f\x8b\x08\x00\x00", "Shift JIS.csv": "N\u30fbm\n1\n".encode("shift_jis")}
    for name, content in contents.items():
        (tmp_path / name).write_bytes(content)
    for path, sentence in (
        ("a.csv", "no text in UTF-8"),
        ("b.csv", "there is no such file"),
        (".", "it is a folder"),
        ("c.csv", "a spreadsheet or an archive; save its table as CSV"),
        ("d.csv", "no text in UTF-8"),
        ("packed.csv", "no text in UTF-8, UTF-16 or Windows-1252; save it as UTF-8"),
        ("Shift JIS.csv", "no text in UTF-8, UTF-16 or Windows-1252; save it as UTF-8"),
    ):
        with pytest.raises(InputError, match=sentence):
            read_measured_torque(tmp_path / path)


@pytest.mark.parametrize("kind", READABLE | ODD_READABLE)
def test_every_kind_of_file_holds_the_same_curve(kind: str, tmp_path: Path) -> None:
    """To the digits written; where rows of the curve are repeated, they are read as often."""
    path = tmp_path / "bench.csv"
    path.write_bytes((READABLE | ODD_READABLE)[kind])
    measured = read_measured_torque(path)
    forth, back = passes(measured.signals)
    assert (forth.direction, back.direction) == (1, -1)
    for turned, mean in ((forth, 0.63), (back, -0.61)):
        expected = mean + 0.02 * np.cos(turned.angle)
        np.testing.assert_allclose(turned.signals["pinion_torque"], expected, atol=2e-5)
    assert np.unique(measured.signals["pinion_angle"].round(6)).size == np.unique(ANGLE).size
    assert any("pinion_torque from column" in sentence for sentence in measured.assumed)
    assert measured.signals["pinion_torque"].size >= TORQUE.size


@pytest.mark.parametrize("kind", REFUSED | ODD_REFUSED)
def test_files_that_leave_something_open_say_what(kind: str, tmp_path: Path) -> None:
    content, sentence = (REFUSED | ODD_REFUSED)[kind]
    with pytest.raises(InputError, match=sentence) as refused:
        read_measured_torque(written(tmp_path, content))
    assert all(WHAT_TO_DO.search(problem) for problem in refused.value.problems)


WHAT_TO_DO = re.compile(
    r"\b(write|save|choose|state|export|give|subtract|shift|check|name one|must|needs|pip install)\b"
)


@pytest.mark.parametrize("kind", [*RIG_TEXTS, *RIG_BINARY])
def test_a_rig_s_file_is_read_right_or_refused_with_what_to_do(kind: str, tmp_path: Path) -> None:
    """Read with the gear at hand: half the difference of both ways, and the angle it covers."""
    path = tmp_path / "bench.csv"
    if kind in RIG_BINARY:
        needs_libraries(kind)
        write, sentence = RIG_BINARY[kind]
        write(path)
    else:
        text, sentence = RIG_TEXTS[kind]
        path.write_text(text, encoding="utf-8")
    if sentence:
        with pytest.raises(InputError, match=sentence) as refused:
            check_sizes(read_measurement([path]), SteeringGear())
        assert all(WHAT_TO_DO.search(problem) for problem in refused.value.problems)
        return
    measurement = read_measurement([path])
    check_sizes(measurement, SteeringGear())
    forth, back = (
        np.concatenate([each.value for each in measurement.passes if each.direction == way])
        for way in (1, -1)
    )
    assert (forth.mean() - back.mean()) / 2 == pytest.approx(0.62, rel=0.005)
    widest = max(np.ptp(each.angle) for each in measurement.passes)
    assert widest == pytest.approx(np.radians(800 if "half turns" in kind else 360), rel=0.06)


@pytest.mark.parametrize(
    ("kind", "columns"),
    [
        ("no header", {"pinion_angle": "1 [deg]", "pinion_torque": "2 [N m]"}),
        ("no unit of the torque", {"pinion_torque": "torque [N m]"}),
        ("two torques", {"pinion_torque": "torque 1"}),
    ],
)
def test_a_stated_column_answers_what_was_open(kind: str, columns: dict[str, str], tmp_path: Path) -> None:
    measured = read_measured_torque(written(tmp_path, REFUSED[kind][0]), columns)
    np.testing.assert_allclose(measured.signals["pinion_torque"], TORQUE, atol=1e-5)


def test_stated_columns_that_are_not_there_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path, HEADER + "0,0.5\n90,0.6\n180,0.7\n")
    for columns, sentence in (
        ({"pinion_torque": "M9 [N m]"}, "has no columns 'M9' for pinion_torque"),
        ({"torque": "2"}, "torque is no quantity; there are pinion_angle"),
    ):
        with pytest.raises(InputError, match=sentence):
            read_measured_torque(path, columns)


def test_what_is_left_out_is_said(tmp_path: Path) -> None:
    path = tmp_path / "bench.csv"
    path.write_bytes(READABLE["missing values"])
    assert any(
        "6 rows without a value are left out: lines 6" in each for each in read_measured_torque(path).assumed
    )
    path.write_bytes(READABLE["footers"])
    assert any("3 lines without numbers are" in each for each in read_measured_torque(path).assumed)


def test_an_angle_that_begins_anew_is_counted_on_over_turns(tmp_path: Path) -> None:
    """Three turns forth and back of an encoder that knows one: two passes of three turns, and it is said."""
    angle = np.concatenate([np.arange(-540, 541, 5), np.arange(535, -541, -5)])
    rows = "".join(f"{a % 360},{0.6 if i < 217 else -0.6}\n" for i, a in enumerate(angle))
    measured = read_measured_torque(written(tmp_path, HEADER + rows))
    assert [round(np.degrees(np.ptp(each.angle))) for each in passes(measured.signals)] == [1080, 1075]
    assert any("restarts 6 times" in sentence for sentence in measured.assumed)


def test_passes_in_one_direction_that_follow_each_other_are_told_apart(tmp_path: Path) -> None:
    """Two turns of 0 to 360 degrees, without the way back between them."""
    text = HEADER + "".join(f"{a},0.5\n" for a in [*range(0, 361, 5)] * 2)
    turned = passes(read_measured_torque(written(tmp_path, text)).signals)
    assert [each.direction for each in turned] == [1, 1]
    assert [each.angle.size for each in turned] == [73, 73]


def test_a_rack_push_is_read_by_the_same_reader(tmp_path: Path) -> None:
    path = written(tmp_path, "Zahnstangenweg [mm];Kraft [daN]\n-10,5;15,1\n0,0;15,2\n10,5;15,3\n")
    push = read_curve(path, ("rack_displacement", "rack_force"))
    np.testing.assert_allclose(push.signals["rack_force"], [151, 152, 153])
    np.testing.assert_allclose(push.signals["rack_displacement"], [-0.0105, 0, 0.0105])


def test_directions_are_compared_apart(tmp_path: Path) -> None:
    """The made-up curve has the simulated one's tooth order, and more mean and first order."""
    outward = np.linspace(-4, 4, 801)
    angle = np.concatenate([outward, outward[-2::-1]])
    rising = np.arange(angle.size) < outward.size
    simulated = np.where(rising, 0.6, -0.5) + 0.01 * np.cos(6 * angle)
    rows = zip(np.degrees(angle), simulated + 0.03 + 0.02 * np.cos(angle), strict=True)
    text = HEADER + "".join(f"{a},{t}\n" for a, t in rows)
    measured = read_measured_torque(written(tmp_path, text))
    forward, backward = compare_with_measured(
        measured, {"pinion_angle": angle, "pinion_torque": simulated}, teeth=6
    )
    assert (forward.direction, backward.direction) == (1, -1)
    difference = 0.03 + 0.02 * np.cos(outward)
    rms = np.sqrt(np.trapezoid(difference**2, outward) / 8)
    assert forward.torque.rms == pytest.approx(rms, rel=1e-4)
    assert backward.torque.rms == pytest.approx(rms, rel=5e-3)
    assert forward.measured["torque_tooth_order"] == pytest.approx(0.01, rel=0.05)
    assert forward.simulated["torque_first_order"] == pytest.approx(0, abs=1e-4)
    assert forward.measured["torque_first_order"] == pytest.approx(0.02, rel=1e-3)
    one_way = {"pinion_angle": outward, "pinion_torque": simulated[: outward.size]}
    assert [each.direction for each in compare_with_measured(measured, one_way, 6)] == [1]
    beyond = {"pinion_angle": 8 + outward / 4, "pinion_torque": one_way["pinion_torque"]}
    assert compare_with_measured(measured, beyond, 6) == []


@pytest.mark.parametrize("first", [-180.0, 180.0, 900.0, -30.0])
def test_angles_are_compared_by_whole_turns(first: float) -> None:
    """A turn from any angle on is compared with the simulated turn from 0 on: the torque repeats."""
    angle = np.radians(np.linspace(first, first + 360, 361))
    simulated = np.linspace(0, 2 * np.pi, 721)

    def torque(at: np.ndarray) -> np.ndarray:
        return 0.6 + 0.02 * np.cos(at - 1) + 0.01 * np.cos(6 * at)

    measured = MeasuredTorque("bench", {"pinion_angle": angle, "pinion_torque": 1.1 * torque(angle)})
    signals = {"pinion_angle": simulated, "pinion_torque": torque(simulated)}
    (compared,) = compare_with_measured(measured, signals, teeth=6)
    assert compared.angle_range == pytest.approx((angle[0], angle[-1]))
    assert compared.measured["torque_mean"] == pytest.approx(0.66, rel=1e-4)
    assert compared.simulated["torque_mean"] == pytest.approx(0.60, rel=1e-4)
    assert compared.torque.largest == pytest.approx(-0.1 * torque(angle).max(), rel=1e-3)
    drawn = onto_simulated(measured, signals)
    together = np.concatenate([each.angle for each in drawn])
    assert together.min() >= -1e-6
    assert together.max() <= 2 * np.pi + 1e-6
    for each in drawn:
        np.testing.assert_allclose(each.signals["pinion_torque"], 1.1 * torque(each.angle), rtol=1e-9)


def test_less_than_a_turn_is_compared_at_its_own_angles_alone() -> None:
    angle = np.radians(np.linspace(-180, 180, 361))
    measured = MeasuredTorque("bench", {"pinion_angle": angle, "pinion_torque": np.ones(361)})
    short = {"pinion_angle": np.radians(np.linspace(90, 270, 181)), "pinion_torque": np.ones(181)}
    (compared,) = compare_with_measured(measured, short, teeth=6)
    assert np.degrees(compared.angle_range) == pytest.approx([90, 180])
    (drawn,) = onto_simulated(measured, short)
    np.testing.assert_array_equal(drawn.angle, angle)


def test_run_draws_and_compares(command: Command, tmp_path: Path) -> None:
    """A measured torque of 1.03 times the computed one differs from it by 3 % / 1.03."""
    measured = 1.03 * free_torque(SteeringGear())
    text = HEADER + "".join(f"{a},{measured}\n" for a in np.linspace(-30, 400, 1000))
    done = command(["run", "--all", "--fidelity", "closed-form", "--measured", str(written(tmp_path, text))])
    assert done.status == 0
    assert "torque_mean" in done.out.split("Torque towards +X, pinion angles of -30 ° to 400 ° (")[1]
    assert "the simulated 0 ° to 360 ° stand for every turn" in done.out
    assert "difference: RMS 2.9" in done.out
    said = refusal_of(command(["run", "--measured", "none.csv"]))
    assert said.startswith("rps-exudyn: none.csv cannot be read: there is no such file")


@given(
    st.lists(st.text("0159", min_size=4, max_size=4), min_size=2, max_size=5),
    st.sampled_from(
        ["a", "-a", "+a.b", "ab,", ",ab", "a.bcd", "a,bcd", "a'bcd", "a b", "aE+b", "aD-b", "a.b.c"]
    ),
    st.sampled_from(["", " Nm", "Nm", " m^b", "/b", '"']),
    st.sampled_from([Format(".", False), Format(",", False), Format(".", True), Format(",", True)]),
)
def test_cells_of_a_column_are_read_as_each_alone(
    digits: list[str], number: str, tail: str, form: Format
) -> None:
    """A column is read as one text with a line for each cell."""
    cells = [
        "".join(each["abcd".index(sign)] if sign in "abcd" else sign for sign in number + tail)
        for each in digits
    ]
    for allowed in (None, ("", "Nm")):
        alone = [form.column([cell], allowed)[0] for cell in cells]
        np.testing.assert_array_equal(form.column(cells, allowed), alone)


def test_numbers_with_a_blank_between_digits_are_none() -> None:
    """Thousands aside: "0 6" is no 6."""
    read = Format(".", False).column(["0 6", "1 234.5", "12 34", "5 Nm", "- 5"])
    np.testing.assert_array_equal(read, [np.nan, 1234.5, np.nan, 5.0, -5.0])


def test_angles_in_random_order_are_refused(tmp_path: Path) -> None:
    """A turn, a turn forth and back, and three turns of an encoder of one turn; recorded so, all are read."""
    rng, path = np.random.default_rng(3), tmp_path / "m.csv"
    turn = np.linspace(0, 360, 721)
    for angle in (turn, np.concatenate([turn, turn[::-1]]), np.linspace(0, 1080, 2000) % 360):
        rows = np.column_stack([angle, 0.6 + 0.02 * np.cos(np.radians(6 * angle))])
        for shuffled in (False, True):
            order = rng.permutation(len(rows)) if shuffled else slice(None)
            np.savetxt(path, rows[order], header="angle [deg],torque [N m]", delimiter=",", comments="")
            if shuffled:
                with pytest.raises(InputError, match=r"m.csv holds its pinion angles in random order"):
                    read_measured_torque(path)
            else:
                assert read_measured_torque(path).signals["pinion_angle"].size == angle.size


@pytest.mark.parametrize("angle", [[0, 90, 180, 90, 0], [0, 1, 2, 3, 2, 1] * 4, [0, 1, 2, 1] * 10, [0, 1, 2]])
def test_few_rows_of_a_motion_are_no_random_order(angle: list[float]) -> None:
    assert not is_in_random_order(np.array(angle, dtype=float))


@pytest.mark.parametrize("kind", BINARY)
def test_every_binary_file_holds_the_same_curve(kind: str, tmp_path: Path) -> None:
    """Units come from the file; of two rates the driven channel's instants count."""
    needs_libraries(kind)
    path = tmp_path / "bench.bin"
    BINARY[kind](path)
    measured = read_measured_torque(path)
    np.testing.assert_allclose(measured.signals["pinion_angle"], np.radians(ANGLE), atol=1e-9)
    np.testing.assert_allclose(measured.signals["pinion_torque"], TORQUE, atol=1e-6)


@pytest.mark.parametrize("kind", BINARY_REFUSED)
def test_binary_files_that_leave_something_open_say_what(kind: str, tmp_path: Path) -> None:
    needs_libraries(kind)
    path = tmp_path / "bench.bin"
    write, sentence = BINARY_REFUSED[kind]
    write(path)
    with pytest.raises(InputError, match=sentence) as refused:
        read_measured_torque(path)
    assert len(refused.value.problems) == 1
    assert WHAT_TO_DO.search(refused.value.problems[0])


@pytest.mark.parametrize("kind", ["MDF", "TDMS", "MAT, compressed, columns", "MAT, a structure with units"])
def test_damaged_binary_files_are_refused_or_hold_the_curve(kind: str, tmp_path: Path) -> None:
    """Cut anywhere, or with random bytes in it: one sentence, or a curve; no other error."""
    needs_libraries(kind)
    path, random = tmp_path / "bench.bin", np.random.default_rng(5)
    BINARY[kind](path)
    whole = path.read_bytes()
    for trial in range(20):
        if trial % 2:
            content = whole[: int(random.integers(10, len(whole)))]
        else:
            changed = bytearray(whole)
            for place in random.integers(8, len(whole), size=1 + trial):
                changed[place] = int(random.integers(256))
            content = bytes(changed)
        path.write_bytes(content)
        with suppress(InputError):
            read_measured_torque(path)


def test_blocks_that_follow_themselves_are_refused(tmp_path: Path) -> None:
    """The process of a reader that follows them for ever is ended."""
    needs_libraries("MDF")
    path = tmp_path / "bench.mf4"
    BINARY["MDF"](path)
    content = bytearray(path.read_bytes())
    place = content.find(b"##CN")
    content[place + 24 : place + 32] = place.to_bytes(8, "little")
    path.write_bytes(content)
    with pytest.raises(InputError, match="is a damaged file of MDF 4, or takes more than 30 s"):
        read_measured_torque(path)


def test_a_library_that_is_missing_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "asammdf", None)
    path = tmp_path / "bench.mf4"
    path.write_bytes(b"MDF     4.10    " + bytes(200))
    with pytest.raises(InputError, match=r"needs asammdf: pip install 'rps-exudyn\[bench\]'"):
        read_measured_torque(path)


def needs_libraries(kind: str) -> None:
    """Skip where the extra [bench] is not installed."""
    pytest.importorskip({"MDF": "asammdf", "TDM": "nptdms"}.get(kind[:3], "scipy"))


# --- The rack's travel, or time and speed, instead of an angle

GAIN = float(GearPair.of(SteeringGear()).gain)


def test_the_racks_travel_gives_the_angle_of_the_gear(tmp_path: Path) -> None:
    rows = "".join(f"{1e3 * GAIN * np.radians(a):.6f};{t:.5f}\n" for a, t in zip(ANGLE, TORQUE, strict=True))
    path = written(tmp_path, "Zahnstangenweg [mm];Moment [Nm]\n" + rows)
    measured = read_measured_torque(path, gear=SteeringGear())
    np.testing.assert_allclose(measured.signals["pinion_angle"], np.radians(ANGLE), atol=1e-5)
    assert any("35.0" in each and "mm per turn of the gear given" in each for each in measured.assumed)
    with pytest.raises(InputError, match="holds the rack's travel and no pinion angle: give the gear"):
        read_measured_torque(path)
    other = written(tmp_path, "yoke displacement [mm];torque [Nm]\n" + rows)
    with pytest.raises(InputError, match="no column pinion_angle"):
        read_measured_torque(other, gear=SteeringGear())


@pytest.mark.parametrize(("unit", "size"), [("deg/s", 1.0), ("rpm", 6.0), ("mm/s", np.degrees(1e-3 / GAIN))])
def test_times_and_speeds_give_the_angle(unit: str, size: float, tmp_path: Path) -> None:
    """Forth and back at 5 degrees a row of half a second."""
    speed = np.gradient(ANGLE, 0.5)
    rows = "".join(
        f"{0.5 * i},{v / size:.8f},{t:.5f}\n" for i, (v, t) in enumerate(zip(speed, TORQUE, strict=True))
    )
    path = written(tmp_path, f"time [s],speed [{unit}],torque [N m]\n" + rows)
    measured = read_measured_torque(path, gear=SteeringGear())
    np.testing.assert_allclose(
        measured.signals["pinion_angle"], np.radians(ANGLE + 180), atol=np.radians(2.6)
    )
    assert [each.direction for each in passes(measured.signals)] == [1, -1]
    text = "".join(
        f"{0.5 * i},{abs(v) / size:.8f},{t:.5f}\n" for i, (v, t) in enumerate(zip(speed, TORQUE, strict=True))
    )
    unsigned = written(tmp_path, f"time [s],speed [{unit}],torque [N m]\n" + text)
    with pytest.raises(InputError, match="its speed has one sign although the motion turns back"):
        read_measured_torque(unsigned, gear=SteeringGear())


@pytest.mark.parametrize("signed", [True, False])
def test_speed_and_torque_of_one_sign_are_named(signed: bool, tmp_path: Path) -> None:
    """Without a stop between both ways nothing shows that the motion turned back."""
    speed = np.where(np.arange(ANGLE.size) < ANGLE.size // 2, 10.0, -10.0)
    rows = np.column_stack([0.5 * np.arange(ANGLE.size), speed, TORQUE])
    text = "\n".join(",".join(f"{each:.5f}" for each in (row if signed else np.abs(row))) for row in rows)
    path = written(tmp_path, f"time [s],speed [deg/s],torque [N m]\n{text}\n")
    measured = read_measured_torque(path, gear=SteeringGear())
    assert any("which is wrong if the motion turned back" in each for each in measured.assumed) != signed


def calls_of_reading(path: Path) -> int:
    calls = 0

    def count(frame: object, event: str, argument: object) -> None:
        nonlocal calls
        calls += event == "call"

    sys.setprofile(count)
    try:
        read_measured_torque(path)
    finally:
        sys.setprofile(None)
    return calls


@pytest.mark.parametrize("sign", [".", ","])
def test_rows_are_read_as_columns(sign: str, tmp_path: Path) -> None:
    """Thirty times the rows take the same calls of Python."""
    calls = []
    for rows in (1_000, 30_000):
        angle = np.concatenate([np.linspace(0, 720, rows // 2), np.linspace(720, 0, rows // 2)])
        lines = [f"{0.001 * i:.3f};{a:.4f};{0.63:.5f};21.5" for i, a in enumerate(angle)]
        text = "\n".join(lines).replace(".", sign)
        path = written(tmp_path, f"time [s];angle [deg];torque [N m];oil [C]\n{text}\n")
        read_measured_torque(path)
        calls.append(calls_of_reading(path))
    assert calls[1] < 1.5 * calls[0]


# --- The motion in a record


def record(*parts: tuple[np.ndarray, float]) -> tuple[np.ndarray, np.ndarray]:
    """Angles [deg] and torques [N m] of parts, each of one torque beside a wave of the angle."""
    angle = np.concatenate([part for part, _ in parts])
    torque = np.concatenate([level + 0.02 * np.cos(np.radians(part)) * (level != 0) for part, level in parts])
    return angle, torque


def curve_file(folder: Path, angle: np.ndarray, torque: np.ndarray) -> Path:
    rows = "".join(f"{a:.4f},{t:.6f}\n" for a, t in zip(angle, torque, strict=True))
    return written(folder, HEADER + rows)


FORTH = np.arange(-180.0, 180.5, 1.0)


def test_rows_at_rest_are_left_out_though_the_angle_trembles(tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    angle, torque = record(
        (np.full(60, -180.0), 0.0), (FORTH, 0.63), (np.full(90, 180.0), 0.3), (FORTH[::-1], -0.61)
    )
    for tremble in (0.0, 0.02):
        measured = read_measured_torque(
            curve_file(tmp_path, angle + tremble * random.standard_normal(angle.size), torque)
        )
        forth, back = passes(measured.signals)
        assert np.abs(forth.signals["pinion_torque"] - 0.63).max() < 0.021
        assert np.abs(back.signals["pinion_torque"] + 0.61).max() < 0.021
        assert min(forth.angle.size, back.angle.size) > 355
        assert any("where the angle rests" in sentence for sentence in measured.left_out)


@pytest.mark.parametrize("sizes", [(0.63, -0.61), (0.63, 0.61), (4.5, 3.2)])
def test_directions_that_alternate_are_refused(sizes: tuple[float, float], tmp_path: Path) -> None:
    torque = np.tile(sizes, FORTH.size) + 0.003 * np.random.default_rng(2).standard_normal(2 * FORTH.size)
    path = curve_file(tmp_path, np.repeat(FORTH, 2), torque)
    with pytest.raises(InputError, match="both directions of the motion in rows that alternate; write all"):
        read_measured_torque(path)


def test_rows_of_one_angle_are_spread_over_the_encoders_step(tmp_path: Path) -> None:
    fine = np.arange(0.0, 360.0, 0.2)
    angle = np.concatenate([np.floor(fine), np.floor(fine[::-1])])
    random = np.random.default_rng(3)
    torque = np.where(np.arange(angle.size) < fine.size, 0.6, -0.6) + 0.01 * random.standard_normal(
        angle.size
    )
    measured = read_measured_torque(curve_file(tmp_path, angle, torque))
    assert sum(each.angle.size for each in passes(measured.signals)) > 0.98 * angle.size
    assert any("5 rows of one pinion angle are spread evenly" in sentence for sentence in measured.assumed)


def test_commas_beside_the_curve_show_that_they_are_decimal(tmp_path: Path) -> None:
    rows = "".join(f"{i};{60 + i},{111 + i};20,55\n" for i in range(40))
    path = written(tmp_path, f"Winkel [°];Moment [Ncm];Temperatur [°C]\n{rows}")
    measured = read_measured_torque(path)
    assert measured.signals["pinion_torque"][0] == pytest.approx(0.60111)
