"""A limit that a number must keep, as limits files of `check` and the explorer's page state it."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any

from rps_exudyn.base.units import to_si
from rps_exudyn.results.quantities import Quantity

LIMIT_KEYS = ("most", "least", "source")


@dataclass(frozen=True)
class Limit:
    """What a number must keep, SI; infinite where there is no limit."""

    least: float
    most: float
    source: str

    def keeps(self, value: Any) -> Any:
        """Return whether a number, or each of an array, keeps the limit; nan does not."""
        return (value >= self.least) & (value <= self.most)

    @property
    def finite(self) -> float:
        """The largest of the limits that there are."""
        return max(abs(end) for end in (self.least, self.most) if isfinite(end))

    def missed(self, low: float, high: float) -> "Limit":
        """Return the limits that a band goes beyond; all of them where it does not."""
        ends = (self.least if low < self.least else -inf, self.most if high > self.most else inf)
        return self if ends == (-inf, inf) else Limit(*ends, self.source)

    def show(self, quantity: Quantity) -> str:
        """Return the limit for a reader."""
        ends = [f"at least {quantity.show(self.least)}"] if self.least > -inf else []
        ends += [f"at most {quantity.show(self.most)}"] if self.most < inf else []
        return ", ".join(ends)


def limit_of(where: str, table: Mapping[str, Any], quantity: Quantity, problems: list[str]) -> Limit:
    """Return the limit of a table of `LIMIT_KEYS`; what is wrong with it becomes a sentence of `problems`.

    `where` stands before a key in a sentence.
    """
    problems += [
        f"{where}{key} is no key; there are {', '.join(LIMIT_KEYS)}."
        for key in table.keys() - set(LIMIT_KEYS)
    ]
    ends = {"least": -inf, "most": inf}
    for key in ends:
        try:
            ends[key] = to_si(table.get(key, ends[key]), quantity.unit)
        except ValueError as error:
            problems.append(f"{where}{key} {error}.")
    if not ends["least"] < ends["most"]:
        problems.append(f"{where}least must be below most, {quantity.show(ends['most'])}.")
    return Limit(ends["least"], ends["most"], str(table.get("source", "your own")))
