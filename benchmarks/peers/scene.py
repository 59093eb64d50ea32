"""The scene that every program gets: one turn of the default gear, with what all of them can model.

The rack slides along X and Y and does nothing else; a constant force presses it into the pinion; the teeth
rub by Coulomb's law and yield by a pressure proportional to depth. Nothing else rubs, yields or is damped.
The pinion turns at a constant speed. What is asked for is its torque over one revolution.
"""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.masses import rack_masses
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.mean_depth import mean_depth, rack_approach
from verification.law_area import by_law

SETTINGS: dict[str, Any] = {
    "yoke.preload": "700 N",
    "yoke.spring_rate": 0,
    "yoke.friction": 0,
    "yoke.clearance": "0.5 mm",
    "bush.drag": 0,
    "bearing.friction_torque": 0,
    "test.speed": "60 rpm",
}
GEAR = by_law(SteeringGear().replace(SETTINGS), "area")
PAIR = GearPair.of(GEAR)
GUIDED = {"rack": "guided", "bush": "condensed"}
"""The package's choices for this scene."""

PRELOAD, FRICTION, STIFFNESS = GEAR.yoke.preload, GEAR.mesh.friction, GEAR.mesh.stiffness
SPEED = GEAR.test.speed  # of the pinion [rad/s]
RACK_MASS = rack_masses(GEAR).mass
APPROACH = rack_approach(PAIR, mean_depth(GEAR))
"""How far the preload presses the rack in [m], at which a motion starts."""

FLYWHEEL = 1e3
"""Inertia that keeps the pinion's speed where a program drives no angle [kg m^2]."""

RUN_IN = np.deg2rad(6.0)
"""Angle that a program in which masses swing turns before the torque is recorded [rad]."""

TURN = 2 * np.pi


@dataclass(frozen=True, eq=False)
class Run:
    """One whole run of one program."""

    angle: np.ndarray  # of the pinion [rad], (n,)
    torque: np.ndarray  # [N m], (n,)
    loop_s: float  # CPU seconds of the solver's loop
    whole_s: float  # and with geometry and model built from the gear's parameters


class Method(Protocol):
    """One program with settings; builds the scene from the gear's parameters and runs it."""

    @property
    def program(self) -> str:
        """Name of the family in chart and tables."""

    @property
    def label(self) -> str:
        """Settings, for tables."""

    def run(self, turned: float) -> Run:
        """Run over an angle [rad].

        Raises:
            ArithmeticError: the run failed; the message says how.
        """


START = np.array([-RUN_IN, -PAIR.gain * RUN_IN, -APPROACH])
"""Where a program with a run-in begins: pinion angle [rad], X and Y of the rack from its place [m] ..."""

RATES = SPEED * np.array([1.0, PAIR.gain, 0.0])
"""... and how fast [rad/s, m/s]."""


def steps_of(turned: float, step: float) -> int:
    """Return how many steps a run over an angle [rad] takes, with its run-in."""
    return int(np.ceil((turned + RUN_IN) / SPEED / step))


def check_mesh(program: str, place: float) -> None:
    """Check Y of the rack at the end, from its place at rest [m].

    Raises:
        ArithmeticError: the rack left the mesh, or the number is not finite.
    """
    if not abs(place) < 10 * APPROACH:
        raise ArithmeticError(f"{program}: the rack ends {1e3 * place:.3g} mm off its place")
