"""Contact of flanks whose teeth bend together: law "teeth".

All lines of contact of both sides stand under one system of equations (`unilateral`): a station yields by the
loads on all stations of its two teeth (`tooth_compliance`), by its own line's Hertzian flattening, and by the
torsion of the pinion's core. Drive and coast flank bend the same tooth against each other; most of that
bending cancels, which laws without it miss.
"""

import numpy as np

from rps_exudyn.base.compiled import inline, kernel, placed, placed_numbers
from rps_exudyn.forces.rigid_motion import cross, scaled, vector
from rps_exudyn.gears.tooth_stiffness import EFFECTIVE_MODULUS, HERTZ
from rps_exudyn.tooth_contact.contact_tangent import (
    add_moved,
    add_to_patch,
    add_viscous,
    arm_of,
    friction_at,
    slopes_of,
)
from rps_exudyn.tooth_contact.flank_contact import begin_contact, end_side
from rps_exudyn.tooth_contact.flank_line import (
    DAMPING_LOSS,
    DEEPEST,
    ENERGY,
    LINES,
    Turning,
    add_load,
    begin_side,
    note_line_load,
    side_of,
    slip_at,
)
from rps_exudyn.tooth_contact.teeth_stations import (
    COLUMN,
    DEPTH,
    LENGTH,
    LINE_SIZE,
    P_R,
    P_T,
    P_Z,
    RATE,
    ROLL,
    TOP,
    find_lines,
    most_lines,
    room_of_lines,
)
from rps_exudyn.tooth_contact.tooth_compliance import add_block, add_line
from rps_exudyn.tooth_contact.unilateral import (
    factorize,
    local_energy,
    local_yield,
    press_stations,
    room_of_loads,
    substitute_all,
)
from rps_exudyn.tooth_contact.wrench import WRENCH_SIZE

GUESS = 20e9  # load per length and depth with which the solution begins [N/m^2]


def room_of_teeth(flank: np.void) -> int:
    """Return how much room law "teeth" takes on a gear, in numbers, by its record of flanks."""
    lines = most_lines(flank)
    n = lines * int(flank["stations"])
    full = (n + 3) // 4 * 4
    tangent = n + full * full + 18 * full
    return room_of_lines(lines, int(flank["stations"])) + n * n + 3 * n + max(room_of_loads(n), tangent)


@kernel
def teeth_contact(  # type: ignore[no-untyped-def]
    angle, rate, position, rotation, velocity, spin, data, pool, work, factor_q, factor_v
):
    """Fill the wrench of law "teeth", see `wrench`, and its stiffness unless both factors are 0, see
    `contact_tangent.Slopes`; `data` is a record `MESH`, `work` a `SCRATCH`, `pool` has `room_of_teeth`."""
    room = pool[data.room :]
    drive, coast, lines, n = begin_teeth(
        angle, rate, position, rotation, velocity, spin, data, pool, room, work
    )
    if n < 0:
        for i in range(WRENCH_SIZE):
            work.wrench[i] = np.nan
        return
    stations = n * data.flank.stations
    left = room[lines.side.size * LINE_SIZE + lines.stations.shape[1] * COLUMN :]
    matrix = placed(left, 0, (stations, stations))
    fill_compliance(matrix, lines, n, data)
    left = left[stations * stations :]
    press_teeth(matrix, lines, n, drive, coast, angle, position, data, work, factor_q, factor_v, left)


@inline
def begin_teeth(angle, rate, position, rotation, velocity, spin, data, pool, room, work):  # type: ignore[no-untyped-def]
    """Empty the sums; return both sides, the lines along which they may meet, and how many."""
    flank = data.flank
    begin_contact(flank.law, work)
    drive = side_of(-1.0, angle, rate, position, rotation, velocity, spin, flank)
    coast = side_of(1.0, angle, rate, position, rotation, velocity, spin, flank)
    lines, n = find_lines(angle, drive, coast, data, pool, room)
    return drive, coast, lines, n


@inline
def press_teeth(matrix, lines, n, drive, coast, angle, position, data, work, factor_q, factor_v, room):  # type: ignore[no-untyped-def]
    """Fill the wrench and its stiffness from the compliance of all stations."""
    flank, size = data.flank, n * data.flank.stations
    force, elastic, left = placed(room, 0, size), placed(room, size, size), room[2 * size :]
    if not solve_loads(matrix, lines, data, force, elastic, left):
        for i in range(WRENCH_SIZE):
            work.wrench[i] = np.nan
        return
    energy = stored_energy(lines, elastic)
    of_drive = slopes_of(work, factor_q, factor_v, drive, angle, position, flank)
    of_coast = slopes_of(work, factor_q, factor_v, coast, angle, position, flank)
    if of_drive.wanted:
        add_teeth(matrix, lines, force, drive, coast, of_drive, of_coast, data, work, left)
    for side, slopes in ((drive, of_drive), (coast, of_coast)):
        begin_side(side, flank, work)
        for line in range(n):
            if lines.side[line] == side.sign:
                _add_loads(lines, n, line, force, elastic, side, flank, work)
        work.sums[ENERGY], energy = energy, 0.0
        end_side(angle, position, side, flank, work, slopes)


@inline
def _add_loads(lines, n, line, force, elastic, side, flank, work):  # type: ignore[no-untyped-def]
    """Add the loads of one of n lines.

    No pressure is kept within a contact's width of a line's ends, nor on a line shorter than two widths:
    there an edge presses, which Hertz's line contact does not describe.
    """
    stations, count, pressed = lines.stations, flank.stations, False
    before = _length(lines, line - 1, line, n)
    end = before + lines.length[line] + _length(lines, line + 1, line, n)
    for i in range(line * count, (line + 1) * count):
        place = before + stations[LENGTH, i] / 2
        before += stations[LENGTH, i]
        if force[i] > 0:
            pressed = True
            add_load(force[i], stations[P_R, i], stations[P_T, i], stations[P_Z, i], side, flank, work)
            work.sums[DAMPING_LOSS] += (force[i] - elastic[i]) * stations[RATE, i]
            load = force[i] / stations[LENGTH, i]
            if contact_width(load, stations[ROLL, i] / flank.cos_base_helix) < min(place, end - place):
                note_line_load(load, stations[ROLL, i], work)
    if pressed:
        work.sums[LINES] += 0 if _goes_on(lines, line, force, count) else 1
        work.sums[DEEPEST] = max(work.sums[DEEPEST], lines.deepest[line])


@inline
def _length(lines, piece, line, n):  # type: ignore[no-untyped-def]
    """Return the length of a piece beside one of n lines [m]; 0 if there is none or it is of another line."""
    if piece < 0 or piece >= n:
        return 0.0
    if lines.tooth[piece] != lines.tooth[line] or lines.side[piece] != lines.side[line]:
        return 0.0
    return lines.length[piece]


@inline
def contact_width(load, radius):  # type: ignore[no-untyped-def]
    """Return the width 2a of Hertz's contact [m] of a load per length [N/m] on a radius [m]."""
    return 4 * np.sqrt(load * radius / (np.pi * EFFECTIVE_MODULUS))


@inline
def _goes_on(lines, line, force, count):  # type: ignore[no-untyped-def]
    """Return whether the piece before is of the same tooth's line and pressed."""
    if line == 0 or lines.tooth[line - 1] != lines.tooth[line] or lines.side[line - 1] != lines.side[line]:
        return False
    for i in range((line - 1) * count, line * count):  # noqa: SIM110, numba has no `any` of a generator
        if force[i] > 0:
            return True
    return False


# --- loads -----------------------------------------------------------------------------------------
@inline
def fill_compliance(matrix, lines, n, data):  # type: ignore[no-untyped-def]
    """Fill the compliance of all stations without the Hertzian part, lower triangle [m/N]."""
    count = data.flank.stations
    nodes, weights = data.flank.along[0, 0, :count], data.flank.along[0, 1, :count]
    for a in range(n):
        for b in range(a + 1):
            torsion = data.teeth.torsion * lines.side[a] * lines.side[b]
            for i in range(a * count, (a + 1) * count):
                for j in range(b * count, (b + 1) * count):
                    matrix[i, j] = torsion
            same_side = lines.side[a] == lines.side[b]
            if a == b:
                add_line(matrix, lines.on_pinion, a * count, nodes, weights, data.teeth.pinion)
                add_line(matrix, lines.on_rack, a * count, nodes, weights, data.teeth.rack)
                continue
            if lines.tooth[a] == lines.tooth[b]:
                add_block(matrix, lines.on_pinion, a * count, b * count, count, same_side, data.teeth.pinion)
            if lines.rack_tooth[a] == lines.rack_tooth[b]:
                add_block(matrix, lines.on_rack, a * count, b * count, count, same_side, data.teeth.rack)


@inline
def solve_loads(matrix, lines, data, force, elastic, room):  # type: ignore[no-untyped-def]
    """Fill the forces of all stations, and those without damping; returns whether they were found."""
    damping, pressing, left = data.flank.damping, placed(room, 0, force.size), room[force.size :]
    depth, length, top = lines.stations[DEPTH], lines.stations[LENGTH], lines.stations[TOP]
    found = press_stations(force.size, matrix, depth, length, top, HERTZ, GUESS, elastic, left)
    for i in range(force.size):
        force[i] = elastic[i]
    if found and damping > 0:
        for i in range(force.size):
            pressing[i] = depth[i] + damping * lines.stations[RATE, i]
        found = press_stations(force.size, matrix, pressing, length, top, HERTZ, GUESS, force, left)
    return found


@inline
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


# --- The tangent of teeth that bend together: the derivative of their equations through the pressed stations
#
# With the wrenches w_i per load of the pressed stations, those u_i of their friction (`contact_tangent`), and
# the tangent compliance A of their equations, a small motion m changes the wrench by -(W + U)^T A^-1 W m.
# Which stations are pressed does not change; the change of the compliance, which moves with the lines, is
# left out.


@inline
def add_teeth(matrix, lines, force, drive, coast, of_drive, of_coast, data, work, room):  # type: ignore[no-untyped-def]
    """Add the tangent of all stations' loads; `matrix` is their compliance, `force` their loads [N]."""
    count, flank, m = data.flank.stations, data.flank, 0
    chosen = placed_numbers(room, 0, force.size)
    for i in range(force.size):
        if force[i] > 0:
            chosen[m] = i
            m += 1
    full = (m + 3) // 4 * 4
    left = room[force.size :]
    system, left = placed(left, 0, (full, full)), left[full * full :]
    yields, normal, rubbing = (
        placed(left, 0, (full, 6)),
        placed(left, 6 * full, (m, 6)),
        placed(left, 12 * full, (m, 6)),
    )
    for row in range(full):
        for i in range(full):
            system[row, i] = 0.0
        for i in range(6):
            yields[row, i] = 0.0
    for row in range(m):
        i = chosen[row]
        for col in range(row):
            system[row, col] = matrix[i, chosen[col]]
        _, slope = local_yield(force[i] / lines.stations[LENGTH, i], lines.stations[TOP, i], HERTZ)
        system[row, row] = matrix[i, i] + slope / lines.stations[LENGTH, i]
        if lines.side[i // count] < 0:
            _fill_wrenches(lines, i, row, force[i], yields, rubbing, drive, flank, of_drive)
        else:
            _fill_wrenches(lines, i, row, force[i], yields, rubbing, coast, flank, of_coast)
        for j in range(6):
            normal[row, j] = yields[row, j]
    for row in range(m, full):
        system[row, row] = 1.0
    if not factorize(system, full):
        return
    substitute_all(system, full, yields)
    factor = of_drive.factor_q + flank.damping * of_drive.factor_v
    for row in range(m):
        side, slopes = (drive, of_drive) if lines.side[chosen[row] // count] < 0 else (coast, of_coast)
        for i in range(6):
            value = factor * normal[row, i]
            for j in range(6):
                slopes.stiffness[i, j] -= value * yields[row, j]
        if flank.law.has_state:
            _add_to_patch(lines.stations, chosen[row], -factor, yields[row], side, flank, work, slopes)
            continue
        for i in range(6):
            slopes.loads[i] -= factor * yields[row, i]
            value = factor * rubbing[row, i]
            for j in range(6):
                slopes.rubbing[i, j] -= value * yields[row, j]


@inline
def _fill_wrenches(lines, i, row, load, yields, rubbing, side, data, slopes):  # type: ignore[no-untyped-def]
    """Fill a station's wrenches per load, the normal one and that of friction; add what friction alone
    changes."""
    stations, piece, stance = lines.stations, i // data.stations, slopes.stance
    p_r, p_t, z = stations[P_R, i], stations[P_T, i], stations[P_Z, i]
    arm = arm_of(p_r, p_t, z, stance)
    slip_r, slip_b = slip_at(p_r, p_t, z, side)
    rub = friction_at(slip_r, slip_b, data, slopes)
    yields[row, 0], yields[row, 1], yields[row, 2] = stance.normal
    yields[row, 3], yields[row, 4], yields[row, 5] = cross(arm, stance.normal)
    rubbing[row, 0], rubbing[row, 1], rubbing[row, 2] = rub.force
    rubbing[row, 3], rubbing[row, 4], rubbing[row, 5] = cross(arm, rub.force)
    if data.law.has_state:
        return
    add_viscous(load, arm, rub, slopes)
    if lines.end[piece] != 0:
        at = lines.turning[:, piece]
        turning, k = Turning(at[0], at[1], at[2], at[3], at[4]), i % data.stations
        add_moved(load, 0.0, k, lines.end[piece], p_r, p_t, z, turning, side, data, slopes)


@inline
def _add_to_patch(stations, i, factor, yields, side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Add a station's change of load over the rack's motion to what bristles change by with it."""
    p_r, p_t, z = stations[P_R, i], stations[P_T, i], stations[P_Z, i]
    force, moment = scaled(factor, vector(yields[:3])), scaled(factor, vector(yields[3:]))
    arm = arm_of(p_r, p_t, z, slopes.stance)
    add_to_patch(force, moment, arm, p_r, p_t, z, side, data, work, slopes)
