"""The course of a rack of variable ratio: its travel X over the pinion's angle phi, X' = g, g' = X''.

For an involute helicoid n . (k x r) = r_b cos(beta_b); so meshing with a rack that travels X(phi) has at
each angle one normal for all teeth of a side, at the generator psi* with

    sin psi* = S = A / g + B,   A = r_b / cos delta,   B = tan(beta_b) tan(delta),   c = sqrt(1 - S^2).

The rack is the envelope of these tangent planes, a developable surface. At each angle it is a rack of
constant ratio with the pressure angle alpha, sin alpha = cos(beta_b) c. A contact at the tangent length q has
the relative radius q (1 - s q / Q) / cos(beta_b) on side s, with

    1 / Q = r_b g' / (g^3 cos^2(delta) c^2):

the rack is undercut where q_a / |Q| reaches 1 at the pinion's tips. Scalars give a course of constant q_a/Q,

    phi_1 - phi_0 = q_a / (kappa r_b) (W(S_1) - W(S_0)),   W(S) = ln(1 - S^2) / 2 + B artanh S.

All of these are derived in the geometry page of the documentation.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import mm
from rps_exudyn.parameters.declaration import DEG, numbers_in
from rps_exudyn.parameters.gear import Ratio

MOST_PIECES = 64  # of a course, as the record of the contact has room for
ON_RAMP = 24  # pieces between two constant ratios: the gain is within 1e-9 m/rad of q_a / Q constant
STEEPNESS = 5 * DEG, 40 * DEG  # limits of the pressure angle, those of pinion.pressure_angle

Function = np.ndarray | float


@dataclass(frozen=True)
class Mesh:
    """What a pinion at its shaft angle makes of a gain."""

    base_radius: float  # r_b [m]
    beta_b: float
    delta: float  # shaft angle as designed
    tip_length: float  # q_a, tangent length at the pinion's tips [m]

    @cached_property
    def A(self) -> float:
        """r_b / cos delta [m]."""
        return self.base_radius / float(np.cos(self.delta))

    @cached_property
    def B(self) -> float:
        """tan(beta_b) tan(delta)."""
        return float(np.tan(self.beta_b) * np.tan(self.delta))

    def sine(self, gain: Function) -> np.ndarray:
        """S = sin psi* of a gain [m/rad]."""
        return np.asarray(self.A / np.asarray(gain) + self.B)

    def pressure_angle(self, gain: Function) -> np.ndarray:
        """Normal pressure angle alpha of the rack [rad]."""
        return np.arcsin(np.cos(self.beta_b) * np.sqrt(1 - self.sine(gain) ** 2))

    def gain(self, pressure_angle: Function) -> np.ndarray:
        """Gain at which the rack has a normal pressure angle [m/rad]."""
        S = np.sqrt(1 - (np.sin(pressure_angle) / np.cos(self.beta_b)) ** 2)
        return np.asarray(self.A / (S - self.B))

    def tooth_angle(self, gain: Function) -> np.ndarray:
        """Angle beta_r of the rack's generators to its cross direction, in its pitch plane [rad]: that of the
        trace of the plane with the normal (1, ., -(tan delta + g tan beta_b / (r_b cos delta)))."""
        lead = np.tan(self.beta_b) / self.base_radius / np.cos(self.delta)
        return np.arctan(np.tan(self.delta) + np.asarray(gain) * lead)

    def bend(self, gain: Function, slope: Function) -> np.ndarray:
        """1 / Q of gain and slope g' [1/m]."""
        c_squared = 1 - self.sine(gain) ** 2
        return (
            self.base_radius
            * np.asarray(slope)
            / (np.asarray(gain) * np.cos(self.delta)) ** 2
            / (np.asarray(gain) * c_squared)
        )

    def gains_allowed(self) -> tuple[float, float]:
        """Least and largest gain [m/rad]: those at the limits of the pressure angle."""
        return float(self.gain(STEEPNESS[0])), float(self.gain(STEEPNESS[1]))

    def primitive(self, gain: Function) -> np.ndarray:
        """W(S) of a gain: the turn that it takes at q_a / Q = 1 over q_a / r_b."""
        S = self.sine(gain)
        return np.log1p(-(S**2)) / 2 + self.B * np.arctanh(S)

    def least_turn(self, first: float, last: float) -> float:
        """Least turn of the pinion from one gain to another without undercut [rad]."""
        change = self.primitive(last) - self.primitive(first)
        return abs(float(self.tip_length / self.base_radius * change))


@dataclass(frozen=True)
class Course:
    """Gain as a piecewise cubic: piece i begins at `starts[i]`, the first one holds below it, too.

    `pieces[i]` is (X_0, g_0, g_1, g_2, g_3): with u the angle from the piece's start, the gain is
    g_0 + g_1 u + g_2 u^2 + g_3 u^3 [m/rad], the travel X_0 plus its integral [m].
    """

    starts: tuple[float, ...]
    pieces: tuple[tuple[float, ...], ...]

    @classmethod
    def through(
        cls, angles: np.ndarray, gains: np.ndarray, before: np.ndarray, after: np.ndarray
    ) -> "Course":
        """Return the course with gains (n,) and slopes behind and ahead of angles (n,), constant outside."""
        h, rise = np.diff(angles), np.diff(gains)
        d_0, d_1 = after[:-1], before[1:]
        cubic = np.stack(
            [gains[:-1], d_0, (3 * rise / h - 2 * d_0 - d_1) / h, (d_0 + d_1 - 2 * rise / h) / h**2]
        )
        cubic = np.concatenate([np.zeros((4, 1)), cubic, np.zeros((4, 1))], axis=1)
        cubic[0, 0], cubic[0, -1] = gains[0], gains[-1]
        starts = np.concatenate([[angles[0] - 1.0], angles])
        widths = np.diff(starts)
        way = (cubic[:, :-1] * widths ** np.arange(1, 5)[:, None] / np.arange(1, 5)[:, None]).sum(axis=0)
        travel = np.concatenate([[0.0], np.cumsum(way)])
        raw = cls(tuple(starts), tuple(map(tuple, np.concatenate([travel[None], cubic]).T)))
        travel -= float(raw.travel(0.0))
        return cls(raw.starts, tuple(map(tuple, np.concatenate([travel[None], cubic]).T)))

    @cached_property
    def _table(self) -> tuple[np.ndarray, np.ndarray]:
        return np.array(self.starts), np.array(self.pieces)

    def _at(self, angle: Function) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
        starts, pieces = self._table
        place = np.maximum(np.searchsorted(starts, angle, side="right") - 1, 0)
        return np.asarray(angle) - starts[place], tuple(pieces.T[:, place])

    def travel(self, angle: Function) -> np.ndarray:
        """X at pinion angles [rad], of their shape [m]."""
        u, (x, a, b, c, d) = self._at(angle)
        return x + u * (a + u * (b / 2 + u * (c / 3 + u * d / 4)))

    def gain(self, angle: Function) -> np.ndarray:
        """g = X' [m/rad]."""
        u, (_, a, b, c, d) = self._at(angle)
        return a + u * (b + u * (c + u * d))

    def slope(self, angle: Function) -> np.ndarray:
        """g' = X'' [m/rad^2]."""
        u, (_, _, b, c, d) = self._at(angle)
        return b + u * (2 * c + u * 3 * d)

    def angle(self, travel: Function) -> np.ndarray:
        """The pinion's angle at a travel [m], by Newton's method: X rises with it [rad]."""
        travel = np.asarray(travel, dtype=float)
        angle = travel / float(self.gain(0.0))
        for _ in range(20):
            step = (self.travel(angle) - travel) / self.gain(angle)
            angle = angle - step
            if not np.abs(step).max(initial=0.0) > 1e-15:
                break
        return angle

    @cached_property
    def places(self) -> np.ndarray:
        """Angles at which extremes of the course are sought: 16 in each piece [rad], shape (n,)."""
        starts = np.array(self.starts)
        inner = starts[:-1, None] + np.diff(starts)[:, None] * np.linspace(0, 1, 17)[:-1]
        return np.append(inner.ravel(), starts[-1])


@lru_cache(maxsize=64)
def course_of(ratio: Ratio, mesh: Mesh, cut: float) -> Course:
    """Return the course that a gear asks for; `cut` is the gain of module and tooth angle [m/rad]."""
    if ratio.angle:
        angles, gains = (
            np.array(numbers_in(ratio.angle)),
            np.array(numbers_in(ratio.travel_per_turn)) / (2 * np.pi),
        )
        from scipy.interpolate import CubicSpline  # loads in a third of a second

        slopes = CubicSpline(angles, gains, bc_type="clamped")(angles, 1)
        course = Course.through(angles, gains, slopes, slopes)
        _check(course.gain(course.places), mesh, lambda end: "rack.ratio.travel_per_turn")
        return course
    centre = ratio.centre / (2 * np.pi) or cut
    lock = ratio.lock / (2 * np.pi) or centre
    ends = np.array([centre, lock])
    _check(ends, mesh, lambda end: f"rack.ratio.{'lock' if end and ratio.lock else 'centre'}")
    if lock == centre:
        return Course.through(np.array([-1.0, 1.0]), np.full(2, centre), np.zeros(2), np.zeros(2))
    begin, end = getattr(ratio, "from"), ratio.to
    gains = np.linspace(centre, lock, ON_RAMP + 1)
    W = mesh.primitive(gains)
    angles = begin + (end - begin) * (W - W[0]) / (W[-1] - W[0])
    per_radian = (W[-1] - W[0]) / (end - begin)  # = kappa r_b / q_a
    # g' = kappa / (q_a bend(g, 1))
    slopes = per_radian / (mesh.base_radius * mesh.bend(gains, 1.0))
    middle = slice(1, None) if begin == 0 else slice(None)
    before, after = slopes.copy(), slopes.copy()
    before[0], after[-1] = -slopes[0] if begin == 0 else 0.0, 0.0
    mirrored = [-angles[::-1], gains[::-1], -after[::-1], -before[::-1]]
    one_way = [each[middle] for each in (angles, gains, before, after)]
    return Course.through(*(np.concatenate(pair) for pair in zip(mirrored, one_way, strict=True)))


def _check(gains: np.ndarray, mesh: Mesh, path: Callable[[int], str]) -> None:
    """Check the gains that a course has [m/rad]."""
    least, most = mesh.gains_allowed()
    for place in (int(gains.argmin()), int(gains.argmax())):
        gain = float(gains[place])
        if not least <= gain <= most:
            nearest = (
                np.ceil(2e6 * np.pi * least) / 1e6 if gain < least else np.floor(2e6 * np.pi * most) / 1e6
            )
            raise InputError(
                f"{path(place)} leads to a travel of {mm(2 * np.pi * gain, 5)} per turn, at which the rack "
                f"would have no pressure angle of {STEEPNESS[0] / DEG:g} to {STEEPNESS[1] / DEG:g} deg; "
                f"the nearest admissible value is {mm(float(nearest), 6)}."
            )
