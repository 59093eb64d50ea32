"""Units as test benches write them: N cm, kgf cm, in-lb, Grad; beside those of `base.units`."""

import re
from functools import lru_cache
from math import pi

from rps_exudyn.base import units

_POUND, _INCH, _KGF = 4.4482216152605, 0.0254, 9.80665  # [N], [m], [N]

_FORCES = {"N": 1.0, "kN": 1e3, "daN": 10.0, "kgf": _KGF, "kp": _KGF, "lbf": _POUND}
_LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "in": _INCH, "inch": _INCH, '"': _INCH}
_ANGLES = {
    **dict.fromkeys(("deg", "°", "˚", "degree", "degrees"), pi / 180),
    **dict.fromkeys(("rev", "revs", "revolution", "revolutions", "turn", "turns"), 2 * pi),
    **dict.fromkeys(("U", "Umdr", "Umdrehung", "Umdrehungen"), 2 * pi),
    "rad": 1.0,
    "mrad": 1e-3,
    "gon": pi / 200,
}
_TORQUES = {
    **{f"{force}{arm}": a * _LENGTHS[arm] for force, a in _FORCES.items() for arm in ("m", "cm", "mm")},
    **dict.fromkeys(("mNm", "Nmm"), 1e-3),
    "cNm": 1e-2,
    **dict.fromkeys(("inlb", "inlbs", "inlbf", "lbin", "lbsin", "lbfin"), _POUND * _INCH),
    **dict.fromkeys(("ftlb", "ftlbs", "ftlbf", "lbft", "lbsft", "lbfft"), _POUND * 12 * _INCH),
    **dict.fromkeys(("ozin", "ozfin", "inoz", "inozf"), _POUND / 16 * _INCH),
}
KNOWN = {"rad": _ANGLES, "N*m": _TORQUES, "m": _LENGTHS, "N": _FORCES}
"""SI unit -> unit, without blanks and signs between its parts -> its size in SI."""

_TURNED = re.compile(r"rad|deg|°|turn|rev|arc|gon|cycle", re.I)
_IN_NO_UNIT = re.compile(r"[;:,|=]|(?<![0-9^*])(?<![\^*][+-])[0-9]")  # digits are those of exponents alone
GERMAN_DEGREE = "grad"  # in English a gon


@lru_cache(maxsize=1024)
def unit_size(unit: str, si_unit: str, german: bool = False) -> float | None:
    """Return the size of a unit in `si_unit`; None if it is none, or none that is certain.

    `german` is true where the column has a German name: Grad is a degree there.
    """
    if _IN_NO_UNIT.search(unit):
        return None
    known, plain = KNOWN.get(si_unit, {}), re.sub(r"[\s.·*×⋅-]|\bof\b", "", unit.replace("º", "°"))
    if plain in known:
        return known[plain]
    if any(plain in others for others in KNOWN.values()):
        return None  # of another quantity, without loading a converter of units for that answer
    if plain.lower() == GERMAN_DEGREE:
        return pi / 180 if german and si_unit == "rad" else None
    alike = {size for name, size in known.items() if name.lower() == plain.lower()}
    if len(alike) == 1 and not plain.startswith("M"):  # NM of a printer in capitals; MNm would be a million
        return alike.pop()
    if si_unit == "rad" and not _TURNED.search(unit):
        return None  # counts, pulses, shares: pure numbers are radians to a converter of units
    if plain[:2].lower() == "kg" or not unit.strip() or unit.strip()[0].isdigit():
        return None  # kg cm: a mass is no force
    try:
        return units.to_si(f"1 {unit.strip()}", si_unit)
    except ValueError:
        return None


BESIDE = {
    "clock": {"s": 1.0, "sec": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0},
    "speed": {
        **dict.fromkeys(("°/s", "deg/s", "deg/sec", "grad/s"), pi / 180),
        **dict.fromkeys(("rpm", "1/min", "u/min", "rev/min", "min-1", "min^-1"), 2 * pi / 60),
        **dict.fromkeys(("1/s", "u/s", "rev/s"), 2 * pi),
        "rad/s": 1.0,
    },
    "rack_speed": {"m/s": 1.0, "mm/s": 1e-3, "mm/min": 1e-3 / 60},
}
"""What a bench records beside the curve -> unit in small letters -> its size in SI."""

_OTHERS = {"%", "1", "-", "#", "v", "mv", "a", "c", "°c", "k", "bar", GERMAN_DEGREE}
_OTHERS.update(*BESIDE.values())


def is_unit_beside(text: str) -> bool:
    """Return whether a text is a unit of what stands beside the curve: a temperature, a speed, a rate."""
    return text.lower() in _OTHERS or bool(re.search(r"/\s*(s|sec|min)$", text))


def is_unit(text: str) -> bool:
    """Return whether a text is a unit of anything that a bench records, in brackets or not."""
    inner = text.strip().strip("[](){}<> ")
    return inner.lower() in _OTHERS or any(unit_size(inner, si_unit) is not None for si_unit in KNOWN)
