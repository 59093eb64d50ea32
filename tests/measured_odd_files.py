"""More made-up measured files: encodings, exports and headers that were met after the reader was written.

Each kind is either read as the one curve of `measured_files`, or refused with what is missing; none was
looked at when the reader's rules were made.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from measured_files import ANGLE, INCH_POUND, TORQUE, comma

PLAIN = "pinion_angle [deg],pinion_torque [Nm]\n"
GERMAN = "Winkel [°];Drehmoment [Nm]\n"


def table(
    head: str, line: Callable[[int, float, float], str], angle: Any = ANGLE, torque: Any = TORQUE
) -> str:
    """A text with a line for each point: number, angle [deg], torque [N m]."""
    points = enumerate(zip(np.asarray(angle).tolist(), np.asarray(torque).tolist(), strict=True))
    return head + "".join(f"{line(i, angle, torque)}\n" for i, (angle, torque) in points)


def german(i: int, angle: float, torque: float) -> str:
    return f"{comma(angle)};{comma(torque)}"


def plain(i: int, angle: float, torque: float) -> str:
    return f"{angle:.2f},{torque:.6f}"


def with_mark(mark: str) -> str:
    """The plain table with three torques replaced by the mark of an instrument."""
    return table(PLAIN, lambda i, a, t: f"{a},{mark}\n{a},{t:.5f}" if i in (20, 21, 90) else plain(i, a, t))


TEXTS = {
    "angle of one turn that begins anew": table(PLAIN, lambda i, a, t: f"{a % 360:.1f},{t:.5f}"),
    "line ends in the header": table('"Winkel\n[°]";"Moment\n[Nm]"\n', german),
    "a line between names and units": table("Winkel;Moment\nroh;gefiltert\n°;Nm\n", german),
    "exponents of Fortran": table(
        "angle [deg] torque [Nm]\n", lambda i, a, t: f"{a:.3E} {t:.6E}".replace("E", "D")
    ),
    "numbers with plus": table(PLAIN, lambda i, a, t: f"{a:+.1f},{t:+.5f}"),
    "numbers kept as texts": table(PLAIN, lambda i, a, t: f'="{a:.1f}",="{t:.5f}"'),
    "lb·ft": table("angle [deg],torque [lb·ft]\n", lambda i, a, t: f"{a:.2f},{t / INCH_POUND / 12:.7f}"),
    "N-m": table("Angle (deg),Torque (N-m)\n", plain),
    "kgf.m": table("Angle (deg),Torque (kgf.m)\n", lambda i, a, t: f"{a:.2f},{t / 9.80665:.8f}"),
    "minutes of arc": table("Angle (arcmin),Torque (Nm)\n", lambda i, a, t: f"{60 * a},{t:.6f}"),
    "date and time first": table(
        "Zeitstempel;Winkel [°];Moment [Nm]\n",
        lambda i, a, t: f"2024-04-03 12:00:{0.1 * i:04.1f};{german(i, a, t)}",
    ),
    "two columns of time": table(
        "Datum;Uhrzeit;Winkel [°];Moment [Nm]\n",
        lambda i, a, t: f"03.04.2024;12:00:0{i % 10};{german(i, a, t)}",
    ),
    "temperature of the torque sensor": table(
        "angle [deg],torque [Nm],torque sensor temperature [°C]\n", lambda i, a, t: f"{plain(i, a, t)},21.5"
    ),
    "angle speed": table(
        "angle [deg],torque [Nm],angle speed [deg/s]\n", lambda i, a, t: f"{plain(i, a, t)},15.0"
    ),
    "Swiss thousands": table(
        "Winkel [°];Moment [mNm]\n", lambda i, a, t: f"{a:.1f};{1e3 * t:,.2f}".replace(",", "'")
    ),
    "decimal commas between tabs": table(
        "Winkel [°]\tMoment [Nm]\n", lambda i, a, t: f"{comma(a)}\t{comma(t)}"
    ),
    "decimal commas between blanks": table(
        "Winkel[°] Moment[Nm]\n", lambda i, a, t: f"{comma(a)} {comma(t)}"
    ),
    "-9999": with_mark("-9999"),
    "9.9E37": with_mark("9.90000E+37"),
    "statistics over the numbers": table(
        "Name;Winkel;Moment\nEinheit;°;Nm\nMin;-180;-0,63\nMax;180;0,65\nMittel;0;0,01\n",
        lambda i, a, t: f"{i};{german(i, a, t)}",
    ),
    "empty first column": table(";Winkel [°];Moment [Nm]\n", lambda i, a, t: f";{german(i, a, t)}"),
    "a table of Markdown": table(
        "| angle [deg] | torque [Nm] |\n|---|---|\n", lambda i, a, t: f"| {a:.2f} | {t:.6f} |"
    ),
    "known by its unit": table("Angle volant (°);Couple (N.m)\n", german),
    "clock of three parts": table(
        "time;angle [deg];torque [Nm]\n", lambda i, a, t: f"12:{i // 60:02d}:{i % 60:02d};{a:.2f};{t:.6f}"
    ),
}
ODD_READABLE = {kind: text.encode() for kind, text in TEXTS.items()} | {
    "UTF-32": table(GERMAN, german).encode("utf-32"),
    "UTF-16, big end first": b"\xfe\xff" + table(GERMAN, german).encode("utf-16-be"),
    "line ends of old machines": table(PLAIN, plain).replace("\n", "\r").encode(),
    "line ends twice": table(PLAIN, plain).replace("\n", "\r\r\n").encode(),
    "zeros at the end": table(PLAIN, plain).encode() + bytes(4096),
}

_JOINED = table("angle [deg];torque [Nm]\n", lambda i, a, t: f"{a};{t:.5f}")
_HALF = "".join(f"{a};{t:.5f}\n" for a, t in zip(ANGLE[:73], TORQUE[:73], strict=True))
_RISING = np.arange(-180, 181, 5)
ODD_REFUSED = {
    "both ways side by side": (
        "angle [deg];forward torque [Nm];backward torque [Nm]\n0;0.6;-0.6\n5;0.6;-0.6\n9;0.6;-0.6\n",
        "2 columns that may be pinion_torque",
    ),
    "merged cells over two blocks": (
        "Rechtslauf;;Linkslauf;\nWinkel [°];Moment [Nm];Winkel [°];Moment [Nm]\n"
        "0;1;0;-1\n5;1;-5;-1\n9;1;-9;-1\n",
        "2 columns that may be pinion_angle",
    ),
    "time for an angle": ("time [s];torque [Nm]\n0;0.6\n1;0.6\n2;0.6\n", "no column pinion_angle"),
    "scaled unit": (
        "angle [deg],torque [Nm*1e-3]\n0,600\n1,601\n2,600\n",
        "no unit of pinion_torque that is",
    ),
    "scaled unit in front": ("angle [deg],torque [x0.01 Nm]\n0,60\n1,61\n2,60\n", "no unit of pinion_torque"),
    "degrees and minutes": ("angle (deg),torque (Nm)\n1°30',0.6\n2°30',0.6\n3°30',0.6\n", "no rows of two"),
    "a date for a number": (
        table(GERMAN, lambda i, a, t: f"{comma(a)};06. Feb" if i == 40 else german(i, a, t)),
        r"line 42: '06\. Feb' is no number",
    ),
    "the same column twice": (
        "angle [deg];torque [Nm];torque [Nm]\n0;1;1\n5;1;1\n9;1;1\n",
        "2 columns that may be pinion_torque",
    ),
    "the angle in two units": ("angle [deg];angle [rad];torque [Nm]\n0;0;1\n5;.1;1\n9;.2;1\n", "2 columns"),
    "set and actual": (
        "Sollwinkel [°];Istwinkel [°];Moment [Nm]\n0;0;1\n5;5;1\n9;9;1\n",
        "2 columns that may be",
    ),
    "one direction of two": (
        "angle [deg],torque [Nm],dir\n"
        + "".join(f"{a},{t},{way}\n" for way, t in (("cw", 0.6), ("ccw", -0.6)) for a in _RISING),
        r"has several directions \(cw, ccw\), but its angle moves one way",
    ),
    "units that change": (
        f"angle [deg];torque [Nm]\n{_HALF}angle [deg];torque [Nmm]\n{_HALF}",
        r"line 75 names its columns again: angle \[deg\], torque \[Nmm\]",
    ),
    "columns that change": (
        f"angle [deg];torque [Nm]\n{_HALF}torque [Nm];angle [deg]\n{_HALF}",
        "line 75 names its columns again",
    ),
    "another table below": (
        f"{_JOINED}\ntime [s];temperature [C]\n" + "".join(f"{i};{20 + 0.01 * i:.2f}\n" for i in range(40)),
        "line 148 names its columns again",
    ),
    "decimal signs that change": (
        table("angle [deg];torque [Nm]\n", lambda i, a, t: f"{a};{t:.5f}" if i < 73 else german(i, a, t)),
        "line 75: '175,00000' is no number",
    ),
    "a web page": (
        "<table><tr><td>angle [deg]</td></tr>\n<tr><td>0</td><td>1</td></tr></table>\n",
        "no rows of",
    ),
    "JSON": ('{"angle": 0.0, "torque": 0.6}\n{"angle": 5.0, "torque": 0.6}\n', "no rows of two numbers"),
    "names before each number": ("angle=0 torque=0.6\nangle=5 torque=0.6\n", "no rows of two numbers"),
    "rows for columns": ("angle [deg],0,5,10\ntorque [Nm],0.6,0.6,0.6\n", "no line that names its columns"),
    "names at the foot": (
        "0;0.6\n5;0.6\n10;0.6\nangle [deg];torque [Nm]\n",
        "no line that names its columns",
    ),
    "units in a head of keys": (
        "Channels\t2\nY_Unit_Label\tdeg\tNm\nX0\t0.0\t0.0\nX_Value\tAngle\tTorque\tComment\n"
        + "".join(f"{i}.0\t{a:.1f}\t{t:.5f}\n" for i, (a, t) in enumerate(zip(ANGLE, TORQUE, strict=True))),
        "gives no unit of pinion_angle in column 'Angle'",
    ),
    "units exchanged": ("angle [Nm],torque [deg]\n0,1\n5,1\n9,1\n", r"\[Nm\] is no unit of pinion_angle"),
    "units in the title": (
        "Torque in N m over degrees\nangle,torque\n0,1\n5,1\n9,1\n",
        "gives no unit of pinion",
    ),
    "percent": ("angle [%];torque [Nm]\n0;1\n5;1\n9;1\n", r"\[%\] is no unit of pinion_angle"),
    "volts": ("angle [deg];torque [V]\n0;1\n5;1\n9;1\n", r"\[V\] is no unit of pinion_torque"),
    "words of another language": ("angolo [gradi];coppia [Nm]\n0;1\n5;1\n9;1\n", "no column pinion_angle"),
}
