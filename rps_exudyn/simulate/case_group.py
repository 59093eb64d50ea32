"""Cases of one design at once, by `batch`: each becomes the result that a study keeps.

Results of gears that were followed together have no counters and no geometry; the finding "together" says so.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter, process_time
from typing import Any, Literal

import numpy as np

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.simulate.batch import TORQUE, Batch, batch

FINDING = "many gears followed together: mean within 1e-4, peak to peak mostly within 1 %"


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
        alone = signals is not None and set(signals) <= {*TORQUE.get(self.scene, ())}
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
        numbers = np.array([values[rows] for values in found.summary.values()]).T.tolist()
        for row, figures in zip(rows, numbers, strict=True):
            yield Result(
                scene=self.scene,
                gear=self.gear.replace(self.settings[row]),
                fidelity=fidelity,
                solver={},
                findings={"together": FINDING},
                status=Status.OK,
                message=found.messages[row],
                signals=found.signals_of(row),
                summary={
                    name: value
                    for name, value in zip(found.summary, figures, strict=True)
                    if not np.isnan(value)
                },
                cpu_s=cpu,
                wall_s=wall,
            )
