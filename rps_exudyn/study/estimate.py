"""Estimated duration of a study: from the times of its finished cases, else from measured costs."""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.study.cases import setup_of
from rps_exudyn.study.definition import Study
from rps_exudyn.study.description import Case
from rps_exudyn.study.runner import StudyWork

# Elapsed seconds of a case on one core of a small cloud machine: fixed, and per step of the solver
COSTS = {
    ("closed-form", "flank"): (0.010, 0.0),
    ("equilibrium", "flank"): (0.013, 1e-5),
    ("equilibrium", "general-contact"): (1.0, 2e-3),
    ("generalized-alpha", "flank"): (0.14, 2.2e-4),
    ("generalized-alpha", "general-contact"): (2.0, 0.03),
}
DEARER_CHAIN = 3.0  # times, of a bush in segments with flank contact
STORING = 0.002  # [s] per case: file, index, log
STARTING = 4.0  # [s] of the processes, kernels compiled


@dataclass(frozen=True)
class Estimate:
    """Elapsed time that the missing cases will take together."""

    seconds: float
    source: str  # what it is based on, in words


def estimate(work: StudyWork, jobs: int) -> Estimate:
    """Estimate the elapsed time of the missing cases with `jobs` processes."""
    missing = work.missing
    if not missing:
        return Estimate(0.0, "nothing is missing")
    measured = work.measured()
    if measured:
        each = float(np.mean(measured))
        source = f"from the {len(measured)} finished cases, {each:.3g} s each"
    else:
        each = float(np.mean([_cost(work.study, case) for case in missing[:: max(1, len(missing) // 100)]]))
        source = f"from costs measured on one small machine, {each:.3g} s each; rough"
    return Estimate(STARTING + len(missing) * (each + STORING) / min(jobs, len(missing)), source)


def _cost(study: Study, case: Case) -> float:
    setup = setup_of(study, case)
    fixed, per_step = _rates(setup.fidelity)
    steps = 2 * np.pi * setup.test.turns / setup.fidelity.step_angle
    return float(fixed + per_step * steps)


def _rates(fidelity: Fidelity) -> tuple[float, float]:
    fixed, per_step = COSTS[fidelity.solver, fidelity.mesh]
    if fidelity.solver == "generalized-alpha" and fidelity.mesh == "flank" and fidelity.bush == "chain":
        return fixed, per_step * DEARER_CHAIN
    return fixed, per_step
