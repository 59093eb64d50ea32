"""Conversion of quantities with units, at the edges only: "1.83 mm" <-> 0.00183.

Inside the package every number is SI. Text from a TOML file or the command line comes in through
`to_si`; numbers for a reader go out through `show`.
"""

import re
from contextlib import suppress
from functools import cache
from math import pi
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pint

# Pint evaluates arithmetic in what it is given ("9**9**9 N" for hours), so only this reaches it
_UNIT = r"(?:[^\W\d_]+|[%°])(?:(?:\^|\*\*)[+-]?\d{1,2}|[²³])?"  # mm, %, m^3, s**-1, m³
_QUANTITY = re.compile(
    r"\s*(?P<number>[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    rf"\s*(?P<unit>(?:1\s*/\s*|/\s*)?{_UNIT}(?:(?:\s*[*/.·]\s*|\s+){_UNIT}){{0,7}})\s*"
)

# SI unit -> an example, and other units with their factors, of most texts: loading pint and its registry
# takes as long as a fast model's run
_COMMON: dict[str, tuple[str, dict[str, float]]] = {
    "": ("", {"%": 0.01}),
    "m": ("1.83 mm", {"cm": 0.01, "mm": 1e-3, "um": 1e-6, "µm": 1e-6}),
    "m/s": ("", {"mm/s": 1e-3}),
    "m/s^2": ("9.81 m/s^2", {}),
    "rad": ("25 deg", {"mrad": 1e-3, "deg": pi / 180}),
    "rad/s": ("15 rpm", {"rpm": 2 * pi / 60}),
    "s": ("10 ms", {"ms": 1e-3}),
    "Hz": ("20 Hz", {"kHz": 1e3}),
    "kg": ("60 g", {"g": 1e-3}),
    "N": ("300 N", {"kN": 1e3}),
    "N*m": ("30 N*mm", {"N*mm": 1e-3}),
    "N/m": ("50 N/mm", {"N/mm": 1e3}),
    "N/m^2": ("", {"N/mm/um": 1e9}),
    "N/m^3": ("2e13 N/m^3", {}),
    "kg*m^2": ("0.04 kg*m^2", {}),
    "N*m/rad": ("120 N*m/rad", {"N*m/deg": 180 / pi}),
    "N*m*s/rad": ("0.02 N*m*s/rad", {}),
    "Pa": ("2.6 GPa", {"MPa": 1e6, "GPa": 1e9}),
    "N*s/m": ("500 N*s/m", {}),
    "m^2/N": ("1e-6 mm^3/N/m", {"mm^3/N/m": 1e-9}),
    "K": ("-30 degC", {"degC": 1.0}),
    "1/K": ("23e-6 1/K", {}),
}
ZERO_OF = {"degC": 273.15}
"""Unit -> its zero in the SI unit; of all others it is 0."""


@cache
def _registry() -> "pint.UnitRegistry":
    import pint

    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


def factor(unit: str, si_unit: str) -> float:
    """The number of `si_unit` in one `unit`, for instance 0.001 for ("mm", "m")."""
    return _common_factor(unit, si_unit) or _factor_by_pint(unit, si_unit)


def _common_factor(unit: str, si_unit: str) -> float | None:
    """The factor of a common unit, without pint; None of others."""
    return 1.0 if unit == si_unit else _COMMON.get(si_unit, ("", {}))[1].get(unit)


@cache
def _factor_by_pint(unit: str, si_unit: str) -> float:
    return float(_registry().Quantity(1.0, unit).to(si_unit).magnitude)


def to_si(value: object, si_unit: str) -> float:
    """A number, or text such as "25 deg" or "50 N/mm", in `si_unit`.

    A bare number is SI already. An empty `si_unit` means dimensionless; a percentage is understood.

    Raises:
        ValueError: the text is no quantity, or its unit does not measure `si_unit`.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(
            f"is {short(repr(value))}; a number or a quantity such as {_example(si_unit)} is expected"
        )
    try:
        return float(value)
    except ValueError:
        pass
    except OverflowError:
        raise ValueError("is too large a number") from None
    try:
        text = respelled(str(value))
    except ValueError as error:
        raise ValueError(f"is {short(repr(value))}, with {error}") from None
    with suppress(ValueError):
        return float(text)
    try:
        parts = _QUANTITY.fullmatch(text)
        if parts is None:
            raise ValueError("not a number and its unit")
        unit = re.sub(r"[.·]", "*", parts["unit"]).replace("°", "deg")
        unit_written = re.sub(r"\s*([*/])\s*|\s+", lambda found: found[1] or "*", unit)  # blanks multiply
        if common := _common_factor(unit_written, si_unit):
            number, zero = float(parts["number"]) * common, ZERO_OF.get(unit_written)
            return number if zero is None else round(number + zero, 9)
        quantity = _registry().Quantity(float(parts["number"]), f"1{unit}" if unit[0] == "/" else unit)
        if _misleading(str(quantity.units), si_unit):
            raise ValueError(f"{quantity.units} are not meant")
        return float(quantity.to(si_unit or "dimensionless").magnitude)
    except Exception as error:  # pint, tokenizer and arithmetic errors alike: the text is no such quantity
        raise ValueError(
            f"is {short(repr(value))}, which is no quantity in {si_unit or 'plain numbers'}; "
            f"write for instance {_example(si_unit)}"
        ) from error


def show(value: float, si_unit: str, display: str) -> str:
    """A value given in `si_unit` as text in the unit `display`, for instance "1.83 mm"."""
    return f"{displayed(value, si_unit, display):.6g} {display}".strip()


def displayed(values: Any, si_unit: str, display: str) -> Any:
    """Values in `si_unit`, a number or an array of any shape, in the unit `display`."""
    if display == si_unit:
        return values
    return (values - ZERO_OF.get(display, 0.0)) / factor(display, si_unit)


def difference_to_si(value: object, si_unit: str) -> float:
    """A difference of two quantities in `si_unit`: 10 degC is 10 K."""
    zero = "0 degC" if isinstance(value, str) and respelled(value).rstrip().endswith("degC") else 0.0
    return to_si(value, si_unit) - to_si(zero, si_unit)


def short(text: str, most: int = 100) -> str:
    """The text, or its beginning and end if it is longer than `most` characters."""
    return text if len(text) <= most else f"{text[: most // 2]}...{text[-10:]}"


def shown(value: object) -> str:
    """A wrong value as a message quotes it: its repr, shortened."""
    try:
        return short(repr(value))
    except ValueError:  # a number of more digits than Python writes
        return "a number too long to be shown"


def mm(length: float, digits: int = 6) -> str:
    """Return a length [m] in millimetres, for instance "1.83 mm"."""
    return f"{length * 1e3:.{digits}g} mm"


def words(name: str) -> str:
    """A quantity's name in words: "torque_mean" -> "torque mean"."""
    return name.replace("_", " ")


def pretty(unit: str) -> str:
    """The unit as printed: "N*mm" -> "N mm", "um" -> "µm"."""
    return unit.replace("*", " ").replace("um", "µm").replace("deg", "°").replace("^3", "³")


def _misleading(unit: str, si_unit: str) -> bool:
    """Return whether pint converts the unit only because it takes angles for plain numbers.

    0.1 deg is no friction coefficient, and 1 Hz would become 1 rad/s where 2 pi rad/s is meant, or the other
    way about.
    """
    return (not si_unit and unit not in ("dimensionless", "percent")) or (
        ("hertz" in unit) != (si_unit == "Hz")
    )


def _example(si_unit: str) -> str:
    example, _ = _COMMON.get(si_unit, ("", {}))
    return f'"{example}"' if example else "0.1"


# --- How engineers write quantities, brought to one spelling: "0,5 Nm" -> "0.5 N*m", "12 μm" -> "12 µm"

_LETTERS = str.maketrans({"μ": "µ", "−": "-", "\u00a0": " ", "\u202f": " ", "º": "°", "″": "''", "′": "'"})
_TORQUE = re.compile(r"(?<![^\W\d_])([kmM]?N)([cm]?m)(?![^\W\d_])")
_TURNS = re.compile(r"(?<![^\W\d_])(?:U|rev|r)\s*/\s*min(?![^\W\d_])")
_COMMA = re.compile(r"\s*[+-]?(\d+),(\d+)(?![\d.,])")


def respelled(text: str) -> str:
    """The quantity with a decimal point, and with units between which a sign stands.

    Raises:
        ValueError: a comma that may divide thousands.
    """
    text = _TURNS.sub("rpm", _TORQUE.sub(r"\1*\2", text.translate(_LETTERS))).replace("°C", "degC")
    found = _COMMA.match(text)
    if not found:
        return text
    if len(found[2]) == 3 and len(found[1]) <= 3 and found[1] != "0":
        either = f"{found[1]}.{found[2]} or {found[1]}{found[2]}"
        raise ValueError(f"a comma that may divide thousands: write {either}")
    return text.replace(",", ".", 1)
