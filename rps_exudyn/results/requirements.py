"""The limits of the requirement sheet: what is asked for, in which unit, and by whom.

A limit has the name of a requirement, or of a metric of the scenes that the sheet runs.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import shown
from rps_exudyn.parameters.declaration import read_toml
from rps_exudyn.parameters.wrong_values import nearest_names
from rps_exudyn.results import quantities
from rps_exudyn.results.limit import Limit, limit_of
from rps_exudyn.results.quantities import SUMMARY, Quantity

SHIPPED = Path(__file__).with_name("limits.toml")
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


def quantity_of(name: str) -> Quantity:
    """Return the number that is judged by a requirement, or a metric."""
    return REQUIRED.get(name) or SUMMARY[name]


def label_of(name: str) -> tuple[str, str]:
    """Return the label of a requirement or a metric, and what stands below it."""
    usual = quantities.LABELS.get(name, name.replace("_", " "))
    return LABELS[name] if name in LABELS else (usual, SUMMARY[name].long_name)


def read_limits(path: Path | None = None) -> dict[str, Limit]:
    """Return the shipped limits, single ones replaced by those of a file."""
    limits = read_only(SHIPPED)
    return limits | (read_only(path) if path else {})


def read_only(file: Path) -> dict[str, Limit]:
    """Return the limits of a file alone."""
    return limits_in(read_toml(file), str(file))


def limits_in(tables: Mapping[str, Any], file: str) -> dict[str, Limit]:
    """Return the limits of tables with most, least and source, name -> table.

    Raises:
        InputError: everything that is wrong with them; `file` names their origin.
    """
    problems: list[str] = []
    found = {}
    for name, table in tables.items():
        if name not in REQUIRED and name not in SUMMARY:
            near = nearest_names(name, [*REQUIRED, *SUMMARY], REQUIRED)
            problems.append(f"{file}: {name} is no requirement and no metric; {near}.")
        elif not isinstance(table, Mapping) or not table.keys() & {"most", "least"}:
            problems.append(f"{file}: {name} is {shown(table)}; it must be a table with most, least or both.")
        else:
            found[name] = limit_of(f"{file}: {name}.", table, quantity_of(name), problems)
    if not tables:
        problems.append(f'{file} has no limit; a line of it is free_torque = {{ most = "1.5 N*m" }}.')
    if problems:
        raise InputError(problems)
    return found
