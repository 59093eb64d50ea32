"""The yoke as a force: spring and stop press on the back of the bar directly, no plunger between them.

What the plunger's body and seat do beyond that (inertia, tilting stiffness along the bar, a load spread
over an arc) is left out. The seat's sideways guide stays, and its wedge in the friction.
"""

import numpy as np

from rps_exudyn.base.compiled import inline, record, record_type
from rps_exudyn.forces.force_element import Part
from rps_exudyn.forces.friction import (
    LAW,
    bristle,
    by_load,
    clear,
    coulomb,
    law_of,
    rubbing,
    stored,
    stribeck,
)
from rps_exudyn.forces.memory import Patches
from rps_exudyn.forces.rigid_motion import cross, dot, on_angles, plus, scaled, spin_of, turn_of, vector
from rps_exudyn.forces.yoke import add_seat_outer, seat_wedge_factor
from rps_exudyn.parameters.gear import SteeringGear

YOKE_FORCE = record_type(
    [
        ("preload", "f8"),  # [N]
        ("rate", "f8"),  # of the spring [N/m]
        ("clearance", "f8"),  # [m]
        ("stop", "f8"),  # stiffness of the yokenut's contact and the seat in series [N/m]
        ("guide", "f8"),  # sideways stiffness of the seat [N/m]
        ("friction", "f8"),  # coefficient times the seat's wedge factor
        ("zone", "f8"),  # friction zone [m/s]
        ("bar_radius", "f8"),  # [m]
        ("approach", "f8"),  # of the rack to the pinion at rest under the preload [m]
        ("law", LAW),
    ]
)
"""Record of the yoke as a force."""

PART = Part("seat", ("rack", "plunger"), ("seat_normal_force", "seat_force", "yokenut_force"))


@inline
def yoke_force(q, v, data, memory, out):  # type: ignore[no-untyped-def]
    """Force on the back of the bar above the pitch point; q = rack (6), plunger (1), which is left alone;
    fills out (13,)."""
    turn = turn_of(q[3:6])
    axis = scaled(-q[0] / turn.axis[0], turn.axis)  # to the point of the bar's axis above the pitch point
    lift, side = q[1] + axis[1] + data.approach, q[2] + axis[2]
    beyond = max(lift - data.clearance, 0.0)
    stop = data.stop * beyond
    press = max(data.preload + data.rate * lift, 0.0) + stop
    held = data.guide * side
    # both across the tilted bar and through its axis; friction acts on its back
    load = ((press * turn.axis[1] + held * turn.axis[2]) / turn.axis[0], -press, -held)
    back = plus(axis, (0.0, data.bar_radius, 0.0))
    slip = plus(vector(v), cross(spin_of(turn, v[3:6]), back))
    slip = (slip[0], 0.0, slip[2])
    speed = np.sqrt(dot(slip, slip))
    law, friction = data.law, data.friction * by_load(press, data.law)
    if law.has_state:
        clear(law.place, memory)
        along, across, lost = bristle(press, slip[0], slip[2], law.place, friction, law, memory)
        rub = (-along, 0.0, -across)
        kept = stored(law.place, friction, law, memory)
    else:
        drag = coulomb(press, friction, speed, data.zone) * stribeck(speed, law)
        rub, lost, kept = scaled(-drag, slip), drag * speed**2, 0.0
    out[6] = out[9] = 0.0
    out[0], out[1], out[2] = plus(load, rub)
    out[3], out[4], out[5] = on_angles(turn, plus(cross(axis, load), cross(back, rub)))
    out[7] = lift * (data.preload + 0.5 * data.rate * lift) + 0.5 * (stop * beyond + data.guide * side**2)
    out[7] += kept
    out[8] = lost
    out[10], out[11], out[12] = press, press, stop


@inline
def add_yoke_tangent(q, v, data, memory, factor_q, factor_v, tangent, of_loads):  # type: ignore[no-untyped-def]
    """Add factor_q dF/dq + factor_v dF/dv of the yoke as a force to a tangent (7, 7); fill `of_loads` (2, 7)
    with factor_q times the derivatives of its first two outputs."""
    turn = turn_of(q[3:6])
    axis = scaled(-q[0] / turn.axis[0], turn.axis)
    lift = q[1] + axis[1] + data.approach
    stiffness, press = 0.0, max(data.preload + data.rate * lift, 0.0)
    if press > 0:
        stiffness += data.rate
    if lift > data.clearance:
        stiffness += data.stop
        press += data.stop * (lift - data.clearance)
    law, back = data.law, plus(axis, (0.0, data.bar_radius, 0.0))
    slip = plus(vector(v), cross(spin_of(turn, v[3:6]), back))
    friction = data.friction * by_load(press, law)
    f_a, f_b, ahead, aside, d_a, d_b = rubbing(slip[0], slip[2], law.place, friction, data.zone, law, memory)
    rub = (f_a, 0.0, f_b)
    up, across = (-turn.axis[1] / turn.axis[0], 1.0, 0.0), (-turn.axis[2] / turn.axis[0], 0.0, 1.0)
    moment = cross(axis, up)
    pressed = plus(up, rub), plus(moment, cross(back, rub))
    add_seat_outer(tangent, -factor_q * stiffness, pressed[0], pressed[1], 0.0, up, moment, 0.0)
    deeper = (up[0], up[1], up[2], moment[0], moment[1], moment[2], 0.0)
    for j in range(7):
        of_loads[0, j] = of_loads[1, j] = factor_q * stiffness * deeper[j]
    moment = cross(axis, across)
    add_seat_outer(tangent, -factor_q * data.guide, across, moment, 0.0, across, moment, 0.0)
    drag = -factor_v * press
    if drag != 0:
        on, beside = (d_a, 0.0, d_b), (-d_b, 0.0, d_a)
        if ahead != 0:
            moment = cross(back, on)
            add_seat_outer(tangent, drag * ahead, on, moment, 0.0, on, moment, 0.0)
        moment = cross(back, beside)
        add_seat_outer(tangent, drag * aside, beside, moment, 0.0, beside, moment, 0.0)


def yoke_record(gear: SteeringGear, *, friction_zone: float, approach: float, patches: Patches) -> np.record:
    """Return the record of spring and stop of the yoke on the rack itself."""
    yoke, phi = gear.yoke, gear.yoke.seat_angle
    return record(
        YOKE_FORCE,
        preload=yoke.preload,
        rate=yoke.spring_rate,
        clearance=yoke.clearance,
        stop=1 / (1 / yoke.nut_stiffness + 1 / yoke.seat_stiffness),
        # pressure per depth over the arc: int sin^2 sideways for int cos^2 along the yoke
        guide=yoke.seat_stiffness * (phi - np.sin(phi) * np.cos(phi)) / (phi + np.sin(phi) * np.cos(phi)),
        friction=seat_wedge_factor(phi) * yoke.friction,
        zone=friction_zone,
        bar_radius=gear.rack.bar_diameter / 2,
        approach=approach,
        law=law_of(yoke, patches, usual_load=yoke.preload),
    )
