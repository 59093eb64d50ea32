"""Where a fit begins: level by the closed form, runout by the half sum of both ways, offset by a scan."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rps_exudyn.inference.fitting.prediction import NoPredictionError
from rps_exudyn.inference.fitting.problem import Problem, State, linearised, robust_weights
from rps_exudyn.inference.fitting.unknowns import settings_of
from rps_exudyn.parameters.gear import SteeringGear

SCANNED = 60  # offsets over a tooth pitch
SHIFTING = ("bush.drag", "bearing.friction_torque")
ROUNDS = 4  # of the closed form's own fit of the level
LARGEST_VECTOR = 60e-6  # of the runout that a start takes from the half sum [m]


def start_of(problem: Problem, gear: SteeringGear) -> State:
    """Return the state from which the simulated fit begins.

    Raises:
        NoPredictionError: the model has no equilibrium there.
    """
    u = _level_by_formula(problem, gear)
    u = _runout_by_half_sum(problem, gear, u)
    values = problem.prediction.simulated(gear.replace(settings_of(problem.unknowns, u)))
    state = State(u, 0.0, 0.0, np.zeros(len(problem.quiet)), values, np.zeros((values.size, u.size)))
    state = replace(state, slopes=first_slopes(problem, gear, state))
    return replace(state, offset=scanned_offset(problem, state)) if problem.with_offset else state


def first_slopes(
    problem: Problem, gear: SteeringGear, state: State, only: Sequence[int] | None = None
) -> np.ndarray:
    """Return derivatives of the predicted values, shape (m, unknowns).

    Those of the level are the closed form's, unless the shape is trusted for it; those of what shows in the
    shape, forward differences. Drag and bearing friction only shift the torque. With `only` those of these
    unknowns alone are made anew.
    """
    slopes = formula_slopes(problem, gear, state.u) if only is None else state.slopes.copy()
    for j, unknown in enumerate(problem.unknowns):
        if only is not None and j not in only:
            continue
        if unknown.is_level and (not problem.trusted or unknown.path in SHIFTING):
            continue
        stepped = state.u.copy()
        stepped[j] += unknown.step
        for part in (1.0, 0.5):  # half of the step where there is no equilibrium
            stepped[j] = state.u[j] + part * unknown.step
            try:
                moved = problem.prediction.simulated(gear.replace(settings_of(problem.unknowns, stepped)))
            except NoPredictionError:
                continue
            slopes[:, j] = (moved - state.values) / (part * unknown.step)
            break
    return slopes


def formula_slopes(problem: Problem, gear: SteeringGear, u: np.ndarray) -> np.ndarray:
    """Return derivatives of the means by the closed form with respect to the level's parameters."""

    def means(at: np.ndarray) -> np.ndarray:
        return problem.prediction.by_formula(gear.replace(settings_of(problem.unknowns, at)))

    base, columns = means(u), []
    for j, unknown in enumerate(problem.unknowns):
        stepped = u.copy()
        stepped[j] += unknown.step
        columns.append((means(stepped) - base) / unknown.step if unknown.is_level else np.zeros_like(base))
    return np.array(columns).T.reshape(base.size, len(problem.unknowns))


def _level_by_formula(problem: Problem, gear: SteeringGear) -> np.ndarray:
    """Gauss and Newton's steps with the closed form instead of a simulation."""
    u = np.array([each.before for each in problem.unknowns])
    fixed = replace(problem, with_offset=False)
    for _ in range(ROUNDS):
        values = problem.prediction.by_formula(gear.replace(settings_of(problem.unknowns, u)))
        state = State(u, 0.0, 0.0, np.zeros(len(problem.quiet)), values, formula_slopes(problem, gear, u))
        equations = linearised(fixed, state)
        step = np.linalg.solve(equations.information, equations.gradient)[: u.size]
        level = np.array([each.is_level for each in problem.unknowns])
        u = u + np.where(level, np.clip(step, -1.0, 1.0), 0.0)
    return u


def _runout_by_half_sum(problem: Problem, gear: SteeringGear, u: np.ndarray) -> np.ndarray:
    """The half sum of the free torques is -P (e_c sin phi + e_s cos phi): what the runout stores."""
    where = {each.component: j for j, each in enumerate(problem.unknowns) if each.path == "pinion.runout"}
    free = [each for each in problem.measurement.passes if each.test.of_kind.by_angle]
    if not where or {each.direction for each in free} != {1, -1}:
        return u
    amplitudes = []
    for sense in (1, -1):
        turned = [each for each in free if each.direction == sense]
        angle = np.concatenate([each.angle for each in turned])
        torque = np.concatenate([each.value - np.median(each.value) for each in turned])
        waves = np.column_stack([np.ones_like(angle), np.sin(angle), np.cos(angle)])
        for _ in range(3):
            fitted = np.linalg.lstsq(waves, torque, rcond=None)[0]
            weights = np.sqrt(robust_weights(torque - waves @ fitted, float(np.std(torque)) / 2 + 1e-12))
            fitted = np.linalg.lstsq(weights[:, None] * waves, weights * torque, rcond=None)[0]
        amplitudes.append(fitted[1:])
    preload = gear.replace(settings_of(problem.unknowns, u)).yoke.preload
    e_c, e_s = -np.mean(amplitudes, axis=0) / preload
    shrink = min(1.0, LARGEST_VECTOR / max(float(np.hypot(e_c, e_s)), 1e-12))
    u = u.copy()
    u[where["cos"]], u[where["sin"]] = shrink * e_c, shrink * e_s
    return u


def scanned_offset(problem: Problem, state: State) -> float:
    """Return the offset within half a pitch at which the teeth's ripple fits best."""
    tried = np.linspace(-0.5, 0.5, SCANNED, endpoint=False) * problem.pitch
    without = replace(problem, with_offset=False)
    costs = [linearised(without, replace(state, offset=float(each))).by_shape for each in tried]
    return float(tried[int(np.argmin(costs))])
