"""The contact law "teeth" with the compliance of finite elements in place of its own: its reference.

    with exchanged(by_elements()):
        result = rps.run("free-pinion-torque", gear_by_teeth, fidelity=model)

Lines, stations, Hertz's flattening, unilateral contact, friction and all other forces are those of the
package; what a load yields elsewhere, and the torsion of the core, are those of `tooth_elements`, between
whose nodes they are interpolated as the elements do.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import entry, inline, kernel
from rps_exudyn.base.kernel_compiler import from_python
from rps_exudyn.forces.rigid_motion import fill_rotation
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.gear_forces import Exchange, GearForces
from rps_exudyn.solvers.gear_model import LAW, begin, finish, rates_of
from rps_exudyn.tooth_contact.elastic_teeth import begin_teeth, fill_compliance, press_teeth, room_of_teeth
from rps_exudyn.tooth_contact.flank_line import affine, side_of
from rps_exudyn.tooth_contact.laws import on_flanks, pose_of
from rps_exudyn.tooth_contact.teeth_data import PHI
from rps_exudyn.tooth_contact.teeth_stations import COLUMN, LENGTH, LINE_SIZE, P_R, P_T, P_Z, ROLL, find_lines
from rps_exudyn.tooth_contact.tooth_compliance import MODES
from verification.tooth_elements import Body, Division, Pinion, Rack, compliance

# Of the pool: numbers of rows and layers of nodes, then of each body its teeth and how its flank is measured
ROWS, LAYERS, PINION, RACK, HALF_FACE, START = 0, 1, 2, 5, 8, 9
NODES = 9  # of an element's face


def by_elements(division: Division | None = None) -> Exchange:
    """Return what puts the compliance of elements in the place of that of law "teeth"."""

    def exchange(forces: GearForces, gear: SteeringGear, fidelity: Fidelity) -> GearForces:
        tables, gears = pool_of(GearPair.of(gear).design, division), forces.gears.copy()
        gears["mesh"]["room"] = len(tables)
        room = np.zeros(room_of_teeth(gears[0]["mesh"]["flank"]))
        return replace(forces, law=elements_gear, gears=gears, pool=np.concatenate([tables, room]))

    return exchange


_pools: dict[tuple[GearPair, Division], np.ndarray] = {}


def pool_of(pair: GearPair, division: Division | None = None) -> np.ndarray:
    """Return the numbers that the law takes of a gear: both bodies' compliance; kept once computed."""
    division = division or Division()
    if (pair, division) not in _pools:
        bodies: Mapping[str, Body] = {"pinion": Pinion(pair, division), "rack": Rack(pair, division)}
        head: list[float] = [2 * division.flank + 1, 2 * division.along + 1]
        for body in bodies.values():
            head += [body.sectors, *body.flank_range]
        tables = [compliance(body).ravel() for body in bodies.values()]
        _pools[pair, division] = np.concatenate([head, [pair.face_width / 2], *tables])
    return _pools[pair, division]


@inline
def place_on(nodes, weights, i, u, t, rows, layers):  # type: ignore[no-untyped-def]
    """Fill a station's nodes and their weights, at shares 0 to 1 up the flank and -1 to 1 along the tooth."""
    row, layer = min(max(u, 0.0), 1.0) * (rows - 1), (min(max(t, -1.0), 1.0) + 1) / 2 * (layers - 1)
    r, k = min(int(row / 2) * 2, rows - 3), min(int(layer / 2) * 2, layers - 3)
    x, y = row - r - 1, layer - k - 1
    for a in range(3):
        by_row = 1 - x * x if a == 1 else x * (x + a - 1) / 2
        for b in range(3):
            by_layer = 1 - y * y if b == 1 else y * (y + b - 1) / 2
            nodes[i, 3 * a + b] = (r + a) * layers + k + b
            weights[i, 3 * a + b] = by_row * by_layer


@inline
def between(table, teeth, count, away, side, other, nodes, weights, i, j):  # type: ignore[no-untyped-def]
    """Return the compliance between two stations, `away` teeth from each other [m/N]."""
    value, first = 0.0, ((away % teeth) * 2 + side) * count
    for a in range(NODES):
        row, part = ((first + nodes[i, a]) * 2 + other) * count, 0.0
        for b in range(NODES):
            part += table[row + nodes[j, b]] * weights[j, b]
        value += part * weights[i, a]
    return value


@inline
def elements_matrix(lines, n, drive, coast, data, pool):  # type: ignore[no-untyped-def]
    """Return the compliance of all stations without the Hertzian part, lower triangle, shape (n, n) [m/N]."""
    flank, stations = data.flank, lines.stations
    count, rows, layers = flank.stations, int(pool[ROWS]), int(pool[LAYERS])
    total, points = n * count, rows * layers
    nodes, weights = np.empty((2, total, NODES), np.int64), np.empty((2, total, NODES))
    for i in range(total):
        side = drive if lines.side[i // count] < 0 else coast
        p_r, p_t, z = stations[P_R, i], stations[P_T, i], stations[P_Z, i]
        u = (stations[ROLL, i] - pool[PINION + 1]) / (pool[PINION + 2] - pool[PINION + 1])
        place_on(nodes[0], weights[0], i, u, z / pool[HALF_FACE], rows, layers)
        y, along = affine(side.y, p_r, p_t, z), affine(side.z, p_r, p_t, z)
        u = (-y - data.teeth.reference_depth - pool[RACK + 1]) / (pool[RACK + 2] - pool[RACK + 1])
        chord = np.sqrt(max(flank.bar_radius * flank.bar_radius - y * y, 1e-12))
        place_on(nodes[1], weights[1], i, u, along / chord, rows, layers)
    of_pinion, of_rack = int(pool[PINION]), int(pool[RACK])
    pinion = pool[START : START + of_pinion * 4 * points * points]
    rack = pool[START + pinion.size :]
    matrix = np.empty((total, total))
    for i in range(total):
        a, side = i // count, 0 if lines.side[i // count] < 0 else 1
        for j in range(i + 1):
            b, other = j // count, 0 if lines.side[j // count] < 0 else 1
            # the pinion's teeth are counted to the left, the rack's to the right
            away, on = int(lines.tooth[b] - lines.tooth[a]), int(lines.rack_tooth[a] - lines.rack_tooth[b])
            matrix[i, j] = between(
                pinion, of_pinion, points, away, side, other, nodes[0], weights[0], i, j
            ) + between(rack, of_rack, points, on, side, other, nodes[1], weights[1], i, j)
    return matrix


@kernel
def elements_contact(angle, rate, position, rotation, velocity, spin, data, pool, work, factor_q, factor_v):  # type: ignore[no-untyped-def]
    """Fill the wrench as `elastic_teeth.teeth_contact` does."""
    room = pool[data.room :]
    drive, coast, lines, n = begin_teeth(
        angle, rate, position, rotation, velocity, spin, data, pool, room, work
    )
    matrix = elements_matrix(lines, n, drive, coast, data, pool)
    left = room[lines.side.size * LINE_SIZE + lines.stations.shape[1] * COLUMN :]
    press_teeth(matrix, lines, n, drive, coast, angle, position, data, work, factor_q, factor_v, left)


@entry(*LAW)
def elements_gear(q, v, gears, g, pool, works, factor_q, factor_v, total, tangent):  # type: ignore[no-untyped-def]
    """A gear with this law."""
    gear, work = gears[g], works[0]
    by_rate = begin(q, v, gear, pool, work, factor_q, factor_v)
    place, rates, mesh = work.place, rates_of(gear.mesh.flank.law, work), gear.mesh
    by_sliding = by_rate if mesh.flank.law.has_state else factor_v
    turn, pose = pose_of(place, rates, mesh.flank.rack_reference, work.contact.pose), work.contact.pose
    at = place[0], rates[0], pose[3], pose[0:3], rates[1:4], pose[4]
    elements_contact(*at, mesh, pool, work.contact, factor_q, by_sliding)
    on_flanks(place, turn, mesh.flank, work.contact, factor_q, by_sliding, work.out, work.near)
    finish(q, v, gear, pool, work, factor_q, factor_v, by_rate, total, tangent)


class LineYields(NamedTuple):
    """Stations of one pose, (n,) each, and yields between them without flattening, (n, n) each [m/N]."""

    side: np.ndarray
    tooth: np.ndarray
    rack_tooth: np.ndarray
    length: np.ndarray  # of line that a station stands for [m]
    law: np.ndarray
    elements: np.ndarray


@from_python
def line_yields(angle, position, tilt, records, pool, room):  # type: ignore[no-untyped-def]
    """Return `LineYields` of a gear of law "teeth"; arguments as those of `line_loads`, the pool,
    and a room of `room_of_teeth`."""
    data = records[0]
    still, flank, rotation = np.zeros(3), data.flank, np.empty((3, 3))
    fill_rotation(tilt, rotation)
    drive = side_of(-1.0, angle, 0.0, position, rotation, still, still, flank)
    coast = side_of(1.0, angle, 0.0, position, rotation, still, still, flank)
    lines, n = find_lines(angle, drive, coast, data, pool, room)
    total = n * flank.stations
    of_elements, law = elements_matrix(lines, n, drive, coast, data, pool), np.empty((total, total))
    fill_compliance(law, lines, n, data)
    side, tooth, rack_tooth = np.empty(total), np.empty(total), np.empty(total)
    for i in range(total):
        line = i // flank.stations
        side[i], tooth[i], rack_tooth[i] = lines.side[line], lines.tooth[line], lines.rack_tooth[line]
        for j in range(i):
            law[j, i], of_elements[j, i] = law[i, j], of_elements[i, j]
    length = lines.stations[LENGTH, :total].copy()
    return LineYields(side, tooth, rack_tooth, length, law[:total, :total], of_elements[:total, :total])


def one_body(records: np.ndarray, pool: np.ndarray, body: str) -> tuple[np.ndarray, ...]:
    """Return the last arguments of `line_yields` with the other body rigid; torsion belongs to the pinion."""
    records, pool = records.copy(), pool.copy()
    start = START + int(pool[PINION]) * 4 * int(pool[ROWS] * pool[LAYERS]) ** 2
    if body == "pinion":
        records["teeth"]["rack_scale"] = 0.0
        pool[start:] = 0.0
    else:
        records["teeth"]["form"][:, PHI : PHI + MODES] = records["teeth"]["torsion"] = 0.0
        pool[START:start] = 0.0
    return records, pool, np.zeros(room_of_teeth(records[0]["flank"]))
