"""Random gears of the kind the package is for: the usual ones around the default gear.

Passenger-car proportions around the paper's gear, both hands, with and without manufacturing errors. A gear
that `gears.limits` does not admit is drawn again; whether it runs is seen later.
"""

from collections.abc import Iterator

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.basic_rack import pointed_radius, undercut_limit
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_report import check_gear
from rps_exudyn.gears.trochoid import form_point
from rps_exudyn.parameters.derived import DERIVED
from rps_exudyn.parameters.gear import SteeringGear

RANGES = {
    "pinion.normal_module": (1.6e-3, 2.2e-3),
    "pinion.pressure_angle": (np.deg2rad(17), np.deg2rad(25)),
    "pinion.helix_angle": (np.deg2rad(10), np.deg2rad(35)),
    "pinion.face_width": (10e-3, 20e-3),
    "rack.tooth_angle": (np.deg2rad(-15), np.deg2rad(15)),
    "yoke.preload": (150.0, 600.0),
    "yoke.spring_rate": (20e3, 200e3),
    "yoke.friction": (0.03, 0.2),
    "mesh.friction": (0.03, 0.2),
    "bush.drag": (0.0, 40.0),
    "bearing.friction_torque": (0.0, 60e-3),
}
"""Uniform between these [SI]; the helix of either hand."""

STIFFNESS = (5e12, 1e14)  # of the contact [N/m^3], uniform in its logarithm
TEETH = (5, 10)
ERRORS = {
    "pinion.runout": (0.0, 40e-6),
    "pinion.runout_angle": (0.0, 2 * np.pi),
    "pinion.crowning": (0.0, 8e-6),
    "pinion.pitch_error": (-5e-6, 5e-6),
    "pinion.profile_slope": (-5e-6, 5e-6),
    "installation.angle_error": (np.deg2rad(-0.05), np.deg2rad(0.05)),
    "installation.axis_offset": (-20e-6, 20e-6),
}
"""Uniform between these [SI]; each is there in half of the gears."""


def random_gears(seed: int, count: int) -> list[SteeringGear]:
    """The first admissible gears of a seed."""
    gears = admissible_gears(np.random.default_rng(seed))
    return [next(gears) for _ in range(count)]


def admissible_gears(rng: np.random.Generator) -> Iterator[SteeringGear]:
    """Yield gears that can exist, without end."""
    while True:
        try:
            gear = _random_gear(rng)
            check_gear(gear)
        except InputError:
            continue
        yield gear


def _random_gear(rng: np.random.Generator) -> SteeringGear:
    """Draw a pinion without undercut, its tip between form circle and point.

    Raises:
        InputError: the numbers drawn make no gear.
    """
    hand = rng.choice([-1.0, 1.0])
    drawn = {path: float(rng.uniform(*limits)) for path, limits in RANGES.items()}
    drawn["pinion.helix_angle"] *= hand
    drawn["rack.tooth_angle"] *= hand
    drawn |= {path: float(rng.uniform(*limits)) for path, limits in ERRORS.items() if rng.random() < 0.5}
    drawn["mesh.stiffness"] = float(np.exp(rng.uniform(*np.log(STIFFNESS))))
    shift_margin, fraction = rng.uniform(0.02, 0.5), rng.uniform(0.5, 0.9)
    drawn = {path: SteeringGear().value_at(path) for path in DERIVED} | drawn  # not those that follow
    base = SteeringGear().replace({**drawn, "pinion.teeth": int(rng.integers(*TEETH, endpoint=True))})
    shifted = base.replace({"pinion.profile_shift": undercut_limit(GearPair.of(base)) + shift_margin})
    pair = GearPair.of(shifted)
    form, pointed = form_point(pair).radius, pointed_radius(pair)
    return shifted.replace({"pinion.tip_diameter": 2 * float(form + fraction * (pointed - form))})
