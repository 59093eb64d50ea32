"""Numbers for readers, with as many digits as their error deserves; files keep every digit."""

from math import floor, isfinite, log10

from rps_exudyn.base.units import pretty
from rps_exudyn.results.law_error import error_of_law
from rps_exudyn.results.quantities import LEAST_SHOWN, SUMMARY, Quantity
from rps_exudyn.results.result import Result

MEANS = ("torque_mean", "torque_mean_forward", "torque_mean_backward")
"""Metrics that have the error of the contact law."""
NEGLIGIBLE = 1e-5  # of the unit that is shown: rounding errors of the solver, where no bar shows what counts
MOST_OF_VALUE = 0.2  # by which a bar may be wide: wider ones are in grey
SMALLER = {"N*m": ("N*mm", 1e3), "J": ("mJ", 1e3), "N*s": ("mN*s", 1e3), "mm": ("um", 1e3)}
"""Display unit -> a smaller one, and how many of it are one of the other."""
LARGER = {"N/m": ("N/um", 1e-6), "N/m^2": ("N/mm/um", 1e-9)}
"""The same for large numbers."""
MOST_SHOWN = 1e5  # in a unit that has a larger one


def law_bar(result: Result, name: str) -> float | None:
    """Return the error of the contact law in a metric of a result, either way, SI; None if unknown."""
    law = error_of_law(result) if name in MEANS else None
    return law.largest * abs(result.summary[name]) if law else None


def is_vague(value: float, error: float | None) -> bool:
    """Return whether the error bar of a value is unknown, or wider than a fifth of it."""
    return error is not None and not error <= MOST_OF_VALUE * abs(value)


def rounded_metric(result: Result, name: str, like: float | None = None) -> str:
    """Return a metric of a result with its error bar."""
    return rounded(SUMMARY[name], result.summary[name], result.errors.get(name), like)


def shown_metric(result: Result, name: str) -> str:
    """Return the same among all metrics."""
    return shown_with_bar(SUMMARY[name], result.summary[name], result.errors.get(name))


def shown_with_bar(quantity: Quantity, value: float, error: float | None) -> str:
    """Return a value for a table: with its bar, or without one four digits; always in the display unit."""
    return quantity.show(value) if error is None else rounded(quantity, value, error, like=0.0)


def rounded(quantity: Quantity, value: float, error: float | None = None, like: float | None = None) -> str:
    """Return a value in its display unit with its error bar, "0.620 ± 0.001 N m": one digit of the error, and
    the value to the same place. Where the error is None or unknown, "0.62 ± ? N m", the value has two digits,
    from 100 up three.

    Args:
        quantity: of which it is a value.
        value: SI.
        error: half width of the bar, SI; nan: unknown; None: without one.
        like: another value, SI, that is shown in the same unit.
    """
    if isinstance(value, int) and error is None:
        return str(value)
    if not isfinite(value):
        return "undetermined"
    unit, size = quantity.display, float(quantity.displayed(value))
    either = 0.0 if error is None else abs(float(quantity.displayed(error)))
    is_known = isfinite(either)
    if max(abs(size), either if is_known else 0.0) < (LEAST_SHOWN.get(unit, 0.0) if either else NEGLIGIBLE):
        size, either = 0.0, either if not is_known else 0.0
    same = max(abs(size), either if is_known else 0.0)
    chosen, times = same if like is None else abs(float(quantity.displayed(like))), 1.0
    if 0 < chosen < 1e-2 and unit in SMALLER:
        unit, times = SMALLER[unit]
    if chosen > MOST_SHOWN and unit in LARGER:
        unit, times = LARGER[unit]
    size, either = size * times, either * times
    if either and is_known:
        first, _, power = f"{either:.0e}".partition("e")
        digits = -int(power)
        size = round(size, digits) + 0.0  # no negative zero
        text = f"{size:.{max(digits, 0)}f} ± {float(first + 'e' + power):.{max(digits, 0)}f}"
    else:
        digits = 3 if abs(size) >= 100 else 2
        places = max(0, digits - 1 - floor(log10(abs(size)))) if size else 0
        text = f"{float(f'{size:.{digits}g}'):.{places}f}{' ± ?' if either else ''}"
    return f"{text} {pretty(unit)}".replace("-", "−").strip()


def half_width(quantity: Quantity, error: float, like: float) -> str:
    """Return an error bar without its value, "± 0.007 N m", in the unit of a value `like` [SI]."""
    return "± " + rounded(quantity, 0.0, error, like).partition(" ± ")[2]


def rounded_range(quantity: Quantity, low: float, high: float, like: float | None = None) -> str:
    """Two values with their unit once: "0.51 to 0.72 N m"; that of `like`, or else of the larger one."""
    same = max(low, high, key=abs) if like is None else like
    return interval(rounded(quantity, low, like=same), rounded(quantity, high, like=same))


def interval(low: str, high: str) -> str:
    """Two numbers with their unit once, where it is the same: "0.5 to 0.7 N m"."""
    unit = high.lstrip("−.0123456789")
    return f"{low.removesuffix(unit)} to {high}" if low.endswith(unit) else f"{low} to {high}"
