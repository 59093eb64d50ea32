"""Metrics of a reference in steps that are halved until halves of them say the same.

confirmed(found).main_metric       found(parts) -> main metric and ripple, each step made in parts
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import nan

REFINED = (1, 2, 4, 8)  # parts of each step, until two in a row say the same ...
SAME, SAME_RIPPLE = 0.005, 0.015  # ... of the main metric, and of the ripple, both over the main metric


class NotFoundError(ArithmeticError):
    """The reference found no equilibrium, is too expensive, or depends on its steps."""


class NotFiniteError(NotFoundError):
    """The reference's motion does not stay finite, as in steps that are too long for it."""


@dataclass(frozen=True)
class Confirmed:
    """Main metric and ripple, the latter nan where there is none, and how much half the steps change them."""

    main_metric: float
    ripple: float
    main_metric_doubt: float
    ripple_doubt: float


def confirmed(found: Callable[[int], tuple[float, float]]) -> Confirmed:
    """Return main metric and ripple, once half the steps say about the same.

    Raises:
        NotFoundError: they go on changing as steps are halved, or there are none.
    """
    main_metric, ripple = _tried(found, REFINED[0])
    for parts in REFINED[1:]:
        before, (main_metric, ripple) = (main_metric, ripple), _tried(found, parts)
        moved, grown = abs(main_metric - before[0]), abs(ripple - before[1])
        if moved <= SAME * abs(main_metric) and not grown > SAME_RIPPLE * abs(
            main_metric
        ):  # nan: there is none
            return Confirmed(main_metric, ripple, moved, grown)
    if main_metric != main_metric:
        raise NotFiniteError("the motion does not stay finite")
    raise NotFoundError(
        f"in half the steps the reference still moves by {moved / abs(main_metric):.2%}, its ripple by "
        f"{grown / abs(main_metric):.2%} of it"
    )


def _tried(found: Callable[[int], tuple[float, float]], parts: int) -> tuple[float, float]:
    try:
        return found(parts)
    except NotFiniteError:
        return nan, nan
