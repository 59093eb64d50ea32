"""The gear in Exudyn's own viewer: solved anew, then played until the window is closed."""

from pathlib import Path

import exudyn as exu
import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.multibody.model import build_model
from rps_exudyn.multibody.solve import SolverPlan, settings_of
from rps_exudyn.multibody.steering_model import SteeringModel
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear

FRAMES, STEPS_PER_SECOND = 200, 500


def solved_model(gear: SteeringGear, fidelity: Fidelity, file: Path) -> SteeringModel:
    """Turn the gear by its test, and write the motion to Exudyn's solution file.

    Raises:
        InputError: no equilibrium to start from.
    """
    model = build_model(gear, fidelity)
    if not model.start.converged:
        raise InputError("There is no equilibrium to start from; change preload or clearance.")
    model.mbs.Assemble()
    seconds = 2 * np.pi * gear.test.turns / gear.test.speed
    settings = settings_of(SolverPlan(end_time=seconds, steps=int(np.ceil(STEPS_PER_SECOND * seconds))))
    settings.solution.file.write = True
    settings.solution.file.name = str(file)
    settings.solution.file.writePeriod = seconds / FRAMES
    model.mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.GeneralizedAlpha)
    return model


def play(model: SteeringModel, file: Path) -> None:
    """Open the player with the coordinates in Exudyn's solution file, until its window is closed."""
    from exudyn.interactive import SolutionViewer  # type: ignore[import-untyped, unused-ignore]
    from exudyn.utilities import LoadSolutionFile  # type: ignore[import-untyped, unused-ignore]

    SolutionViewer(model.mbs, LoadSolutionFile(str(file)))
