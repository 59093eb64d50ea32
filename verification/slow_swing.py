"""A reversal as the limit of slow motion: equilibria, and the inertia of the motion that the rig prescribes.

This is a method besides Exudyn's dynamics, in which only the contact is integrated more finely than a scene
does. Nothing in a slow reversal but rack and pinion is accelerated enough to be felt.
"""

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import swing_maneuver
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.solvers.gear_forces import gear_forces
from verification.equilibria import equilibria


def slow_swing(gear: SteeringGear, fidelity: Fidelity) -> SceneRun:
    """Run a reversal, the contact integrated as `fidelity` says.

    Raises:
        InputError: the steering leaves the rack's teeth.
    """
    return equilibria(gear, gear_forces(gear, fidelity), swing_maneuver(gear, fidelity.step_angle))
