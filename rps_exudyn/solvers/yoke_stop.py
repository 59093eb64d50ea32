"""The stopping yoke by formula: how far a torque lifts the rack, and what setting the cap leaves behind.

The cap is the yokenut: a mechanic tightens it until it presses the plunger against the rack, then turns it
back by an angle. A torque T on its thread presses with F = T / lever, the lever that of a metric thread
(VDI 2230), without friction under a head, which a cap does not have:

    lever = d_2 / 2 tan(lambda + rho'),  tan(lambda) = p / (pi d_2),  tan(rho') = mu / cos(30 deg)

Springs count along the yoke: P and clearance c of a gear are one point of the spring's line, so that the
spring presses with P + k c when the cap touches the plunger, whatever the cap's place.
"""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.parameters.gear import SteeringGear

PITCH_DIAMETER = 0.6495  # outer minus pitch diameter of a metric thread, in pitches (ISO 724)
FLANK_ANGLE = np.deg2rad(30)  # of a metric thread


@dataclass(frozen=True)
class YokeSetting:
    """What tightening the cap and turning it back makes of a gear; SI units."""

    cap_force: float  # along the yoke, under the tightening torque [N]
    compression: float  # of nut, seat and flanks by that force, beyond where the cap touches [m]
    clearance: float  # after turning back; below 0 the cap still presses [m]
    preload: float  # of the spring at the rest position [N]

    def of(self, gear: SteeringGear) -> SteeringGear:
        """Return the gear as it is set.

        Raises:
            InputError: the cap is turned back so far that its spring is loose, or beyond the limits.
        """
        if self.preload < 0:
            raise InputError(
                f"test.back_off leaves the yoke's spring loose: it would press with {self.preload:.4g} N; "
                "turn the cap back by less, or tighten it with more torque."
            )
        try:
            return gear.replace({"yoke.clearance": self.clearance, "yoke.preload": self.preload})
        except InputError as error:
            raise InputError(
                f"test.cap_torque and test.back_off set what no gear may have: {problem}"
                for problem in error.problems
            ) from None


def stop_stiffness(gear: SteeringGear) -> float:
    """Return force over travel of the cap against the stopped plunger [N/m].

    Nut, seat and both flanks in series: 1 / k = 1 / k_nut + 1 / k_seat + 1 / (2 c' b sin^2(alpha_n)).
    """
    yoke = gear.yoke
    flanks = 2 * line_stiffness(gear) * gear.pinion.face_width * np.sin(gear.pinion.pressure_angle) ** 2
    return float(1 / (1 / yoke.nut_stiffness + 1 / yoke.seat_stiffness + 1 / flanks))


def thread_lever(gear: SteeringGear) -> float:
    """Return torque over force of the cap's thread while it is tightened [m]."""
    yoke = gear.yoke
    diameter = yoke.nut_diameter - PITCH_DIAMETER * yoke.thread_pitch
    lead = np.arctan(yoke.thread_pitch / (np.pi * diameter))
    return float(diameter / 2 * np.tan(lead + np.arctan(yoke.thread_friction / np.cos(FLANK_ANGLE))))


def yoke_setting(gear: SteeringGear) -> YokeSetting:
    """Return what `test.cap_torque` and `test.back_off` make of the gear's yoke."""
    yoke, test = gear.yoke, gear.test
    force = test.cap_torque / thread_lever(gear)
    touching = yoke.preload + yoke.spring_rate * yoke.clearance
    if force > touching or not yoke.spring_rate:
        compression = max(0.0, force - touching) / stop_stiffness(gear)
        tightened = -compression
    else:  # the spring alone holds the cap
        compression, tightened = 0.0, yoke.clearance - (force - yoke.preload) / yoke.spring_rate
    clearance = tightened + yoke.thread_pitch * test.back_off / (2 * np.pi)
    preload = touching - yoke.spring_rate * max(0.0, clearance)
    return YokeSetting(force, compression, clearance, preload)


def lift_of_torque(gear: SteeringGear, torque: float) -> float:
    """Return how far a torque on the pinion lifts the held rack [m]; 0 while the preload holds it.

    The teeth push the rack away by F = T / s' tan(alpha_n) / cos(beta_r), against spring, nut and seat:
    lift = c + (F - P - k c) / k_nut + (F - P) / k_seat once the plunger is on the nut. What the flanks yield
    with one instead of two in mesh is left out.
    """
    pair, yoke = GearPair.of(gear), gear.yoke
    force = abs(torque) / float(pair.gain) * np.tan(pair.alpha_n) / np.cos(pair.beta_r)
    beyond = max(0.0, float(force) - yoke.preload)
    on_nut = max(0.0, beyond - yoke.spring_rate * yoke.clearance)
    on_spring = min(yoke.clearance, beyond / yoke.spring_rate) if yoke.spring_rate else yoke.clearance
    plunger = on_spring + on_nut / yoke.nut_stiffness if beyond else 0.0
    return float(plunger + beyond / yoke.seat_stiffness)
