"""An independent rack that bends: nodes of a finite-element bar instead of modes beside a rigid body.

    record = shaken_bar(gear, step=2e-6, end=15e-3)

The bar's deflections and rotations at its nodes are absolute coordinates: there is no rigid body, no mode,
and neither Exudyn nor its solver. The force laws of teeth, seat and bush are the package's, at the pose of a
straight bar that touches this one there; virtual work takes their forces to the nodes. Classical Runge-Kutta
with fixed steps. The pinion is held, so that each law keeps its station on the bar.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag, eigh

from rps_exudyn.forces.force_element import COORDINATE_BLOCKS, Part, stacked
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.masses import rack_masses
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.rack_beam import RackBeam
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.yoke_impact import shaken
from rps_exudyn.solvers.balance import SIZE, Balance
from rps_exudyn.solvers.equilibrium import equilibrium_path
from rps_exudyn.solvers.gear_forces import GearForces, gear_forces
from rps_exudyn.solvers.gear_model import COLUMNS

ELEMENTS = 52
X, ROLL, PLUNGER, Y_PLANE = 0, 1, 2, 3  # where coordinates begin; those of the plane z follow the plane y


@dataclass(frozen=True, eq=False)
class ShakenBar:
    """What the yokenut and the bar's end do, one row per step."""

    time: np.ndarray  # [s]
    yokenut_force: np.ndarray  # [N]
    end: np.ndarray  # displacement of the end beside the pinion along Y and Z, (n, 2) [m]


@dataclass(frozen=True, eq=False)
class NodalBar:
    """Equations of motion over x, roll, plunger, and (deflection, rotation) of all nodes in both planes."""

    straight: Balance  # the gear's forces on a rack that is straight and rigid
    angle: float  # of the pinion, held
    acting: list[tuple[np.ndarray, list[Part]]]  # parts, and what `carry` returns where they act
    nodes: np.ndarray
    size: int
    inverse_mass: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray

    @classmethod
    def of(cls, gear: SteeringGear, forces: GearForces, x: float) -> "NodalBar":
        """The gear with its rack displaced by x."""
        beams = [RackBeam.of(gear).elements(plane, ELEMENTS) for plane in (0, 1)]
        solid = rack_masses(gear)
        lumped = np.diag([solid.mass, solid.inertia[0, 0], gear.yoke.plunger_mass])
        nothing = np.zeros((3, 3))
        stiffness, mass, damping = (
            block_diag(first, *parts)
            for first, parts in zip(
                (nothing, lumped, nothing),
                zip(*(_matrices(beam, gear.rack.modal_damping) for beam in beams), strict=True),
                strict=True,
            )
        )
        bush = float(forces.gear.fit.station)
        stations = {"mesh": -x, "seat": -x, "yoke_spring": -x, "yokenut": -x, "bush": bush - x}
        parts = [part for part in forces.parts if part.name != "bearing"]
        straight = forces.statics.gears.copy()
        straight["is_bent"] = 0
        bar = cls(
            replace(forces.statics, gears=straight),
            gear.test.start_angle,
            [],
            beams[0].nodes,
            2 * beams[0].nodes.size,
            np.linalg.inv(mass),
            stiffness,
            damping,
        )
        for station in {stations.get(part.name, 0.0) for part in parts}:
            there = [part for part in parts if stations.get(part.name, 0.0) == station]
            bar.acting.append((bar.carry(station), there))
        return bar

    def carry(self, station: float) -> np.ndarray:
        """Coordinates of a straight rack that touches the bar at a station, over those of the bar, (6, n)."""
        step = self.nodes[1] - self.nodes[0]
        i = min(max(int((station - self.nodes[0]) / step), 0), self.nodes.size - 2)
        s = (station - self.nodes[i]) / step
        cubic = np.array(
            [1 - 3 * s**2 + 2 * s**3, step * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3, step * (s**3 - s**2)]
        )
        turn = np.array([0.0, 1 - s, 0.0, s])
        by = np.zeros((6, Y_PLANE + 2 * self.size))
        by[0, X] = by[3, ROLL] = 1.0
        for begin, across, about, sense in ((Y_PLANE, 1, 5, 1), (Y_PLANE + self.size, 2, 4, -1)):
            place = slice(begin + 2 * i, begin + 2 * i + 4)
            by[across, place], by[about, place] = cubic - station * turn, sense * turn
        return by

    def laws(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Forces of all parts on the bar's coordinates."""
        total = np.zeros(q.size)
        for by, parts in self.acting:
            place = np.concatenate([[-self.angle], by @ q, q[PLUNGER : PLUNGER + 1]])
            rate = np.concatenate([[0.0], by @ v, v[PLUNGER : PLUNGER + 1]])
            self.straight.force(place, rate)
            out, forces = self.straight.works[0]["out"], np.zeros(SIZE)
            for part in parts:
                forces[stacked(part.bodies)] += out[COLUMNS[part.name]][: part.size]
            total += by.T @ forces[COORDINATE_BLOCKS["rack"]]
            total[PLUNGER] += forces[-1]
        return total


def shaken_bar(gear: SteeringGear, fidelity: Fidelity, *, step: float, end: float) -> ShakenBar:
    """Shake the rack as the scene yoke-impact does, from rest until `end` [s] in steps [s].

    The rest is that of the package's flexible rack: its equilibrium is judged by tests of its own.
    """
    chosen, maneuver = fidelity.replace({"rack": "flexible"}), shaken(gear)
    forces, pair = gear_forces(gear, chosen), GearPair.of(gear)
    rest = equilibrium_path(forces.statics, pair, maneuver.drive, np.zeros(1))
    assert forces.bar is not None
    assert maneuver.pulse is not None
    q_rest = rest.coordinates[0]
    bar = NodalBar.of(gear, forces, float(q_rest[1]))
    q = np.zeros(Y_PLANE + 2 * bar.size)
    q[[X, ROLL, PLUNGER]] = q_rest[1], q_rest[4], q_rest[7]
    for i, station in enumerate(bar.nodes):
        pose = forces.bar.poses(rest.coordinates, rest.rates, (float(station), 0.0))[0][0]
        q[Y_PLANE + 2 * i : Y_PLANE + 2 * i + 2] = pose[1] + station * pose[5], pose[5]
        z = Y_PLANE + bar.size + 2 * i
        q[z : z + 2] = pose[2] - station * pose[4], -pose[4]
    on_end = np.zeros((q.size, 3))
    on_end[X, 0] = on_end[Y_PLANE, 1] = on_end[Y_PLANE + bar.size, 2] = 1.0
    assert bar.nodes[0] == RackBar.of(gear).x_min
    pulse = maneuver.pulse

    def acceleration(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        total = on_end @ pulse.force(t) - bar.stiffness @ q - bar.damping @ v + bar.laws(q, v)
        return np.asarray(bar.inverse_mass @ total)

    v, clearance, stop = np.zeros(q.size), gear.yoke.clearance, gear.yoke.nut_stiffness
    kept = []
    for k in range(round(end / step) + 1):
        kept.append((k * step, stop * max(q[PLUNGER] - clearance, 0.0), *(on_end.T @ q)[1:]))
        t, half = k * step, step / 2
        a1 = acceleration(t, q, v)
        v2 = v + half * a1
        a2 = acceleration(t + half, q + half * v, v2)
        v3 = v + half * a2
        a3 = acceleration(t + half, q + half * v2, v3)
        v4 = v + step * a3
        a4 = acceleration(t + step, q + step * v3, v4)
        q = q + step / 6 * (v + 2 * v2 + 2 * v3 + v4)
        v = v + step / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    rows = np.array(kept)
    return ShakenBar(rows[:, 0], rows[:, 1], rows[:, 2:])


def _matrices(beam, ratio: float):  # type: ignore[no-untyped-def]
    """Stiffness, mass, and damping by the same ratio in all modes that bend the beam."""
    stiffness, mass = beam.matrices()
    squares, modes = eigh(stiffness, mass)
    squares[:2] = 0.0  # it moves and turns freely
    weighed = mass @ modes
    return stiffness, mass, weighed @ np.diag(2 * ratio * np.sqrt(squares)) @ weighed.T
