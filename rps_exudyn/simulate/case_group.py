"""Cases of one design at once, by `batch`: each becomes the result that a study keeps.

Results of gears that were followed together are those of single runs within what the finding "together" says.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter, process_time
from typing import Any, Literal

import numpy as np

from rps_exudyn.gears.geometry_report import geometry_report
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status, each_once, joined_text
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named
from rps_exudyn.simulate.batch import Batch, batch
from rps_exudyn.solvers.settling import TOLERANCE

FINDING = "many gears followed together: mean within 1e-5, other metrics mostly within 1e-3 of a single run"


@dataclass(frozen=True, eq=False)
class CaseGroup:
    """Gears that differ in some parameters, SI."""

    scene: str
    gear: SteeringGear
    fidelity: Fidelity
    settings: Sequence[Mapping[str, Any]]  # path -> value, the same paths in each
    ranges: Mapping[str, Sequence[float]] | None = None  # over which they vary in the whole study

    def results(self, signals: Sequence[str] | None) -> list[Result]:
        """Return the gears' results, with at least these signals.

        Raises:
            InputError: what they have in common is wrong.
        """
        wall, cpu = perf_counter(), process_time()
        table = {path: [each[path] for each in self.settings] for path in self.settings[0]}
        test = scene_named(self.scene).test
        alone = test is not None and signals is not None and set(signals) <= {*test.curve}
        keep: Literal["torque", "signals"] = "torque" if alone else "signals"
        found = batch(self.scene, self.gear, table, fidelity=self.fidelity, keep=keep, ranges=self.ranges)
        each_cpu = (process_time() - cpu) / len(self.settings)
        each_wall = (perf_counter() - wall) / len(self.settings)
        together = self._together(found, each_cpu, each_wall)
        return [next(together) if result is None else result for result in found.results]

    def _together(self, batch: Batch, cpu: float, wall: float) -> Iterator[Result]:
        """Yield the results of those gears that were followed together, in their order."""
        found = batch.found
        if found is None:
            return
        rows, fidelity = np.flatnonzero(batch.in_loop).tolist(), self.fidelity.model_dump()
        metrics, counters = _rows(found.summary, rows), _rows(found.counters, rows)
        for row, own, counted in zip(rows, metrics, counters, strict=True):
            gear = self.gear.replace(self.settings[row])
            yield Result(
                scene=self.scene,
                gear=gear,
                fidelity=fidelity,
                solver={"name": "equilibrium", "tolerance": TOLERANCE},
                findings={"together": FINDING},
                status=Status.OK,
                message=joined_text(found.remarks[row]),
                codes=each_once(remark.code for remark in found.remarks[row]),
                signals=found.signals_of(row),
                summary=own,
                counters={name: int(count) for name, count in counted.items()},
                geometry=geometry_report(gear).numbers,
                cpu_s=cpu,
                wall_s=wall,
            )


def _rows(columns: Mapping[str, np.ndarray], rows: Sequence[int]) -> Iterator[dict[str, float]]:
    """Yield the numbers of rows, without those that are nan."""
    for numbers in np.array([values[rows] for values in columns.values()]).T.tolist():
        yield {name: value for name, value in zip(columns, numbers, strict=True) if value == value}
