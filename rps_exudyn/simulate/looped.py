"""Many gears' forces by one compiled loop: figures and curves, without all other signals.

What the loop cannot judge, gears lost, limits of the contact laws, records that ask for shorter steps, it
leaves to single runs: a row that it gives is one that a single run ends ok.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rps_exudyn.base.compiling import begin_work
from rps_exudyn.base.errors import InputError
from rps_exudyn.checks.before_run import refused
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.simulate.loop_design import Design, Table
from rps_exudyn.simulate.loop_figures import figures_of, remarks_on
from rps_exudyn.simulate.loop_knows import WEIGHT
from rps_exudyn.simulate.loop_legs import SIGNALS, legs_of
from rps_exudyn.simulate.loop_signals import LegRecord, joined
from rps_exudyn.solvers.gear_rows import RUNOUT, RUNOUT_ANGLE, packed_rows, rows_of_table
from rps_exudyn.solvers.many_gears import Rows

FEWEST = 4  # gears for each that is followed to learn from: with fewer single runs are quicker
TOGETHER = 256  # gears whose signals are held at once


@dataclass(frozen=True, eq=False)
class Looped:
    """What the loop found; rows that it leaves to single runs have nan, and no message."""

    ended: np.ndarray  # (n,) whether the row is the loop's
    summary: dict[str, np.ndarray]  # figure -> (n,)
    messages: list[str]
    signals: dict[str, np.ndarray]  # by time, (m,) where all gears have the same, else (n, m)

    def signals_of(self, row: int) -> dict[str, np.ndarray]:
        """Return the signals of one gear, (m,) each."""
        return {name: values if values.ndim == 1 else values[row] for name, values in self.signals.items()}


def looped(
    scene: str, gear: SteeringGear, fidelity: Fidelity, table: Table, ranges: Table | None = None
) -> Looped | None:
    """Find the curves of gears that differ in a table; None if it cannot begin.

    Args:
        scene: one that the loop knows.
        gear: what they have in common.
        fidelity: how they are modelled.
        table: path -> values (n,) in SI.
        ranges: path -> values that tell over what the parameters of a larger table vary of which this is a
            part: then its gears end as in any other part. Without it the table is whole.
    """
    count = len(next(iter(table.values())))
    if ranges is None and count < fewest(table):
        return None
    valid, rows, reference = _rows(gear, fidelity, table, ranges)
    if rows is None or refused(reference, fidelity, steady=True):
        return None
    begin_work("loop")
    some = {path: values[valid] for path, values in table.items()}
    designs = []
    for leg in legs_of(scene, gear):
        if leg.weighted and not reference.test.load_mass > 0:
            return None
        if (design := Design.of(leg, reference, fidelity, some, ranges)) is None:
            return None
        designs.append(design)
    begins = range(0, len(rows), TOGETHER)
    parts = [_Part.of(scene, designs, rows, np.arange(i, min(i + TOGETHER, len(rows)))) for i in begins]
    return _joined(parts, valid, count)


def fewest(table: Table) -> int:
    """Return the number of gears from which a loop over a table is quicker than single runs."""
    return FEWEST * (2 * sum(np.ptp(values) > 0 for values in table.values()) + 1)


def _rows(
    gear: SteeringGear, fidelity: Fidelity, table: Table, ranges: Table | None
) -> tuple[np.ndarray, Rows | None, SteeringGear]:
    """Which gears can exist, their rows, and the reference gear."""
    valid = _within(table, table if ranges is None else ranges)
    for attempt in range(2 if valid.size else 0):
        part = {path: np.asarray(values, dtype=float)[valid] for path, values in table.items()}
        try:
            centre = {path: float(np.median(values)) for path, values in (ranges or part).items()}
            reference = gear.replace(centre | ({RUNOUT: 0.0} if {RUNOUT, RUNOUT_ANGLE} & {*part} else {}))
            full = part | ({RUNOUT: np.full(len(valid), gear.pinion.runout)} if _fixed_runout(part) else {})
            return valid, rows_of_table(reference, fidelity, full, ranges), reference
        except InputError:
            if attempt:
                break
            valid = np.array([row for row in valid.tolist() if _exists(gear, fidelity, table, row)], np.intp)
            if not valid.size:
                break
    return valid, None, gear


def _fixed_runout(table: Mapping[str, Any]) -> bool:
    return RUNOUT_ANGLE in table and RUNOUT not in table


def _within(table: Table, ranges: Table) -> np.ndarray:
    """Rows of a table within the ranges; none without its weight."""
    inside = [(ranges[path].min() <= each) & (each <= ranges[path].max()) for path, each in table.items()]
    weighted = np.greater(table.get(WEIGHT, 1.0), 0.0)
    return np.flatnonzero(np.logical_and.reduce(inside) & weighted)


def _exists(gear: SteeringGear, fidelity: Fidelity, table: Table, row: int) -> bool:
    return can_exist(gear, fidelity, {path: float(values[row]) for path, values in table.items()})


def can_exist(gear: SteeringGear, fidelity: Fidelity, settings: Mapping[str, float]) -> bool:
    """Tell whether a gear with other settings can be built."""
    try:
        packed_rows([gear.replace(settings)], fidelity)
    except InputError:
        return False
    return True


@dataclass(frozen=True, eq=False)
class _Part:
    """Some gears of a loop, described."""

    kept: np.ndarray  # (n,) whether the rows are the loop's
    summary: dict[str, np.ndarray]  # of those kept
    messages: list[str]
    signals: dict[str, np.ndarray]

    @classmethod
    def of(cls, scene: str, designs: Sequence[Design], rows: Rows, chosen: np.ndarray) -> "_Part":
        """Follow the chosen gears over all legs, and describe those that the loop has found in each."""
        records = [LegRecord.of(design, rows, chosen) for design in designs]
        kept = np.logical_and.reduce([each.surely_ok() for each in records])
        if not kept.all():
            records = [each.some(kept) for each in records]
        if not kept.any():
            return cls(kept, {}, [], {})
        signals = joined([each.whole() for each in records if each.design.leg.recorded])
        summary, told = figures_of(scene, records, signals)
        messages = [
            "; ".join(remark for remark in (limits, *own) if remark)
            for limits, own in zip(remarks_on(records), told, strict=True)
        ]
        return cls(kept, summary, messages, {name: signals[name] for name in SIGNALS[scene]})


def _joined(parts: list[_Part], valid: np.ndarray, count: int) -> Looped:
    """The parts one after the other, in the rows of the table."""
    ended, messages = np.zeros(count, dtype=bool), [""] * count
    summary: dict[str, np.ndarray] = {}
    signals: dict[str, np.ndarray] = {}
    begin = 0
    for part in parts:
        rows = valid[begin : begin + len(part.kept)][part.kept]
        begin += len(part.kept)
        ended[rows] = True
        for name, values in part.summary.items():
            summary.setdefault(name, np.full(count, np.nan))[rows] = values
        for name, values in part.signals.items():
            if values.ndim == 1:
                signals[name] = values
            else:
                signals.setdefault(name, np.full((count, values.shape[1]), np.nan))[rows] = values
        for row, message in zip(rows.tolist(), part.messages, strict=True):
            messages[row] = message
    return Looped(ended, summary, messages, signals)
