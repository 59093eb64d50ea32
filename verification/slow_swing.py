"""A reversal as the limit of slow motion: equilibria, and the inertia of the motion that the rig prescribes.

This is a method besides Exudyn's dynamics, in which only the contact is integrated more finely than a scene
does. Nothing in a slow reversal but rack and pinion is accelerated enough to be felt.
"""

from dataclasses import replace

from rps_exudyn.mesh_contact.flank_data import MOST_POINTS, pack
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import swing_maneuver
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.solvers.gear_forces import GearForces, gear_forces
from verification.equilibria import equilibria

ON_GENERATOR = MOST_POINTS  # Gauss points on each: teeth that hardly move rub one way here, another there


def slow_swing(gear: SteeringGear, fidelity: Fidelity) -> SceneRun:
    """Run a reversal, the contact integrated as `fidelity` says, generators with `ON_GENERATOR` points.

    Raises:
        InputError: the steering leaves the rack's teeth.
    """
    return equilibria(gear, _well_integrated(gear, fidelity), swing_maneuver(gear, fidelity.step_angle))


def _well_integrated(gear: SteeringGear, fidelity: Fidelity) -> GearForces:
    forces = gear_forces(gear, fidelity)
    if fidelity.mesh != "flank-generators":
        return forces
    gears = forces.gears.copy()
    gears["mesh"]["flank"] = pack(
        gear, zone=forces.friction_zone, generators=fidelity.generators, along=ON_GENERATOR
    )
    return replace(forces, gears=gears)
