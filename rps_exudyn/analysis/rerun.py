"""A result compared number by number with its repetition."""

from typing import Any

import numpy as np

from rps_exudyn.results.provenance import FIELDS
from rps_exudyn.results.result import Result

VARYING = ("date",)  # of the provenance: has no effect on the numbers


def differing_numbers(old: Result, new: Result) -> dict[str, tuple[Any, Any]]:
    """Name -> (old, new): status, summary, signals (the first value that differs); {} if all are the same.

    Signals of a thinned record are not compared. If numbers differ, differing versions are listed too.
    """
    found: dict[str, tuple[Any, Any]] = {}
    if old.status is not new.status:
        found["status"] = (old.status.value, new.status.value)
    for name in dict.fromkeys((*old.summary, *new.summary)):
        pair = (old.summary.get(name), new.summary.get(name))
        if pair[0] != pair[1] and any(value == value for value in pair):  # nan is nan again
            found[name] = pair
    for name, values in old.signals.items():
        if name in new.signals and len(values) == len(new.signals[name]):
            differs = np.flatnonzero(~np.isclose(values, new.signals[name], rtol=0, atol=0, equal_nan=True))
            if differs.size:
                found[f"{name}[{differs[0]}]"] = (values[differs[0]], new.signals[name][differs[0]])
    if found:
        found |= {
            name: (old.provenance[name], new.provenance[name])
            for name in FIELDS
            if name not in VARYING and old.provenance[name] != new.provenance[name]
        }
    return found


def largest_difference(old: Result, new: Result) -> tuple[str, float]:
    """Return the signal or number that differs most, and its difference over its largest size; ("", 0.0) if
    none.

    Signals of different length are not compared.
    """
    pairs = {
        name: (values, new.signals[name])
        for name, values in old.signals.items()
        if name in new.signals and len(values) == len(new.signals[name])
    }
    pairs |= {
        name: (np.array([value]), np.array([new.summary[name]]))
        for name, value in old.summary.items()
        if name in new.summary
    }
    differences = {
        name: float(np.nanmax(np.abs(first - second), initial=0.0) / np.nanmax(np.abs(first), initial=1e-300))
        for name, (first, second) in pairs.items()
    }
    name = max(differences, key=differences.__getitem__, default="")
    return (name, differences[name]) if differences.get(name) else ("", 0.0)
