"""Equilibria of many gears of one design: a reference gear, how its motion responds, and the compiled loop.

A few gears are followed at close angles: the reference, and two for each parameter that varies. What they do
is known of all others to first order; the loop finds the rest of their motion at angles further apart. That
rest is smooth, so that a spline carries it to the angles between.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.mesh_contact.flank_element import flank_force_and_tangent
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS
from rps_exudyn.solvers.drive import DrivenBody
from rps_exudyn.solvers.gear_forces import GearForces
from rps_exudyn.solvers.coordinates import COORDINATE_BLOCKS
from rps_exudyn.solvers.gear_loop import FOUND, KEPT, Grid, Motion, gear_loop
from rps_exudyn.solvers.gear_numbers import AXIS_OFFSET, COLUMN, LOAD, PRELOAD, REST_GAP
from rps_exudyn.solvers.newton_approach import newton_approach

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

# Residual [N] from which a last step is not evaluated: of all gears; of the known, the next one where the
# contact's quadrature jumps by more at an angle, so that none below it is found
COARSE, FINE = 5.0, (0.05, 0.5, 5.0)
PINION, RACK = (COORDINATE_BLOCKS[body].start for body in ("pinion", "rack"))


@dataclass(frozen=True, eq=False)
class Rows:
    """Gears as rows of numbers, see `gear_numbers`."""

    numbers: np.ndarray  # (n, COUNT)
    references: np.ndarray  # (n or 1, 3)
    points: np.ndarray  # (n or 1, ., 4)
    stiffnesses: np.ndarray  # (n or 1, 4, 4)
    seat_stiffness: np.ndarray  # (n,) [N/m]

    def __len__(self) -> int:
        return len(self.numbers)

    def of(self, rows: np.ndarray) -> "Rows":
        """Return some of the gears."""
        arrays = (self.references, self.points, self.stiffnesses)
        reference, points, stiffness = (each if len(each) == 1 else each[rows] for each in arrays)
        return Rows(self.numbers[rows], reference, points, stiffness, self.seat_stiffness[rows])


@dataclass(frozen=True, eq=False)
class Found:
    """What became of the gears: the columns of `gear_loop` at each angle."""

    out: np.ndarray  # (n, angles, KEPT)
    ended: np.ndarray  # (n,)
    evaluations: np.ndarray  # (n,) of the forces
    adjusted: np.ndarray  # (n,) place of the rack under the preload, along Y [m]

    @property
    def found(self) -> np.ndarray:
        """Which gears were found at all angles, shape (n,)."""
        return np.asarray(self.ended == FOUND)


@dataclass(frozen=True, eq=False)
class Loop:
    """One compiled loop over gears that share laws, drive and angles.

    A driven rack moves as the pinion would move it: the angles are those of a pinion without errors.
    """

    forces: GearForces  # of the reference gear
    pair: GearPair
    speed: float  # of the pinion, with its sense [rad/s]
    body: DrivenBody = "pinion"
    weighted: bool = False  # whether each gear's weight pulls at its rack
    place: tuple[float, float] = field(init=False)  # of the reference rack under its preload [m]

    def __post_init__(self) -> None:
        data, spring = self.forces.ideal.data, self.forces.spring
        assert spring is not None  # the loop knows gears with a plunger
        x, y, _ = newton_approach(flank_force_and_tangent)(
            spring.data.preload, 0.0, self.pair.axis_offset - self.forces.approach, data
        )
        object.__setattr__(self, "place", (float(x), float(y)))

    def follow(
        self,
        rows: Rows,
        angles: np.ndarray,
        per_pitch: int,
        known: "Known",
        features: np.ndarray,
        accepted: float,
    ) -> Found:
        """Follow gears over even angles (k,) [rad]; the known motion responds to `features` (n, f)."""
        balance, n = self.forces.statics, len(rows)
        numbers = rows.numbers.copy()
        numbers[:, REST_GAP] = rows.seat_stiffness
        if not self.weighted:
            numbers[:, LOAD] = 0.0
        driven = COORDINATE_BLOCKS[self.body].start
        out = np.zeros((n, len(angles), KEPT))
        ended, evaluations = np.zeros((2, n), dtype=np.int64)
        x, y = self.place
        aside = rows.numbers[:, AXIS_OFFSET] - self.pair.axis_offset
        near = np.column_stack([np.full(n, x), y + aside + features @ known.resting])
        free, swing = balance.free(driven), swing_of(self.pair)
        grid = Grid(driven, free, CHARACTERISTIC_LENGTHS, swing, angles, per_pitch, accepted)
        gear_loop(self.forces.mesh.tangent, self.forces.seat.kernel)(
            balance.data,
            numbers,
            rows.references,
            rows.points,
            rows.stiffnesses,
            np.full(n, self.speed),
            near,
            y,
            grid,
            known.at(angles),
            np.ascontiguousarray(features),
            out,
            ended,
            evaluations,
        )
        adjusted = numbers[:, PRELOAD] / rows.seat_stiffness - numbers[:, REST_GAP]
        return Found(out, ended, evaluations, adjusted)


@dataclass(frozen=True, eq=False)
class Known:
    """A reference gear's coordinates at the mesh beside gain and runout, and their response."""

    motion: "CubicSpline"  # -> (8,)
    response: "CubicSpline | None" = None  # -> (f, 8) per feature
    resting: np.ndarray = field(
        default_factory=lambda: np.zeros(0)
    )  # of the rest's place beside the axis (f,)

    def at(self, angles: np.ndarray) -> Motion:
        """Return both and their derivatives at angles (k,)."""
        places, rates = (np.ascontiguousarray(self.motion(angles, order)) for order in (0, 1))
        if self.response is None:
            none = np.zeros((len(angles), 0, 8))
            return Motion(places, rates, none, none)
        return Motion(
            places, rates, *(np.ascontiguousarray(self.response(angles, order)) for order in (0, 1))
        )


def swing_of(pair: GearPair) -> float:
    """Return the share of the runout across the pinion's axis that the rack follows along X."""
    return float(np.cos(pair.beta_p) / np.cos(pair.beta_r))


def motion_at_mesh(
    angles: np.ndarray, coordinates: np.ndarray, rows: Rows, loop: Loop, shift: np.ndarray
) -> np.ndarray:
    """Return coordinates (n, k, 8) at the mesh, beside gain, runout and a shift (n,) along Y [m]."""
    at = coordinates.copy()
    x, yaw, pitch = (coordinates[..., i] for i in (RACK, RACK + 4, RACK + 5))
    at[..., RACK + 1] -= x * pitch
    at[..., RACK + 2] += x * yaw
    towards_e, towards_y, gain = (
        rows.numbers[:, COLUMN["mesh", name], None] for name in ("eccentric_e", "eccentric_y", "gain")
    )
    across = towards_y * np.sin(angles) + towards_e * np.cos(angles)
    lift = towards_y * np.cos(angles) - towards_e * np.sin(angles)
    swing = across * swing_of(loop.pair)
    at[..., PINION] += angles
    at[..., RACK] -= gain * angles
    if loop.body == "rack":
        at[..., PINION] -= swing / gain
    else:
        at[..., RACK] -= swing
    at[..., RACK + 1] -= lift + shift[:, None]
    at[..., RACK + 6] -= lift
    return at


@dataclass(frozen=True, eq=False)
class Between:
    """What is known of gears over a record, from what the loop found at its own angles.

    Columns are those of the loop; each is a gear's known part and the spline of the rest.
    """

    nodes: np.ndarray  # the loop's angles [rad]
    record: np.ndarray  # the record's, (m,) [rad]
    weights: np.ndarray  # (nodes, m) of the spline from one to the other
    beside: np.ndarray  # (KEPT, 1 + f, m) what a spline of the known part misses: at 1, and per feature

    @classmethod
    def of(
        cls, columns: "CubicSpline", response: "CubicSpline", nodes: np.ndarray, record: np.ndarray
    ) -> "Between":
        """From columns of the reference gear and their response over the angle; nodes (k,), record (m,)."""
        order = np.argsort(nodes)
        weights = np.empty((len(nodes), len(record)))
        weights[order] = rising(nodes[order], np.eye(len(nodes)))(record).T

        def known(angles: np.ndarray) -> np.ndarray:
            return np.concatenate([columns(angles)[:, None], response(angles)], axis=1).T.copy()

        return cls(nodes, record, weights, known(record) - known(nodes) @ weights)

    def over_record(self, out: np.ndarray, features: np.ndarray, which: Sequence[int]) -> np.ndarray:
        """Return columns of the loop's `out` (n, nodes, KEPT) over the record, shape (columns, n, m)."""
        return self._summed(out, features, which, self.weights, self.beside)

    def weighed(
        self, out: np.ndarray, features: np.ndarray, which: Sequence[int], weights: np.ndarray
    ) -> np.ndarray:
        """Return sums of columns over the record with weights (m, s): integrals, ends; (columns, n, s)."""
        return self._summed(out, features, which, self.weights @ weights, self.beside @ weights)

    def _summed(
        self,
        out: np.ndarray,
        features: np.ndarray,
        which: Sequence[int],
        of_nodes: np.ndarray,
        of_known: np.ndarray,
    ) -> np.ndarray:
        """Columns at the nodes, times weights (nodes, s), and what is known beside, (KEPT, 1 + f, s)."""
        known = np.column_stack([np.ones(len(out)), features])
        found = np.empty((len(which), len(out), of_nodes.shape[1]))
        for row, column in zip(found, which, strict=True):
            np.matmul(np.ascontiguousarray(out[:, :, column]), of_nodes, out=row)
            row += known @ of_known[column]
        return found


def rising(angles: np.ndarray, values: np.ndarray) -> "CubicSpline":
    """Return the spline of values (k, ...) over angles (k,) that rise or fall."""
    from scipy.interpolate import CubicSpline  # half a second, for the loop over gears alone

    order = slice(None) if angles[-1] > angles[0] else slice(None, None, -1)
    return CubicSpline(angles[order], values[order])


def learned(
    loop: Loop, rows: Rows, steps: np.ndarray, angles: np.ndarray, per_pitch: int, known: Known
) -> "tuple[Known, CubicSpline, CubicSpline] | None":
    """Follow the reference gear and two for each feature, `steps` (f,) above and below it.

    `rows` are these gears in this order; returns what is known then, and the reference gear's columns and
    their response over the angle; None if one of them was not found.
    """
    found = _finely(loop, rows, angles, per_pitch, known)
    if not found.found.all():
        return None
    shift = found.adjusted - loop.place[1]
    motion = motion_at_mesh(angles, found.out[..., :8], rows, loop, shift)

    def slope(values: np.ndarray) -> np.ndarray:
        difference = (values[1::2] - values[2::2]) / (2 * steps[:, None, None])
        return np.moveaxis(difference, 0, 1)

    beside = found.adjusted - rows.numbers[:, AXIS_OFFSET]
    resting = (beside[1::2] - beside[2::2]) / (2 * steps)
    responding = Known(rising(angles, motion[0]), rising(angles, slope(motion)), resting)
    return responding, rising(angles, found.out[0]), rising(angles, slope(found.out))


def _finely(loop: Loop, rows: Rows, angles: np.ndarray, per_pitch: int, known: Known) -> Found:
    """Follow gears, each by the smallest residual of `FINE` by which it is found."""

    def followed(some: Rows, accepted: float) -> Found:
        return loop.follow(some, angles, per_pitch, known, np.zeros((len(some), 0)), accepted)

    found = followed(rows, FINE[0])
    for accepted in FINE[1:]:
        lost = np.flatnonzero(~found.found)
        if not lost.size:
            break
        again = followed(rows.of(lost), accepted)
        for each in fields(found):
            getattr(found, each.name)[lost] = getattr(again, each.name)
    return found
