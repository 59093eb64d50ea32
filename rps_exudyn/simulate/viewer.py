"""The gear in Exudyn's viewer: solved anew, then played by Exudyn's own player."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear

FRAMES, STEPS_PER_SECOND = 200, 500


def show_model(gear: SteeringGear, fidelity: Fidelity) -> None:
    """Turn the gear as its test says, and play the motion until the window is closed.

    Raises:
        InputError: no equilibrium to start from.
    """
    from rps_exudyn.multibody.model import build_model
    from rps_exudyn.multibody.viewing import played

    model = build_model(gear, fidelity)
    if not model.start.converged:
        raise InputError("There is no equilibrium to start from; change preload or clearance.")
    seconds = 2 * np.pi * gear.test.turns / gear.test.speed
    with TemporaryDirectory() as folder:
        played(model, seconds, int(np.ceil(STEPS_PER_SECOND * seconds)), Path(folder) / "motion.txt", FRAMES)
