"""Figures of a reference in steps that are halved until halves of them say the same.

confirmed(found).figure       found(parts) -> figure and ripple, each step made in parts
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import nan

REFINED = (1, 2, 4, 8)  # parts of each step, until two in a row say the same ...
SAME, SAME_RIPPLE = 0.005, 0.015  # ... of the figure, and of the ripple, both over the figure


class NotFoundError(ArithmeticError):
    """The reference found no equilibrium, is too expensive, or depends on its steps."""


class NotFiniteError(NotFoundError):
    """The reference's motion does not stay finite, as in steps that are too long for it."""


@dataclass(frozen=True)
class Confirmed:
    """Figure and ripple, the latter nan where there is none, and how much half the steps change them."""

    figure: float
    ripple: float
    figure_doubt: float
    ripple_doubt: float


def confirmed(found: Callable[[int], tuple[float, float]]) -> Confirmed:
    """Return figure and ripple, once half the steps say about the same.

    Raises:
        NotFoundError: they go on changing as steps are halved, or there are none.
    """
    figure, ripple = _tried(found, REFINED[0])
    for parts in REFINED[1:]:
        before, (figure, ripple) = (figure, ripple), _tried(found, parts)
        moved, grown = abs(figure - before[0]), abs(ripple - before[1])
        if moved <= SAME * abs(figure) and not grown > SAME_RIPPLE * abs(figure):  # nan: there is none
            return Confirmed(figure, ripple, moved, grown)
    if figure != figure:
        raise NotFiniteError("the motion does not stay finite")
    raise NotFoundError(
        f"in half the steps the reference still moves by {moved / abs(figure):.2%}, its ripple by "
        f"{grown / abs(figure):.2%} of it"
    )


def _tried(found: Callable[[int], tuple[float, float]], parts: int) -> tuple[float, float]:
    try:
        return found(parts)
    except NotFiniteError:
        return nan, nan
