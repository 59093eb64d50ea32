"""Draws of the uncertain inputs, and the runs of a scene at them."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.simulate.batch import Batch, batch
from rps_exudyn.simulate.together import unsupported_reason

TOGETHER, MANY = 32, 1024  # runs between which Ctrl-C loses nothing: single ones, those found together


@dataclass(frozen=True, eq=False)
class Samples:
    """Points drawn from the distributions of inputs."""

    inputs: Mapping[str, Distribution]  # path -> distribution
    quantile: np.ndarray  # of each input at each point, 0 to 1, shape (n, inputs)

    @classmethod
    def drawn(cls, inputs: Mapping[str, Distribution], count: int, seed: int) -> "Samples":
        """Draw a Latin hypercube: even in each input, and independent enough to tell inputs apart."""
        from scipy.stats import qmc  # loads in a second

        points = qmc.LatinHypercube(len(inputs), rng=np.random.default_rng(seed)).random(count)
        return cls(inputs, points)

    def __len__(self) -> int:
        return len(self.quantile)

    def first(self, count: int) -> "Samples":
        """Return the first points."""
        return replace(self, quantile=self.quantile[:count])

    @property
    def values(self) -> dict[str, np.ndarray]:
        """Path -> values in SI, shape (n,)."""
        return {
            path: np.asarray(each.quantile(self.quantile[:, i]), dtype=float)
            for i, (path, each) in enumerate(self.inputs.items())
        }

    def settings(self) -> Iterator[dict[str, float]]:
        """Yield path -> value of each point."""
        values = self.values
        for row in zip(*(column.tolist() for column in values.values()), strict=True):
            yield dict(zip(values, row, strict=True))


def runs_at(scene: str, gear: SteeringGear, fidelity: Fidelity, points: Samples) -> Iterator[Batch]:
    """Yield the runs of the scene at the points, part by part, whatever their outcome; together where the
    scene does so."""
    values = points.values
    singly = bool(unsupported_reason(scene, gear, fidelity, values))
    keep: Literal["signals", "torque"] = "signals" if singly else "torque"
    together = TOGETHER if singly else MANY
    for begin in range(0, len(points), together):
        part = {path: column[begin : begin + together] for path, column in values.items()}
        yield batch(scene, gear, part, fidelity=fidelity, keep=keep)
