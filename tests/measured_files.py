"""Made-up measured files of one curve, written in the ways in which benches and spreadsheets write them.

No measurement stands behind these numbers: the torque is a mean, a first harmonic and nothing else.
"""

from collections.abc import Callable, Iterator

import numpy as np

ANGLE = np.concatenate([np.arange(-180.0, 181.0, 5.0), np.arange(175.0, -181.0, -5.0)])  # [deg], to and fro
TORQUE = np.where(np.arange(ANGLE.size) < 73, 0.63, -0.61) + 0.02 * np.cos(np.radians(ANGLE))  # [N m]
NM, INCH_POUND, KGF_CM = 1.0, 0.1129848290276167, 0.0980665


def rows(
    separator: str = ",",
    number: Callable[[float], str] = "{:.5f}".format,
    unit: float = NM,
    between: dict[int, str] | None = None,
) -> str:
    """The rows of the curve, the torque in a unit [N m], with lines put before some."""
    lines = []
    for i, (angle, torque) in enumerate(zip(ANGLE, TORQUE / unit, strict=True)):
        lines += [between[i]] if between and i in between else []
        lines.append(f"{number(angle)}{separator}{number(torque)}")
    return "\n".join(lines) + "\n"


def comma(value: float) -> str:
    return f"{value:.5f}".replace(".", ",")


def grouped(value: float) -> str:
    """1.234,56"""
    return f"{value:,.2f}".translate(str.maketrans(",.", ".,"))


def apart(value: float) -> str:
    """1 234,56 with a narrow blank."""
    return f"{value:,.2f}".translate(str.maketrans(",.", "\u202f,"))


def fixed(value: float) -> str:
    return f"{value:14.6E}"


def _readable() -> Iterator[tuple[str, bytes]]:
    plain = "pinion_angle [deg], pinion_torque [N m]\n"
    german = "Winkel [°];Drehmoment [Nm]\n"
    text = {
        "comma": plain + rows(),
        "semicolon, decimal comma": german + rows(";", comma),
        "tab, units in a row of their own": "Angle\tTorque\n(deg)\t(Nm)\n" + rows("\t"),
        "blanks, fixed width": "   angle_deg    torque_Nm\n" + rows("  ", fixed),
        "blanks, two words and a unit": "Pinion angle [deg] Pinion torque [N m]\n" + rows(" "),
        "title lines": (
            "Prüfprotokoll; Lenkgetriebe 4711\nDatum;03.04.2024\nPrüfer;N. N.\nDrehzahl [1/min];2,5\n\n"
            "Drehwinkel in °;Reibmoment in Ncm\n" + rows(";", comma, 0.01)
        ),
        "N mm with thousands": "Winkel (Grad);Moment (N·mm)\n" + rows(";", grouped, 1e-3),
        "N mm, narrow blanks": "Lenkwinkel [°];Lenkmoment [Nmm]\n" + rows(";", apart, 1e-3),
        "kgf cm": "Steering angle (deg),Torque (kgf·cm)\n" + rows(unit=KGF_CM),
        "in-lb": "ANGLE/deg|TORQUE/in-lb\n" + rows("|", unit=INCH_POUND),
        "footers": german + rows(";", comma) + "\nMittelwert;0,621\nMaximum;;0,65\nEnde der Messung\n",
        "missing values": plain
        + rows(between={4: "-160.5,", 9: "-141,NaN", 12: "-131,---", 20: ",", 30: "-31,#N/A", 40: "n/a,0.6"}),
        "repeated angles, time and temperature": "time [s],angle [deg],temperature [°C],torque [mNm]\n"
        + "".join(
            f"{0.1 * i:.1f},{angle:.1f},21.5,{1e3 * torque:.2f}\n" * 2
            for i, (angle, torque) in enumerate(zip(ANGLE, TORQUE, strict=True))
        ),
        "header again at each pass": plain + rows(between={73: "\nPass 2\n" + plain.strip()}),
        "quoted, commas twice": '"Winkel, °","Drehmoment, Nm"\n'
        + "".join(f'"{comma(a)}","{comma(t)}"\n' for a, t in zip(ANGLE, TORQUE, strict=True)),
        "commented header": "# made up\n# angle [rad] torque [Nm]\n"
        + "".join(f"{np.radians(a):.7e} {t:.7e}\n" for a, t in zip(ANGLE, TORQUE, strict=True)),
        "commented units": "% angle torque\n% deg Nm\n" + rows(" "),
        "separator stated": "sep=;\n" + german + rows(";", comma),
        "units behind the numbers": "angle;torque\n"
        + "".join(f"{a:.1f} deg;{t:.5f} N m\n" for a, t in zip(ANGLE, TORQUE, strict=True)),
        "revolutions, capitals, last separator": "ROTATION [REV],TORQUE [NM],\n"
        + "".join(f"{a / 360:.9f},{t:.6f},\n" for a, t in zip(ANGLE, TORQUE, strict=True)),
        "names and units behind words": "Sensor\t1\t2\nName\tDrehwinkel\tDrehmoment\nEinheit\t°\tNm\n"
        + "".join(
            f"{0.1 * i:.1f}\t{a:.5f}\t{t:.5f}\n" for i, (a, t) in enumerate(zip(ANGLE, TORQUE, strict=True))
        ),
        "overloads, no numbers": german + rows(";", comma, between={7: "-146;#####", 9: "-141;OVLD"}),
        "by unit alone": "Kanal 1 [°];Kanal 2 [Nm];Kanal 3 [bar]\n"
        + "".join(f"{comma(a)};{comma(t)};1,0\n" for a, t in zip(ANGLE, TORQUE, strict=True)),
    }
    for kind, content in text.items():
        yield kind, content.encode()
    yield "byte order mark, old line ends", b"\xef\xbb\xbf" + (plain + rows()).replace("\n", "\r\n").encode()
    yield "UTF-16", (german + rows(";", comma)).encode("utf-16")
    yield "UTF-16 without a mark", (german + rows(";", comma)).encode("utf-16-le")
    yield "Windows-1252", (german + rows(";", comma)).encode("cp1252")


READABLE = dict(_readable())
"""Kind -> content of files that hold the curve."""

REFUSED = {
    "no header": (rows(), "no line that names its columns"),
    "no unit": ("Winkel;Moment\n" + rows(";", comma), "gives no unit of pinion_angle in column 'Winkel'"),
    "no unit of the torque": ("angle [deg],torque\n" + rows(), "gives no unit of pinion_torque"),
    "two torques": (
        "angle [deg];torque 1 [Nm];torque 2 [Nm]\n" + rows(";").replace("\n", ";1\n"),
        "2 columns that may be pinion_torque: torque 1 \\[Nm\\] and torque 2 \\[Nm\\]; choose one",
    ),
    "a mass is no force": ("angle [deg],torque [kg cm]\n" + rows(), r"\[kg cm\] is no unit of pinion_torque"),
    "grad may be a gon": ("angle [grad],torque [Nm]\n" + rows(), r"\[grad\] is no unit of pinion_angle"),
    "counts are no angle": (
        "encoder [counts],torque [Nm]\n" + rows(),
        r"no column pinion_angle with its unit, only encoder \[counts\], torque \[Nm\]",
    ),
    "commas that may be either": (
        "angle [deg];torque [N mm]\n1,000;1,500\n2,000;1,400\n3,000;1,300\n",
        "may be decimal or divide thousands: ",
    ),
    "commas for both": ("angle [deg],torque [Nm]\n" + rows(",", comma), "may separate cells or decimals"),
    "no torque": ("angle [deg];speed [rpm]\n" + rows(";"), "no column pinion_torque with its unit"),
    "no numbers": ("pinion_angle [deg], pinion_torque [N m]\n", "holds no rows of two numbers"),
}
"""Kind -> content, and what is said of it."""
