"""A CSV file of a measured torque: read in its units, compared, and refused in one sentence when it is none.

All curves here are made up; no measurement is part of this package.
"""

from pathlib import Path

import numpy as np
import pytest

from rps_exudyn.analysis.measured import compare_with_measured, read_measured_torque
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.closed_form import closed_form
from shell import Command

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
        ("angle [deg], pinion_torque [N m]\n0,1\n", "has no column pinion_angle with its unit"),
        ("pinion_angle, pinion_torque [N m]\n0,1\n", "has no column pinion_angle with its unit"),
        ("pinion_angle [deg], pinion_torque [N]\n0,1\n", r"line 1: \[N\] is no unit of pinion_torque"),
        (HEADER + "0,1\n1,1\n", "holds 2 points; a torque curve needs at least 3"),
        (HEADER + "0,1\n\n1,x1\n2,3\n", "line 4: 'x1' is no number"),
        (HEADER + "0,1\n1\n2,3\n", "line 3: '' is no number"),
        (HEADER + "0,1\n1,nan\n2,3\n", "line 3: 'nan' is no number"),
        (HEADER + "5,1\n5,2\n5,3\n", "holds one pinion angle only"),
    ],
)
def test_what_is_no_curve_is_refused_in_one_sentence(text: str, sentence: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=sentence) as refused:
        read_measured_torque(written(tmp_path, text))
    assert len(refused.value.problems) == 1
    assert "\n" not in refused.value.problems[0]


def test_files_that_cannot_be_read_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes(b"\xff\xfe\x00\x01")
    for path, sentence in (("a.csv", "no text in UTF-8"), ("b.csv", "No such file"), (".", "directory")):
        with pytest.raises(InputError, match=sentence):
            read_measured_torque(tmp_path / path)


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
    beyond = {"pinion_angle": outward + 10, "pinion_torque": one_way["pinion_torque"]}
    assert compare_with_measured(measured, beyond, 6) == []


def test_run_draws_and_compares(command: Command, tmp_path: Path) -> None:
    """A measured torque of 1.03 times the computed one differs from it by 3 % / 1.03."""
    measured = 1.03 * closed_form(SteeringGear()).free_torque
    text = HEADER + "".join(f"{a},{measured}\n" for a in np.linspace(-30, 400, 1000))
    done = command(["run", "--fidelity", "closed-form", "--measured", str(written(tmp_path, text))])
    assert done.status == 0
    assert "torque_mean" in done.out.split("Torque towards +X, pinion angles of 0 ° to 360 °:")[1]
    assert "difference: RMS 2.9" in done.out
    refused = command(["run", "--measured", "none.csv"])
    assert refused.status == 2
    assert refused.err.startswith("rps-exudyn: none.csv cannot be read: No such file")
