"""All cases of a study as columns: what was varied, how each ended, and its numbers.

    table = CaseTable.of(Store.open("preload-study"))
    table.axes["preload"], table.numbers["torque_mean"]  # SI, one value per case

Cases stand in the order of the design. A case that is not finished has the status `PENDING`. Numbers are
those of cases that ended ok; all others are nan, because only ok results may be used. What a failed case
left is in its own file.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from rps_exudyn.parameters.setup import Setup
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import SUMMARY, Quantity
from rps_exudyn.study.description import Axis, Case, Description, Value
from rps_exudyn.study.store import CaseRow, Store

PENDING = "pending"
NEGLIGIBLE = 1e-5  # share of a number below which its differences are of no interest


@dataclass(frozen=True, eq=False)
class CaseTable:
    """The columns; every array has the shape (cases,)."""

    path: Path
    description: Description
    rows: Sequence[CaseRow | None]  # None: not finished
    skipped: Sequence[tuple[Path, str]]  # files that could not be used, and why

    @classmethod
    def of(cls, store: Store) -> "CaseTable":
        """What is finished by now."""
        finished = {case.hash: row for case, row in store.rows()}
        rows = [finished.get(case.hash) for case in store.description.cases]
        return cls(store.path, store.description, rows, tuple(store.skipped))

    @property
    def cases(self) -> tuple[Case, ...]:
        return self.description.cases

    @cached_property
    def status(self) -> np.ndarray:
        """`outcome.Status` as text, or `PENDING`."""
        return np.array([row.status.value if row else PENDING for row in self.rows], dtype=np.str_)

    @cached_property
    def ok(self) -> np.ndarray:
        """Whether the case's numbers may be used."""
        return self.status == Status.OK.value

    @cached_property
    def axes(self) -> dict[str, np.ndarray]:
        """What was varied: SI values, or the words of a choice."""
        return {axis.name: _column([case.values[axis.name] for case in self.cases]) for axis in self._axes}

    @cached_property
    def numbers(self) -> dict[str, np.ndarray]:
        """Every summary quantity that some ok case has; nan where it is unknown."""
        return {name: values for name in SUMMARY if np.isfinite(values := self._summary(name)).any()}

    def times(self, name: str) -> np.ndarray:
        """`cpu_s` or `wall_s` of the finished cases [s], else nan."""
        return np.array([getattr(row, name) if row else np.nan for row in self.rows], dtype=float)

    def failed(self) -> Iterator[tuple[Case, CaseRow]]:
        """Cases that did not end ok, each once."""
        ended = {case.hash: (case, row) for case, row in zip(self.cases, self.rows, strict=True) if row}
        return (pair for pair in ended.values() if pair[1].status is not Status.OK)

    def varying(self) -> list[str]:
        """Numbers that differ noticeably between the cases, in the order of `SUMMARY`.

        Differences are measured by the largest number with the same unit: an order's amplitude that
        is nothing but rounding does not differ.
        """
        largest: dict[str, float] = {}
        for name, values in self.numbers.items():
            unit = SUMMARY[name].unit
            largest[unit] = max(largest.get(unit, 0.0), float(np.nanmax(np.abs(values))))
        return [
            name
            for name, values in self.numbers.items()
            if np.nanmax(values) - np.nanmin(values) > NEGLIGIBLE * largest[SUMMARY[name].unit]
        ]

    @property
    def _axes(self) -> tuple[Axis, ...]:
        return self.description.axes

    def _summary(self, name: str) -> np.ndarray:
        usable = [row.summary.get(name) if row and row.status is Status.OK else None for row in self.rows]
        return np.array([np.nan if value is None else value for value in usable], dtype=float)


def axis_quantity(axis: Axis) -> Quantity:
    """Unit, display unit and meaning of what an axis varies."""
    declared = Setup.declared_at(axis.paths[0])[0] if axis.paths else None
    unit = declared.unit.si if declared and declared.unit else ""
    display = axis.unit or (declared.unit.display if declared and declared.unit else "")
    meaning = declared.meaning if declared else ""
    others = [*axis.paths[1:], *axis.along]
    return Quantity(unit, display, f"{meaning}; with it {', '.join(others)}" if others else meaning)


def show_value(axis: Axis, value: Value) -> str:
    """The value for a reader: in the axis' unit, or the word that it is."""
    return value if isinstance(value, str) else axis_quantity(axis).show(value)


def is_numeric(values: np.ndarray) -> bool:
    """Whether an axis has numbers, not words."""
    return values.dtype.kind == "f"


def _column(values: list[Value]) -> np.ndarray:
    if any(isinstance(value, str) for value in values):
        return np.array([str(value) for value in values], dtype=np.str_)
    return np.array(values, dtype=float)
