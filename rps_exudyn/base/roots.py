"""The root of a function between two places where its signs differ.

Brent's method with the tolerances, the order of operations and therefore the digits of
`scipy.optimize.brentq`, whose import takes as long as a run of a fast model.
"""

from collections.abc import Callable
from math import copysign, inf, isnan, ulp

RELATIVE_TOLERANCE = 4 * ulp(1.0)
MOST_STEPS = 100


def bracketed_root(function: Callable[[float], float], low: float, high: float, *, tolerance: float) -> float:
    """Return a root to within `tolerance` and four roundings of it.

    R. P. Brent, Algorithms for Minimization Without Derivatives, 1973, chapter 4.

    Raises:
        ValueError: the function has one sign at both ends, or is not a number somewhere.
        ArithmeticError: the root is not found in `MOST_STEPS` steps.
    """
    before, here = float(low), float(high)
    f_before, f_here = _number(function, before), _number(function, here)
    if f_before == 0:
        return before
    if f_here == 0:
        return here
    if _same_sign(f_before, f_here):
        raise ValueError(f"there may be no root between {low:g} and {high:g}: both ends have one sign")
    other = f_other = step_before = step = 0.0
    for _ in range(MOST_STEPS):
        if f_before != 0 and not _same_sign(f_before, f_here):
            other, f_other = before, f_before
            step_before = step = here - before
        if abs(f_other) < abs(f_here):
            before, here, other = here, other, here
            f_before, f_here, f_other = f_here, f_other, f_here
        least, half = (tolerance + RELATIVE_TOLERANCE * abs(here)) / 2, (other - here) / 2
        if f_here == 0 or abs(half) < least:
            return here
        interpolated = inf  # if there is no reason to trust it
        if abs(step_before) > least and abs(f_here) < abs(f_before):
            interpolated = _interpolated((before, f_before), (here, f_here), (other, f_other))
        if 2 * abs(interpolated) < min(abs(step_before), 3 * abs(half) - least):
            step_before, step = step, interpolated
        else:
            step_before = step = half
        before, f_before = here, f_here
        here += step if abs(step) > least else copysign(least, half)
        f_here = _number(function, here)
    raise ArithmeticError(f"no root was found between {low:g} and {high:g} in {MOST_STEPS} steps")


Point = tuple[float, float]


def _interpolated(before: Point, here: Point, other: Point) -> float:
    """Return the step to the root of a line through two points, or of a hyperbola through three."""
    (x_before, f_before), (x, f), (x_other, f_other) = before, here, other
    if x_before == x_other:
        return -f * (x - x_before) / (f - f_before)
    slope, slope_other = (f_before - f) / (x_before - x), (f_other - f) / (x_other - x)
    return -f * (f_other * slope_other - f_before * slope) / (slope_other * slope * (f_other - f_before))


def _number(function: Callable[[float], float], place: float) -> float:
    value = float(function(place))
    if isnan(value):
        raise ValueError(f"the function is not a number at {place:g}")
    return value


def _same_sign(first: float, second: float) -> bool:
    return copysign(1.0, first) == copysign(1.0, second)
