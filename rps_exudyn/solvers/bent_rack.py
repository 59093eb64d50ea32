"""A bar that is bent: the laws of straight racks act at the bar's pose where they stand.

Modes of the free bar, eta, stand behind the coordinates of `gear_model`: pinion, rack (6), plunger, eta (m).
At the station xi of the bar, where an element touches it, the bar is displaced by w = sum(phi eta) + bow and
turned by theta in plane y, likewise by u and psi in plane z. A straight rack that touches there has

    y' = y + w - xi theta,  c' = c + theta        z' = z + u - xi psi,  b' = b - psi

and the element's law sees this local pose. Station xi = X - x for what stands at X in the housing, so that
the local pose moves along the bar as the rack is displaced. By virtual work a law's forces on the local pose
act on the rack as they are, on the modes by the derivatives of the local pose, and along X by what the local
pose changes with the station: without that part, sliding along a bent bar would do work.

Deflections are linear in eta: slopes of 0.02 rad shorten the bar by a part in five thousand.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rps_exudyn.base.compiled import (
    CUBE,
    MATRIX,
    NUMBER,
    VECTOR,
    Array,
    entry,
    inline,
    record,
    record_type,
    stacked,
    stacked_zeros,
)
from rps_exudyn.forces.friction import MOST_COORDINATES
from rps_exudyn.gears.bar_bow import BarBow
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.rack_beam import RackBeam
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear

MODES = 8  # where the modes begin in the stack
LOCAL = 13  # coordinates of pinion, rack, plunger and supports
MOST_MODES = MOST_COORDINATES - LOCAL
MOST_SECTIONS, MOST_LOCAL = 4 * (MOST_MODES + 2), LOCAL * MOST_COORDINATES  # numbers of arrays on the stack

# Rows of a bar's fields at its nodes: w, dw/dxi, theta, dtheta/dxi of a unit of each mode, and of the bow
SHAPE, SLOPE, ROTATION, CURVATURE = 0, 1, 2, 3
# Rows of its sections: what it lifts and turns a straight rack that touches it, and both by the station
LIFT, TURN, LIFT_DRIFT, TURN_DRIFT = 0, 1, 2, 3
# Rows of a local pose
POSE, RATE, DRIFT = 0, 1, 2  # six coordinates, their rates, their derivatives by the station

BAR = record_type(
    [
        ("is_bent", "i8"),  # else the bar is straight and rigid, and nothing else counts
        ("modes", "i8"),
        ("in_y", "i8"),  # modes in plane y, which come first
        ("nodes", "i8"),
        ("first", "f8"),  # station of the first node [m]
        ("spacing", "f8"),  # of the nodes [m]
        (
            "fields",
            "i8",
        ),  # place in the pool: (nodes, 4, modes + 2), rows SHAPE .. CURVATURE of the modes, ...
        ("stiffness", "i8"),  # ... of the bow in y and in z; (modes,) angular frequency squared [1/s^2]
        ("damping", "i8"),  # (modes,) twice the damping ratio times the angular frequency [1/s]
    ]
)
"""Record of the shapes of a bar's modes and its bow at even stations; the numbers stand in the pool."""


@inline
def bar_sections(station, bar, pool, sections):  # type: ignore[no-untyped-def]
    """Fill rows LIFT .. TURN_DRIFT at a station, shape (4, m + 2), by cubic Hermite interpolation."""
    place = (station - bar.first) / bar.spacing
    i = min(max(int(np.floor(place)), 0), bar.nodes - 2)
    t, h = place - i, bar.spacing
    columns = bar.modes + 2
    a = bar.fields + i * 4 * columns  # place of the node before the station
    at_a, at_b = (1 + 2 * t) * (1 - t) ** 2, t * t * (3 - 2 * t)
    by_a, by_b = t * (1 - t) ** 2 * h, t * t * (t - 1) * h
    rise, by_a_rise, by_b_rise = 6 * t * (1 - t) / h, (1 - t) * (1 - 3 * t), t * (3 * t - 2)
    for k in range(columns):
        shape_a, slope_a = pool[a + SHAPE * columns + k], pool[a + SLOPE * columns + k]
        turn_a, bend_a = pool[a + ROTATION * columns + k], pool[a + CURVATURE * columns + k]
        shape_b, slope_b = pool[a + (4 + SHAPE) * columns + k], pool[a + (4 + SLOPE) * columns + k]
        turn_b, bend_b = pool[a + (4 + ROTATION) * columns + k], pool[a + (4 + CURVATURE) * columns + k]
        w = at_a * shape_a + at_b * shape_b + by_a * slope_a + by_b * slope_b
        slope = rise * (shape_b - shape_a) + by_a_rise * slope_a + by_b_rise * slope_b
        turn = at_a * turn_a + at_b * turn_b + by_a * bend_a + by_b * bend_b
        bend = rise * (turn_b - turn_a) + by_a_rise * bend_a + by_b_rise * bend_b
        sections[LIFT, k], sections[TURN, k] = w - station * turn, turn
        sections[LIFT_DRIFT, k], sections[TURN_DRIFT, k] = slope - turn - station * bend, bend


@inline
def fill_pose(q, v, sections, drifts, bar, pose):  # type: ignore[no-untyped-def]
    """Fill the pose of a straight rack that touches the bar at a station, rows POSE, RATE and DRIFT.

    `drifts` is how fast the station moves over the rack's speed along X: -1, or 0 where it is a point of the
    bar.
    """
    m = bar.modes
    for i in range(6):
        pose[POSE, i], pose[RATE, i], pose[DRIFT, i] = q[1 + i], v[1 + i], 0.0
    for plane in range(2):
        begin, end, bow = (0, bar.in_y, m) if plane == 0 else (bar.in_y, m, m + 1)
        lift, turn = sections[LIFT, bow], sections[TURN, bow]
        lift_drift, turn_drift = sections[LIFT_DRIFT, bow], sections[TURN_DRIFT, bow]
        lift_rate = turn_rate = 0.0
        for k in range(begin, end):
            eta, eta_rate = q[MODES + k], v[MODES + k]
            lift += sections[LIFT, k] * eta
            turn += sections[TURN, k] * eta
            lift_rate += sections[LIFT, k] * eta_rate
            turn_rate += sections[TURN, k] * eta_rate
            lift_drift += sections[LIFT_DRIFT, k] * eta
            turn_drift += sections[TURN_DRIFT, k] * eta
        across, about, sense = (1, 5, 1.0) if plane == 0 else (2, 4, -1.0)
        pose[POSE, across] += lift
        pose[POSE, about] += sense * turn
        pose[RATE, across] += lift_rate + lift_drift * drifts * v[1]
        pose[RATE, about] += sense * (turn_rate + turn_drift * drifts * v[1])
        pose[DRIFT, across] = lift_drift
        pose[DRIFT, about] = sense * turn_drift


@inline
def add_to_bar(total, forces, pose, sections, drifts, bar):  # type: ignore[no-untyped-def]
    """Add forces (6) on a local pose to those on the rack and its modes."""
    for i in range(6):
        total[1 + i] += forces[i]
        total[1] += drifts * forces[i] * pose[DRIFT, i]
    for k in range(bar.in_y):
        total[MODES + k] += forces[1] * sections[LIFT, k] + forces[5] * sections[TURN, k]
    for k in range(bar.in_y, bar.modes):
        total[MODES + k] += forces[2] * sections[LIFT, k] - forces[4] * sections[TURN, k]


@inline
def add_elasticity(total, q, v, bar, pool):  # type: ignore[no-untyped-def]
    """Add the modes' own forces: elastic, and of the bar's damping."""
    for k in range(bar.modes):
        total[MODES + k] -= pool[bar.stiffness + k] * q[MODES + k] + pool[bar.damping + k] * v[MODES + k]


@entry(MATRIX, MATRIX, NUMBER, NUMBER, Array(BAR, 1), VECTOR, CUBE)
def fill_local_poses(coordinates, rates, place, drifts, bars, pool, poses):  # type: ignore[no-untyped-def]
    """Fill the local poses along a motion (n, 3, 6), at X = `place` in the housing (`drifts` -1) or at that
    station of the bar (0); `bars` holds the record `BAR`."""
    bar = bars[0]
    sections = stacked((4, bar.modes + 2), MOST_SECTIONS)
    for i in range(coordinates.shape[0]):
        bar_sections(place + drifts * coordinates[i, 1], bar, pool, sections)
        fill_pose(coordinates[i], rates[i], sections, drifts, bar, poses[i])


# --- tangent ---------------------------------------------------------------------------------------
@inline
def fill_pose_by_bar(pose, sections, drifts, bar, by):  # type: ignore[no-untyped-def]
    """Fill the derivatives of pinion, a local pose and plunger by all coordinates, shape (8, n)."""
    for i in range(8):
        for j in range(by.shape[1]):
            by[i, j] = 1.0 if i == j else 0.0
    for i in range(6):
        by[1 + i, 1] += drifts * pose[DRIFT, i]
    for k in range(bar.in_y):
        by[2, MODES + k], by[6, MODES + k] = sections[LIFT, k], sections[TURN, k]
    for k in range(bar.in_y, bar.modes):
        by[3, MODES + k], by[5, MODES + k] = sections[LIFT, k], -sections[TURN, k]


@inline
def add_products(by, rows, local, tangent):  # type: ignore[no-untyped-def]
    """Add by^T local by to a tangent (n, n); `by` has so many rows, `local` (rows, rows)."""
    n = by.shape[1]
    carried = stacked_zeros((rows, n), MOST_LOCAL)
    for i in range(rows):
        for k in range(rows):
            if local[i, k] != 0:
                for j in range(n):
                    carried[i, j] += local[i, k] * by[k, j]
    for k in range(rows):
        for i in range(n):
            if by[k, i] != 0:
                for j in range(n):
                    tangent[i, j] += by[k, i] * carried[k, j]


@inline
def add_elasticity_tangent(bar, pool, factor_q, factor_v, tangent):  # type: ignore[no-untyped-def]
    """Add what the modes' own forces change by."""
    for k in range(bar.modes):
        own = factor_q * pool[bar.stiffness + k] + factor_v * pool[bar.damping + k]
        tangent[MODES + k, MODES + k] -= own


@inline
def add_geometric(result, forces, sections, drifts, factor_q, bar):  # type: ignore[no-untyped-def]
    """Add what forces (6) on a local pose change as the station moves along the modes."""
    for k in range(bar.modes):
        if k < bar.in_y:
            change = forces[1] * sections[LIFT_DRIFT, k] + forces[5] * sections[TURN_DRIFT, k]
        else:
            change = forces[2] * sections[LIFT_DRIFT, k] - forces[4] * sections[TURN_DRIFT, k]
        result[1, MODES + k] += factor_q * drifts * change
        result[MODES + k, 1] += factor_q * drifts * change


# --- The bar of a gear: its modes of bending, its bow, and where the forces act on it

ALONG_BAR, ON_BAR = -1.0, 0.0  # what stands in the housing, along which the bar slides; what travels with it


@dataclass(frozen=True, eq=False)
class BentBar:
    """A bar with modes, a bow, or both."""

    record: np.record  # its constants for compiled code
    pool: np.ndarray  # the numbers that the record points to
    # element -> X in the housing and `ALONG_BAR`, or station of the bar and `ON_BAR`; an element that is not
    # listed acts on the rigid body
    places: Mapping[str, tuple[float, float]]
    end: float  # station of the end beside the pinion [m]

    @property
    def modes(self) -> int:
        """Return the number of modes m, of both planes."""
        return int(self.record.modes)

    @property
    def stiffness(self) -> np.ndarray:
        """Return the stiffness of the modes, shape (m,) [N/m per kg]."""
        return self.pool[self.record.stiffness :][: self.modes]

    @property
    def damping(self) -> np.ndarray:
        """Return the damping of the modes, shape (m,) [N s/m per kg]."""
        return self.pool[self.record.damping :][: self.modes]

    def poses(
        self, coordinates: np.ndarray, rates: np.ndarray, place: tuple[float, float]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return coordinates and rates, (n, 6) each, of a straight rack that touches the bar at a place, from
        those of the whole gear, (n, 8 + m)."""
        q, v = (np.ascontiguousarray(rows) for rows in (coordinates, rates))
        bars, local = np.array([self.record], dtype=BAR), np.empty((len(q), 3, 6))
        fill_local_poses(q, v, *place, bars, self.pool, local)
        return local[:, 0], local[:, 1]

    def on_modes(self, station: float) -> np.ndarray:
        """Return the forces on the modes per force along X, Y, Z on a station of the bar, shape (m, 3)."""
        sections = np.empty((4, self.modes + 2))
        bar_sections.py_func(station, self.record, self.pool, sections)
        lift, turn = sections[:2, : self.modes]
        shapes, in_y = lift + station * turn, self.record.in_y
        forces = np.zeros((self.modes, 3))
        forces[:in_y, 1], forces[in_y:, 2] = shapes[:in_y], shapes[in_y:]
        return forces

    def elastic_energy(self, coordinates: np.ndarray) -> np.ndarray:
        """Return the energy of bending, shape (n,) [J]."""
        return 0.5 * coordinates[:, MODES : MODES + self.modes] ** 2 @ self.stiffness

    def damping_power(self, rates: np.ndarray) -> np.ndarray:
        """Return what the bar's damping takes, shape (n,) [W]."""
        return rates[:, MODES : MODES + self.modes] ** 2 @ self.damping


def bent_bar(
    gear: SteeringGear, fidelity: Fidelity, places: Mapping[str, tuple[float, float]]
) -> BentBar | None:
    """Return the bar as the fidelity models it; None where it is straight and rigid."""
    per_plane = gear.rack.modes if fidelity.rack == "flexible" else 0
    if not per_plane and not gear.rack.bow:
        return None
    # tabulated, modes in plane y first
    modes = RackBeam.of(gear).modes(per_plane)
    bow = BarBow.of(gear)
    of_modes = np.stack([modes.shape, modes.gradient, modes.slope, modes.curvature])  # (4, m, nodes)
    of_bow = np.stack([bow.offset, bow.gradient, bow.gradient, bow.curvature])  # (4, 2, nodes)
    fields = np.concatenate([of_modes, of_bow], axis=1).transpose(2, 0, 1)
    damping = 2 * gear.rack.modal_damping * modes.frequencies
    count = len(modes.frequencies)
    made = record(
        BAR,
        is_bent=1,
        modes=count,
        in_y=int(np.sum(modes.plane == 0)),
        nodes=len(modes.nodes),
        first=float(modes.nodes[0]),
        spacing=float(modes.nodes[1] - modes.nodes[0]),
        fields=2 * count,
        stiffness=0,
        damping=count,
    )
    pool = np.concatenate([modes.frequencies**2, damping, fields.ravel()])
    return BentBar(made, pool, places, RackBar.of(gear).x_min)
