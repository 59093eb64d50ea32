"""Levenberg and Marquardt's steps, for a bow and an angle error, of which the torque is no straight line.

With either of them teeth touch at their edges, and the ripple grows with its size whichever way it points:
beside the true bow there may be one of the other sign at which the deviations are also smallest. So slopes
are simulated anew wherever the state has moved, the scale of the deviations is estimated as long as the model
is far off, and the steps begin again from bows of either direction; what explains the curves best is kept.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rps_exudyn.inference.fitting.noise import robust_deviation
from rps_exudyn.inference.fitting.prediction import NoPredictionError
from rps_exudyn.inference.fitting.problem import FitState, Problem, found_offset, linearised
from rps_exudyn.inference.fitting.unknowns import LEVEL, settings_of
from rps_exudyn.parameters.gear import SteeringGear

LONGEST = 3.0  # standard deviations of the prior that a step may go
SETTLED = 0.2  # of a standard error: a smaller step of the unknowns ends the search
MOST_STEPS = 20
MOST_BESIDE = 12  # of steps that begin again elsewhere
MOST_TRIES = 6  # of a step, each damped more
DAMPED, MORE, LESS = 1e-2, 6.0, 0.1  # of the information's diagonal at the start; factors after a try
FLAT = 0.5  # of chi squared that the next step promises: less is no reason to go on
LITTLE = 0.2  # of chi squared that a step gained: a flat valley is the end of the search
MOVED = 0.5  # standard errors, after which slopes of bow and angle error are simulated anew
FAR = 1.0  # the same, after which all slopes are
SAME = 2.0  # standard errors within which two ends are one
SCANNED = (-1.6, -0.8, 0.0, 0.8, 1.6)  # angle errors and bows of a start, in declared deviations
CLOSE = 9.0  # of chi squared: another end that explains the curves nearly as well is named


class OtherShape(NamedTuple):
    """Another gear that explains the curves nearly as well."""

    settings: dict[str, float]  # path -> SI value, of bow and angle error
    worse: float  # by this much of chi squared


def searched(problem: Problem, gear: SteeringGear, start: FitState) -> tuple[FitState, list[OtherShape]]:
    """Improve a state from several bows and angle errors; return the best end, and others nearly as good."""
    ends = [damped_steps(problem, gear, scanned(problem, gear, start))]
    for other in _other_starts(problem, gear, ends[0]):
        ends.append(damped_steps(problem, gear, other, near=ends[0]))
    best = min(ends, key=lambda end: end.chi_squared)
    return best, _named(problem, best, ends)


def damped_steps(
    problem: Problem, gear: SteeringGear, start: FitState, *, near: FitState | None = None
) -> FitState:
    """Improve a state until its next step is small beside the errors, or it comes `near` another end.

    Intervals rest on the slopes at the end, so all of them are made anew there.
    """
    shaping = [j for j, each in enumerate(problem.unknowns) if not each.is_level]
    state, damping, fresh = _with_slopes(problem, gear, start), DAMPED, True
    for _ in range(MOST_STEPS if near is None else MOST_BESIDE):
        widened = _widened(problem, state)
        equations = linearised(widened, state)
        errors = np.sqrt(np.diag(np.linalg.inv(equations.information)))
        if near is not None and _distance(state.u, near.u, errors, shaping) < SAME:
            return near
        whole = _step(problem, equations, 0.0)
        small = _distance(whole, np.zeros_like(whole), errors, range(state.u.size)) < SETTLED
        new, reason = None, ""
        if not small:
            new, damping, reason = _tried(widened, gear, state, equations, damping)
        if new is None and fresh:
            flat = small or float(whole @ equations.gradient) < FLAT
            return replace(linearised(problem, state), converged=flat, why="" if flat else reason)
        gained = 0.0 if new is None else equations.chi_squared - linearised(widened, new).chi_squared
        if new is not None and fresh and gained < LITTLE:
            return replace(linearised(problem, new), converged=True)
        if new is None or gained < LITTLE:
            state, damping, fresh = _with_slopes(problem, gear, new or state), DAMPED, True
            continue
        moved = _distance(new.u, state.u, errors, range(state.u.size))
        state, fresh = _with_slopes(problem, gear, new, moved), moved > FAR
    return replace(linearised(problem, state), why=f"{MOST_STEPS} steps were not enough")


def _with_slopes(problem: Problem, gear: SteeringGear, state: FitState, moved: float = np.inf) -> FitState:
    """The state with slopes made anew: all of them after a step of many standard errors, those of bow and
    angle error after a smaller one, none after one that hardly bends the curve."""
    if moved < MOVED:
        return state
    curved = [j for j, each in enumerate(problem.unknowns) if each.needs_shape_fit]
    return replace(state, slopes=first_slopes(problem, gear, state, None if moved > FAR else curved))


def scanned(problem: Problem, gear: SteeringGear, start: FitState) -> FitState:
    """The best of a start with angle errors, bows along the pinion and offsets tried.

    Each makes the flanks lean across the face, in a way of its own over the travel: what steps cannot cross.
    """
    where = [j for j, each in enumerate(problem.unknowns) if each.needs_shape_fit and each.component != "cos"]
    best, least = start, np.inf
    for j in reversed(where):  # the angle error first: it shows in every turn
        begun = best.u
        for tried in SCANNED:
            u = begun.copy()
            u[j] += tried * problem.unknowns[j].sd
            if (state := _at(problem, gear, replace(best, u=u))) is None:
                continue
            state = replace(state, offset=found_offset(problem, state.values)[0])
            cost = linearised(problem, state).chi_squared
            if cost < least:
                best, least = state, cost
    return best


def _simulated(problem: Problem, gear: SteeringGear, state: FitState) -> FitState:
    values = problem.prediction.simulated(gear.replace(settings_of(problem.unknowns, state.u)))
    return replace(state, values=values)


def _at(problem: Problem, gear: SteeringGear, state: FitState) -> FitState | None:
    """The same; None where there is no equilibrium."""
    try:
        return _simulated(problem, gear, state)
    except NoPredictionError:
        return None


def _tried(
    problem: Problem, gear: SteeringGear, state: FitState, equations: FitState, damping: float
) -> tuple[FitState | None, float, str]:
    """The state after a step that makes the loss smaller, and the next damping; None with the reason."""
    before, reason = equations.chi_squared, "no step makes the deviations smaller"
    for _ in range(MOST_TRIES):
        guess = problem.moved(state, _step(problem, equations, damping))
        damping *= MORE
        try:
            new = _simulated(problem, gear, guess)
        except NoPredictionError as error:
            reason = str(error)
            continue
        if linearised(problem, new).chi_squared < before:
            return new, max(damping / MORE * LESS, 1e-8), ""
    return None, damping, reason


def _step(problem: Problem, equations: FitState, damping: float) -> np.ndarray:
    """A damped step of everything that is varied, at most `LONGEST` declared deviations, shape (size,)."""
    matrix = equations.information + damping * np.diag(np.diag(equations.information))
    step = np.linalg.solve(matrix, equations.gradient)
    count, scale = len(problem.unknowns), np.array([each.sd for each in problem.unknowns])
    longest = float(np.max(np.abs(step[:count]) / scale))
    turned = abs(float(step[count])) / (problem.pitch / 16)
    return step / max(1.0, longest / LONGEST * 2, turned)


def _widened(problem: Problem, state: FitState) -> Problem:
    """The problem with the noise that its deviations show, where they are larger than the noise."""
    rows = linearised(problem, state).rows
    free = [i for i, each in enumerate(problem.measurement.passes) if each.test.of_kind.by_angle]
    whites = list(problem.whites)
    for number, row in zip(free, rows, strict=True):
        whites[number] = max(whites[number], robust_deviation(row.deviation))
    return replace(problem, whites=whites)


def _distance(one: np.ndarray, other: np.ndarray, errors: np.ndarray, of: Sequence[int]) -> float:
    """The largest difference of these unknowns, in standard errors."""
    return max(abs(float(one[j] - other[j])) / float(errors[j]) for j in of)


def _other_starts(problem: Problem, gear: SteeringGear, end: FitState) -> Iterator[FitState]:
    """The end's state with its bow pointing elsewhere; those without an equilibrium are left out."""
    for j, unknown in enumerate(problem.unknowns):
        if unknown.path != "rack.bow" or unknown.component != "cos":
            continue
        size, sense = float(np.abs(end.u[j])), float(np.sign(end.u[j])) or 1.0
        begun = [-sense * max(size, unknown.sd)] + ([sense * unknown.sd] if size < unknown.sd / 2 else [])
        for value in begun:
            u = end.u.copy()
            u[j] = value
            if (state := _at(problem, gear, replace(end, u=u))) is not None:
                yield state


def _named(problem: Problem, best: FitState, ends: list[FitState]) -> list[OtherShape]:
    """The ends beside the best one that explain the curves nearly as well."""
    errors = np.sqrt(np.diag(best.covariance))
    shaping = [j for j, each in enumerate(problem.unknowns) if not each.is_level]
    found = []
    for end in ends:
        worse = end.chi_squared - best.chi_squared
        if worse < CLOSE and _distance(end.u, best.u, errors, shaping) > SAME:
            settings = settings_of(problem.unknowns, end.u)
            of_shape = {path: value for path, value in settings.items() if path not in LEVEL}
            found.append(OtherShape(of_shape, worse))
    return found


# --- A fit with a bow or an angle error: first the shape of the curves, then their level
#
# The ripple of an angle error depends on preload and friction as well. So the shape is fitted with all
# unknowns, and its part in preload and friction is left out again (`problem`): it widens the intervals of
# bow and angle error, and the level's parameters are fitted to the levels, with bow and angle error held.


def fit_shape(
    problem: Problem, gear: SteeringGear, u: np.ndarray, search: bool
) -> tuple[FitState, list[OtherShape]]:
    """Return where all unknowns explain the curves best; `search` from several bows and angle errors.

    Raises:
        NoPredictionError: there is no equilibrium at `u`.
    """
    values = problem.prediction.simulated(gear.replace(settings_of(problem.unknowns, u)))
    start = FitState(u, values, found_offset(problem, values)[0], np.zeros((values.size, u.size)))
    state, others = searched(problem, gear, start) if search else (damped_steps(problem, gear, start), [])
    fitted = gear.replace(settings_of(problem.unknowns, state.u))
    try:
        change = problem.prediction.numerical(fitted, {}, problem.prediction.simulated(fitted))
    except NoPredictionError as error:
        return replace(state, converged=False, why=f"the numerical error is unknown: {error}"), others
    moved = linearised(problem, replace(state, values=state.values - change)).gradient - state.gradient
    shift = state.covariance @ moved  # of the unknowns: a bias, which points do not average out
    information = np.linalg.inv(state.covariance + np.outer(shift, shift))
    return replace(state, information=information), others


SHIFTING = ("bush.drag", "bearing.friction_torque")


def first_slopes(
    problem: Problem, gear: SteeringGear, state: FitState, only: Sequence[int] | None = None
) -> np.ndarray:
    """Return derivatives of the predicted values by forward differences, shape (m, unknowns).

    Drag and bearing friction only shift the torque: theirs are the closed form's. With `only` those of these
    unknowns alone are made anew.
    """
    slopes = state.slopes.copy()

    def values_at(u: np.ndarray, simulated: bool) -> np.ndarray:
        changed = gear.replace(settings_of(problem.unknowns, u))
        return problem.prediction.simulated(changed) if simulated else problem.prediction.by_formula(changed)

    for j, unknown in enumerate(problem.unknowns):
        if only is not None and j not in only:
            continue
        simulated = unknown.path not in SHIFTING
        for part in (1.0, 0.5):  # half of the step where there is no equilibrium
            stepped = state.u.copy()
            stepped[j] += part * unknown.step
            try:
                base = state.values if simulated else values_at(state.u, False)
                slopes[:, j] = (values_at(stepped, simulated) - base) / (part * unknown.step)
            except NoPredictionError:
                continue
            break
    return slopes
