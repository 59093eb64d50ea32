"""The wheel and the gear as two masses: what a torque at the wheel does to them against the tyres.

    settled_work(gear, friction=0.4)      # [J], of a cycle

    J_w theta'' = T sin(w t) - k (theta - phi) - c (theta' - phi')
    J phi''     = k (theta - phi) + c (theta' - phi') - K phi - friction,     J = J_p + m s'^2,  K = k_t s'^2

Friction of the gear is Coulomb's, of a constant size; teeth and guides are rigid. Semi-implicit Euler steps
from rest, friction as what holds or brakes over a step.
"""

from math import ceil

import numpy as np
from numba import njit

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.masses import pinion_inertia, rack_masses
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.steering_column import ColumnModel

PER_PERIOD = 400  # steps in the period of the gear on its column
PER_CYCLE = 20000  # and in one of the hand


def settled_work(gear: SteeringGear, friction: float, cycles: int = 16) -> float:
    """Return the work that friction [N m] takes over the last of so many cycles [J]."""
    test, column, gain = gear.test, ColumnModel.of(gear), float(GearPair.of(gear).gain)
    pinion, rack = pinion_inertia(gear), rack_masses(gear).mass
    inertia, period = pinion + rack * gain**2, 1 / test.steer_frequency
    per_cycle = max(PER_CYCLE, ceil(PER_PERIOD * period / (2 * np.pi * np.sqrt(inertia / column.stiffness))))
    spring = column.stiffness, column.damping, test.tyre_stiffness * gain**2
    slid = _slid(test.steer_torque, friction, column.inertia, inertia, spring, period, per_cycle, cycles)
    return float(friction * slid)


@njit
def _slid(peak, friction, wheel_inertia, inertia, spring, period, per_cycle, cycles):  # type: ignore[no-untyped-def]
    """Angle over which the gear slides in the last cycle [rad]."""
    (stiffness, damping, tyres), step = spring, period / per_cycle
    wheel = turning = place = rate = slid = 0.0
    for i in range(cycles * per_cycle):
        torque = stiffness * (wheel - place) + damping * (turning - rate)
        turning += step * (peak * np.sin(2 * np.pi * (i + 0.5) / per_cycle) - torque) / wheel_inertia
        pushed, held = rate + step * (torque - tyres * place) / inertia, step * friction / inertia
        rate = np.sign(pushed) * max(abs(pushed) - held, 0.0)
        wheel, place = wheel + step * turning, place + step * rate
        if i >= (cycles - 1) * per_cycle:
            slid += abs(step * rate)
    return slid
