"""Cases of one design at once, by `batch`: each becomes the result that a study keeps.

Where no more than the torque or force of the drive is kept, most gears of a free pinion torque, a load test
or a rack push come from the loop over many gears. Their results hold what the loop knows: that curve and its
figures, without counters and geometry; the finding "loop" says so.
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
from rps_exudyn.simulate.batch import Batch, batch
from rps_exudyn.simulate.loop_legs import SIGNALS

FINDING = "figures by the loop over many gears: mean within 1e-4, peak to peak mostly within 1 %"


def torque_alone(scene: str, signals: Sequence[str] | None) -> bool:
    """Tell whether what a study keeps is no more than the loop knows of its scene; None keeps all signals."""
    return signals is not None and set(signals) <= {*SIGNALS.get(scene, ())}


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
        keep: Literal["torque", "signals"] = "torque" if torque_alone(self.scene, signals) else "signals"
        found = batch(self.scene, self.gear, table, fidelity=self.fidelity, keep=keep, ranges=self.ranges)
        each_cpu = (process_time() - cpu) / len(self.settings)
        each_wall = (perf_counter() - wall) / len(self.settings)
        looped = self._looped(found, each_cpu, each_wall)
        return [next(looped) if result is None else result for result in found.results]

    def _looped(self, batch: Batch, cpu: float, wall: float) -> Iterator[Result]:
        """Yield the results of those gears that the loop found, in their order."""
        loop = batch.found
        if loop is None:
            return
        rows, fidelity = np.flatnonzero(batch.in_loop).tolist(), self.fidelity.model_dump()
        numbers = np.array([values[rows] for values in loop.summary.values()]).T.tolist()
        for row, figures in zip(rows, numbers, strict=True):
            yield Result(
                scene=self.scene,
                gear=self.gear.replace(self.settings[row]),
                fidelity=fidelity,
                solver={},
                findings={"loop": FINDING},
                status=Status.OK,
                message=loop.messages[row],
                signals=loop.signals_of(row),
                summary={
                    name: value
                    for name, value in zip(loop.summary, figures, strict=True)
                    if not np.isnan(value)
                },
                cpu_s=cpu,
                wall_s=wall,
            )
