"""The limits of the requirement sheet: what is asked for, in which unit, and by whom."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, isfinite
from pathlib import Path
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import shown, to_si
from rps_exudyn.parameters.declaration import read_toml
from rps_exudyn.results.quantities import Quantity

SHIPPED = Path(__file__).with_name("limits.toml")
KEYS = ("most", "least", "source")
TORQUE, STRESS = ("N*m", "N*m"), ("Pa", "MPa")

REQUIRED = {
    "free_torque": Quantity(*TORQUE, "mean free torque of the pinion"),
    "variation_on_centre": Quantity(*TORQUE, "largest minus smallest torque on centre, in one direction"),
    "variation_off_centre": Quantity(*TORQUE, "largest minus smallest torque off centre, in one direction"),
    "efficiency_ratio": Quantity("", "", "reverse over forward efficiency with the test's weight"),
    "rated_root_pinion": Quantity(*STRESS, "bending stress at the pinion's root, ISO 6336-3"),
    "rated_root_rack": Quantity(*STRESS, "bending stress at the rack's root, ISO 6336-3"),
    "rated_flank": Quantity(*STRESS, "contact stress at the pitch point, ISO 6336-2"),
    "rated_lift": Quantity("m", "um", "lift of the held rack"),
    "travel": Quantity("m", "mm", "travel that the teeth allow"),
    "gain": Quantity("m", "mm", "rack travel per turn of the pinion"),
}
"""Name of a requirement -> the number that is judged. The rated ones are under the rated torque."""

LABELS = {
    "free_torque": ("free torque", "mean, no load"),
    "variation_on_centre": ("variation on centre", "free torque, one direction"),
    "variation_off_centre": ("variation off centre", "free torque, one direction"),
    "efficiency_ratio": ("reverse / forward efficiency", "with the test's weight"),
    "rated_root_pinion": ("root stress, pinion", "at {torque}"),
    "rated_root_rack": ("root stress, rack", "at {torque}"),
    "rated_flank": ("flank pressure", "at {torque}"),
    "rated_lift": ("rack lift", "at {torque}"),
    "travel": ("travel", "stop to stop"),
    "gain": ("gain", "rack travel per turn"),
}
"""Name of a requirement -> its label for readers, and under what it holds ({torque}: the rated one)."""


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


def read_limits(path: Path | None = None) -> dict[str, Limit]:
    """Return the shipped limits, single ones replaced by those of a file.

    Raises:
        InputError: everything that is wrong with the file: name, key, and what is allowed.
    """
    limits = _limits(SHIPPED)
    return limits | (_limits(path) if path else {})


def _limits(file: Path) -> dict[str, Limit]:
    problems: list[str] = []
    found = {}
    for name, table in read_toml(file).items():
        if name not in REQUIRED:
            problems.append(f"{file}: {name} is no requirement; there are {', '.join(REQUIRED)}.")
        elif not isinstance(table, Mapping) or not table.keys() & {"most", "least"}:
            problems.append(f"{file}: {name} is {shown(table)}; it must be a table with most, least or both.")
        else:
            found[name] = _limit(f"{file}: {name}", table, REQUIRED[name], problems)
    if problems:
        raise InputError(problems)
    return found


def _limit(where: str, table: Mapping[str, Any], quantity: Quantity, problems: list[str]) -> Limit:
    problems += [f"{where}.{key} is no key; there are {', '.join(KEYS)}." for key in table.keys() - set(KEYS)]
    ends = {"least": -inf, "most": inf}
    for key in ends:
        try:
            ends[key] = to_si(table.get(key, ends[key]), quantity.unit)
        except ValueError as error:
            problems.append(f"{where}.{key} {error}.")
    if not ends["least"] < ends["most"]:
        problems.append(f"{where}.least must be below most.")
    return Limit(ends["least"], ends["most"], str(table.get("source", "your own")))
