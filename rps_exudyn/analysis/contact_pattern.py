"""Contact pattern: largest pressure on each point of the pinion's flanks on their way through the mesh.

A flank is unrolled: length of roll (the tangent length q, from the base circle) over the face width Z. All
teeth are superimposed. The pressure is Hertz's on the lines of contact (`load_distribution`).
"""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.analysis.load_distribution import LoadDistribution, load_distribution
from rps_exudyn.analysis.passes import Signals
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.parameters.retired import with_lines

POINTS = (80, 100)  # along the roll, along the face


@dataclass(frozen=True, eq=False)
class FlankPattern:
    """One side of the teeth: the largest pressure at each point over the record's instants."""

    side: int  # -1 drives the rack towards +X, +1 towards -X
    roll: np.ndarray  # tangent lengths q, shape (n,) [m]
    face: np.ndarray  # Z, shape (m,) [m]
    pressure: np.ndarray  # shape (n, m) [Pa]


def contact_pattern(gear: SteeringGear, signals: Signals) -> tuple[FlankPattern, FlankPattern]:
    """Both sides' patterns, the drive flanks' (side -1) first, of every instant of a record with the rack's
    motions: give only those needed (`one_pitch`).

    Raises:
        InputError: the record lacks the rack's motions.
    """
    roll, face = unrolled(gear)
    loads = load_distribution(with_lines(gear), signals)
    drive, coast = (
        FlankPattern(side, roll, face, _between_lines(loads, side, roll, face)) for side in (-1, +1)
    )
    return drive, coast


def _between_lines(loads: LoadDistribution, side: int, roll: np.ndarray, face: np.ndarray) -> np.ndarray:
    """Hertz's pressure at the flank's points, shape (roll, face) [Pa], linear between the stations."""
    from scipy.interpolate import griddata  # a fifth of a second, which other metrics are spared

    chosen = loads.side == side
    places = np.column_stack([loads.roll[chosen], loads.face[chosen]])
    scale = [np.ptp(roll), np.ptp(face)]
    grid = np.stack(np.meshgrid(roll, face, indexing="ij"), axis=-1)
    return np.asarray(griddata(places / scale, loads.pressure[chosen], grid / scale, fill_value=0.0))


def one_pitch(signals: Signals, teeth: int) -> dict[str, np.ndarray]:
    """The instants of one tooth pitch in the middle of a record in one direction."""
    angle = signals["pinion_angle"]
    middle = (angle[0] + angle[-1]) / 2
    kept = np.abs(angle - middle) <= np.pi / teeth * (1 + 1e-9)
    return {name: values[kept] for name, values in signals.items()}


def unrolled(gear: SteeringGear, points: tuple[int, int] = POINTS) -> tuple[np.ndarray, np.ndarray]:
    """Midpoints of even cells over a flank: roll q from form to tip circle, face Z [m]."""
    pair = GearPair.of(gear)
    flank = Flank(pair, 0, -1)
    q_0, q_a, half = flank.form_tangent_length, flank.tip_tangent_length, pair.face_width / 2
    n, m = points
    return (q_0 + (q_a - q_0) * (np.arange(n) + 0.5) / n, -half + 2 * half * (np.arange(m) + 0.5) / m)
