"""Derivatives of metrics by parameters beside differences of single runs with the same step."""

from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from xarray import Dataset

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.inference.uncertainty.sensitivities import LINE_STIFFNESS
from rps_exudyn.parameters.fidelity import FOR_MEANS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.scenes.scene import WITHOUT_BARS
from rps_exudyn.simulate.run_plan import Plan


@dataclass(frozen=True)
class Slopes:
    """Slopes (n,) of all metrics by all parameters, their stated errors, and the differences; SI."""

    slope: np.ndarray
    error: np.ndarray
    difference: np.ndarray

    @property
    def apart(self) -> np.ndarray:
        """How far slopes and differences are apart."""
        return np.asarray(np.abs(self.slope - self.difference))

    @property
    def size(self) -> np.ndarray:
        """The larger one of both."""
        return np.maximum(np.abs(self.slope), np.abs(self.difference))


def beside_single_runs(scene: str, gear: SteeringGear, found: Dataset) -> Slopes:
    """Return the derivatives of a gear beside those by single runs: central differences, or differences to
    the gear itself where one side is not allowed; without what has neither."""
    metrics = found["metric"].values.tolist()
    same = gear.replace({"mesh.law": found.attrs["contact_law"]})
    middle, differences = _metrics_of(scene, same, metrics), []
    for path, step in zip(found["parameter"].values.tolist(), found["step"].values, strict=True):
        value = float(same.value_at(path))
        if path == LINE_STIFFNESS and not value:
            value = line_stiffness(same)
        high, low = (_metrics_of(scene, same, metrics, {path: value + side * step}) for side in (1, -1))
        steps = step * sum(bool(np.isfinite(side).any()) for side in (high, low))
        differences.append((_known(high, middle) - _known(low, middle)) / (steps or np.nan))
    columns = found["slope"].values.T.ravel(), found["error"].values.T.ravel(), np.ravel(differences)
    known = np.isfinite(columns).all(axis=0)
    return Slopes(*(each[known] for each in columns))


def _metrics_of(
    scene: str, gear: SteeringGear, metrics: list[str], settings: dict[str, float] | None = None
) -> np.ndarray:
    """Metrics of a single run; nan where the gear is not allowed or does not end ok."""
    with suppress(InputError):
        result = Plan(scene, gear.replace(settings or {}), FOR_MEANS).run(WITHOUT_BARS)
        if result.status is Status.OK:
            return np.array([result.summary.get(name, np.nan) for name in metrics])
    return np.full(len(metrics), np.nan)


def _known(side: np.ndarray, middle: np.ndarray) -> np.ndarray:
    return side if np.isfinite(side).any() else middle
