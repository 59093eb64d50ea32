"""The adjustment of the yoke that a fit of the free torque leads to: a turn of the plug, or another spring.

The thread moves the plug by p theta / 2 pi: back, the spring relaxes and the plunger gains clearance. Two
symptoms call for it:

contact  The plunger touches the plug once per turn (`plug_contact`): back by the depth.
level    The mean is outside its limits by dT, of which the preload P makes the part T_P: the spring's force
         must change by dT / T_P of itself. The turn for that also depends on P and the spring's rate.

Back, the room of the plug ends where the rack's lift under a torque reaches its limit; in, at the contact.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rps_exudyn.inference.fitting.noise import NORMAL
from rps_exudyn.inference.fitting.plug_contact import PlugContact, plug_contact, preload_part
from rps_exudyn.results.limit import Limit
from rps_exudyn.scenes.yoke_setting import travel_of_turn
from rps_exudyn.solvers.yoke_stop import lift_of_torque

if TYPE_CHECKING:
    from rps_exudyn.inference.fitting.fitted import Fit

RATE = 0.05  # standard deviation of the spring's rate: usual tolerance, EN 15800


@dataclass(frozen=True)
class Adjustment:
    """What to do to the yoke.

    Attributes:
        turn: of the plug [rad], above 0 back; 0 if none is needed, or none helps.
        interval: 95 % interval of the turn that just ends the contact, or brings the mean where it is aimed.
        room: by which the plug may be turned: in (0 or less) and back [rad].
        contact: of plunger and plug; None where the curves show none.
        spring_change: of the spring's force, as a part of it, if that must change beyond the room; else 0.
        spring_sd: its standard deviation.
        mean: free torque that is expected afterwards [N m].
    """

    turn: float
    interval: tuple[float, float]
    room: tuple[float, float]
    contact: PlugContact | None
    spring_change: float
    spring_sd: float
    mean: float


def adjustment_of(fit: "Fit", limits: Mapping[str, Limit]) -> Adjustment | None:
    """Return what brings the free torque of a gear within limits; None without curves in both directions, or
    without convergence.

    A contact is ended with 97.5 %: by the upper end of its interval, in whole degrees. A mean is moved as
    little as its own interval demands, or to the middle of limits that are closer together than that.

    Args:
        limits: of which free_torque and rated_lift count.
    """
    level, gear = fit.level, fit.gear
    if level is None or not level.both_ways or not fit.converged:
        return None
    contact, per_radian = plug_contact(fit), travel_of_turn(gear, 1.0)
    clearance = contact.clearance if contact else gear.yoke.clearance
    lift = lift_of_torque(gear.replace({"yoke.clearance": max(0.0, clearance)}), gear.test.lift_torque)
    back = max(0.0, limits["rated_lift"].most - lift) + max(0.0, -clearance)
    runout = fit.runout.interval[1] if fit.runout else gear.pinion.runout
    inward = 0.0 if contact else max(0.0, clearance - runout)
    room = -inward / per_radian, back / per_radian
    turn, interval = 0.0, (0.0, 0.0)
    if contact:
        low, high = contact.depth * np.exp(NORMAL * contact.depth_sd * np.array([-1, 1])) / per_radian
        whole = np.radians(np.ceil(np.degrees(high)))  # as a plug is set
        turn, interval = min(float(whole), room[1]), (float(low), float(high))
    mean, half = level.value - (contact.mean_rise if contact else 0.0), NORMAL * level.sd
    part, limit = preload_part(gear, mean), limits["free_torque"]
    low, high = limit.least + half, limit.most - half
    excess = mean - (float(np.clip(mean, low, high)) if low <= high else (low + high) / 2)
    by_turn = part / gear.yoke.preload * gear.yoke.spring_rate * per_radian  # torque per radian back
    if excess and room[0] * by_turn <= excess <= room[1] * by_turn:
        needed = excess / by_turn
        if needed > turn or not contact:
            spread = float(np.hypot(np.hypot(fit.preload_sd, RATE) * NORMAL * needed, half / by_turn))
            turn, interval = needed, (needed - spread, needed + spread)
        excess = 0.0
    change, sd = (-excess / part, level.sd / part) if excess else (0.0, 0.0)
    return Adjustment(turn, interval, room, contact, change, sd, mean - by_turn * turn - excess)
