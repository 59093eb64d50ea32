"""Whether a plan's number is right, against the same maneuver in small steps; and where it stops being.

plan = Plan("free-pinion-torque", gear, fidelity)
trial = unchecked(plan)                    as if nothing were checked but that the solver got to its end
cell_of(trial, reference(plan, ...))   right, inaccurate, wrong, failed, not computed
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
from rps_exudyn.checks.after_run import validated
from rps_exudyn.checks.before_run import refused
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Outcome, Status
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.maneuver import StepLimits
from rps_exudyn.scenes.run_options import RunOptions
from rps_exudyn.simulate.checked_run import run_unchecked

FIGURE = {
    "free-pinion-torque": "torque_mean",
    "rack-push": "push_force_mean",
    "load-test": "torque_forward",
    "reversal": "hysteresis_area",
}
"""Scene -> the figure that must be right."""

INACCURATE, WRONG = 0.01, 0.05  # error of the figure
RESIDUAL_BOUND = 0.05  # of the work
STILL = {"solver": "equilibrium", "step_angle": np.deg2rad(0.25), "bush": "condensed"}
SLOW = {"solver": "generalized-alpha", "step_angle": np.deg2rad(0.2)}
STRIP = {"mesh": "flank", "strip_stations": 6, "strip_points": 4}
GENERATORS = {"mesh": "flank-generators", "generators": 320}
REFERENCES = (
    STILL | STRIP,
    STILL | GENERATORS,
    STILL | STRIP | SLOW,
    STRIP | SLOW,
    STILL | GENERATORS | SLOW,
)


Choices = Mapping[str, Any]  # of a fidelity


class Cell(StrEnum):
    """One point of a stability map."""

    RIGHT = "right"
    INACCURATE = "inaccurate"  # by more than 1 %
    WRONG = "wrong"  # it ends normally, by more than 5 % wrong, or its work does not add up
    FAILED = "failed"  # and says so
    NOT_COMPUTED = "not computed"


@dataclass(frozen=True)
class Plan:
    """A gear in a scene, and how it is modelled."""

    scene: str
    gear: SteeringGear
    fidelity: Fidelity

    def with_step(self, degrees: float) -> "Plan":
        """The same in steps of so many degrees of the pinion's angle."""
        return Plan(self.scene, self.gear, self.fidelity.replace({"step_angle": np.deg2rad(degrees)}))

    def figure(self, result: Result) -> float:
        """The number that must be right; nan if there is none."""
        return float(result.summary.get(FIGURE[self.scene], float("nan")))


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
    told: list[list[bool]]  # whether guards or judge would not let it pass
    lines: list[Line]


AS_ASKED = StepLimits(per_period=1, of_part=1)  # no finer steps than the fidelity asks for


def unchecked(plan: Plan) -> Result:
    """Run in steps as asked without any check: ok is what the solver calls a success."""
    return run_and_check(plan)[0]


def run_and_check(plan: Plan) -> tuple[Result, bool]:
    """Run the same, and tell whether a check before or after it would have refused it."""
    verdicts: list[Outcome] = []

    def only_noted(outcome: Outcome, *seen: Any) -> Outcome:
        verdicts.append(validated(outcome, *seen))
        return outcome

    options = RunOptions(check=only_noted, least_steps=AS_ASKED)
    result = run_unchecked(plan.scene, plan.gear, plan.fidelity, options)
    against = any(verdict.status is not Status.OK for verdict in verdicts)
    return result, against or bool(refused(plan.gear, plan.fidelity, steady=scene_named(plan.scene).steady))


@contextmanager
def processor_time(seconds: float) -> Iterator[None]:
    """Within the block Python raises after so much CPU time; a force law that Exudyn calls does too,
    and the run then ends without convergence.

    Raises:
        TimeoutError: the time is over.
    """

    def over(number: int, frame: Any) -> None:
        raise TimeoutError(f"more than {seconds:g} s of CPU time")

    before = signal.signal(signal.SIGVTALRM, over)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


def reference(plan: Plan, value: float, methods: Sequence[Choices] = REFERENCES) -> float:
    """The figure of the same maneuver from equilibria or dynamics in small steps, nan if none is sound.

    Both are right answers where inertia matters: of several the one nearest to `value` is returned.
    """
    found: list[float] = []
    for changes in methods:
        if found and (abs(error_of(value, found[-1])) <= INACCURATE or value != value):
            break
        try:
            result = run_unchecked(plan.scene, plan.gear, plan.fidelity.replace(changes))
        except InputError:
            break
        if result.status is Status.OK:
            found.append(plan.figure(result))
    return min(found, key=lambda true: abs(error_of(value, true)), default=float("nan"))


def error_of(value: float, true: float) -> float:
    """Relative error; nan without a reference."""
    return value / true - 1 if true else float("nan")


def cell_of(plan: Plan, result: Result, true: float) -> Cell:
    """What a map shows of a run that nobody checked."""
    if result.status is not Status.OK:
        return Cell.FAILED
    error = abs(error_of(plan.figure(result), true))
    residual = abs(result.summary.get("energy_residual", 0.0))
    if not (error <= WRONG and residual <= RESIDUAL_BOUND):
        return Cell.WRONG
    return Cell.INACCURATE if error > INACCURATE else Cell.RIGHT


def bisected(holds: Callable[[float], bool], good: float, bad: float, ratio: float = 1.05) -> float:
    """The limit between a value that holds and one that does not, to 5 %, on a logarithmic scale.

    Either may be the larger; nan if not `good` holds, `bad` if it holds too.
    """
    if not holds(good):
        return float("nan")
    if holds(bad):
        return bad
    while max(good / bad, bad / good) > ratio:
        middle = float(np.sqrt(good * bad))
        good, bad = (middle, bad) if holds(middle) else (good, middle)
    return float(np.sqrt(good * bad))
