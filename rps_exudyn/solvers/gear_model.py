"""All forces of a gear with their tangent: one function, whatever its teeth's contact and its rack.

Coordinates are stacked [pinion (about k), rack (6), plunger]. Behind them stand the modes of a rack that
bends (`bent_rack`), or the last segment (6) of a bush that is a chain; and last of all those of the supports
(5) of a pinion that has some (`forces.pinion_support`). The constants of a gear are a record `GEAR`, one of
an array, so that many gears differ by their place in it; `pool` holds what has no fixed size, and `work` is a
record `WORK` that no evaluation of a gear with a rigid pinion needs to allocate.

    law(q, v, gears, g, pool, works, factor_q, factor_v, total, tangent)

fills the generalised forces `total` (n,) on the coordinates q with rates v, and the outputs of all parts
`works[0].out`, see `COLUMNS`. Unless both factors are 0 it fills `tangent` (n, n) with factor_q dF/dq +
factor_v dF/dv, to a few per cent of its largest entry or better: what turns with the bar's small angles is
left out, but for the bush, where a roll of a tilted bar counts.

Friction with a state takes the slip from what the coordinates moved over a step (`forces.friction`): a step
of a coordinate is then one of its rate too.
"""

from rps_exudyn.base.compiled import (
    MATRIX,
    NUMBER,
    VECTOR,
    WHOLE,
    Array,
    Law,
    called,
    entry,
    inline,
    kernel,
    record_type,
    stacked,
    stacked_zeros,
)
from rps_exudyn.forces import bearing, external_load, pinion_support, sliding_fit, yoke
from rps_exudyn.forces.bearing import BEARING, bearing_force, bearing_slope
from rps_exudyn.forces.external_load import DEAD_FORCE, add_dead_tangent, dead_force
from rps_exudyn.forces.friction import MOST_COORDINATES, PATCH_SUMS, PLACES, begin_step, duration
from rps_exudyn.forces.pinion_support import SUPPORT, axial_friction, held, place_of, seen_from_pinion
from rps_exudyn.forces.sliding_fit import FIT, add_fit_tangent, carried_fit_force, held_fit_force
from rps_exudyn.forces.yoke import (
    BORE,
    MOST_POINTS,
    NUT,
    SEAT,
    SPRING,
    add_seat_tangent,
    bore_force,
    nut_force,
    nut_slope,
    seat_force,
    spring_force,
)
from rps_exudyn.solvers.bent_rack import (
    BAR,
    MOST_LOCAL,
    MOST_SECTIONS,
    POSE,
    RATE,
    add_elasticity,
    add_elasticity_tangent,
    add_geometric,
    add_products,
    add_to_bar,
    bar_sections,
    fill_pose,
    fill_pose_by_bar,
)
from rps_exudyn.tooth_contact import wrench
from rps_exudyn.tooth_contact.laws import (
    BY_LINE,
    BY_SPHERES,
    BY_TEETH,
    KINDS,
    MESH,
    SCRATCH,
    line_law,
    sphere_law,
    teeth_law,
    triangle_law,
)

# Parts in the order of their outputs
PARTS = (
    wrench.PART,
    yoke.SEAT_PART,
    yoke.SPRING_PART,
    yoke.NUT_PART,
    bearing.PART,
    sliding_fit.PART,
    external_load.LOAD,
    external_load.WEIGHT,
    pinion_support.PART,
    yoke.BORE_PART,
)
COLUMNS: dict[str, slice] = {}
"""Part -> its columns of the outputs."""
for _part in PARTS:
    _first = max((each.stop for each in COLUMNS.values()), default=0)
    COLUMNS[_part.name] = slice(_first, _first + _part.columns)
OUTPUTS = _first + _part.columns
_MESH, _SEAT, _SPRING, _NUT, _BEARING, _BUSH, _LOAD, _WEIGHT, _SUPPORT, _BORE = (
    each.start for each in COLUMNS.values()
)
RIGID = 8  # coordinates of pinion, rack and plunger
HELD = pinion_support.SIZE  # of the supports
NEAR = RIGID + HELD  # what the forces beside the mesh depend on
SEAT_LOADS = _SEAT + 10  # first of the seat's own outputs

GEAR = record_type(
    [
        ("mesh", MESH),
        ("seat", SEAT),
        ("spring", SPRING),
        ("nut", NUT),
        ("bore", BORE),
        ("has_bore", "i8"),  # which rubs or damps
        ("bearing", BEARING),
        ("fit", FIT),
        ("load", DEAD_FORCE),  # at the rack's end
        ("weight", DEAD_FORCE),  # of the rack
        ("is_bent", "i8"),  # the rack bends or is not straight ...
        ("bar", BAR),  # ... and this is its bar
        ("support", SUPPORT),  # of the pinion
        ("is_supported", "i8"),  # else the pinion only turns
        ("has_load", "i8"),
        ("has_weight", "i8"),
        ("is_carried", "i8"),  # the rack slides in a segment of a chain, else in the housing
        ("has_bristles", "i8"),
    ]
)
"""Record of a gear: the constants of all its force laws."""

WORK = record_type(
    [
        ("contact", SCRATCH),
        ("out", "f8", (OUTPUTS,)),
        # of pinion, of a straight rack that touches the bar at the mesh, of plunger, of the supports
        ("place", "f8", (NEAR,)),
        ("rate", "f8", (NEAR,)),  # where friction has a state: means over the step
        ("ended", "f8", (NEAR,)),  # where it has none: those at its end
        ("near", "f8", (NEAR, NEAR)),  # tangent by these
        ("beside", "f8", (2, 6)),  # place and rate of that rack, where `place` has those seen by the pinion
        ("carry", "f8", (6, 11)),  # derivatives of these by the rack's coordinates and the pinion's place
        ("by_seat", "f8", (HELD, HELD)),  # of that place by the supports' coordinates
        ("held", "f8", (HELD,)),  # elastic force of the supports ...
        ("held_slope", "f8", (HELD, HELD)),  # ... and its derivative
        ("on_support", "f8", (NEAR,)),  # forces of mesh and supports on all these
        ("of_mesh", "f8", (2, 2)),  # part of it: of the mesh's forces along X and Y, by the same
        ("of_loads", "f8", (2, 7)),  # tangent of the seat's own outputs, by rack and plunger
        ("points", "f8", (MOST_POINTS, 4)),  # of the seat
        ("rubbed", "f8", (PATCH_SUMS,)),  # its sums of bristles
        ("slip", "f8", (MOST_COORDINATES,)),  # rates with which contacts slip
        ("of_fit", "f8", (5, 4)),  # elastic stiffness and loads of rack and bush
        ("on_carrier", "f8", (6,)),
    ]
)
"""Record of the work space."""

GEARS, WORKS = Array(GEAR, 1), Array(WORK, 1)
LAW = (VECTOR, VECTOR, GEARS, WHOLE, VECTOR, WORKS, NUMBER, NUMBER, VECTOR, MATRIX)


# --- assembly --------------------------------------------------------------------------------------
@inline
def _begin(q, v, gear, work, factor_q, factor_v):  # type: ignore[no-untyped-def]
    """Fill where the laws find the bodies and how these slip; return the factor of the derivative by `rate`.

    Friction with a state slips by the mean rates of the step, by which it stores what is taken from the
    bodies. Friction that depends on the rate itself takes that at the step's end: by the mean, a step that
    stops a slip would hand it on with the other sign, and rates would swing from step to step undamped.
    """
    memory, h = work.contact.memory, 0.0
    if gear.has_bristles:
        h = duration(memory)
        for i in range(q.size):
            memory[1, PLACES + i] = q[i]
    for i in range(q.size):
        work.slip[i] = (q[i] - memory[0, PLACES + i]) / h if h > 0 else v[i]
    for i in range(8):
        work.place[i], work.rate[i], work.ended[i] = q[i], work.slip[i], v[i]
    for i in range(near_size(gear)):
        for j in range(near_size(gear)):
            work.near[i, j] = 0.0
    return factor_q / h if h > 0 else factor_v


@inline
def near_size(gear):  # type: ignore[no-untyped-def]
    """Number of coordinates on which the forces at the mesh depend."""
    return NEAR if gear.is_supported else RIGID


@inline
def rates_of(law, work):  # type: ignore[no-untyped-def]
    """Return the rates of `place` that a part's friction takes."""
    return work.rate if law.has_state else work.ended


@kernel
def go_beside_pinion(q, v, gear, work):  # type: ignore[no-untyped-def]
    """Let the teeth see the rack from a supported pinion; `leave_pinion` goes back."""
    first, place, rate = q.size - HELD, work.place, rates_of(gear.mesh.flank.law, work)
    for i in range(HELD):
        place[RIGID + i] = q[first + i]
        work.rate[RIGID + i], work.ended[RIGID + i] = work.slip[first + i], v[first + i]
    for i in range(6):
        work.beside[0, i], work.beside[1, i] = place[1 + i], rate[1 + i]
    p, p_rate, out = stacked(HELD), stacked(HELD), work.out
    energy, upper, lower, axial = held(place[RIGID:NEAR], gear.support, work.held, work.held_slope)
    place_of(
        place[RIGID:NEAR],
        rate[RIGID:NEAR],
        gear.support,
        work.held,
        work.held_slope,
        work.by_seat,
        p,
        p_rate,
    )
    seen_from_pinion(place[1:7], rate[1:7], p, p_rate, gear.support, work.carry)
    out[_SUPPORT], out[_SUPPORT + 2] = energy, 0.0
    for i in range(3):
        out[_SUPPORT + 3 + i] = p[i]
    out[_SUPPORT + 6], out[_SUPPORT + 7], out[_SUPPORT + 8] = upper, lower, axial


@kernel
def leave_pinion(gear, work, factor_q, factor_v, by_rate):  # type: ignore[no-untyped-def]
    """Turn the teeth's forces and tangent into those by the rack's own coordinates and the supports', and add
    the supports' own."""
    place, out, near, memory = work.place, work.out, work.near, work.contact.memory
    rate = rates_of(gear.mesh.flank.law, work)
    for i in range(6):
        place[1 + i], rate[1 + i] = work.beside[0, i], work.beside[1, i]
    by = stacked_zeros((7, NEAR))  # of what the teeth see
    by[0, 0] = 1.0
    for i in range(6):
        for j in range(6):
            by[1 + i, 1 + j] = work.carry[i, j]
        for j in range(HELD):
            for k in range(HELD):
                by[1 + i, RIGID + j] += work.carry[i, 6 + k] * work.by_seat[k, j]
    for j in range(NEAR):
        work.on_support[j] = 0.0
        for i in range(7):
            work.on_support[j] += by[i, j] * out[_MESH + i]
        if j < 7:
            out[_SUPPORT + 11 + j] = work.on_support[j]
        elif j >= RIGID:
            out[_SUPPORT + 10 + j] = work.on_support[j]
    stored = stacked(3)
    friction, braking = axial_friction(work.rate[RIGID + 2], gear.support, memory, stored)
    for i in range(HELD):
        for k in range(HELD):
            work.on_support[RIGID + i] += work.by_seat[k, i] * (gear.support.pressed[k] - work.held[k])
    work.on_support[RIGID + 2] += friction
    out[_SUPPORT] += stored[2]
    out[_SUPPORT + 1], out[_SUPPORT + 9], out[_SUPPORT + 10] = stored[0], stored[1], stored[2]
    if factor_q == 0 and factor_v == 0:
        return
    half = stacked_zeros((7, NEAR))
    for i in range(7):
        for k in range(7):
            if near[i, k] != 0:
                for j in range(NEAR):
                    half[i, j] += near[i, k] * by[k, j]
    for i in range(NEAR):
        for j in range(NEAR):
            near[i, j] = 0.0
            for k in range(7):
                near[i, j] += by[k, i] * half[k, j]
    for i in range(HELD):
        for j in range(HELD):
            for k in range(HELD):
                near[RIGID + i, RIGID + j] -= factor_q * work.by_seat[k, i] * work.held_slope[k, j]
    near[RIGID + 2, RIGID + 2] += by_rate * braking


@kernel
def _begin_straight(q, v, gear, work, factor_q, factor_v):  # type: ignore[no-untyped-def]
    """The same of a rack that is straight and rigid, as the pinion sees it."""
    by_rate = _begin(q, v, gear, work, factor_q, factor_v)
    if gear.is_supported:
        go_beside_pinion(q, v, gear, work)
    return by_rate


@kernel
def _begin_bent(q, v, gear, pool, work, factor_q, factor_v):  # type: ignore[no-untyped-def]
    """The same with the pose of a straight rack that touches the bar where mesh and yoke stand, at X = 0."""
    by_rate = _begin(q, v, gear, work, factor_q, factor_v)
    pose, sections = stacked((3, 6)), stacked((4, gear.bar.modes + 2), MOST_SECTIONS)
    bar_sections(-q[1], gear.bar, pool, sections)
    fill_pose(q, v, sections, -1.0, gear.bar, pose)
    for i in range(6):
        work.ended[1 + i] = pose[RATE, i]
    fill_pose(q, work.slip, sections, -1.0, gear.bar, pose)
    for i in range(6):
        work.place[1 + i], work.rate[1 + i] = pose[POSE, i], pose[RATE, i]
    if gear.is_supported:
        go_beside_pinion(q, v, gear, work)
    return by_rate


@inline
def begin(q, v, gear, pool, work, factor_q, factor_v):  # type: ignore[no-untyped-def]
    """Fill what the teeth's contact sees; return the factor of the derivative by the bodies' mean rates."""
    if gear.is_bent:
        return _begin_bent(q, v, gear, pool, work, factor_q, factor_v)
    return _begin_straight(q, v, gear, work, factor_q, factor_v)


@kernel
def _add_others(gear, work, factor_q, factor_v, by_rate):  # type: ignore[no-untyped-def]
    """Fill the outputs of yoke and bearing, and add their tangents if they are wanted."""
    place, out, near, memory = work.place, work.out, work.near, work.contact.memory
    rate, turning = rates_of(gear.seat.law, work), rates_of(gear.bearing.law, work)[0]
    if gear.is_supported:
        leave_pinion(gear, work, factor_q, factor_v, by_rate)
    for i in range(2):
        for j in range(2):
            work.of_mesh[i, j] = near[1 + i, 1 + j]
    seat_force(place[1:8], rate[1:8], gear.seat, memory, work.rubbed, work.points, out[_SEAT : _SEAT + 14])
    spring_force(place[7], gear.spring, out[_SPRING : _SPRING + 5])
    nut_force(place[7], work.ended[7], gear.nut, out[_NUT : _NUT + 5])
    if gear.has_bore:
        sliding = rates_of(gear.bore.law, work)[7]
        by_bore = by_rate if gear.bore.law.has_state else factor_v
        near[7, 7] += by_bore * bore_force(sliding, gear.bore, memory, out[_BORE : _BORE + 7])
    load = out[_SUPPORT + 6] + out[_SUPPORT + 7] if gear.is_supported else 0.0
    bearing_force(turning, load, gear.bearing, memory, out[_BEARING : _BEARING + 7])
    if factor_q == 0 and factor_v == 0:
        return
    at = gear.seat, memory, work.rubbed, work.points
    by_sliding = by_rate if gear.seat.law.has_state else factor_v
    add_seat_tangent(place[1:8], rate[1:8], *at, factor_q, by_sliding, near[1:8, 1:8], work.of_loads)
    near[7, 7] -= factor_q * gear.spring.rate
    near[7, 7] += nut_slope(place[7], work.ended[7], gear.nut, factor_q, factor_v)
    by_turning = by_rate if gear.bearing.law.has_state else factor_v
    near[0, 0] += by_turning * bearing_slope(turning, load, gear.bearing, memory)


@inline
def _near_force(i, gear, work):  # type: ignore[no-untyped-def]
    """The force of mesh, supports, yoke and bearing on a coordinate of `place`."""
    out, force = work.out, 0.0
    if gear.is_supported:
        force += work.on_support[i]
    elif i < 7:
        force += out[_MESH + i]
    if 0 < i < 8:
        force += out[_SEAT + i - 1]
    if i == 7:
        force += out[_SPRING] + out[_NUT]
        if gear.has_bore:
            force += out[_BORE]
    if i == 0:
        force += out[_BEARING]
    return force


@inline
def _add_loads(q, gear, out):  # type: ignore[no-untyped-def]
    """Fill the outputs of load and weight on a rigid rack."""
    if gear.has_load:
        dead_force(q, gear.load, out[_LOAD : _LOAD + 10])
    if gear.has_weight:
        dead_force(q, gear.weight, out[_WEIGHT : _WEIGHT + 10])


@kernel
def _finish_straight(q, v, gear, work, factor_q, factor_v, by_rate, total, tangent):  # type: ignore[no-untyped-def]
    """Add the forces of all other parts to those of the teeth; of a rack that is straight and rigid."""
    _add_others(gear, work, factor_q, factor_v, by_rate)
    rack, rate, out, memory = q[1:7], rates_of(gear.fit.law, work)[1:7], work.out, work.contact.memory
    segment, by_sliding = stacked(6), by_rate if gear.fit.law.has_state else factor_v
    bush = out[_BUSH : _BUSH + 13]
    for i in range(8):
        total[i] = _near_force(i, gear, work)
    if gear.is_carried:
        on_carrier = work.on_carrier
        for i in range(6):
            segment[i] = work.slip[8 + i] if gear.fit.law.has_state else v[8 + i]
        carried_fit_force(rack, rate, q[8:14], segment, gear.fit, memory, bush, work.of_fit, on_carrier)
        for i in range(6):
            total[8 + i] = on_carrier[i]
    else:
        held_fit_force(rack, rate, gear.fit, memory, bush, work.of_fit)
    _add_loads(rack, gear, out)
    _add_support(gear, work, total)
    for i in range(6):
        total[1 + i] += out[_BUSH + i]
        if gear.has_load:
            total[1 + i] += out[_LOAD + i]
        if gear.has_weight:
            total[1 + i] += out[_WEIGHT + i]
    if factor_q == 0 and factor_v == 0:
        return
    if gear.has_load:
        add_dead_tangent(rack, gear.load, factor_q, work.near[1:7, 1:7])
    if gear.has_weight:
        add_dead_tangent(rack, gear.weight, factor_q, work.near[1:7, 1:7])
    if gear.is_carried:
        _carried_tangent(q, rate, segment, gear, work, factor_q, by_sliding, tangent)
    else:
        of_fit, near = work.of_fit, work.near[1:7, 1:7]
        add_fit_tangent(rack, rate, gear.fit, memory, of_fit, factor_q, by_sliding, near)
        size = near_size(gear)
        for i in range(size):
            for j in range(size):
                tangent[i, j] = work.near[i, j]


@inline
def _add_support(gear, work, total):  # type: ignore[no-untyped-def]
    """Fill the forces on the supports' coordinates, the last ones."""
    if gear.is_supported:
        for i in range(HELD):
            total[total.size - HELD + i] = _near_force(RIGID + i, gear, work)


@kernel
def _carried_tangent(q, rate, segment, gear, work, factor_q, factor_v, tangent):  # type: ignore[no-untyped-def]
    """Fill the tangent of a rack in a segment (14, 14), and of supports behind: the fit moves with the rack
    against the segment."""
    rack, relative, fit = stacked(6), stacked(6), stacked_zeros((6, 6))
    for i in range(6):
        rack[i], relative[i] = q[1 + i], rate[i] - segment[i]
    add_fit_tangent(rack, relative, gear.fit, work.contact.memory, work.of_fit, factor_q, factor_v, fit)
    n = tangent.shape[0]
    for i in range(n):
        for j in range(n):
            tangent[i, j] = 0.0
    size = near_size(gear)
    for i in range(size):
        for j in range(size):
            tangent[i if i < 8 else 6 + i, j if j < 8 else 6 + j] = work.near[i, j]
    # the segment's motion seen as one of the rack: between the reference points lie both levers
    carry, along = stacked_zeros((6, 6)), gear.fit.station - q[1] - gear.fit.lever
    for i in range(6):
        carry[i, i] = 1.0
    carry[1, 5], carry[2, 4] = -along, along
    for i in range(6):
        for j in range(6):
            tangent[1 + i, 1 + j] += fit[i, j]
            for k in range(6):
                tangent[1 + i, 8 + j] -= fit[i, k] * carry[k, j]
                tangent[8 + i, 1 + j] -= carry[k, i] * fit[k, j]
                for m in range(6):
                    tangent[8 + i, 8 + j] += carry[k, i] * fit[k, m] * carry[m, j]


@kernel
def _finish_bent(q, v, gear, pool, work, factor_q, factor_v, by_rate, total, tangent):  # type: ignore[no-untyped-def]
    """The same of a rack that bends or is not straight, see `bent_rack`."""
    _add_others(gear, work, factor_q, factor_v, by_rate)
    bar, out, memory, n = gear.bar, work.out, work.contact.memory, q.size
    wanted = factor_q != 0 or factor_v != 0
    pose, forces = stacked((3, 6)), stacked(6)
    sections = stacked((4, bar.modes + 2), MOST_SECTIONS)
    size = near_size(gear)
    by, local = stacked_zeros((size, n), MOST_LOCAL), stacked_zeros((6, 6))
    for i in range(n):
        total[i] = 0.0
    _add_support(gear, work, total)
    if wanted:
        for i in range(n):
            for j in range(n):
                tangent[i, j] = 0.0
        add_elasticity_tangent(bar, pool, factor_q, by_rate, tangent)
    add_elasticity(total, q, work.slip, bar, pool)

    bar_sections(-q[1], bar, pool, sections)
    fill_pose(q, work.slip, sections, -1.0, bar, pose)
    for i in range(6):
        forces[i] = _near_force(1 + i, gear, work)
    total[0] += _near_force(0, gear, work)
    total[7] += _near_force(7, gear, work)
    add_to_bar(total, forces, pose, sections, -1.0, bar)
    if wanted:
        fill_pose_by_bar(pose, sections, -1.0, bar, by)
        for i in range(RIGID, size):
            by[i, n - NEAR + i] = 1.0
        add_products(by, size, work.near, tangent)
        add_geometric(tangent, forces, sections, -1.0, factor_q, bar)

    bar_sections(gear.fit.station - q[1], bar, pool, sections)
    by_sliding = by_rate if gear.fit.law.has_state else factor_v
    if gear.fit.law.has_state:
        fill_pose(q, work.slip, sections, -1.0, bar, pose)
    else:
        fill_pose(q, v, sections, -1.0, bar, pose)
    held_fit_force(pose[POSE], pose[RATE], gear.fit, memory, out[_BUSH : _BUSH + 13], work.of_fit)
    for i in range(6):
        forces[i] = out[_BUSH + i]
    add_to_bar(total, forces, pose, sections, -1.0, bar)
    if wanted:
        of_fit = work.of_fit
        add_fit_tangent(pose[POSE], pose[RATE], gear.fit, memory, of_fit, factor_q, by_sliding, local)
        fill_pose_by_bar(pose, sections, -1.0, bar, by)
        add_products(by[1:7], 6, local, tangent)
        add_geometric(tangent, forces, sections, -1.0, factor_q, bar)

    if gear.has_load:
        bar_sections(gear.load.place, bar, pool, sections)
        fill_pose(q, work.slip, sections, 0.0, bar, pose)
        dead_force(pose[POSE], gear.load, out[_LOAD : _LOAD + 10])
        for i in range(6):
            forces[i] = out[_LOAD + i]
        add_to_bar(total, forces, pose, sections, 0.0, bar)
    if gear.has_weight:
        dead_force(q[1:7], gear.weight, out[_WEIGHT : _WEIGHT + 10])
        for i in range(6):  # on the rigid body: it bends no mode of a free bar
            total[1 + i] += out[_WEIGHT + i]


@inline
def finish(q, v, gear, pool, work, factor_q, factor_v, by_rate, total, tangent):  # type: ignore[no-untyped-def]
    """Add the forces of all other parts to those of the teeth."""
    if gear.is_bent:
        _finish_bent(q, v, gear, pool, work, factor_q, factor_v, by_rate, total, tangent)
    else:
        _finish_straight(q, v, gear, work, factor_q, factor_v, by_rate, total, tangent)


@entry(*LAW)
def gear_law(q, v, gears, g, pool, works, factor_q, factor_v, total, tangent):  # type: ignore[no-untyped-def]
    """The forces of a gear, its teeth's contact by `mesh.kind`."""
    gear, work = gears[g], works[0]
    by_rate = begin(q, v, gear, pool, work, factor_q, factor_v)
    at = work.place, rates_of(gear.mesh.flank.law, work), gear.mesh, pool, work.contact
    by_sliding = by_rate if gear.mesh.flank.law.has_state else factor_v
    if gear.mesh.kind == BY_LINE:
        line_law(*at, factor_q, by_sliding, work.out, work.near)
    elif gear.mesh.kind == BY_TEETH:
        teeth_law(*at, factor_q, by_sliding, work.out, work.near)
    elif gear.mesh.kind == BY_SPHERES:
        sphere_law(*at, factor_q, by_sliding, work.out, work.near)
    else:
        triangle_law(*at, factor_q, by_sliding, work.out, work.near)
    finish(q, v, gear, pool, work, factor_q, factor_v, by_rate, total, tangent)


LAWS = dict.fromkeys(KINDS, gear_law)
"""Law of the teeth's contact -> the forces of a gear with it. Others may be added from outside."""


# --- along a motion --------------------------------------------------------------------------------
@entry(Law(LAW), MATRIX, MATRIX, VECTOR, MATRIX, GEARS, VECTOR, WORKS, MATRIX)
def fill_outputs(law, coordinates, rates, time, begun, gears, pool, works, outputs):  # type: ignore[no-untyped-def]
    """Fill the outputs (t, OUTPUTS) of all parts at states (t, n) of one gear.

    `begun` is the state of its bristles at the start of the steps that end there, (t, 0) without any.
    """
    work, n = works[0], coordinates.shape[1]
    total, tangent = stacked(n, MOST_COORDINATES), stacked((0, 0), 1)
    for k in range(coordinates.shape[0]):
        begin_step(work.contact.memory, begun[k], time[k])
        called(law, coordinates[k], rates[k], gears, 0, pool, works, 0.0, 0.0, total, tangent)
        for i in range(OUTPUTS):
            outputs[k, i] = work.out[i]
