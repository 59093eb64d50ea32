"""The gear in Exudyn's viewer: solved anew, then played by Exudyn's own player."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear

if TYPE_CHECKING:
    from rps_exudyn.multibody.steering_model import SteeringModel

FRAMES, STEPS_PER_SECOND = 200, 500


def solved_model(gear: SteeringGear, fidelity: Fidelity, file: Path) -> "SteeringModel":
    """Turn the gear as its test says, and write the motion to Exudyn's solution file.

    Raises:
        InputError: no equilibrium to start from.
    """
    from rps_exudyn.multibody.model import build_model
    from rps_exudyn.multibody.viewing import solved

    model = build_model(gear, fidelity)
    if not model.start.converged:
        raise InputError("There is no equilibrium to start from; change preload or clearance.")
    seconds = 2 * np.pi * gear.test.turns / gear.test.speed
    solved(model, seconds, int(np.ceil(STEPS_PER_SECOND * seconds)), file, FRAMES)
    return model


def play(model: "SteeringModel", file: Path) -> None:
    """Play a motion until the window is closed."""
    from rps_exudyn.multibody.viewing import played

    played(model, file)
