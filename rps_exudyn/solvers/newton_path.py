"""Equilibria along steady motion by Newton's method, for gears whose tangent is known in closed form.

What it does not find the follower of `path_follower` looks for, from the last instant found on.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.solvers.drive import Drive
from rps_exudyn.solvers.gear_kernel import COORDINATE_BLOCKS
from rps_exudyn.solvers.newton_tangent import ALL_OUTPUTS

LONGEST = 20_000  # instants followed without a break for Ctrl-C: half a second
PINION, RACK, PLUNGER = (COORDINATE_BLOCKS[body].start for body in ("pinion", "rack", "plunger"))


class NewtonLaw(NamedTuple):
    """A gear's forces with their tangent."""

    follow: Callable[..., Any]  # of `newton_follower`
    approach: float  # of the rack under the preload at rest [m]


class Found(NamedTuple):
    """What Newton's method found of a path."""

    rows: int  # instants, from the first on
    costs: np.ndarray  # evaluations of the forces, iterations, tangents
    residual: float  # largest one left [N]
    outputs: np.ndarray  # (n, 73) of the force elements, see `newton_tangent.OUTPUTS`


def kinematic(pair: GearPair, drive: Drive, time: np.ndarray) -> np.ndarray:
    """Return about where rigid bodies would be at times [s], shape (t, 8): gain and runout."""
    angle = np.asarray(drive.place(time)) / (1.0 if drive.body == "pinion" else pair.gain)
    phase, places = angle + pair.runout_angle, np.zeros((len(time), 8))
    swing = pair.runout * np.cos(pair.beta_p) / np.cos(pair.beta_r) * np.sin(phase)
    if drive.body == "pinion":
        places[:, RACK] = pair.gain * angle + swing
    else:
        places[:, PINION] = swing / pair.gain - angle
    places[:, RACK + 1] = places[:, PLUNGER] = pair.runout * np.cos(phase)
    return places


def newton_path(
    law: NewtonLaw,
    pair: GearPair,
    drive: Drive,
    time: np.ndarray,
    first: int,
    free: np.ndarray,
    lengths: np.ndarray,
    rows: tuple[np.ndarray, np.ndarray, np.ndarray],
    handle: Any,
) -> Found:
    """Fill coordinates, rates and forces (t, 8) from row `first` on as far as equilibria are found.

    In row 0 the rates are given; it begins where the preload presses the rack at rest.
    """
    places, (coordinates, rates, forces) = kinematic(pair, drive, time), rows
    outputs = np.empty((len(time), ALL_OUTPUTS))
    if first == 0:
        guess = places[0].copy()
        guess[RACK + 1] -= law.approach
        coordinates[0, free] = guess[free]
    found, evaluations, iterations, residual = law.follow(
        first,
        time,
        instants_per_pitch(pair, drive, time[first:]),
        drive.coordinate,
        free,
        lengths,
        places,
        coordinates,
        rates,
        forces,
        outputs,
        handle,
    )
    return Found(found, np.array([evaluations, iterations, iterations]), residual, outputs)


def instants_per_pitch(pair: GearPair, drive: Drive, time: np.ndarray) -> int:
    """Return the number of even instants in a tooth pitch; 0 if they are uneven or no whole number."""
    if len(time) < 3:
        return 0
    steps = np.diff(time)
    if np.ptp(steps) > 1e-6 * steps[0]:
        return 0
    pitch = 2 * np.pi / pair.teeth / abs(drive.pinion_speed(pair.gain, float(time[0])))
    whole = round(pitch / steps[0])
    return whole if whole and abs(pitch / steps[0] - whole) < 1e-6 * whole else 0
