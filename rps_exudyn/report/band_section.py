"""The section about bands of a study with the design `uncertain`: quantiles with errors, contributions."""

from collections.abc import Iterable, Sequence

import numpy as np

from rps_exudyn.base.units import words
from rps_exudyn.report.blocks import Block, Fold, Grid, Section, Text, Warning
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.study.description import UNCERTAIN_DESIGN
from rps_exudyn.study.table import PENDING, CaseTable
from rps_exudyn.uncertainty.contributions import contributions
from rps_exudyn.uncertainty.quantiles import LEVELS, quantiles

LEAST_KNOWN = 8  # cases, for quantiles
WITH_CONTRIBUTIONS = 6  # numbers


def band_sections(table: CaseTable, names: Sequence[str]) -> list[Section]:
    """Return the section about these numbers; none of a study of another design."""
    if table.description.design != UNCERTAIN_DESIGN:
        return []
    return [Section("Bands", list(_blocks(table, names)))]


def _blocks(table: CaseTable, names: Sequence[str]) -> Iterable[Block]:
    failed = sum(status not in (Status.OK, PENDING) for status in table.status)
    if failed:
        yield Warning(
            f"{failed} of {len(table.status)} samples failed and are in no quantile; see Failed cases."
        )
    rows = [_row(table.numbers[name], name, failed) for name in names if _known(table.numbers[name]).any()]
    head = ("number", *(f"{100 * level:g} %" for level in LEVELS), "error of 5 %", "error of 95 %")
    rows = [row for row in rows if row]
    if not rows:
        yield Text(f"Quantiles need at least {LEAST_KNOWN} cases that ended ok.")
        return
    yield Grid(head, rows, "Quantiles; errors are standard errors, from the number of samples")
    inputs = [name for name, values in table.axes.items() if values.dtype.kind == "f"]
    for name in names[:WITH_CONTRIBUTIONS]:
        yield from _contributions(table, name, inputs)


def _row(numbers: np.ndarray, name: str, failed: int) -> list[str]:
    known = numbers[_known(numbers)]
    if known.size < LEAST_KNOWN:
        return []
    found, show = quantiles(known, failed), SUMMARY[name].show
    errors = [show(float(found.errors[at])) for at in (0, -1)]
    return [words(name), *(show(value) for value in found.values.tolist()), *errors]


def _contributions(table: CaseTable, name: str, inputs: list[str]) -> Iterable[Block]:
    """Fractions of the variance; the quantile of a value is its rank among all that were drawn."""
    known = _known(table.numbers[name])
    ranks = [np.argsort(np.argsort(table.axes[axis])) for axis in inputs]
    if not ranks:
        return
    quantile = (np.stack(ranks, axis=1) + 0.5) / len(known)
    shares = contributions(quantile[known], table.numbers[name][known], inputs) if known.any() else None
    if shares is None:
        return
    rows = [[axis, f"{share:.0%}"] for axis, share in shares.fractions.items()]
    rows.append(["acting together", f"{shares.together:.0%}"])
    caption = f"Share of the variance of {words(name)}, each within {shares.error:.0%} by chance"
    yield Fold(f"Contributions to {words(name)}", [Grid(("input", "share"), rows, caption)])


def _known(numbers: np.ndarray) -> np.ndarray:
    return np.isfinite(numbers)
