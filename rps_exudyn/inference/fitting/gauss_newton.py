"""Gauss and Newton's steps on a simulated model, damped where one fails, with Broyden's slopes where slow.

Weights of robust loss, offset and zeros need no simulation: each step ends where the linearised model fits
best, and only then the gear is simulated there.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from rps_exudyn.inference.fitting.prediction import NoPredictionError
from rps_exudyn.inference.fitting.problem import Linearised, Problem, State, linearised
from rps_exudyn.inference.fitting.unknowns import settings_of
from rps_exudyn.parameters.gear import SteeringGear

ENOUGH = 0.05  # of a standard error: a smaller step of the unknowns ends the fit
MOST_STEPS = 12
MOST_ROUNDS = 25  # of weights, offset and zeros within a step
MOST_HALVINGS = 6
SLOW = 0.5  # of the step before: a step longer than that asks for better slopes
LONGEST = 3.0  # standard deviations of the prior that a step may go
WORSE = 1.0  # by which a step may raise a sum of squares ...
BLURRED = 0.2  # ... and that of the shape, times itself: its own rows are no gradient of the level


@dataclass(frozen=True, eq=False)
class Solved:
    """Where the steps ended."""

    state: State
    equations: Linearised
    converged: bool
    why: str  # not; "" where it did


def solve(
    problem: Problem,
    gear: SteeringGear,
    start: State,
    slopes_anew: Callable[[State], np.ndarray] | None = None,
    enough: float = ENOUGH,
) -> Solved:
    """Improve a state until the next step is small beside the standard errors.

    `enough` is that small step, in standard errors; `slopes_anew` makes the derivatives again where a step
    by the updated ones fails.
    """
    state, last = start, np.inf
    for _ in range(MOST_STEPS):
        guess, equations = best_of_line(problem, state)
        errors = np.sqrt(np.diag(np.linalg.inv(equations.information)))[: state.u.size]
        size = float(np.max(np.abs(guess.u - state.u) / errors))
        if size < enough:
            return Solved(guess, equations, True, "")
        improved = _by_broyden if size > SLOW * last else _as_before
        accepted, reason = _tried(problem, gear, state, guess, improved)
        if accepted is None and slopes_anew is not None:
            state, slopes_anew = replace(state, slopes=slopes_anew(state)), None
            last = np.inf
            continue
        if accepted is None:
            return Solved(state, linearised(problem, state), False, reason)
        state, last = accepted, size
    return Solved(state, linearised(problem, state), False, f"{MOST_STEPS} steps were not enough")


def best_of_line(problem: Problem, state: State) -> tuple[State, Linearised]:
    """Return where the linearised model fits best, and the normal equations there."""
    scale, best = np.array([each.sd for each in problem.unknowns]), state
    count = len(problem.unknowns)
    for _ in range(MOST_ROUNDS):
        equations = linearised(problem, best)
        step = np.linalg.solve(equations.information, equations.gradient)
        step[count] = np.clip(step[count], -problem.pitch / 16, problem.pitch / 16)
        away = (best.u + step[:count] - state.u) / scale
        if np.max(np.abs(away), initial=0.0) > LONGEST:
            step = step * LONGEST / float(np.max(np.abs(away))) / 2
            return problem.moved(best, step), equations
        best = problem.moved(best, step)
        errors = np.sqrt(np.diag(np.linalg.inv(equations.information)))
        if np.max(np.abs(step) / errors) < ENOUGH / 5:
            break
    return best, linearised(problem, best)


Improved = Callable[[Problem, np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""Problem, slopes, what they missed (m,), step of the unknowns (n,) -> slopes."""


def _tried(
    problem: Problem, gear: SteeringGear, state: State, guess: State, improved: Improved
) -> tuple[State | None, str]:
    """The state at the guess, or on the way to it; None with the reason where nothing on the way helps."""
    before, reason = linearised(problem, state), ""
    step = problem.vector(guess) - problem.vector(state)
    for _ in range(MOST_HALVINGS):
        guess = problem.moved(state, step)
        try:
            values = problem.prediction.simulated(gear.replace(settings_of(problem.unknowns, guess.u)))
        except NoPredictionError as error:
            reason, step = str(error), step / 2
            continue
        slopes = improved(problem, state.slopes, values - guess.values, guess.u - state.u)
        new = replace(guess, values=values, slopes=slopes)
        if _is_better(linearised(problem, new), before):
            return new, ""
        reason, step = "no step makes the deviations smaller", step / 3
        state, improved = replace(state, slopes=slopes), _by_broyden
    return None, reason


def _is_better(after: Linearised, before: Linearised) -> bool:
    """Return whether a step is taken: the means decide, for what moves them also changes the ripple."""
    blurred = after.by_shape <= (1 + BLURRED) * before.by_shape + WORSE
    return after.by_level <= before.by_level + WORSE and blurred


def _as_before(problem: Problem, slopes: np.ndarray, missed: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """The slopes as they were: those of the closed form are good to a percent or two."""
    return slopes


def _by_broyden(problem: Problem, slopes: np.ndarray, missed: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Broyden's update of the level's slopes, in unknowns over their deviations: they explain how the means
    moved. What shows in the shape is nearly linear, and keeps the slopes that were simulated."""
    level = np.array([each.is_level for each in problem.unknowns])
    scale = np.array([each.sd for each in problem.unknowns])
    scaled = np.where(level, moved / scale, 0.0)
    length = float(scaled @ scaled)
    if length < 1e-16:
        return slopes
    return slopes + np.outer(problem.prediction.means_of(missed), scaled / length) / scale
