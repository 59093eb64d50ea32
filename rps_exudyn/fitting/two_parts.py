"""A fit with a bow or an angle error: first the shape of the curves, then their level.

How large the ripple of an angle error is depends on preload and friction as well. So the shape is fitted with
all unknowns, and what it says of preload and friction is left out again (`problem`): it widens the intervals
of bow and angle error, and the level's parameters are fitted to the means, with bow and angle error held.
"""

from dataclasses import replace

import numpy as np

from rps_exudyn.fitting.curved import OtherEnd, damped_steps, searched
from rps_exudyn.fitting.problem import Noise, Problem, State, linearised
from rps_exudyn.fitting.solve import ENOUGH, Solved, solve
from rps_exudyn.fitting.start import formula_slopes
from rps_exudyn.fitting.unknowns import settings_of
from rps_exudyn.parameters.gear import SteeringGear

HELD = 1e-4  # of a declared deviation, by which what is held may still move


def is_curved(problem: Problem) -> bool:
    """Tell whether a bow or an angle error is fitted, for which there is a curve of free turning."""
    return problem.with_offset and any(each.is_curved for each in problem.unknowns)


def shape_of(
    problem: Problem, gear: SteeringGear, start: State, search: bool
) -> tuple[Solved, list[OtherEnd]]:
    """Return where all unknowns explain the curves best; `search` from several bows and angle errors."""
    trusting = replace(problem, trusted=True)
    return searched(trusting, gear, start) if search else (damped_steps(trusting, gear, start), [])


def level_of(
    problem: Problem, gear: SteeringGear, shape: Solved, noises: list[Noise], enough: float = ENOUGH
) -> Solved:
    """Return the level's parameters by the means, beside the shape's, with the covariance of both."""
    unknowns = [
        each if each.is_level else replace(each, before=float(value), sd=HELD * each.sd)
        for each, value in zip(problem.unknowns, shape.state.u, strict=True)
    ]
    before = np.array([each.before for each in unknowns])
    state = _with_means(problem, gear, replace(shape.state, u=before))
    held = replace(problem, unknowns=unknowns, noises=noises)
    solved = solve(held, gear, state, enough=enough)
    trusting = replace(problem, trusted=True, noises=noises)
    information = _joined(problem, linearised(trusting, shape.state).information, solved)
    return Solved(
        replace(solved.state, slopes=_with_shape(problem, solved.state, shape.state)),
        replace(solved.equations, information=information),
        solved.converged and shape.converged,
        shape.why or solved.why,
    )


def _with_means(problem: Problem, gear: SteeringGear, state: State) -> State:
    """The state at its unknowns, simulated, with the closed form's slopes of the level."""
    values = problem.prediction.simulated(gear.replace(settings_of(problem.unknowns, state.u)))
    slopes = formula_slopes(problem, gear, state.u)
    shaping = [j for j, each in enumerate(problem.unknowns) if not each.is_level]
    slopes[:, shaping] = state.slopes[:, shaping]
    return replace(state, values=values, slopes=slopes)


def _with_shape(problem: Problem, state: State, shape: State) -> np.ndarray:
    shaping = [j for j, each in enumerate(problem.unknowns) if not each.is_level]
    slopes = state.slopes.copy()
    slopes[:, shaping] = shape.slopes[:, shaping]
    return slopes


def _joined(problem: Problem, shape: np.ndarray, level: Solved) -> np.ndarray:
    """The information whose inverse has the shape's covariance and that of the level, each by itself."""
    count = len(problem.unknowns)
    own = [j for j, each in enumerate(problem.unknowns) if not each.is_level] + [count]  # and the offset
    others = [j for j in range(problem.size) if j not in own]
    by_shape, by_level = np.linalg.inv(shape), np.linalg.inv(level.equations.information)
    covariance = np.zeros_like(by_shape)
    covariance[np.ix_(own, own)] = by_shape[np.ix_(own, own)]
    covariance[np.ix_(others, others)] = by_level[np.ix_(others, others)]
    return np.linalg.inv(covariance)
