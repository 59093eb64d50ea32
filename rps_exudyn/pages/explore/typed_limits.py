"""Limits that the page's user types for the metrics of a scene, read as those of a limits file."""

from collections.abc import Mapping
from contextlib import suppress
from math import isfinite
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import pretty, respelled, short
from rps_exudyn.results.limit import limit_of
from rps_exudyn.results.quantities import LABELS, SUMMARY, Quantity
from rps_exudyn.results.result import Result
from rps_exudyn.results.rounding import shown_metric


def metrics_of(result: Result) -> list[dict[str, Any]]:
    """Metrics that a limit can be typed for: those of a result that have a label; their "error" is None where
    it is unknown."""
    found = []
    for name in (name for name in LABELS if name in result.summary):
        value, quantity, error = result.summary[name], SUMMARY[name], result.errors.get(name, 0.0)
        known: dict[str, Any] = {}
        if isfinite(value):
            either = error if isfinite(error) else None
            known = {"value": value, "error": either, "shown": shown_metric(result, name)}
        found.append({"name": name, "words": LABELS[name], "unit": pretty(quantity.display), **known})
    return found


def limits_of(typed: Any) -> dict[str, Any]:
    """Read the limits: metric -> "least" and "most", SI, None without one, and both "shown"; or "problems".

    Args:
        typed: metric -> table as of a limits file; a bare number has the unit of the page.

    Raises:
        InputError: it is no table of metrics.
    """
    if not isinstance(typed, Mapping) or not all(isinstance(table, Mapping) for table in typed.values()):
        raise InputError("limits must be a table of metrics, each with least, most or both.")
    if unknown := [short(name) for name in typed if name not in LABELS]:
        raise InputError([f"{name} is no metric of this page." for name in unknown])
    found: dict[str, Any] = {}
    for name, table in typed.items():
        quantity, problems = SUMMARY[name], list[str]()
        with_units = {key: _with_unit(text, quantity) for key, text in table.items()}
        limit = limit_of(f"{LABELS[name]}, ", with_units, quantity, problems)
        ends = {key: end if isfinite(end := getattr(limit, key)) else None for key in ("least", "most")}
        found[name] = {"problems": problems} if problems else {**ends, "shown": limit.show(quantity)}
    return {"limits": found}


def _with_unit(text: Any, quantity: Quantity) -> Any:
    """What was typed, a bare number with the unit that the page shows beside it."""
    with suppress(ValueError):
        float(respelled(str(text)))
        return f"{text} {quantity.display}"
    return text
