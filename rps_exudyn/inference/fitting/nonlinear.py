"""Levenberg and Marquardt's steps, for a bow and an angle error, of which the torque is no straight line.

With either of them teeth touch at their edges, and the ripple grows with its size whichever way it points:
beside the true bow there may be one of the other sign at which the deviations are also smallest. So slopes
are simulated anew wherever the state has moved, the scale of the deviations is estimated as long as the model
is far off, and the steps begin again from bows of either direction; what explains the curves best is kept.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rps_exudyn.inference.fitting.prediction import NoPredictionError
from rps_exudyn.inference.fitting.problem import (
    LINEAR_TO,
    Linearised,
    Problem,
    State,
    found_offset,
    linearised,
)
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


@dataclass(frozen=True, eq=False)
class Solved:
    """Where the steps ended."""

    state: State
    equations: Linearised
    converged: bool
    why: str  # not; "" where it did

    @property
    def covariance(self) -> np.ndarray:
        """Covariance of unknowns and offset, shape (size, size)."""
        return np.asarray(np.linalg.inv(self.equations.information))


@dataclass(frozen=True)
class OtherEnd:
    """Another gear that explains the curves nearly as well."""

    settings: dict[str, float]  # path -> SI value, of bow and angle error
    worse: float  # by this much of chi squared


def chi_squared(equations: Linearised) -> float:
    """The loss of means, shapes and priors, in squares of standard deviations: what the steps make smaller.

    That of a shape is soft_l1, whose weights are w = 1 / sqrt(1 + z^2).
    """
    shapes = [2 * LINEAR_TO**2 * float(np.sum(1 / row.weights - 1)) for row in equations.rows]
    return equations.by_level + sum(shapes)


def searched(problem: Problem, gear: SteeringGear, start: State) -> tuple[Solved, list[OtherEnd]]:
    """Improve a state from several bows and angle errors; return the best end, and others nearly as good."""
    ends = [damped_steps(problem, gear, scanned(problem, gear, start))]
    for other in _other_starts(problem, gear, ends[0].state):
        ends.append(damped_steps(problem, gear, other, near=ends[0]))
    best = min(ends, key=lambda end: chi_squared(end.equations))
    return best, _named(problem, best, ends)


def damped_steps(problem: Problem, gear: SteeringGear, start: State, *, near: Solved | None = None) -> Solved:
    """Improve a state until its next step is small beside the errors, or it comes `near` another end.

    Intervals rest on the slopes at the end, so all of them are made anew there.
    """
    shaping = [j for j, each in enumerate(problem.unknowns) if not each.is_level]
    state, damping, fresh = _with_slopes(problem, gear, start), DAMPED, True
    for _ in range(MOST_STEPS if near is None else MOST_BESIDE):
        widened = _widened(problem, state)
        equations = linearised(widened, state)
        errors = np.sqrt(np.diag(np.linalg.inv(equations.information)))
        if near is not None and _distance(state.u, near.state.u, errors, shaping) < SAME:
            return near
        whole = _step(problem, equations, 0.0)
        small = _distance(whole, np.zeros_like(whole), errors, range(state.u.size)) < SETTLED
        new, reason = None, ""
        if not small:
            new, damping, reason = _tried(widened, gear, state, equations, damping)
        if new is None and fresh:
            flat = small or float(whole @ equations.gradient) < FLAT
            return Solved(state, linearised(problem, state), flat, "" if flat else reason)
        gained = 0.0 if new is None else chi_squared(equations) - chi_squared(linearised(widened, new))
        if new is not None and fresh and gained < LITTLE:
            return Solved(new, linearised(problem, new), True, "")
        if new is None or gained < LITTLE:
            state, damping, fresh = _with_slopes(problem, gear, new or state), DAMPED, True
            continue
        moved = _distance(new.u, state.u, errors, range(state.u.size))
        state, fresh = _with_slopes(problem, gear, new, moved), moved > FAR
    return Solved(state, linearised(problem, state), False, f"{MOST_STEPS} steps were not enough")


def _with_slopes(problem: Problem, gear: SteeringGear, state: State, moved: float = np.inf) -> State:
    """The state with slopes made anew: all of them after a step of many standard errors, those of bow and
    angle error after a smaller one, none after one that hardly bends the curve."""
    if moved < MOVED:
        return state
    curved = [j for j, each in enumerate(problem.unknowns) if each.is_curved]
    return replace(state, slopes=first_slopes(problem, gear, state, None if moved > FAR else curved))


def scanned(problem: Problem, gear: SteeringGear, start: State) -> State:
    """The best of a start with angle errors, bows along the pinion and offsets tried.

    Each makes the flanks lean across the face, in a way of its own over the travel: what steps cannot cross.
    """
    where = [j for j, each in enumerate(problem.unknowns) if each.is_curved and each.component != "cos"]
    best, least = start, np.inf
    for j in reversed(where):  # the angle error first: it shows in every turn
        begun = best.u
        for tried in SCANNED:
            u = begun.copy()
            u[j] += tried * problem.unknowns[j].sd
            if (state := _at(problem, gear, replace(best, u=u))) is None:
                continue
            state = replace(state, offset=found_offset(problem, state.values)[0])
            cost = chi_squared(linearised(problem, state))
            if cost < least:
                best, least = state, cost
    return best


def _simulated(problem: Problem, gear: SteeringGear, state: State) -> State:
    """The state with the values simulated at its unknowns."""
    values = problem.prediction.simulated(gear.replace(settings_of(problem.unknowns, state.u)))
    return replace(state, values=values)


def _at(problem: Problem, gear: SteeringGear, state: State) -> State | None:
    """The same; None where there is no equilibrium."""
    try:
        return _simulated(problem, gear, state)
    except NoPredictionError:
        return None


def _tried(
    problem: Problem, gear: SteeringGear, state: State, equations: Linearised, damping: float
) -> tuple[State | None, float, str]:
    """The state after a step that makes the loss smaller, and the next damping; None with the reason."""
    before, reason = chi_squared(equations), "no step makes the deviations smaller"
    for _ in range(MOST_TRIES):
        guess = problem.moved(state, _step(problem, equations, damping))
        damping *= MORE
        try:
            new = _simulated(problem, gear, guess)
        except NoPredictionError as error:
            reason = str(error)
            continue
        if chi_squared(linearised(problem, new)) < before:
            return new, max(damping / MORE * LESS, 1e-8), ""
    return None, damping, reason


def _step(problem: Problem, equations: Linearised, damping: float) -> np.ndarray:
    """A damped step of everything that is varied, at most `LONGEST` declared deviations, shape (size,)."""
    matrix = equations.information + damping * np.diag(np.diag(equations.information))
    step = np.linalg.solve(matrix, equations.gradient)
    count, scale = len(problem.unknowns), np.array([each.sd for each in problem.unknowns])
    longest = float(np.max(np.abs(step[:count]) / scale))
    turned = abs(float(step[count])) / (problem.pitch / 16)
    return step / max(1.0, longest / LONGEST * 2, turned)


def _widened(problem: Problem, state: State) -> Problem:
    """The problem with the noise that its deviations show, where they are larger than the noise."""
    rows = linearised(problem, state).rows
    free = [i for i, each in enumerate(problem.measurement.passes) if each.test.of_kind.by_angle]
    whites = list(problem.whites)
    for number, row in zip(free, rows, strict=True):
        whites[number] = max(whites[number], 1.4826 * float(np.median(np.abs(row.deviation))))
    return replace(problem, whites=whites)


def _distance(one: np.ndarray, other: np.ndarray, errors: np.ndarray, of: Sequence[int]) -> float:
    """The largest difference of these unknowns, in standard errors."""
    return max(abs(float(one[j] - other[j])) / float(errors[j]) for j in of)


def _other_starts(problem: Problem, gear: SteeringGear, end: State) -> Iterator[State]:
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


def _named(problem: Problem, best: Solved, ends: list[Solved]) -> list[OtherEnd]:
    """The ends beside the best one that explain the curves nearly as well."""
    errors = np.sqrt(np.diag(best.covariance))
    shaping = [j for j, each in enumerate(problem.unknowns) if not each.is_level]
    found = []
    for end in ends:
        worse = chi_squared(end.equations) - chi_squared(best.equations)
        if worse < CLOSE and _distance(end.state.u, best.state.u, errors, shaping) > SAME:
            settings = settings_of(problem.unknowns, end.state.u)
            own = {path: value for path, value in settings.items() if path not in LEVEL}
            found.append(OtherEnd(own, worse))
    return found


# --- A fit with a bow or an angle error: first the shape of the curves, then their level
#
# The ripple of an angle error depends on preload and friction as well. So the shape is fitted with all
# unknowns, and its part in preload and friction is left out again (`problem`): it widens the intervals of
# bow and angle error, and the level's parameters are fitted to the levels, with bow and angle error held.


def is_curved(problem: Problem) -> bool:
    """Return whether a bow or an angle error is fitted, for which there is a curve of free turning."""
    return problem.with_offset and any(each.is_curved for each in problem.unknowns)


def shape_of(
    problem: Problem, gear: SteeringGear, u: np.ndarray, search: bool
) -> tuple[Solved, list[OtherEnd]]:
    """Return where all unknowns explain the curves best; `search` from several bows and angle errors.

    Raises:
        NoPredictionError: there is no equilibrium at `u`.
    """
    values = problem.prediction.simulated(gear.replace(settings_of(problem.unknowns, u)))
    start = State(u, found_offset(problem, values)[0], values, np.zeros((values.size, u.size)))
    solved, others = searched(problem, gear, start) if search else (damped_steps(problem, gear, start), [])
    state, equations = solved.state, solved.equations
    fitted = gear.replace(settings_of(problem.unknowns, state.u))
    try:
        change = problem.prediction.numerical(fitted, {}, problem.prediction.simulated(fitted))
    except NoPredictionError as error:
        return replace(solved, converged=False, why=f"the numerical error is unknown: {error}"), others
    moved = linearised(problem, replace(state, values=state.values - change)).gradient - equations.gradient
    shift = solved.covariance @ moved  # of the unknowns: a bias, which points do not average out
    information = np.linalg.inv(solved.covariance + np.outer(shift, shift))
    return replace(solved, equations=replace(equations, information=information)), others


SHIFTING = ("bush.drag", "bearing.friction_torque")


def first_slopes(
    problem: Problem, gear: SteeringGear, state: State, only: Sequence[int] | None = None
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
