"""Made-up files of the curve of `measured_files` whose motion, zero or size a rig recorded in its own way.

Read with the gear at hand: rest, repeated runs, travel or speed for an angle, a late channel, a wrong unit.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from measured_binary_files import BETWEEN, TIME, mat, mdf, tdms
from measured_files import ANGLE, INCH_POUND, KGF_CM, TORQUE
from measured_odd_files import table
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear

HEAD = "angle [deg];torque [Nm]\n"
HALF = 73  # rows of the way forth
TRAVEL = 1e3 * float(GearPair.of(SteeringGear()).gain) * np.radians(ANGLE)  # [mm]
SWEPT = 36 * np.diff(ANGLE, prepend=-185) / 5  # [deg/s]
FINE = np.concatenate([np.arange(-180.0, 181.0), np.arange(179.0, -181.0, -1.0)])  # [deg]
FINE_TORQUE = np.where(np.arange(FINE.size) < 361, 0.63, -0.61) + 0.02 * np.cos(np.radians(FINE))
FINE_TORQUE += 0.003 * np.random.default_rng(1).standard_normal(FINE.size)
AT_REST = np.repeat(
    np.arange(ANGLE.size), np.isin(np.arange(ANGLE.size), [0, HALF - 1, ANGLE.size - 1]) * 40 + 1
)
REST = np.diff(ANGLE[AT_REST], prepend=0) == 0
TURNED = np.arange(ANGLE.size) % HALF  # row of each way
MIDDLE = [*range(36, HALF), *range(HALF, ANGLE.size), *range(36)]
WIDE = np.concatenate([np.arange(-400, 401, 5), np.arange(395, -401, -5)])
WIDE_TORQUE = np.where(np.arange(WIDE.size) < 161, 0.63, -0.61) + 0.02 * np.cos(np.radians(WIDE))


def of(angle: Any = ANGLE, torque: Any = TORQUE, head: str = HEAD) -> str:
    """Angles and torques of any lengths below a header."""
    return table(head, lambda i, a, t: f"{a:.5f};{t:.5f}", angle, torque)


def late(rows: int) -> str:
    return of(torque=np.roll(TORQUE, rows))


def forth_and_back(i: int, word: str) -> str:
    other = ANGLE.size - 1 - i
    return "".join(
        f"{ANGLE[k]};{TORQUE[k]:.5f}{end}\n" for k, end in ((i, word and ";cw"), (other, word and ";ccw"))
    )


SIZE = "check the unit of its torque"
TEXTS: dict[str, tuple[str, str]] = {
    "three runs below each other": (of(np.tile(ANGLE, 3), np.tile(TORQUE, 3)), ""),
    "three runs, blank lines between": ("\n".join([of(), of()[len(HEAD) :], of()[len(HEAD) :]]), ""),
    "three runs, a header each": (3 * of(), ""),
    "a column of runs": (
        "run;" + HEAD + "".join(f"{k};{line}\n" for k in (1, 2, 3) for line in of().splitlines()[1:]),
        "",
    ),
    "rest before, between, after": (of(ANGLE[AT_REST], np.where(REST, 0.2, TORQUE[AT_REST])), ""),
    "an encoder's steps of 5 deg": (of(5 * np.round(FINE / 5), FINE_TORQUE), ""),
    "noise of the angle": (of(FINE + 0.4 * np.sin(7 * np.arange(FINE.size)), FINE_TORQUE), ""),
    "rack travel in mm": (of(TRAVEL, head="rack travel [mm];torque [Nm]\n"), ""),
    "rack travel in cm": (of(TRAVEL / 10, head="Zahnstangenweg [cm];Moment [Nm]\n").replace(".", ","), ""),
    "rack travel beside the angle": (
        table("travel [mm];" + HEAD, lambda i, a, t: f"{TRAVEL[i]:.4f};{a};{t:.5f}"),
        "",
    ),
    "time and speed": (
        table("time [s];speed [deg/s];torque [Nm]\n", lambda i, a, t: f"{i * 5 / 36:.6f};{SWEPT[i]};{t:.5f}"),
        "",
    ),
    "time and revolutions": (
        table("t [s];n [rpm];M [Nm]\n", lambda i, a, t: f"{i * 5 / 36:.6f};{SWEPT[i] / 6};{t:.5f}"),
        "",
    ),
    "milliseconds and speed": (
        table(
            "Zeit [ms];Drehzahl [1/min];Moment [Ncm]\n",
            lambda i, a, t: f"{i * 5e3 / 36:.3f};{SWEPT[i] / 6};{100 * t:.3f}",
        ),
        "",
    ),
    "an encoder that counts down": (of(-ANGLE), ""),
    "torques against the motion": (of(torque=-TORQUE), ""),
    "torques without sign": (of(torque=np.abs(TORQUE)), ""),
    "a zero of 0.1 N m": (of(torque=TORQUE + 0.1), ""),
    "begins in the middle": (of(ANGLE[MIDDLE], TORQUE[MIDDLE]), ""),
    "back first": (of(np.roll(ANGLE, -HALF), np.roll(TORQUE, -HALF)), ""),
    "an encoder of half turns": (of((WIDE + 180) % 360 - 180, WIDE_TORQUE), ""),
    "counted from far away": (of(ANGLE + 1000), ""),
    "gon": (of(ANGLE / 0.9, head="Winkel [gon];Moment [Nm]\n"), ""),
    "turns": (of(ANGLE / 360, head="Winkel [U];Moment [Nm]\n"), ""),
    "seconds of arc": (of(3600 * ANGLE, head="angle [arcsec];torque [Nm]\n"), ""),
    "N.m in brackets": (of(head="angle (deg);torque (N.m)\n"), ""),
    "kgf-cm": (of(torque=TORQUE / KGF_CM, head="angle [deg];torque [kgf-cm]\n"), ""),
    "lbf.in": (of(torque=TORQUE / INCH_POUND, head="angle [deg];torque [lbf.in]\n"), ""),
    "names in one word": (of(head="pinion_angle_deg;pinion_torque_nm\n"), ""),
    "a comment between": (of().replace("0.00000;", "# pause\n0.00000;", 1), ""),
    "overloads as numbers": (of(torque=np.where(np.isin(TURNED, [20, 50]), 9.999e9, TORQUE)), ""),
    "angles of -9999": (of(np.where(np.isin(TURNED, [20, 50]), -9999, ANGLE)), ""),
    "exponents with commas": (
        table("Winkel [°]\tMoment [Nm]\n", lambda i, a, t: f"{a:.5E}\t{t:.5E}".replace(".", ",")),
        "",
    ),
    "a torque of 10 deg late": (late(2), ""),
    "a torque of 40 deg late": (late(8), "its channel is late; shift it"),
    "an angle of 40 deg late": (late(-8), "the channel of the angle is late; shift it"),
    "N cm called N m": (of(torque=100 * TORQUE), SIZE),
    "ten times too large": (of(torque=10 * TORQUE, head="angle [deg];torque x10 [Nm]\n"), SIZE),
    "ten times too small": (of(torque=TORQUE / 10), SIZE),
    "degrees called rad": (of(head="angle [rad];torque [Nm]\n"), "check the unit of its angle"),
    "a zero of 0.9 N m": (of(torque=TORQUE + 0.9), "subtract the sensor's zero"),
    "both ways in turn": (
        HEAD + "".join(forth_and_back(i, "") for i in range(HALF - 1)),
        "write all rows of one way",
    ),
    "both ways in turn, named": (
        "angle [deg];torque [Nm];dir\n" + "".join(forth_and_back(i, "named") for i in range(HALF - 1)),
        "write all rows of one way",
    ),
    "sorted by angle": (
        of(*np.array(sorted(zip(ANGLE, TORQUE, strict=True))).T),
        "write all rows of one way",
    ),
    "random order": (
        of(*np.random.default_rng(2).permutation(np.array([ANGLE, TORQUE]).T).T),
        "in which they were recorded",
    ),
    "speed without sign": (
        table("time [s];speed [deg/s];torque [Nm]\n", lambda i, a, t: f"{i * 5 / 36:.6f};36;{t:.5f}"),
        "speeds that are negative",
    ),
    "angles of wheel and pinion": (
        table("wheel angle [deg];pinion angle [deg];torque [Nm]\n", lambda i, a, t: f"{a + 2};{a};{t:.5f}"),
        "choose one",
    ),
    "negative numbers in parentheses": (
        table(HEAD, lambda i, a, t: f"{a};{t:.5f}" if t > 0 else f"{a};({-t:.5f})"),
        "is no number",
    ),
    "minus behind the number": (
        table(HEAD, lambda i, a, t: f"{a};{t:.5f}" if t > 0 else f"{a};{-t:.5f}-"),
        "is no number",
    ),
    "kg-cm": (of(head="angle [deg];torque [kg-cm]\n"), "write for instance"),
    "hundredths in the unit": (
        of(torque=100 * TORQUE, head="angle [deg];torque [Nm/100]\n"),
        "write for instance",
    ),
}
"""Kind -> content, and what is said of it; "" of a file that is read."""

TWICE = np.interp(BETWEEN, TIME, TORQUE)
BINARY: dict[str, tuple[Callable[[Path], object], str]] = {
    "MDF, two rates": (
        lambda path: mdf(path, [("Lenkwinkel", "°", ANGLE, TIME)], [("Lenkmoment", "Nm", TWICE, BETWEEN)]),
        "",
    ),
    "MDF, integers": (
        lambda path: mdf(
            path,
            [
                ("angle", "deg", ANGLE.astype(np.int16), TIME),
                ("torque", "mNm", (1e3 * TORQUE).astype(np.int16), TIME),
            ],
        ),
        "",
    ),
    "MDF, travel": (
        lambda path: mdf(path, [("rack travel", "mm", TRAVEL, TIME), ("torque", "Nm", TORQUE, TIME)]),
        "",
    ),
    "MDF, speed": (
        lambda path: mdf(
            path, [("speed", "deg/s", SWEPT * 5 / 36 / TIME[1], TIME), ("torque", "Nm", TORQUE, TIME)]
        ),
        "",
    ),
    "MDF, a late torque": (
        lambda path: mdf(path, [("angle", "deg", ANGLE, TIME), ("torque", "Nm", np.roll(TORQUE, 8), TIME)]),
        "its channel is late; shift it",
    ),
    "MDF, degrees by a hundred": (
        lambda path: mdf(path, [("angle", "deg", 100 * ANGLE, TIME), ("torque", "Nm", TORQUE, TIME)]),
        "check the unit of its angle",
    ),
    "TDMS, a clock": (
        lambda path: tdms(
            path, ("g/time", "s", TIME, {}), ("g/Angle", "deg", ANGLE, {}), ("g/Torque", "N·m", TORQUE, {})
        ),
        "",
    ),
    "TDMS, two runs": (
        lambda path: tdms(
            path,
            *(
                (f"run{k}/{name}", unit, values, {})
                for k in (1, 2)
                for name, unit, values in (("Angle", "deg", ANGLE), ("Torque", "Nm", TORQUE))
            ),
        ),
        "choose one",
    ),
    "TDMS, N cm called N m": (
        lambda path: tdms(path, ("g/Angle", "deg", ANGLE, {}), ("g/Torque", "Nm", 100 * TORQUE, {})),
        SIZE,
    ),
    "MAT, rows and columns": (
        lambda path: mat(path, {"angle_deg": ANGLE.astype(np.float32), "torque_Nm": TORQUE[None, :]}),
        "",
    ),
    "MAT, a structure": (
        lambda path: mat(path, {"data": {"time": TIME, "angle_deg": ANGLE, "torque_mNm": 1e3 * TORQUE}}),
        "",
    ),
    "MAT, revolutions": (
        lambda path: mat(path, {"t": TIME, "speed_rpm": SWEPT * 5 / 36 / TIME[1] / 6, "torque_Nm": TORQUE}),
        "",
    ),
    "MAT, without units": (lambda path: mat(path, {"angle": ANGLE, "torque": TORQUE}), "gives no unit"),
    "MAT, missing ends": (
        lambda path: mat(path, {"angle_deg": ANGLE, "torque_Nm": np.append(TORQUE[:-3], 3 * [np.nan])}),
        "",
    ),
}
"""Kind -> what writes it, and what is said of it."""
