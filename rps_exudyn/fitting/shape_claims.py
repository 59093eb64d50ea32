"""What the shape of a free torque would claim to tell of the level's parameters, were the contact law true.

The fit does not use it (`problem`): data of one law fitted by another would move preload and friction by a
fifth, with intervals of a few percent. It is worth seeing how sure a fit that trusts the shape would be.
"""

from dataclasses import replace

import numpy as np

from rps_exudyn.fitting.estimate import Fit
from rps_exudyn.fitting.prediction import NoPredictionError
from rps_exudyn.fitting.problem import linearised
from rps_exudyn.fitting.unknowns import LEVEL, settings_of


def shape_claims(fit: Fit) -> dict[str, float]:
    """Return path -> standard deviation of the logarithm from means and shape together; {} if the gear has no
    equilibrium beside the fit.

    One simulation for each parameter of the level.
    """
    problem, state = fit.problem, fit.series.state
    slopes = state.slopes.copy()
    gear, unknowns = fit.given, problem.unknowns
    try:
        base = problem.prediction.simulated(gear.replace(settings_of(unknowns, state.u)))
        for j, unknown in enumerate(unknowns):
            if unknown.is_level:
                stepped = state.u.copy()
                stepped[j] += unknown.step
                moved = problem.prediction.simulated(gear.replace(settings_of(unknowns, stepped)))
                slopes[:, j] = (moved - base) / unknown.step
    except NoPredictionError:
        return {}
    trusting = linearised(replace(problem, trusted=True), replace(state, slopes=slopes))
    deviations = np.sqrt(np.diag(np.linalg.inv(trusting.information)))
    return {each.path: float(deviations[j]) for j, each in enumerate(unknowns) if each.path in LEVEL}
