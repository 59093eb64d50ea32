"""All cases of a study as columns: values of the axes, outcomes, and numbers.

    table = CaseTable.of(Store.open("preload-study"))
    table.axes["preload"], table.numbers["torque_mean"]  # SI, one value per case

Cases are in the order of the design. A case that is not finished has the status `PENDING`. Numbers of cases
that did not end ok are nan, because only ok results may be used; what a failed case left is in its own file.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from rps_exudyn.base.units import pretty
from rps_exudyn.parameters.gear import Setup
from rps_exudyn.results.block import TIMES, CaseRow
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import COLUMNS, SUMMARY, Quantity
from rps_exudyn.scenes.checks.rules import met_limit
from rps_exudyn.study.definition import Axis, Case, Description, Value, axis_quantity, axis_values
from rps_exudyn.study.store import Store

PENDING = "pending"
NEGLIGIBLE = 1e-5  # differences below this fraction of the largest number do not count

OUTCOME = {
    "hash": Quantity("", "", "name of the case, without .h5"),
    "status": Quantity("", "", "how the case ended, or pending"),
    "message": Quantity("", "", "cause of a failure, or remarks of an ok case"),
    **TIMES,
}
"""The columns of every table beside its axes and numbers."""


@dataclass(frozen=True, eq=False)
class TableColumn:
    """One column with its definition."""

    group: str  # "axes", "outcome" or "summary"
    name: str
    values: np.ndarray  # SI, shape (cases,)
    quantity: Quantity

    @property
    def header(self) -> str:
        """Name of the column with its unit, for instance "torque_mean [N*m]"."""
        return f"{self.name} [{self.quantity.unit}]" if self.quantity.unit else self.name


@dataclass(frozen=True, eq=False)
class CaseTable:
    """The columns; every array has the shape (cases,)."""

    path: Path
    description: Description
    rows: Sequence[CaseRow | None]  # None: not finished
    skipped: Sequence[tuple[Path, str]]  # files that could not be used, and why

    @classmethod
    def of(cls, store: Store) -> "CaseTable":
        """The cases of a study's folder, as far as they are finished by now."""
        finished = {case.hash: row for case, row in store.rows()}
        rows = [finished.get(case.hash) for case in store.description.cases]
        return cls(store.path, store.description, rows, tuple(store.skipped))

    @property
    def cases(self) -> tuple[Case, ...]:
        """All cases, in the order of the design."""
        return self.description.cases

    @cached_property
    def status(self) -> np.ndarray:
        """`outcome.Status` as text, or `PENDING`."""
        return np.array([row.status.value if row else PENDING for row in self.rows], dtype=np.str_)

    @cached_property
    def ok(self) -> np.ndarray:
        """Return whether the case's numbers may be used."""
        return self.status == Status.OK.value

    @cached_property
    def limited(self) -> np.ndarray:
        """Return whether an ok case met a limit of the gear, where a contact opens or closes."""
        met = [row is not None and met_limit(row.codes) for row in self.rows]
        return self.ok & np.array(met, dtype=bool)

    @cached_property
    def axes(self) -> dict[str, np.ndarray]:
        """Axis name -> SI values, or the words of a choice."""
        return {axis.name: axis_values(axis, self.cases) for axis in self.description.axes}

    @cached_property
    def numbers(self) -> dict[str, np.ndarray]:
        """Every summary quantity that some ok case has; nan where it is unknown."""
        return {name: values for name in SUMMARY if np.isfinite(values := self._summary(name)).any()}

    @cached_property
    def errors(self) -> dict[str, np.ndarray]:
        """Half widths of the error bars of those numbers that have some; nan where one is unknown."""
        kept = {name for row in self.rows if row for name in row.summary}
        return {name: self._summary(error) for name in self.numbers if (error := f"{name}_error") in kept}

    def times(self, name: str) -> np.ndarray:
        """`cpu_s` or `wall_s` of the finished cases [s], else nan."""
        return np.array([getattr(row, name) if row else np.nan for row in self.rows], dtype=float)

    def columns(self) -> list[TableColumn]:
        """Axes, outcome and numbers, in the order of `TableColumn.group`."""
        outcome: dict[str, np.ndarray] = {
            "hash": np.array([case.hash for case in self.cases], dtype=np.str_),
            "status": self.status,
            "message": np.array([row.message if row else "" for row in self.rows], dtype=np.str_),
            "cpu_s": self.times("cpu_s"),
            "wall_s": self.times("wall_s"),
        }
        axes = self.description.axes
        numbers = self.numbers | {f"{name}_error": errors for name, errors in self.errors.items()}
        declared = COLUMNS["summary"].items()
        return [
            *(TableColumn("axes", axis.name, self.axes[axis.name], axis_quantity(axis)) for axis in axes),
            *(TableColumn("outcome", name, outcome[name], quantity) for name, quantity in OUTCOME.items()),
            *(
                TableColumn("summary", name, numbers[name], each)
                for name, each in declared
                if name in numbers
            ),
        ]

    def ended(self) -> Iterator[tuple[Case, CaseRow]]:
        """Finished cases with their rows, each once."""
        ended = {case.hash: (case, row) for case, row in zip(self.cases, self.rows, strict=True) if row}
        yield from ended.values()

    def failed(self) -> Iterator[tuple[Case, CaseRow]]:
        """Cases that did not end ok with their rows, each once."""
        return (pair for pair in self.ended() if pair[1].status is not Status.OK)

    def remarked(self) -> Iterator[tuple[Case, CaseRow]]:
        """Cases that ended ok with a remark, with their rows, each once."""
        return (pair for pair in self.ended() if pair[1].status is Status.OK and pair[1].message)

    def varying(self) -> list[str]:
        """Names of the numbers that differ noticeably between the cases, in the order of `SUMMARY`.

        Differences are compared with the largest number of the same unit: an order's amplitude that is only
        rounding does not differ.
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

    def _summary(self, name: str) -> np.ndarray:
        usable = [row.summary.get(name) if row and row.status is Status.OK else None for row in self.rows]
        return np.array([np.nan if value is None else value for value in usable], dtype=float)


def show_value(axis: Axis, value: Value, digits: int = 6) -> str:
    """The value as text: in the axis' unit with so many significant digits, or the word itself."""
    if isinstance(value, str):
        return value
    unit = Setup.declared_at(axis.paths[0])[0].unit if axis.paths else None
    if unit and unit.zero and not value:
        return unit.zero
    quantity = axis_quantity(axis)
    return f"{quantity.displayed(value):.{digits}g} {pretty(quantity.display)}".strip()
