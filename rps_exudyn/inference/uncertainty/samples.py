"""Draws of the uncertain inputs, and the runs of a scene at them."""

from collections.abc import Generator, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from rps_exudyn.inference.uncertainty.joint import JointInputs
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.simulate.batch import Batch, batch
from rps_exudyn.simulate.cases.run_cases import run_cases
from rps_exudyn.simulate.cases.task import Task
from rps_exudyn.simulate.gear_table import fewest, unsupported_reason

TOGETHER = 256  # gears that are computed together at once


@dataclass(frozen=True, eq=False)
class Samples:
    """Points drawn from the distributions of inputs."""

    inputs: JointInputs  # path -> distribution
    quantile: np.ndarray  # of each input at each point, 0 to 1, shape (n, inputs)

    @classmethod
    def drawn(cls, inputs: Mapping[str, Distribution], count: int, seed: int) -> "Samples":
        """Draw a Latin hypercube: even in each input, and independent enough to separate the inputs; then
        let vary together what does (`JointInputs`)."""
        from scipy.stats import qmc  # loads in a second

        points = qmc.LatinHypercube(len(inputs), rng=np.random.default_rng(seed)).random(count)
        joint = JointInputs.of(inputs)
        return cls(joint, joint.joined(points, seed))

    def __len__(self) -> int:
        return len(self.quantile)

    @property
    def values(self) -> dict[str, np.ndarray]:
        """Path -> values in SI, shape (n,)."""
        return {
            path: np.asarray(each.quantile(self.quantile[:, i]), dtype=float)
            for i, (path, each) in enumerate(self.inputs.items())
        }

    def settings(self) -> Iterator[dict[str, float]]:
        values = self.values
        for row in zip(*(column.tolist() for column in values.values()), strict=True):
            yield dict(zip(values, row, strict=True))


def runs_at(
    scene: str,
    gear: SteeringGear,
    fidelity: Fidelity,
    points: Samples,
    jobs: int = 1,
    time_limit: float = float("inf"),
) -> Generator[tuple[range, Batch]]:
    """Yield the runs of the scene at the points, whatever their outcome, part by part as they end: numbers of
    the part's points, and its runs.

    What a part gives depends neither on other parts nor on the number of processes. A part that does not end
    is done again, run by run: in the same way, and where that takes too long by single runs. The time limit
    [s] is that of a run, or of a part that is computed together.
    """
    values, count = points.values, len(points)
    singly = bool(unsupported_reason(scene, gear, fidelity, values)) or count < fewest(values)
    keep: Literal["signals", "torque"] = "signals" if singly else "torque"
    size, ranges = (1, None) if singly else (TOGETHER, values)
    waiting = [(range(begin, min(begin + size, count)), ranges) for begin in range(0, count, size)]
    while waiting:
        tasks: dict[Task, tuple[range, dict[str, np.ndarray] | None]] = {}
        for rows, learned in waiting:
            part = {path: column[rows.start : rows.stop] for path, column in values.items()}
            call = partial(batch, scene, gear, part, fidelity=fidelity, keep=keep, ranges=learned)
            tasks[Task(call)] = rows, learned
        waiting = []
        for task, answer in run_cases(list(tasks), jobs, time_limit):
            rows, learned = tasks[task]
            if answer.value is not None:
                yield rows, answer.value
            elif len(rows) > 1:
                waiting += [(range(row, row + 1), learned) for row in rows]
            elif learned is not None and answer.failed_by_itself:
                waiting.append((rows, None))
            else:
                yield rows, Batch((answer.failure(scene, gear, fidelity),))
