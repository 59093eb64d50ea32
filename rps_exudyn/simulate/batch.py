"""Many gears of one design in one scene: a table of parameter values in, metrics and curves out.

    found = batch("free-pinion-torque", gear, {"pinion.runout": runouts, "yoke.preload": preloads})
    found.summary["torque_mean"]                      # (n,), nan where the gear failed
    found.curves("pinion_torque", angles)             # (n, angles)

Every row ends as a single run of that gear would: same equations, statuses, messages and metrics.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np

from rps_exudyn.analysis.passes import longest_pass
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import shown
from rps_exudyn.parameters.declaration import check_settings
from rps_exudyn.parameters.fidelity import Fidelity, check_fidelity
from rps_exudyn.parameters.gear import SteeringGear, check_gear
from rps_exudyn.results.outcome import Status, joined_text
from rps_exudyn.results.quantities import SIGNALS, SUMMARY
from rps_exudyn.results.result import Result, failed
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.contact_law import resolve_contact_law
from rps_exudyn.simulate.cases.task import Task, answer_to
from rps_exudyn.simulate.gear_table import UNSUPPORTED, GearTable, simulate_table, unsupported_reason
from rps_exudyn.simulate.run import simulate

ROUNDING = 1e-9  # of an angle [rad]


class Columns(dict[str, np.ndarray]):
    """Metrics of n gears by name, shape (n,) each; a declared metric that no gear has is a column of nan."""

    def __init__(self, count: int) -> None:
        super().__init__()
        self._count = count

    def __missing__(self, name: str) -> np.ndarray:
        if name not in SUMMARY:
            raise KeyError(name)
        return np.full(self._count, np.nan)


@dataclass(frozen=True, eq=False)
class Batch:
    """What became of n gears, in the order of the table's rows. All values are SI.

    Attributes:
        results: of the rows that were simulated one by one; None where gears were computed together.
        found: these; None if none were.
        single_run_reason: why all rows were simulated one by one; "" if they were not.

    Examples:
        >>> gears = rps.batch("free-pinion-torque", rps.SteeringGear(), {"mesh.friction": [0.05, 0.1]})
        >>> len(gears), gears.statuses[0].value
        (2, 'ok')
    """

    results: tuple[Result | None, ...]
    found: GearTable | None = None
    single_run_reason: str = ""

    def __len__(self) -> int:
        return len(self.results)

    @property
    def alone(self) -> str:
        """The former name of `single_run_reason`."""
        return self.single_run_reason

    @property
    def in_loop(self) -> np.ndarray:
        """Which rows were computed together, shape (n,), see `batch`."""
        return np.array([result is None for result in self.results], dtype=bool)

    @property
    def statuses(self) -> tuple[Status, ...]:
        """How each gear ended."""
        return tuple(Status.OK if result is None else result.status for result in self.results)

    @property
    def messages(self) -> tuple[str, ...]:
        """Cause of each failure, or remarks on a gear that ended ok."""
        together = [[]] * len(self) if self.found is None else self.found.remarks
        return tuple(
            joined_text(remarks) if result is None else result.message
            for result, remarks in zip(self.results, together, strict=True)
        )

    @property
    def ok(self) -> np.ndarray:
        """Which gears ended ok, shape (n,); only their numbers may be used."""
        return np.array([status is Status.OK for status in self.statuses], dtype=bool)

    @property
    def errors(self) -> Columns:
        """Half widths of the metrics' error bars, shape (n,) each; nan where a gear has none."""
        return self._columns("errors", {})

    @property
    def summary(self) -> Columns:
        """Metrics by the names of `quantities`, shape (n,) each; nan where a gear has none; where every gear
        failed, the scene's own main metric.
        """
        scenes = (scene_named(result.scene) for result in self.results if result)
        return self._columns("summary", dict.fromkeys(scene.main_metric for scene in scenes))

    def _columns(self, group: str, usual: Mapping[str, Any]) -> Columns:
        """Numbers of a group of each result; without any, the usual names."""
        known = {} if self.found is None else getattr(self.found, group)
        rows = [{} if result is None else getattr(result, group) for result in self.results]
        names = dict.fromkeys(name for row in rows for name in row)
        columns = Columns(len(self))
        for name in {**known, **names} or usual:
            column = np.array([row.get(name, np.nan) for row in rows])
            columns[name] = np.where(self.in_loop, known[name], column) if name in known else column
        return columns

    def curves(self, name: str, angle: np.ndarray, direction: int = +1) -> np.ndarray:
        """Return a signal over pinion angles.

        Args:
            name: of the signal, by `quantities`; with `keep` = "torque" one of the scene's `test.curve`.
            angle: rising pinion angles [rad], shape (m,).
            direction: sense in which the pinion turns, +1 moves the rack along +X.

        Returns:
            Values (n, m), between instants on straight lines; nan beyond what was recorded, and for gears
            that did not end ok.

        Raises:
            InputError: no signal has this name.
        """
        if name not in SIGNALS:
            raise InputError(f"{name!r} is no signal; `quantities` lists them, such as pinion_torque.")
        angle = np.asarray(angle)
        if angle.ndim != 1:
            raise InputError(f"angle is {shown(angle.tolist())}; it must be a list of angles.")
        found = np.full((len(self.results), len(angle)), np.nan)
        for i, (row, result) in enumerate(zip(found, self.results, strict=True)):
            if result is None:
                assert self.found is not None
                turned, about = longest_pass(self.found.signals_of(i), direction), ROUNDING
            else:
                signals = result.signals if result.status is Status.OK else {}
                turned, about = longest_pass(signals, direction), 0.0
            if turned is not None and name in turned.signals:
                inside = (angle >= turned.angle.min() - about) & (angle <= turned.angle.max() + about)
                row[inside] = turned.over(angle[inside], name)
        return found


def batch(
    scene: str,
    gear: SteeringGear,
    values: Mapping[str, Sequence[Any] | np.ndarray],
    *,
    fidelity: str | Fidelity = "quasi-static",
    keep: Literal["signals", "torque"] = "signals",
    ranges: Mapping[str, Sequence[float] | np.ndarray] | None = None,
) -> Batch:
    """Simulate gears that differ from one in the parameters of a table.

    Each row is a gear of its own; one that cannot exist is a row with the status `invalid`, and its message
    states why.

    The gears of a free pinion torque, a load test or a rack push are computed together. That is several times
    as fast as one by one, by the same equations at the same instants. Means are within 1e-5, other metrics
    mostly within 1e-3 of single runs. What is not supported (`gear_table.UNSUPPORTED`) or not found well
    within the bounds of all checks is simulated one by one; see `in_loop` and `single_run_reason`. So are
    tables of few gears.

    Args:
        scene: one of `scenes.SCENE_NAMES`.
        gear: what all have in common, the contact law by scene too.
        values: path of a parameter -> its n values, SI or text with a unit.
        fidelity: name of a preset, or a `Fidelity`.
        keep: "signals", all of them; or "torque", the curve of the drive's torque or force, and metrics.
        ranges: of a table that is a part of a larger one: path -> values over which that one varies, SI; so
            each gear ends the same in whichever part it is.

    Raises:
        InputError: no such scene, fidelity or parameter, columns of different length, or nothing of that name
            to keep.

    Examples:
        >>> table = {"yoke.preload": ["250 N", "350 N"]}
        >>> gears = rps.batch("free-pinion-torque", rps.SteeringGear(), table, fidelity="closed-form")
        >>> gears.ok.tolist(), gears.summary["torque_mean"].round(2).tolist()
        ([True, True], [0.54, 0.69])
    """
    chosen_scene = scene_named(scene)
    if keep not in ("signals", "torque"):
        raise InputError(f"keep is {keep!r}; it must be signals or torque.")
    check_gear(gear)
    check_fidelity(fidelity)
    check_settings(ranges or {})
    chosen = fidelity if isinstance(fidelity, Fidelity) else Fidelity.preset(fidelity)
    rows = rows_of(values)
    if "mesh.law" not in values:
        gear = resolve_contact_law(gear, chosen, chosen_scene.law, values)
    kept = chosen_scene.test.curve if keep == "torque" and chosen_scene.test else None
    found, reason = None, unsupported_reason(scene, gear, chosen, values)
    if not reason:
        of_ranges = None if ranges is None else _numbers(ranges)
        found = simulate_table(scene, gear, chosen, _numbers(values), of_ranges, kept)
        reason = "" if found else UNSUPPORTED["few"]
    ended = [False] * len(rows) if found is None else found.ended
    results = (
        None if done else _row(scene, gear, row, chosen) for row, done in zip(rows, ended, strict=True)
    )
    return Batch(tuple(results), found, reason)


def _numbers(values: Mapping[str, Any]) -> dict[str, np.ndarray]:
    return {path: np.asarray(each, dtype=float) for path, each in values.items()}


def rows_of(values: Mapping[str, Sequence[Any] | np.ndarray]) -> list[dict[str, Any]]:
    """Return the settings of each row of a table.

    Raises:
        InputError: no column, a path that is no parameter, or columns of different length.
    """
    check_settings(values)
    for path in values:
        if len(SteeringGear.declared_at(path)) != 1:
            raise InputError(f"{path} is a table of parameters; each column must be a single parameter.")
    for path, column in values.items():
        if isinstance(column, str | Mapping) or np.array(column, dtype=object).ndim != 1:
            raise InputError(f"{path} is {shown(column)}; a column must be a list, one value a row.")
    lengths = {path: len(column) for path, column in values.items()}
    if not lengths:
        raise InputError("the table of a batch has no column; give at least one parameter and its values.")
    if len(set(lengths.values())) > 1:
        each = ", ".join(f"{path} has {length}" for path, length in lengths.items())
        raise InputError(f"the columns of a batch differ in length: {each}; each must have one value a row.")
    if 0 in lengths.values():
        raise InputError(f"{next(iter(lengths))} has no value; a batch needs at least one row.")
    columns = [np.asarray(column).tolist() for column in values.values()]
    return [dict(zip(values, row, strict=True)) for row in zip(*columns, strict=True)]


def _row(scene: str, gear: SteeringGear, settings: Mapping[str, Any], fidelity: Fidelity) -> Result:
    try:
        varied = gear.replace(settings)
    except InputError as error:  # a value that is not allowed
        return failed(scene, gear, fidelity, Status.INVALID, " ".join(error.problems))
    return answer_to(Task(partial(simulate, scene, varied, fidelity))).result(scene, varied, fidelity)
