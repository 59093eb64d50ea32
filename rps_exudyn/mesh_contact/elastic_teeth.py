"""Contact of flanks whose teeth bend together: law "teeth".

All lines of contact of both sides stand under one system of equations (`unilateral`): a station yields by the
loads on all stations of its two teeth (`tooth_compliance`), by its own line's Hertzian flattening, and by the
torsion of the pinion's core. Drive and coast flank bend the same tooth against each other; most of that
bending cancels, which laws without it miss.
"""

import numpy as np

from rps_exudyn.base.compiled import apart, borrowing, inlined
from rps_exudyn.mesh_contact.contact_tangent import add_turn_of_loads, slopes_of
from rps_exudyn.mesh_contact.flank_line import (
    DAMPING_LOSS,
    DEEPEST,
    ENERGY,
    LINES,
    SUMS,
    add_load,
    add_side,
    begin_side,
    note_line_load,
    side_of,
)
from rps_exudyn.mesh_contact.steel import HERTZ
from rps_exudyn.mesh_contact.teeth_stations import DEPTH, LENGTH, P_R, P_T, P_Z, RATE, ROLL, TOP, find_lines
from rps_exudyn.mesh_contact.teeth_tangent import add_teeth
from rps_exudyn.mesh_contact.tooth_compliance import add_block, add_line
from rps_exudyn.mesh_contact.unilateral import local_energy, press_stations
from rps_exudyn.mesh_contact.wrench import WRENCH_SIZE

GUESS = 20e9  # load per length and depth with which the solution begins [N/m^2]


@apart
def teeth_contact(angle, rate, position, rotation, velocity, spin, data):  # type: ignore[no-untyped-def]
    """The mesh contact kernel of law "teeth", see `wrench`; `data` from `teeth_data`."""
    unused = np.empty((0, 0))
    return teeth_contact_tangent(angle, rate, position, rotation, velocity, spin, data, unused, 0.0, 0.0)


@apart
def teeth_contact_tangent(  # type: ignore[no-untyped-def]
    angle, rate, position, rotation, velocity, spin, data, stiffness, factor_q, factor_v
):
    """The same; adds the tangent to `stiffness` unless both factors are 0, see `contact_tangent.Slopes`."""
    out, flank = np.zeros(WRENCH_SIZE), data.flank
    drive = side_of(-1.0, angle, rate, position, rotation, velocity, spin, flank)
    coast = side_of(1.0, angle, rate, position, rotation, velocity, spin, flank)
    lines, n = find_lines(angle, drive, coast, data)
    count = flank.along.shape[2]
    force, elastic = np.empty(n * count), np.empty(n * count)
    matrix = compliance_matrix(lines, n, data)
    if not solve_loads(matrix, lines, data, force, elastic):
        out[:] = np.nan
        return out
    sums, energy = np.empty(SUMS), stored_energy(lines, elastic)
    of_drive = slopes_of(stiffness, factor_q, factor_v, drive, angle, position, flank)
    of_coast = slopes_of(stiffness, factor_q, factor_v, coast, angle, position, flank)
    if of_drive.wanted:
        add_teeth(matrix, lines, force, drive, coast, of_drive, of_coast, data)
    for side, slopes in ((drive, of_drive), (coast, of_coast)):
        begin_side(side, flank, sums)
        for line in range(n):
            if lines.side[line] == side.sign:
                _add_loads(lines, line, force, elastic, side, flank, sums)
        sums[ENERGY], energy = energy, 0.0
        add_side(sums, angle, position, side, flank, out)
        if slopes.wanted:
            add_turn_of_loads(sums, side, slopes)
    return out


@borrowing
def _add_loads(lines, line, force, elastic, side, flank, sums):  # type: ignore[no-untyped-def]
    """Add the loads of one line."""
    stations, count, pressed = lines.stations, flank.along.shape[2], False
    for i in range(line * count, (line + 1) * count):
        if force[i] > 0:
            pressed = True
            add_load(force[i], stations[P_R, i], stations[P_T, i], stations[P_Z, i], side, flank, sums)
            sums[DAMPING_LOSS] += (force[i] - elastic[i]) * stations[RATE, i]
            note_line_load(force[i] / stations[LENGTH, i], stations[ROLL, i], sums)
    if pressed:
        sums[LINES] += 1
        sums[DEEPEST] = max(sums[DEEPEST], lines.deepest[line])


# --- loads -----------------------------------------------------------------------------------------
@inlined
def compliance_matrix(lines, n, data):  # type: ignore[no-untyped-def]
    """Return the compliance of all stations without the Hertzian part, lower triangle, shape (n, n) [m/N]."""
    nodes, weights = data.flank.along[0, 0], data.flank.along[0, 1]
    count = nodes.size
    matrix = np.empty((n * count, n * count))
    for a in range(n):
        for b in range(a + 1):
            torsion = data.torsion * lines.side[a] * lines.side[b]
            for i in range(a * count, (a + 1) * count):
                for j in range(b * count, (b + 1) * count):
                    matrix[i, j] = torsion
            same_side = lines.side[a] == lines.side[b]
            if a == b:
                add_line(matrix, lines.on_pinion, a * count, nodes, weights, data.pinion)
                add_line(matrix, lines.on_rack, a * count, nodes, weights, data.rack)
                continue
            if lines.tooth[a] == lines.tooth[b]:
                sigma = 1.0 if same_side else -data.pinion.coupling
                add_block(matrix, lines.on_pinion, a * count, b * count, count, sigma, data.pinion)
            if lines.rack_tooth[a] == lines.rack_tooth[b]:
                sigma = 1.0 if same_side else -data.rack.coupling
                add_block(matrix, lines.on_rack, a * count, b * count, count, sigma, data.rack)
    return matrix


@inlined
def solve_loads(matrix, lines, data, force, elastic):  # type: ignore[no-untyped-def]
    """Fill the forces of all stations, and those without damping; returns whether they were found."""
    damping = data.flank.damping
    depth, length, top = lines.stations[DEPTH], lines.stations[LENGTH], lines.stations[TOP]
    found = press_stations(force.size, matrix, depth, length, top, HERTZ, GUESS, elastic)
    for i in range(force.size):
        force[i] = elastic[i]
    if found and damping > 0:
        pressing = np.empty(force.size)
        for i in range(force.size):
            pressing[i] = depth[i] + damping * lines.stations[RATE, i]
        found = press_stations(force.size, matrix, pressing, length, top, HERTZ, GUESS, force)
    return found


@borrowing
def stored_energy(lines, elastic):  # type: ignore[no-untyped-def]
    """Elastic energy of teeth and contact [J]: half of force times bending, and of the Hertzian part."""
    energy = 0.0
    for i in range(elastic.size):
        if elastic[i] > 0:
            length, top = lines.stations[LENGTH, i], lines.stations[TOP, i]
            f = elastic[i] / length
            flattened, stored = local_energy(f, top, HERTZ)
            energy += length * stored + elastic[i] * (lines.stations[DEPTH, i] - flattened) / 2
    return energy
