"""Many gears of one design in one scene: a table of parameter values in, figures and curves out.

    found = batch("free-pinion-torque", gear, {"pinion.runout": runouts, "yoke.preload": preloads})
    found.summary["torque_mean"]                      # (n,), nan where the gear failed
    found.curves("pinion_torque", angles)             # (n, angles)

Every row ends as a single run of that gear would: same equations, statuses, messages and figures.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rps_exudyn.analysis.passes import longest_pass
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result, failed
from rps_exudyn.scenes import scene_named
from rps_exudyn.simulate.run import simulate


@dataclass(frozen=True, eq=False)
class Batch:
    """What became of n gears, in the order of the table's rows. All values are SI."""

    results: tuple[Result, ...]

    def __len__(self) -> int:
        return len(self.results)

    @property
    def statuses(self) -> tuple[Status, ...]:
        """How each gear ended."""
        return tuple(result.status for result in self.results)

    @property
    def messages(self) -> tuple[str, ...]:
        """Cause of each failure, or remarks on a gear that ended ok."""
        return tuple(result.message for result in self.results)

    @property
    def ok(self) -> np.ndarray:
        """Which gears ended ok, shape (n,); only their numbers may be used."""
        return np.array([status is Status.OK for status in self.statuses], dtype=bool)

    @property
    def summary(self) -> dict[str, np.ndarray]:
        """Figures by the names of `quantities`, shape (n,) each; nan where a gear has none."""
        names = dict.fromkeys(name for result in self.results for name in result.summary)
        return {
            name: np.array([result.summary.get(name, np.nan) for result in self.results]) for name in names
        }

    def curves(self, name: str, angle: np.ndarray, direction: int = +1) -> np.ndarray:
        """Return a signal over pinion angles.

        Args:
            name: of the signal, by `quantities`.
            angle: rising pinion angles [rad], shape (m,).
            direction: sense in which the pinion turns, +1 moves the rack along +X.

        Returns:
            Values (n, m), between instants on straight lines; nan beyond what was recorded, and for gears
            that did not end ok.
        """
        found = np.full((len(self.results), len(angle)), np.nan)
        for row, result in zip(found, self.results, strict=True):
            turned = longest_pass(result.signals, direction) if result.status is Status.OK else None
            if turned is not None and name in turned.signals:
                inside = (angle >= turned.angle.min()) & (angle <= turned.angle.max())
                row[inside] = turned.over(angle[inside], name)
        return found


def batch(
    scene: str,
    gear: SteeringGear,
    values: Mapping[str, Sequence[Any] | np.ndarray],
    *,
    fidelity: str | Fidelity = "quasi-static",
) -> Batch:
    """Simulate gears that differ from one in the parameters of a table.

    Each row is simulated on its own; a gear that cannot exist is a row with the status `invalid`, and its
    message says why.

    Args:
        scene: one of `scenes.SCENE_NAMES`.
        gear: what all have in common.
        values: path of a parameter -> its n values, SI or text with a unit.
        fidelity: name of a preset, or a `Fidelity`.

    Raises:
        InputError: no such scene, fidelity or parameter, or columns of different length.
    """
    scene_named(scene)
    chosen = fidelity if isinstance(fidelity, Fidelity) else Fidelity.preset(fidelity)
    rows = rows_of(values)
    return Batch(tuple(_row(scene, gear, row, chosen) for row in rows))


def rows_of(values: Mapping[str, Sequence[Any] | np.ndarray]) -> list[dict[str, Any]]:
    """Return the settings of each row of a table.

    Raises:
        InputError: no column, a path that is no parameter, or columns of different length.
    """
    for path in values:
        if len(SteeringGear.declared_at(path)) != 1:
            raise InputError(f"{path} is a table of parameters; each column must be a single parameter.")
    lengths = {path: len(column) for path, column in values.items()}
    if not lengths:
        raise InputError("the table of a batch has no column; give at least one parameter and its values.")
    if len(set(lengths.values())) > 1:
        shown = ", ".join(f"{path} has {length}" for path, length in lengths.items())
        raise InputError(f"the columns of a batch differ in length: {shown}; each must have one value a row.")
    columns = [np.asarray(column).tolist() for column in values.values()]
    return [dict(zip(values, row, strict=True)) for row in zip(*columns, strict=True)]


def _row(scene: str, gear: SteeringGear, settings: Mapping[str, Any], fidelity: Fidelity) -> Result:
    try:
        varied = gear.replace(settings)
        return simulate(scene, varied, fidelity)
    except InputError as error:  # a value that is not allowed, a gear that cannot be built
        status, message = Status.INVALID, " ".join(error.problems)
    except Exception as error:
        status, message = Status.CRASHED, f"{type(error).__name__}: {error}"
    return failed(scene, gear, fidelity, status, message)
