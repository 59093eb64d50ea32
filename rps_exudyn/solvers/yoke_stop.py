"""The stopping yoke by formula: how far a torque lifts the rack, and how stiff the yokenut stops the plunger.

Springs count along the yoke: P and clearance c of a gear are one point of the spring's line, so that the
spring presses with P + k c when the plunger touches the nut.
"""

import numpy as np

from rps_exudyn.forces.yoke import seat_under
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.parameters.gear import SteeringGear


def stop_stiffness(gear: SteeringGear, force: float | None = None) -> float:
    """Return force over travel of the cap against the stopped plunger [N/m] under a force, else the preload.

    Nut, seat and both flanks in series: 1 / k = 1 / k_nut + 1 / k_seat + 1 / (2 k b sin^2(alpha_n)).
    """
    yoke = gear.yoke
    flanks = 2 * line_stiffness(gear) * gear.pinion.face_width * np.sin(gear.pinion.pressure_angle) ** 2
    return float(1 / (1 / yoke.nut_stiffness + 1 / seat_under(gear, force).stiffness + 1 / flanks))


def lift_of_torque(gear: SteeringGear, torque: float) -> float:
    """Return how far a torque on the pinion lifts the held rack [m]; 0 while the preload holds it.

    The teeth push the rack away by F = T / s' tan(alpha_n) / cos(beta_r), against spring, nut and seat:
    lift = c + (F - P - k c) / k_nut + (F - P) / k_seat once the plunger is on the nut (a seat with clearance
    yields more). What the flanks yield with one instead of two in mesh is left out.
    """
    pair, yoke = GearPair.of(gear), gear.yoke
    force = abs(torque) / float(pair.gain) * np.tan(pair.alpha_n) / np.cos(pair.beta_r)
    beyond = max(0.0, float(force) - yoke.preload)
    on_nut = max(0.0, beyond - yoke.spring_rate * yoke.clearance)
    on_spring = min(yoke.clearance, beyond / yoke.spring_rate) if yoke.spring_rate else yoke.clearance
    plunger = on_spring + on_nut / yoke.nut_stiffness if beyond else 0.0
    return float(plunger + seat_under(gear, yoke.preload + beyond).depth - seat_under(gear).depth)
