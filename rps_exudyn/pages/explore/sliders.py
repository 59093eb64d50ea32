"""What the page lets its reader drag: parameter, range, step, in the unit that the reader sees."""

from dataclasses import dataclass
from typing import Any

from rps_exudyn.base import units
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.gear import SteeringGear


@dataclass(frozen=True)
class Slider:
    """A parameter's range and step in its shown unit; the same parameter may stand for others, too."""

    path: str
    low: float
    high: float
    step: float
    unit: str = ""

    @property
    def name(self) -> str:
        """The parameter's name in words, for instance "yoke preload"."""
        return units.words(self.path.replace(".", " "))

    def value(self, number: float) -> str | int:
        """The number of the shown unit as a setting of the gear."""
        if self.path == "pinion.teeth":
            return int(number)
        return f"{number:g} {self.unit}".strip()

    def of(self, gear: SteeringGear) -> float:
        """A gear's value in the shown unit, on the slider's grid where it is close to that."""
        value = gear.value_at(self.path)
        item = gear.declared_at(self.path)[0]
        number = units.displayed(value, item.unit.si, self.unit) if item.unit and self.unit else float(value)
        return float(f"{number:.9g}")


SLIDERS = (
    Slider("yoke.preload", 0, 1000, 10, "N"),
    Slider("mesh.friction", 0, 0.3, 0.005),
    Slider("yoke.friction", 0, 0.3, 0.005),
    Slider("pinion.runout", 0, 100, 1, "um"),
    Slider("yoke.clearance", 0, 200, 5, "um"),
    Slider("yoke.spring_rate", 0, 200, 5, "N/mm"),
    Slider("bush.drag", 0, 60, 1, "N"),
    Slider("bearing.friction_torque", 0, 150, 5, "N*mm"),
    Slider("pinion.teeth", 5, 12, 1),
    Slider("pinion.normal_module", 1.2, 2.6, 0.01, "mm"),
    Slider("pinion.helix_angle", 0, 35, 0.5, "deg"),
    Slider("rack.tooth_angle", -5, 20, 0.5, "deg"),
    Slider("pinion.profile_shift", 0.2, 1.3, 0.01),
    Slider("pinion.face_width", 8, 25, 0.5, "mm"),
    Slider("installation.axis_offset", -100, 100, 5, "um"),
    Slider("installation.angle_error", -1, 1, 0.05, "deg"),
)
BY_PATH = {slider.path: slider for slider in SLIDERS}


def settings_of(state: Any) -> dict[str, Any]:
    """Settings of the gear from what a page sends: path -> number in the shown unit.

    Raises:
        InputError: it is no table of numbers of known sliders within their ranges.
    """
    if not isinstance(state, dict):
        raise InputError("the state is no table of sliders.")
    settings, problems = {}, []
    for path, number in state.items():
        slider = BY_PATH.get(path)
        if slider is None:
            problems.append(f"{units.short(str(path))} is no slider of this page.")
        elif isinstance(number, bool) or not isinstance(number, int | float):
            problems.append(f"{path} is {units.shown(number)}; it must be a number.")
        elif not slider.low <= number <= slider.high:
            problems.append(
                f"{path} is {units.shown(number)}; it must be from {slider.low:g} to {slider.high:g}."
            )
        else:
            settings[path] = slider.value(number)
    if problems:
        raise InputError(problems)
    return settings
