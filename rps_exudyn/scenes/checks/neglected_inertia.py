"""The inertia that equilibria leave out in steady motion, and what it would change.

Along its travel the drive overcomes the rack's inertia; beside it, inertia presses on the yoke and moves the
rack itself. Both grow with the square of the speed: with a runout of 20 um the first order of the default
gear's torque is 0.4 % off at 120 rpm, and 10 % at 600.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from rps_exudyn.analysis.curve import durations, pieces_of
from rps_exudyn.analysis.passes import Signals
from rps_exudyn.gears.bar_section import mass_and_moments
from rps_exudyn.gears.masses import pinion_inertia
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.gear import SteeringGear

FREE_OF_RANGES = 4e-3
"""Of the yoke's force, the inertia beside the travel, at its largest, that moves the rack's ranges by 5 % and
more: the default gear's yaw is 0.3 urad off at 0.0015, 0.6 urad (12 % of what is of interest) at 0.004."""

FREE_OF_SHARES = 0.3
"""Of the yoke's force, the same that changes shares of losses: of a rack that jumps between both flanks of
the teeth, at 0.9, they are 8 % off."""

YOKE_OF_TEETH = 0.1
"""Of the teeth's mean normal force, that a yoke without preload is taken to carry."""

BESIDE = "rack_y", "rack_z", "rack_roll", "rack_yaw", "rack_pitch"


@dataclass(frozen=True, eq=False)
class MovedMasses:
    """What a steady motion accelerates; of many gears arrays (n, 1)."""

    gain: Any  # rack travel per radian [m]
    rack: Any  # the rack's mass [kg]
    # masses for each motion of `BESIDE`, moments of inertia over the distance of what holds the rack against
    # it [kg, kg m]
    beside: tuple[Any, ...]
    preload: Any  # of the yoke [N]
    gears: tuple[SteeringGear, ...]  # that they are of

    @classmethod
    def of(cls, gear: SteeringGear) -> "MovedMasses":
        """Return those of one gear."""
        bar = RackBar.of(gear)
        mass, (about_x, about_y, about_z) = mass_and_moments(bar, gear.rack.density)
        seat, bush = gear.rack.bar_diameter / 2, gear.bush.distance
        beside = mass, mass, about_x / seat, about_y / bush, about_z / bush
        return cls(float(bar.pair.gain), mass, beside, gear.yoke.preload, (gear,))

    @cached_property
    def pinion(self) -> Any:
        """Moments of inertia of the pinions about their axes [kg m^2]."""
        moments = [pinion_inertia(gear) for gear in self.gears]
        return moments[0] if len(moments) == 1 else np.array(moments)[:, None]


def of_many(masses: list[MovedMasses]) -> MovedMasses:
    """Return the masses of many gears as one."""
    rows = np.array([(each.gain, each.rack, each.preload, *each.beside) for each in masses], dtype=float)
    gain, rack, preload, *beside = rows.T[..., None]
    gears = tuple(gear for each in masses for gear in each.gears)
    return MovedMasses(gain, rack, tuple(beside), preload, gears)


def accelerations(signals: Signals, *names: str) -> list[np.ndarray]:
    """Return the second derivatives of signals over time (..., n), by differences of each maneuver."""
    found = [np.zeros(signals[name].shape) for name in names]
    for piece in pieces_of(signals["time"]):
        steps = np.diff(signals["time"][piece])
        if steps.size < 2:
            continue
        for filled, name in zip(found, names, strict=True):
            rates = np.diff(signals[name][..., piece]) / steps
            inner = np.diff(rates) / (steps[1:] + steps[:-1]) * 2
            filled[..., piece] = np.concatenate([inner[..., :1], inner, inner[..., -1:]], axis=-1)
    return found


def with_inertia(signals: Signals, masses: MovedMasses) -> dict[str, np.ndarray]:
    """Return signals (..., n) whose drive overcomes the inertia of what follows it along the travel: pinion
    torque that of the rack, rack force that of the pinion."""
    added = dict(signals)
    if "pinion_torque" in signals:
        (along,) = accelerations(signals, "rack_displacement")
        added["pinion_torque"] = signals["pinion_torque"] + masses.gain * (masses.rack * along)
    elif "rack_force" in signals:
        (turning,) = accelerations(signals, "pinion_angle")
        added["rack_force"] = signals["rack_force"] + masses.pinion * turning / masses.gain
    return added


def beside_travel(signals: Signals, masses: MovedMasses) -> tuple[Any, Any]:
    """Return the inertia forces on the rack beside its travel, over the yoke's force: the largest
    of all, and the one that half of the instants exceed, of the motion that has the most; numbers, or of many
    gears (n,)."""
    normal = np.mean(signals["mesh_normal_force"], axis=-1, keepdims=True)
    yoke = np.maximum(masses.preload, YOKE_OF_TEETH * normal)
    moved = {name: mass for name, mass in zip(BESIDE, masses.beside, strict=True) if name in signals}
    accelerated = zip(moved.values(), accelerations(signals, *moved), strict=True)
    forces = np.stack([np.abs(mass * each) / yoke for mass, each in accelerated])
    return forces.max(axis=(0, -1)), np.median(forces, axis=-1).max(axis=0)


def ringing(signals: Signals, masses: MovedMasses) -> Any:
    """Return how much the teeth's depth changes where masses ring on their stiffness [m], (n,) of many gears.

    The masses are what follows the drive, and the rack across it. Their rate changes between two instants: a
    jump dv makes a swing of dv / omega, a longer, slow acceleration a makes one of a / omega^2.
    """
    depth, normal = (
        np.mean(signals[name], axis=-1, keepdims=True) for name in ("mesh_penetration", "mesh_normal_force")
    )
    if "pinion_torque" in signals:
        (along, across), mass = accelerations(signals, "rack_displacement", "rack_y"), masses.rack
    else:
        turning, across = accelerations(signals, "pinion_angle", "rack_y")
        along, mass = masses.gain * turning, masses.pinion / masses.gain**2
    whole, stands = 0.0, durations(signals["time"])
    for accelerated, each in ((along, mass), (across, masses.rack)):
        frequency = np.sqrt(normal / (depth * each))
        lasts = np.maximum(stands, 1 / frequency)
        whole = whole + np.max(np.abs(accelerated) * lasts / frequency, axis=-1)
    return whole
