"""Right values of a plan's metrics, made without the ladder that its bars come from.

The scene's main metric comes from `plan_reference` and `behind_column` of verification, every other one from
finer runs in two lengths of steps.
"""

from collections.abc import Collection, Iterator
from math import isfinite

import numpy as np

from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.error_bars import size_of, sizes
from verification.behind_column import settled_metrics
from verification.plan_reference import expected, finer_metrics
from verification.refined_steps import NotFoundError
from verification.stability import ScenePlan, cpu_time_limit

REFERENCE_LIMIT = 10.0  # [s] of CPU time of a reference
BY_EQUATIONS = ("free-pinion-torque", "rack-push", "load-test", "reversal", "yoke-impact")
BEHIND_COLUMN = ("steering-feel", "stick-slip")
RIPPLES = ("torque_peak_to_peak", "push_force_peak_to_peak")

Values = dict[str, tuple[float, float]]
"""Metric -> its right value, and how far that can be doubted."""


def references(plan: ScenePlan, printed: Collection[str]) -> Iterator[tuple[str, Values]]:
    """Yield what each reference is, or why there is none, and the right values of printed metrics by it."""
    if plan.scene in BY_EQUATIONS:
        yield by_equations(plan, printed)
    if plan.scene in BEHIND_COLUMN:
        yield behind_column(plan)
    try:
        yield "finer runs", finer_metrics(plan)
    except NotFoundError as error:
        yield str(error), {}


def best_reference(plan: ScenePlan, name: str) -> tuple[str, float, float] | None:
    """Return what the surest reference of a metric is, its right value and how far that can be doubted; None
    if there is none."""
    every = [(how, *values[name]) for how, values in references(plan, [name]) if name in values]
    known = [each for each in every if isfinite(each[1]) and isfinite(each[2])]
    return min(known, key=lambda each: each[2], default=None)


def size_in(result: Result, name: str) -> float:
    """Return the size of a metric in a run, of which its error is a share."""
    of_run = sizes(dict(result.signals), result.summary)
    return float(size_of(name, result.summary[name], of_run))


def by_equations(plan: ScenePlan, printed: Collection[str]) -> tuple[str, Values]:
    """Return the scene's main metric and ripple by other methods than the package's."""
    try:
        with cpu_time_limit(REFERENCE_LIMIT):
            right = expected(plan)
    except TimeoutError as error:
        return str(error), {}
    if not isfinite(right.main_metric):
        return right.cause or right.method, {}
    values = {scene_named(plan.scene).main_metric: (right.main_metric, right.main_metric_doubt)}
    still = plan.fidelity.solver == "equilibrium" and right.method == "equilibria"
    if still and isfinite(right.ripple):  # vibration adds to that of dynamics, by what the start excites
        values |= {name: (right.ripple, right.ripple_doubt) for name in RIPPLES if name in printed}
    return right.cause or right.method, values


def behind_column(plan: ScenePlan) -> tuple[str, Values]:
    """Return the scene's main metric behind a column, integrated by a method of its own."""
    try:
        right, finer = settled_metrics(plan, REFERENCE_LIMIT / 2)
    except (NotFoundError, TimeoutError, np.linalg.LinAlgError) as error:
        return str(error), {}
    values = {scene_named(plan.scene).main_metric: (right.main_metric, 0.0)}
    if plan.scene == "stick-slip":
        values["breakaway_torque"] = right.peak, 0.0
    return f"implicit Runge-Kutta, {finer}", values
