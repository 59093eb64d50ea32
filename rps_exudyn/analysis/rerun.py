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
