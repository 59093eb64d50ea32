"""External forces on the rack: a load at its end, its weight, a pulse."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from rps_exudyn.base.compiled import inline, record, record_type
from rps_exudyn.forces.force_element import Part
from rps_exudyn.forces.rigid_motion import cross, dot, on_angles, plus, scaled, spin_of, turn_of, vector
from rps_exudyn.gears.masses import rack_masses
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.gear import SteeringGear

DEAD_FORCE = record_type(
    [
        ("force", "f8", (3,)),  # in the housing [N]
        ("place", "f8"),  # along the bar's axis from the rack's reference point [m]
    ]
)
"""Record of a force that keeps its size and direction, on a point of the bar's axis."""

LOAD, WEIGHT = Part("load", ("rack",), ("load_force",)), Part("weight", ("rack",), ("weight_force",))


@inline
def dead_force(q, data, out):  # type: ignore[no-untyped-def]
    """A constant force and its potential; q = rack (6), fills out (10,)."""
    turn, force = turn_of(q[3:6]), vector(data.force)
    lever = scaled(data.place, turn.axis)
    out[0], out[1], out[2] = force
    out[3], out[4], out[5] = on_angles(turn, cross(lever, force))
    out[6] = -dot(force, plus(vector(q), lever))
    out[7], out[8] = 0.0, 0.0
    out[9] = -force[0]


@inline
def add_dead_tangent(q, data, factor_q, tangent):  # type: ignore[no-untyped-def]
    """Add factor_q dF/dq to a tangent (6, 6) of the rack: the lever turns with the bar, p a x F with the axis
    a = (1, c, -b) of small angles."""
    lever, (x, y, z) = factor_q * data.place, vector(data.force)
    tangent[4, 4] -= lever * x
    tangent[5, 5] -= lever * x
    tangent[3, 4] += lever * y
    tangent[3, 5] += lever * z


def end_load(gear: SteeringGear, load: float) -> np.record:
    """Return a load [N] along -X at the rack's end beside the pinion, with the side force there."""
    size, angle = gear.rack.side_force, gear.rack.side_angle
    force = -load, size * np.cos(angle), size * np.sin(angle)
    return record(DEAD_FORCE, force=force, place=RackBar.of(gear).x_min)


def weight(gear: SteeringGear) -> np.record:
    """Return the weight at the mass centre; gravity along -Y is turned about X and raised towards X."""
    bar, given = rack_masses(gear), gear.installation
    angle, slope = given.gravity_angle, given.gravity_slope
    direction = sin(slope), -cos(slope) * cos(angle), cos(slope) * sin(angle)
    force = tuple(bar.mass * (given.gravity * np.array(direction)))
    return record(DEAD_FORCE, force=force, place=float(bar.centre_of_mass[0]))


@dataclass(frozen=True)
class TimedForce(ABC):
    """A force over time on a point of the bar's axis, along one direction."""

    peak: tuple[float, float, float]  # largest, in the housing [N]
    place: float  # along the bar's axis from the rack's reference point [m]

    def force(self, time: float) -> np.ndarray:
        """Return the force in the housing at a time [s], shape (3,) [N]."""
        return np.multiply(self.share(time), self.peak)

    @abstractmethod
    def share(self, time: float) -> float:
        """Return the force at a time over its peak."""


@dataclass(frozen=True)
class Pulse(TimedForce):
    """Half sines of force, one per period, the first from time 0 on."""

    duration: float  # of a half sine [s]
    period: float  # from pulse to pulse [s]
    count: int

    def share(self, time: float) -> float:
        number, since = divmod(time, self.period)
        if time < 0 or number >= self.count or since >= self.duration:
            return 0.0
        return sin(pi * since / self.duration)


@dataclass(frozen=True)
class RoadForce(TimedForce):
    """A force of the road along a tie rod: a sine, or its positive halves."""

    frequency: float  # [Hz]
    phase: float  # at time 0 [rad]
    halves: bool  # only the positive halves

    def share(self, time: float) -> float:
        wave = sin(2 * pi * self.frequency * time + self.phase)
        return max(wave, 0.0) if self.halves else wave


def axis_velocity(q: np.ndarray, v: np.ndarray, place: float) -> np.ndarray:
    """Velocity of a point of the bar's axis, from the rack's coordinates and rates (6,); shape (3,) [m/s]."""
    turn = turn_of.py_func(q[3:6])
    return v[:3] + np.cross(spin_of.py_func(turn, v[3:6]), scaled.py_func(place, turn.axis))
