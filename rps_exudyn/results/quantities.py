"""Every quantity a result may hold: name, unit, definition. Declared once, in the table `quantities.txt`.

A result with another name is refused when it is made, so that files, charts and the format's page
(docs/hdf5-format.md, which a test compares with this list) cannot drift apart. Directions are those of the
housing frame in `gears.gear_pair`: X the rack's travel, Y from the pinion to the rack, Z = X x Y.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from rps_exudyn.base import units

LEAST_SHOWN = {
    "N*m": 1e-7,
    "N": 1e-6,
    "N*s": 1e-9,
    "J": 1e-9,
    "mm": 1e-7,
    "um": 1e-4,
    "deg": 1e-6,
    "mrad": 1e-6,
    "mm/s": 1e-6,
    "%": 1e-4,
}
"""Display unit -> size below which a number means nothing: a millionth of what is measured in a small gear.
Equilibria are found to 1e-3 N, a hundred thousandth of their torque, and positions to rounding, 1e-17 m."""


LEAST_CHANGED = {"um": 1e-7, "mrad": 1e-6, "deg": 1e-5, "%": 1e-3}
"""Display unit -> size in SI below which the error of a metric counts as if it had that size."""
NOTHING = 1e-200  # size in SI of any other that is 0
LEAST_SHARE = 0.01  # the same where a run has a size of its own, of that size
FACE = 0.01  # face width of a small gear [m], beside which the error of a place counts
PART = 0.02  # of all work lost, or of a record's time, beside which the error of a share counts
IMPACTS = 30  # beside which the error of their number counts
SEEN = 5e-7  # smallest motion of the rack that is of interest [m], at the bar's surface and half a seat ...
LEVERS = {"rack_roll_range": 0.01, "rack_yaw_range": 0.1, "lost_motion_angle": 0.01}
"""... of turns about X and Y, and of the pinion's [m]."""


@dataclass(frozen=True)
class Quantity:
    """One number or signal: kept in the SI `unit`, shown in the unit `display`; "" is dimensionless.

    A metric is `simulated` unless a formula, a setting or a check gives it. `least` is the size below which
    its error counts as if it had that size: of a place the length that it is a place on, of a share a part of
    the whole.
    """

    unit: str
    display: str
    long_name: str
    simulated: bool = False
    least: float = 0.0

    @property
    def attributes(self) -> dict[str, str]:
        """Return what files and labelled arrays state of it: `units` and `long_name`."""
        return {"units": self.unit, "long_name": self.long_name}

    def size(self, value: Any, of_run: Any = 0.0) -> Any:
        """Return the size of a metric beside that of its run: its own value, or the least that matters."""
        least = max(self.least, LEAST_CHANGED.get(self.display, NOTHING))
        return np.maximum(np.abs(value), np.maximum(LEAST_SHARE * of_run, least))

    def show(self, value: float) -> str:
        """Return the value for a reader, for instance "0.593 N m"; counts are whole numbers.

        What is below `LEAST_SHOWN` is rounding, and shown as 0.
        """
        if isinstance(value, int):
            return str(value)
        number = self.displayed(value)
        if abs(number) < LEAST_SHOWN.get(self.display, 0.0):
            number = 0.0
        return f"{number:.4g} {units.pretty(self.display)}".strip()

    def displayed(self, values: Any) -> Any:
        """Return SI values, a number or an array of any shape, in the display unit."""
        return units.displayed(values, self.unit, self.display)

    def axis_label(self, name: str) -> str:
        """Return the label of an axis, for instance "pinion torque [N m]"."""
        unit = units.pretty(self.display)
        return f"{name} [{unit}]" if unit else name


def _tables() -> dict[str, dict[str, list[str]]]:
    """Read `quantities.txt`: table -> its first column -> the others."""
    tables: dict[str, dict[str, list[str]]] = {}
    for line in Path(__file__).with_suffix(".txt").read_text(encoding="utf-8").splitlines():
        if line.startswith("["):
            table = tables[line.strip("[]")] = {}
        elif line and not line.startswith("#"):
            name, *others = re.split("  +", line, maxsplit=3)
            table[name] = others
    return tables


_TABLES = _tables()
SIGNALS, _SUMMARY, COUNTERS, GEOMETRY = (
    {
        name: Quantity(unit.strip("-"), shown.strip("-"), meaning)
        for name, (unit, shown, meaning) in _TABLES[table].items()
    }
    for table in ("signals", "summary", "counters", "geometry")
)
LABELS, PARTS, INSTANTS, SCATTERS = (
    {name: other for name, (other,) in _TABLES[table].items()}
    for table in ("labels", "parts", "instants", "scatters")
)
WORKS = frozenset(name for name in SIGNALS if name.startswith("work_") or name == "stored_energy")
"""Signals that count energy from the start of recording."""

_NOT_FROM_STEPS = {
    "torque_closed_form", "rack_lift_closed_form", "cap_force", "clearance_set", "preload_set",
    "sticking_speed", "sliding_damping", "bristle_margin", "energy_residual",
}  # fmt: skip


RACK_RANGES = "rack_lift_range", "rack_roll_range", "rack_yaw_range"
VARIATIONS = frozenset(
    name
    for name in _SUMMARY
    if name.endswith(("_peak_to_peak", "_range", "_variation")) or name == "torque_tooth_order"
)
"""Metrics of how far a signal varies, which vibration and the start of a motion change before its mean."""
EXTREMES = frozenset(name for name in _SUMMARY if name.endswith(("_min", "_max")))
"""Metrics that one instant of a signal gives, which vibration changes as it does what varies."""
FIRST_ORDERS = frozenset(name for name in _SUMMARY if name.endswith("_first_order"))
"""Metrics of what repeats with the turn, which may be small beside what is left of the start."""
MOTIONS = frozenset(
    name for name in _SUMMARY if name.startswith("transmission_error_") or name in RACK_RANGES
)
"""Metrics of motions beside the travel, of micrometres."""
LOST_MOTIONS = frozenset({"lost_motion", "lost_motion_angle"})
"""Metrics of how far the rack stays behind between both directions."""
WANDERING = MOTIONS | LOST_MOTIONS | {"reversal_angle"}
"""Metrics of a swing that small motions make, which may go on to change when its torque has settled."""
LOSS_SHARES = frozenset(name for name in _SUMMARY if name.startswith("loss_share_"))
"""Metrics of who takes the work, which depend on how lines of contact share the load at each instant."""


def _least(name: str) -> float:
    """Return the size below which the error of a metric counts as if it had that size [SI]."""
    if name in MOTIONS | LOST_MOTIONS:
        return SEEN / LEVERS.get(name, 1.0)
    if name == "load_centre":
        return FACE
    if name == "impacts":
        return IMPACTS
    return PART if name.startswith("loss_share_") or name == "stick_share" else 0.0


SUMMARY = {
    name: replace(
        each,
        simulated=name not in _NOT_FROM_STEPS and not name.startswith(("operating_", "wear_")),
        least=_least(name),
    )
    for name, each in _SUMMARY.items()
}


def metric_sizes(values: Mapping[str, Any], of_run: Mapping[str, Any]) -> dict[str, Any]:
    """Return the sizes of the simulated ones of some metrics, beside the sizes of their run by unit."""
    items = {name: SUMMARY[name] for name in values}
    return {
        name: item.size(values[name], of_run.get(item.unit, 0.0))
        for name, item in items.items()
        if item.simulated
    }


GROUPS = {"signals": SIGNALS, "summary": SUMMARY, "counters": COUNTERS, "geometry": GEOMETRY}
"""Group of the HDF5 file -> what it may hold."""

COLUMNS = GROUPS | {
    "summary": {
        column: quantity
        for name, each in SUMMARY.items()
        for column, quantity in (
            (name, each),
            (f"{name}_error", Quantity(each.unit, each.display, f"numerical error of {name}")),
        )
    }
}
"""Group of a table of many results -> its columns: beside each number of the summary stands its error."""
