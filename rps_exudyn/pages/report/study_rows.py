"""The rows of a study's sheet: ranges of its numbers, what was varied, and how the cases ended."""

from collections.abc import Iterable

import numpy as np

from rps_exudyn.base.units import words
from rps_exudyn.pages.report.result_sheet import listed
from rps_exudyn.parameters.display_names import named
from rps_exudyn.results.quantities import LABELS, SUMMARY
from rps_exudyn.results.rounding import rounded_range
from rps_exudyn.results.sheet import Row
from rps_exudyn.study.table import CaseTable

LEADING = 3  # numbers of a sheet


def range_rows(table: CaseTable) -> Iterable[Row]:
    """Ranges of the numbers that differ most, those of a sheet first."""
    varying = table.varying()
    seen = set[str]()
    for name in [name for name in LABELS if name in varying] or ranked(table):
        known = table.numbers[name][np.isfinite(table.numbers[name])]
        shown = rounded_range(SUMMARY[name], float(known.min()), float(known.max()))
        if shown not in seen and len(seen) < LEADING:
            yield Row(shown, f"{LABELS.get(name, words(name))} over {count(known.size, 'case')}")
            seen.add(shown)


def study_rows(table: CaseTable) -> Iterable[Row]:
    """The ranges, what was varied, and how the cases ended."""
    yield from range_rows(table)
    paths = [", ".join(map(named, axis.paths)) for axis in table.description.axes]
    yield Row("varied", listed(paths))
    if remarked := len(list(table.remarked())):
        yield Row("warnings", f"{count(remarked, 'case')} completed with a remark")
    if failed := len(list(table.failed())):
        yield Row("failed", count(failed, "case"))


def count(number: int, noun: str) -> str:
    """The number with its noun: "1 case", "3 cases"."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def ranked(table: CaseTable) -> list[str]:
    """Numbers that differ between the cases; efficiencies first, where a scene measures them."""
    return sorted(table.varying(), key=lambda name: not name.startswith("efficiency"))
