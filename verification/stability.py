"""Whether a plan's number is right, compared with the same maneuver in small steps; and where it stops being.

plan = ScenePlan("free-pinion-torque", gear, fidelity)
result = unchecked(plan)                            # ok if the solver reached its end
cell_of(plan, result, reference(plan, plan.main_metric(result)))   # right, inaccurate, wrong, failed
limit = bisected(lambda h: cell(h) is Cell.RIGHT, 1e-4, 1e-2)
"""

import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Outcome, Status
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.checks.after_run import validated
from rps_exudyn.scenes.checks.rules import refused
from rps_exudyn.scenes.maneuver import StepLimits
from rps_exudyn.scenes.scene import RunOptions
from rps_exudyn.simulate.cases.time_limit import dropped_rings_again
from rps_exudyn.simulate.run_plan import run_unchecked

INACCURATE, WRONG = 0.01, 0.05  # error of the main metric
RESIDUAL_BOUND = 0.05  # of the work
STILL = {"solver": "equilibrium", "step_angle": np.deg2rad(0.25), "bush": "condensed"}
SLOW = {"solver": "generalized-alpha", "step_angle": np.deg2rad(0.2)}
STRIP = {"mesh": "flank", "strip_stations": 6, "strip_points": 4}
REFERENCES = (
    STILL | STRIP,
    STILL | STRIP | SLOW,
    STRIP | SLOW,
)


Choices = Mapping[str, Any]
"""Choice of a fidelity -> value."""


class Cell(StrEnum):
    """One point of a stability map."""

    RIGHT = "right"
    INACCURATE = "inaccurate"  # by more than 1 %
    WRONG = "wrong"  # it ends normally, by more than 5 % wrong, or its work does not add up
    FAILED = "failed"  # and says so
    NOT_COMPUTED = "not computed"


@dataclass(frozen=True)
class ScenePlan:
    """A gear in a scene, and how it is modelled."""

    scene: str
    gear: SteeringGear
    fidelity: Fidelity

    def with_step(self, degrees: float) -> "ScenePlan":
        """The same plan in steps of this pinion angle [deg]."""
        return ScenePlan(self.scene, self.gear, self.fidelity.replace({"step_angle": np.deg2rad(degrees)}))

    def main_metric(self, result: Result) -> float:
        """The number that must be right; nan if there is none."""
        return float(result.summary.get(scene_named(self.scene).main_metric, float("nan")))


@dataclass(frozen=True)
class Line:
    """A predicted limit in a map: a value of y at each x, nan where there is none."""

    label: str
    y: list[float]


@dataclass(frozen=True)
class StabilityMap:
    """Cells over two axes, in display units, and the limits that theory predicts in them."""

    title: str
    x_name: str
    y_name: str
    x: list[float]
    y: list[float]
    cells: list[list[str]]  # [y][x]
    flagged: list[list[bool]]  # whether the checks before or after the run object
    lines: list[Line]


AS_ASKED = StepLimits(per_period=1, of_part=1)  # no finer steps than the fidelity asks for


def unchecked(plan: ScenePlan) -> Result:
    """Run in steps as asked, without any check: ok is what the solver calls a success."""
    return run_and_check(plan)[0]


def run_and_check(plan: ScenePlan) -> tuple[Result, bool]:
    """Run unchecked, and say whether a check before or after the run objects."""
    verdicts: list[Outcome] = []

    def noted(outcome: Outcome, *seen: Any) -> Outcome:
        verdicts.append(validated(outcome, *seen))
        return outcome

    options = RunOptions(check=noted, least_steps=AS_ASKED, bars=False)
    result = run_unchecked(plan.scene, plan.gear, plan.fidelity, options)
    against = any(verdict.status is not Status.OK for verdict in verdicts)
    return result, against or bool(refused(plan.gear, plan.fidelity, motion=scene_named(plan.scene).motion))


@contextmanager
def cpu_time_limit(seconds: float) -> Iterator[None]:
    """Limit the CPU time of a block; a force law that Exudyn calls raises too, and the run then fails.

    Raises:
        TimeoutError: the time is over.
    """

    def over(number: int, frame: Any) -> None:
        raise TimeoutError(f"more than {seconds:g} s of CPU time")

    before = signal.signal(signal.SIGVTALRM, over)
    with dropped_rings_again(TimeoutError, signal.ITIMER_VIRTUAL):
        signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_VIRTUAL, 0)
            signal.signal(signal.SIGVTALRM, before)


def reference(plan: ScenePlan, methods: Sequence[Choices] = REFERENCES) -> float:
    """The main metric of a maneuver in small steps: that of the first method with which a later one agrees
    to `INACCURATE`, or of the first that is ok where none do; nan if none is.

    One of the plan's own kind is asked first, dynamics or equilibria, which differ where inertia matters.
    What the plan gives is not looked at.
    """
    found: list[float] = []
    for changes in _in_order(plan, methods):
        try:
            result = run_unchecked(plan.scene, plan.gear, _of_the_same_bush(plan.fidelity, changes))
        except InputError:
            break
        if result.status is not Status.OK:
            continue
        main_metric = plan.main_metric(result)
        for before in found:
            if abs(error_of(main_metric, before)) <= INACCURATE:
                return before
        found.append(main_metric)
    return found[0] if found else float("nan")


def _of_the_same_bush(fidelity: Fidelity, changes: Choices) -> Fidelity:
    """A reference's model; a chain of segments is condensed to what it is at rest, any other bush stays."""
    kept = fidelity.bush if "chain" not in fidelity.bush else changes.get("bush", fidelity.bush)
    return fidelity.replace({**changes, "bush": kept})


def _in_order(plan: ScenePlan, methods: Sequence[Choices]) -> list[Choices]:
    """Return one of the plan's own kind, then equilibria, which are cheap, then dynamics."""
    own = plan.fidelity.solver
    solvers = [changes.get("solver", own) for changes in methods]
    first = solvers.index(own) if own in solvers else 0
    ranks = [(i != first, solver != "equilibrium") for i, solver in enumerate(solvers)]
    return [methods[i] for i in sorted(range(len(methods)), key=ranks.__getitem__)]


def error_of(value: float, true: float) -> float:
    """Relative error; nan without a reference."""
    return value / true - 1 if true else float("nan")


def cell_of(plan: ScenePlan, result: Result, true: float) -> Cell:
    """Return what a map shows of an unchecked run."""
    if result.status is not Status.OK:
        return Cell.FAILED
    error = abs(error_of(plan.main_metric(result), true))
    residual = abs(result.summary.get("energy_residual", 0.0))
    if not (error <= WRONG and residual <= RESIDUAL_BOUND):
        return Cell.WRONG
    return Cell.INACCURATE if error > INACCURATE else Cell.RIGHT


def bisected(holds: Callable[[float], bool], good: float, bad: float, ratio: float = 1.05) -> float:
    """The limit between a value that holds and one that does not, within `ratio`, on a logarithmic scale.

    Either may be the larger. It is nan if `good` does not hold, and `bad` if that holds too.
    """
    if not holds(good):
        return float("nan")
    if holds(bad):
        return bad
    while max(good / bad, bad / good) > ratio:
        middle = float(np.sqrt(good * bad))
        good, bad = (middle, bad) if holds(middle) else (good, middle)
    return float(np.sqrt(good * bad))
