"""A range for every declared parameter, from which random gears and models are drawn.

    range_of(declared)         the stated range, or one that follows from default and limits

Ranges are those of a gear of the default's size. A drawn gear is that gear scaled: lengths by s, everything
else by the power of s that keeps stresses, strains and velocities (`POWERS`), so that a module of 0.3 mm gets
a preload, a stiffness and a bar of its own size.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, get_args

import numpy as np
from annotated_types import Ge, Gt, Le, Lt

from rps_exudyn.parameters.declaration import Declared

WIDTH = 2.0  # of a range that is not stated: from the default over this to the default times this

POWERS = {
    "": 0,
    "rad": 0,
    "m": 1,
    "N": 2,
    "N/m": 1,
    "N*m": 3,
    "kg": 3,
    "kg/m^3": 0,
    "Pa": 0,
    "N/m^3": -1,
    "N/m^2": 0,
    "s": 1,
    "rad/s": -1,
    "m/s": 0,
    "Hz": -1,
    "kg*m^2": 5,
    "N*m/rad": 3,
    "N*m*s/rad": 4,
    "K": 0,
    "1/K": 0,
    "N*s/m": 2,
    "m^2/N": 0,
    "m/s^2": 0,  # gravity is the Earth's, whatever the gear's size
}
"""SI unit -> power of the scale s with which its quantities grow in similar gears of the same materials."""

POWERS_OF = {"test.load_mass": 2}  # a weight is a load, and grows like the forces
"""Path -> the power of a parameter whose unit does not tell it."""

Drawn = Mapping[str, Any]
"""What was drawn before: path -> value, in the size of the default gear."""


class Range(Protocol):
    """Something that a value is drawn from."""

    def draw(self, rng: np.random.Generator, drawn: Drawn) -> Any:
        """Return a value."""


@dataclass(frozen=True)
class Even:
    """Uniform between two numbers."""

    low: float
    high: float

    def draw(self, rng: np.random.Generator, drawn: Drawn) -> float:
        """Return a number."""
        return float(rng.uniform(self.low, self.high))


@dataclass(frozen=True)
class Logarithmic:
    """Uniform in the logarithm between two numbers."""

    low: float
    high: float

    def draw(self, rng: np.random.Generator, drawn: Drawn) -> float:
        """Return a number."""
        return float(np.exp(rng.uniform(np.log(self.low), np.log(self.high))))


@dataclass(frozen=True)
class Whole:
    """Whole numbers from the first to the last, small ones more often."""

    low: int
    high: int

    def draw(self, rng: np.random.Generator, drawn: Drawn) -> int:
        """Return a whole number."""
        return int(np.exp(rng.uniform(np.log(self.low), np.log(self.high + 1))))


@dataclass(frozen=True)
class Choice:
    """One of some values, by their weights."""

    weights: Mapping[Any, float]

    def draw(self, rng: np.random.Generator, drawn: Drawn) -> Any:
        """Return one of them."""
        weights = np.array(list(self.weights.values()), dtype=float)
        return list(self.weights)[int(rng.choice(len(weights), p=weights / weights.sum()))]


@dataclass(frozen=True)
class Seldom:
    """A value in a share of the gears; 0 in the others."""

    share: float
    of: Range

    def draw(self, rng: np.random.Generator, drawn: Drawn) -> Any:
        """Return a value or 0."""
        value = self.of.draw(rng, drawn)
        return value if rng.random() < self.share else 0.0


@dataclass(frozen=True)
class Where:
    """A value where other parameters allow it, else one that they always allow."""

    holds: Callable[[Drawn], bool]
    of: Range
    otherwise: Any

    def draw(self, rng: np.random.Generator, drawn: Drawn) -> Any:
        """Return a value."""
        return self.of.draw(rng, drawn) if self.holds(drawn) else self.otherwise


@dataclass(frozen=True)
class Share:
    """A share of what other parameters leave."""

    of: Range
    limit: Callable[[Drawn], float]

    def draw(self, rng: np.random.Generator, drawn: Drawn) -> float:
        """Return a number."""
        return float(self.limit(drawn) * self.of.draw(rng, drawn))


def range_of(item: Declared, stated: Mapping[str, Range]) -> Range:
    """Return the stated range of a declared parameter, or one that follows from its declaration.

    Choices are as likely as each other; a positive default stands in the middle of a range as wide as
    `WIDTH` either way, cut at the parameter's limits.

    Raises:
        LookupError: none is stated, and none follows.
    """
    if item.path in stated:
        return stated[item.path]
    if choices := get_args(item.field.annotation):
        return Choice(dict.fromkeys(choices, 1.0))
    usual = item.default
    if not (isinstance(usual, int | float) and usual > 0) or (item.unit and item.unit.si not in POWERS):
        raise LookupError(
            f"{item.path} has no range: nothing follows from its default {usual!r}; state one in "
            "verification/stated_ranges.py"
        )
    low = max([usual / WIDTH, *_limits(item, Ge, "ge"), *_limits(item, Gt, "gt")])
    high = min([usual * WIDTH, *_limits(item, Le, "le"), *_limits(item, Lt, "lt")])
    return Whole(int(low), int(high)) if isinstance(usual, int) else Logarithmic(low, high)


def _limits(item: Declared, kind: type, attribute: str) -> list[float]:
    return [getattr(limit, attribute) for limit in item.field.metadata if isinstance(limit, kind)]


def scaled(item: Declared, value: Any, scale: float) -> Any:
    """Return a value of the default gear's size in a gear that is `scale` times as large."""
    power = POWERS_OF.get(item.path, POWERS[item.unit.si] if item.unit else 0)
    return value * scale**power if power else value


def within(item: Declared, value: Any) -> Any:
    """Return the admissible value nearest to one that scaling may have led beyond a parameter's limits."""
    if not isinstance(value, float):
        return value
    return float(
        np.clip(
            value, max(_limits(item, Ge, "ge"), default=-np.inf), min(_limits(item, Le, "le"), default=np.inf)
        )
    )
