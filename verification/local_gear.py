"""The gear of constant ratio that a rack of variable ratio is at one angle: same pinion, same shaft angle."""

import numpy as np

from rps_exudyn.gears.basic_rack import half_angle, involute
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear


def local_gear(gear: SteeringGear, gain: float) -> SteeringGear:
    """Return the gear of a constant gain [m/rad] with the involutes, the tips and the axes of another one.

    Its basic rack is cut at another height; clearances of its roots are the other gear's.
    """
    pair = GearPair.of(gear)
    mesh = pair.design_mesh
    alpha, beta_r = float(mesh.pressure_angle(gain)), float(mesh.tooth_angle(gain))
    beta_p = beta_r - mesh.delta
    module = 2 * gain * np.cos(beta_r) / pair.teeth
    radius = pair.teeth * module / (2 * np.cos(beta_p))
    alpha_t = np.arctan(np.tan(alpha) / np.cos(beta_p))
    level = float(half_angle(pair, pair.base_radius)) - float(involute(alpha_t))
    shift = (level * pair.teeth - np.pi / 2) / (2 * np.tan(alpha))
    tips, height = pair.reference_line_height - pair.rack_addendum, pair.bar_axis_height
    line = radius + shift * module
    return gear.replace(
        {
            **{f"rack.ratio.{name}": 0.0 for name in ("centre", "lock")},
            **{f"rack.ratio.{name}": "none" for name in ("angle", "travel_per_turn")},
            "pinion.normal_module": module,
            "pinion.pressure_angle": alpha,
            "pinion.helix_angle": beta_p,
            "pinion.profile_shift": shift,
            "pinion.tip_diameter": 2 * pair.tip_radius,
            "pinion.shaft_diameter": gear.pinion.shaft_diameter,
            "rack.tooth_angle": beta_r,
            "rack.reference_height": height - line,
            "basic_rack.addendum": (line - tips) / module,
            "basic_rack.dedendum": (line - pair.root_radius) / module,
            "basic_rack.fillet_radius": 0.1,
        }
    )
