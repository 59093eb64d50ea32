"""Pitch errors of every tooth of pinion and rack: given one by one, or drawn from a class of ISO 1328.

An error is the displacement of a tooth from its place: along the pinion's reference circle in the sense of
`pinion.pitch_error`, or along X of the rack. The class A states the largest error from tooth to tooth f_pt
and over all teeth F_p (ISO 1328-1:2013; d and m_n in mm, f and F in um):

    f_pt = (0.001 d + 0.4 m_n + 5) sqrt(2)^(A - 5)
    F_p = (0.002 d + 0.55 sqrt(d) + 0.7 m_n + 12) sqrt(2)^(A - 5)

A rack has no d of its own: it gets that of its pinion. Steps from tooth to tooth are drawn evenly and are as
large as the class allows.
"""

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.declaration import accuracy_class, numbers_in
from rps_exudyn.parameters.gear import SteeringGear

MOST_TEETH = 255  # of a rack with errors


def class_tolerances(pair: GearPair, accuracy: int) -> tuple[float, float]:
    """Return f_pt and F_p of a class [m]."""
    d, m, step = 2e3 * pair.reference_radius, 1e3 * pair.module, np.sqrt(2) ** (accuracy - 5)
    single = 0.001 * d + 0.4 * m + 5
    whole = 0.002 * d + 0.55 * np.sqrt(d) + 0.7 * m + 12
    return float(1e-6 * single * step), float(1e-6 * whole * step)


def pinion_errors(gear: SteeringGear) -> np.ndarray:
    """Return the displacements of the pinion's teeth, polar angle ascending, (z,) [m]; (0,) without any."""
    text = gear.pinion.pitch_errors
    if not text:
        return np.zeros(0)
    drawn = accuracy_class(text)
    return np.array(numbers_in(text)) if drawn is None else _drawn(gear, *drawn, gear.pinion.teeth, True)


def rack_errors(gear: SteeringGear) -> np.ndarray:
    """Return the displacements of the rack's teeth along X, in order of X, (n,) [m]; (0,) without errors.

    Raises:
        InputError: a list of another length, or more teeth than errors can have.
    """
    text = gear.rack.pitch_errors
    if not text:
        return np.zeros(0)
    count = len(RackBar.of(gear).teeth)
    if count > MOST_TEETH:
        raise InputError(f"the rack has {count} teeth; rack.pitch_errors is for at most {MOST_TEETH}.")
    drawn = accuracy_class(text)
    errors = np.array(numbers_in(text)) if drawn is None else _drawn(gear, *drawn, count, False)
    if len(errors) != count:
        raise InputError(
            f"rack.pitch_errors has {len(errors)} numbers; it must have {count}, one for each tooth of "
            "the rack in order of X."
        )
    return errors


def _drawn(gear: SteeringGear, accuracy: int, seed: int, teeth: int, closed: bool) -> np.ndarray:
    """Displacements of teeth (n,) [m] of mean 0, in a ring if it is closed."""
    single, whole = class_tolerances(GearPair.of(gear), accuracy)
    steps = np.random.default_rng([seed, int(closed)]).uniform(-1, 1, teeth if closed else teeth - 1)
    if closed:
        steps -= steps.mean()
    places = np.concatenate([[0.0], np.cumsum(steps)])[:teeth]
    size = min(single / np.abs(steps).max(), whole / np.ptp(places))
    return np.asarray(size * (places - places.mean()))
