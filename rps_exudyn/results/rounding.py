"""Numbers for readers, with as many digits as their error deserves; files keep every digit."""

from math import floor, isfinite, log10

from rps_exudyn.base.units import pretty
from rps_exudyn.results.law_error import error_of_law
from rps_exudyn.results.quantities import SUMMARY, Quantity
from rps_exudyn.results.result import Result

MEANS = ("torque_mean", "torque_mean_forward", "torque_mean_backward")
"""Metrics that have the error of the contact law."""
NEGLIGIBLE = 1e-5  # of the unit that is shown: rounding errors of the solver
SMALLER = {"N*m": ("N*mm", 1e3), "J": ("mJ", 1e3), "N*s": ("mN*s", 1e3), "mm": ("um", 1e3)}
"""Display unit -> a smaller one, and how many of it are one of the other."""
LARGER = {"N/m": ("N/um", 1e-6), "N/m^2": ("N/mm/um", 1e-9)}
"""The same for large numbers."""
MOST_SHOWN = 1e5  # in a unit that has a larger one


def error_of(result: Result, name: str) -> float | None:
    """Return the error of a metric of a result either way, SI; None where none is known."""
    law = error_of_law(result) if name in MEANS else None
    return law.largest * abs(result.summary[name]) if law else None


def with_error(quantity: Quantity, value: float, error: float | None) -> str:
    """Return a value with its error bar: "0.6199 ± 0.0012 N m", with one digit more than the error's first;
    "0.62 ± ? N m" where the error is unknown, the value alone without one."""
    if error is None:
        return quantity.show(value)
    unit = pretty(quantity.display)
    size, either = (float(quantity.displayed(each)) for each in (value, error))
    if not isfinite(either):
        return f"{size:.2g} ± ? {unit}".strip()
    if not either:
        return quantity.show(value)
    digits = 1 - floor(log10(either))
    size, either, digits = round(size, digits), round(either, digits), max(digits, 0)
    return f"{size:.{digits}f} ± {either:.{digits}f} {unit}".strip()


def rounded_metric(result: Result, name: str) -> str:
    """Return a metric of a result with the digits that it deserves."""
    return rounded(SUMMARY[name], result.summary[name], error_of(result, name))


def rounded(quantity: Quantity, value: float, error: float | None = None, like: float | None = None) -> str:
    """Return a value in its display unit with as many digits as its error deserves: one of the error's own;
    without one two, from 100 up three.

    Args:
        quantity: of which it is a value.
        value: SI.
        error: either way, SI.
        like: another value, SI, that is shown in the same unit.
    """
    if isinstance(value, int):
        return str(value)
    if not isfinite(value):
        return "undetermined"
    unit, size = quantity.display, float(quantity.displayed(value))
    if abs(size) < NEGLIGIBLE:
        size = 0.0
    chosen, times = abs(size if like is None else float(quantity.displayed(like))), 1.0
    if 0 < chosen < 1e-2 and unit in SMALLER:
        unit, times = SMALLER[unit]
    if chosen > MOST_SHOWN and unit in LARGER:
        unit, times = LARGER[unit]
    size *= times
    if error:
        either = abs(float(quantity.displayed(error))) * times
        digits = -floor(log10(either))
        size, either, digits = round(size, digits), round(either, digits), max(digits, 0)
        return f"{size:.{digits}f} ± {either:.{digits}f} {pretty(unit)}".replace("-", "−").strip()
    digits = 3 if abs(size) >= 100 else 2
    places = max(0, digits - 1 - floor(log10(abs(size)))) if size else 0
    return f"{float(f'{size:.{digits}g}'):.{places}f} {pretty(unit)}".replace("-", "−").strip()


def rounded_range(quantity: Quantity, low: float, high: float, like: float | None = None) -> str:
    """Two values with their unit once: "0.51 to 0.72 N m"; that of `like`, or else of the larger one."""
    same = max(low, high, key=abs) if like is None else like
    return interval(rounded(quantity, low, like=same), rounded(quantity, high, like=same))


def interval(low: str, high: str) -> str:
    """Two numbers with their unit once, where it is the same: "0.5 to 0.7 N m"."""
    unit = high.lstrip("−.0123456789")
    return f"{low.removesuffix(unit)} to {high}" if low.endswith(unit) else f"{low} to {high}"
