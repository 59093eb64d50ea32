"""Gears of constant ratio that a gear of variable ratio is along its travel: same pinion, same shaft angle.

At each angle its rack is one of constant ratio with another pressure and tooth angle (`gears.course`). So a
law of constant ratio holds for it with the numbers of the place, and a mean over the travel is that of such
gears:

    mean_over_travel(gear, lambda local: [law(local)])

Laws are computed at a few pressure angles and interpolated by polynomials between them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from rps_exudyn.gears.basic_rack import half_angle, involute
from rps_exudyn.gears.course import Function, Mesh
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import Ratio, SteeringGear

NODES = 5  # pressure angles: free torques from 15 to 35 degrees are within 1e-4
ALONG = 257  # angles of a mean over the travel


def local_gear(gear: SteeringGear, gain: float) -> SteeringGear:
    """Return the gear of a constant gain [m/rad] with the involutes, the tips and the axes of another one.

    Its basic rack is cut at another height; clearances of its roots are the other gear's. Its values are not
    validated: no cutter need have its form.
    """
    pair = GearPair.of(gear)
    mesh = pair.design_mesh
    alpha, beta_r = float(mesh.pressure_angle(gain)), float(mesh.tooth_angle(gain))
    beta_p = beta_r - mesh.delta
    module = float(2 * gain * np.cos(beta_r) / pair.teeth)
    radius = pair.teeth * module / (2 * np.cos(beta_p))
    alpha_t = np.arctan(np.tan(alpha) / np.cos(beta_p))
    level = float(half_angle(pair, pair.base_radius)) - float(involute(alpha_t))
    shift = float((level * pair.teeth - np.pi / 2) / (2 * np.tan(alpha)))
    tips, line = pair.reference_line_height - pair.rack_addendum, radius + shift * module
    return gear.with_unchecked(
        {
            "pinion.normal_module": module,
            "pinion.pressure_angle": alpha,
            "pinion.helix_angle": beta_p,
            "pinion.profile_shift": shift,
            "rack.ratio": Ratio(),
            "rack.tooth_angle": beta_r,
            "rack.reference_height": float(pair.bar_axis_height - line),
            "basic_rack.addendum": float((line - tips) / module),
            "basic_rack.dedendum": float((line - pair.root_radius) / module),
            "basic_rack.fillet_radius": 0.1,
        }
    )


def local_gear_at(gear: SteeringGear, angle: float) -> SteeringGear:
    """Return the gear of constant ratio that a gear is at a pinion angle [rad]."""
    pair = GearPair.of(gear)
    return gear if pair.course is None else local_gear(gear, float(pair.gain_at(angle)))


def turn_of_test(gear: SteeringGear) -> tuple[float, float]:
    """Return the pinion angles between which the test turns, one way [rad]."""
    test = gear.test
    if test.path == "lock-to-lock":
        pair, end = GearPair.of(gear), test.direction * gear.rack.travel / 2
        return float(pair.angle_at(-end)), float(pair.angle_at(end))
    return test.start_angle, test.start_angle + test.direction * 2 * np.pi * test.turns


@dataclass(frozen=True, eq=False)
class LocalGears:
    """Gears that stand for all places between two pinion angles; the gear itself, of a constant ratio."""

    mesh: Mesh
    places: np.ndarray  # pressure angles of the gears, (k,)
    gears: tuple[SteeringGear, ...]

    @classmethod
    def between(cls, gear: SteeringGear, angles: np.ndarray) -> "LocalGears":
        """Return those of a gear for pinion angles (n,) [rad]."""
        pair = GearPair.of(gear)
        mesh = pair.design_mesh
        if pair.course is None:
            return cls(mesh, np.array([pair.alpha_n]), (gear,))
        gains = pair.gain_at(angles)
        ends = np.array([gains.min(), gains.max()])
        low, high = mesh.pressure_angle(ends)
        count = NODES if high - low > 1e-9 else 1
        places = (low + high) / 2 + (high - low) / 2 * np.cos(np.pi * (np.arange(count) + 0.5) / count)
        return cls(mesh, places, tuple(local_gear(gear, float(mesh.gain(place))) for place in places))

    def weights(self, gain: Function) -> np.ndarray:
        """Return the weights of the gears' numbers at gains (n,) [m/rad], (n, k): Lagrange's polynomials."""
        at = np.atleast_1d(self.mesh.pressure_angle(gain))[:, None]
        found = np.ones((len(at), len(self.places)))
        for k, place in enumerate(self.places):
            others = np.delete(self.places, k)
            found[:, k] = np.prod((at - others) / (place - others), axis=1)
        return found


def mean_over_travel(gear: SteeringGear, numbers: Callable[[SteeringGear], Sequence[float]]) -> list[float]:
    """Return the mean of numbers of gears of constant ratio over the turn of the test."""
    angles = np.linspace(*turn_of_test(gear), ALONG)
    local = LocalGears.between(gear, angles)
    weights = local.weights(GearPair.of(gear).gain_at(angles)).mean(axis=0)
    return [float(each) for each in weights @ np.array([numbers(each) for each in local.gears])]
