"""Files of measured flanks for tests: any function of place, flank and tooth as a grid."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.parameters.gear import SteeringGear

Surface = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Places along both coordinates [m] -> deviations [m]."""


def write_grid(
    path: Path, axes: dict[str, np.ndarray], surfaces: dict[tuple[str, str], Surface] | Surface
) -> str:
    """Write a grid over two named axes [m], of surfaces by tooth and flank or of one for all; return the
    path."""
    (first, u), (second, w) = axes.items()
    of_all = surfaces if isinstance(surfaces, dict) else {("all", "both"): surfaces}
    lines = [f"tooth,flank,{first} [mm],{second} [mm],deviation [um]"]
    for (tooth, flank), surface in of_all.items():
        for a, b in np.ndindex(u.size, w.size):
            height = float(surface(u[a], w[b]))
            lines.append(f"{tooth},{flank},{1e3 * u[a]:.12g},{1e3 * w[b]:.12g},{1e6 * height:.12g}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return str(path)


def pinion_axes(gear: SteeringGear, rolls: int = 33, faces: int = 25) -> dict[str, np.ndarray]:
    """Places over the whole flank of a pinion."""
    pair = GearPair.of(gear)
    flank, b = Flank(pair, 0, -1), pair.face_width / 2
    return {
        "roll": np.linspace(flank.form_tangent_length, flank.tip_tangent_length, rolls),
        "face": np.linspace(-b, b, faces),
    }


def rack_axes(gear: SteeringGear, heights: int = 33, across: int = 25) -> dict[str, np.ndarray]:
    """Places over the whole flank of a rack, above and below the reference line."""
    module, half = gear.pinion.normal_module, gear.rack.bar_diameter / 2
    return {
        "height": np.linspace(-1.2 * module, 1.05 * module, heights),
        "across": np.linspace(-half, half, across),
    }
