"""The yoke as a force: spring and stop press on the back of the bar directly, no plunger between them.

What the plunger's body and seat do beyond that (inertia, tilting stiffness along the bar, a load spread
over an arc) is left out. The seat's sideways guide stays, and its wedge in the friction.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import kernel
from rps_exudyn.forces.force_element import ForceElement
from rps_exudyn.forces.friction import (
    BRISTLE,
    Law,
    bristle,
    by_load,
    clear,
    coulomb,
    law_of,
    stored,
    stribeck,
)
from rps_exudyn.forces.memory import Memory
from rps_exudyn.forces.rigid_motion import cross, dot, on_angles, plus, scaled, spin_of, turn_of, vector
from rps_exudyn.forces.yoke import seat_wedge_factor
from rps_exudyn.parameters.gear import SteeringGear


class YokeForceData(NamedTuple):
    """Constants of the yoke as a force."""

    preload: float  # [N]
    rate: float  # of the spring [N/m]
    clearance: float  # [m]
    stop: float  # stiffness of the yokenut's contact and the seat in series [N/m]
    guide: float  # sideways stiffness of the seat [N/m]
    friction: float  # coefficient times the seat's wedge factor
    zone: float  # friction zone [m/s]
    bar_radius: float  # [m]
    approach: float  # of the rack to the pinion at rest under the preload [m]
    law: Law


@kernel
def yoke_force(q, v, data):  # type: ignore[no-untyped-def]
    """Force on the back of the bar above the pitch point; q = rack (6), plunger (1), which is left alone."""
    out = np.zeros(7 + 3 + 3)
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
    if law.kind == BRISTLE:
        clear(law.place, law)
        along, across, lost = bristle(press, slip[0], slip[2], law.place, friction, law)
        rub = (-along, 0.0, -across)
        kept = stored(law.place, friction, law)
    else:
        drag = coulomb(press, friction, speed, data.zone) * stribeck(speed, law)
        rub, lost, kept = scaled(-drag, slip), drag * speed**2, 0.0
    out[0], out[1], out[2] = plus(load, rub)
    out[3], out[4], out[5] = on_angles(turn, plus(cross(axis, load), cross(back, rub)))
    out[7] = lift * (data.preload + 0.5 * data.rate * lift) + 0.5 * (stop * beyond + data.guide * side**2)
    out[7] += kept
    out[8] = lost
    out[10], out[11], out[12] = press, press, stop
    return out


def yoke_as_force(
    gear: SteeringGear, *, friction_zone: float, approach: float, memory: Memory
) -> ForceElement:
    """Spring and stop of the yoke on the rack itself."""
    yoke, phi = gear.yoke, gear.yoke.seat_angle
    data = YokeForceData(
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
        law=law_of(yoke, memory, usual_load=yoke.preload),
    )
    outputs = ("seat_normal_force", "seat_force", "yokenut_force")
    return ForceElement("seat", ("rack", "plunger"), yoke_force, data, outputs)
