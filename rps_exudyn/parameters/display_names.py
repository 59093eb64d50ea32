"""Names of parameters for readers, in sheets and on pages.

named("yoke.preload x mesh.friction")  # "yoke preload x friction of the teeth"
"""

from rps_exudyn.base.units import words
from rps_exudyn.parameters.wrong_values import PATH

GEAR_FACTS = {
    "pinion.teeth": "teeth",
    "pinion.normal_module": "normal module",
    "pinion.pressure_angle": "pressure angle",
    "pinion.helix_angle": "helix angle",
    "pinion.profile_shift": "profile shift",
    "rack.tooth_angle": "angle of the rack teeth",
    "rack.bar_diameter": "bar diameter",
    "yoke.preload": "yoke preload",
    "yoke.clearance": "yoke clearance",
    "mesh.friction": "friction of the teeth",
    "yoke.friction": "friction of the plunger",
    "pinion.runout": "runout",
    "test.speed": "test speed",
}
"""Parameters that distinguish one gear from another -> their names."""

OTHERS = {
    "bush.drag": "bush drag",
    "bearing.friction_torque": "bearing friction",
    "pinion.profile_slope": "profile slope",
    "pinion.pitch_error": "pitch error",
    "installation.angle_error": "shaft angle error",
    "installation.axis_offset": "axis offset",
}
"""Parameters that may differ, too -> their names."""
NAMES = GEAR_FACTS | OTHERS


def named(text: str) -> str:
    """The text with names in place of the paths of parameters."""
    return PATH.sub(lambda found: NAMES.get(found[0]) or words(found[0].replace(".", " ")), text)
