"""The gear reduced to one coordinate: a table of its torque, friction elements, inertia. A record of arrays.

Equilibria give the torque T of the pinion at angles phi under loads F, turned up and down
(`scenes.reduced_table`). What is conservative in it follows from one potential, so that the gear makes no
energy; the rest is friction:

    W(phi, F) = g phi F + R(phi, F) + E(F),        T_c = dW/dphi,        rack travel X = dW/dF
    J phi'' = T - T_c - sum k_i (xi_i + tau xi_i') - c phi'
    - s_i H_down <= k_i xi_i <= s_i H_up,          H_up = T_up - T_c,     H_down = T_c - T_down

R is the ripple, E the complementary energy of what yields under load; F pulls the rack towards -X. The k_i
are elasto-plastic elements side by side (Iwan, J. Appl. Mech. 33, 1966; Dupont et al., IEEE Trans. Autom.
Control 47, 2002), whose limits have the table's friction and fall with speed as that of the gear's parts.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

Row = tuple[float, float, float, float]


class BeyondTable(Exception):
    """An angle or a load outside the table, with the range as text."""


@dataclass(frozen=True, eq=False)
class ReducedGear:
    """The reduced gear; SI units.

    Attributes:
        gain: rack travel per radian [m].
        inertia: of pinion and rack about the pinion's axis [kg m^2].
        drag: viscous, on the pinion [N m s/rad].
        angles: (n,) even; of a gear that repeats they are one period, its end included [rad].
        repeats: whether the table is that of one period.
        loads: (m,) even, with 0 among them [N].
        up: (n, m) torque on the pinion that turns towards +X [N m].
        down: the same of one that turns towards -X.
        yielding: (m,) mean transmission error under each load, without that of no load [m].
        shares: (e,) of the friction that the elements carry.
        stiffness: (e,) of the elements [N m/rad].
        speeds: (s,) rising, from 0 [rad/s].
        speed_factor: (s,) friction over that of the table.
        constant: part of the friction that depends neither on preload nor on load [N m].
        seat_share: share of the rest that is the plunger's.
    """

    gain: float
    inertia: float
    drag: float
    angles: np.ndarray
    repeats: bool
    loads: np.ndarray
    up: np.ndarray
    down: np.ndarray
    yielding: np.ndarray
    shares: np.ndarray
    stiffness: np.ndarray
    speeds: np.ndarray = field(default_factory=lambda: np.zeros(1))
    speed_factor: np.ndarray = field(default_factory=lambda: np.ones(1))
    constant: float = 0.0
    seat_share: float = 0.0

    @cached_property
    def ripple(self) -> np.ndarray:
        """R and its derivatives by angle, by load and by both at the table's nodes, (n, m, 4)."""
        h, both = self.angles[1] - self.angles[0], (self.up + self.down) / 2
        weight = np.full(len(self.angles), h)
        weight[[0, -1]] = h / 2
        slope = both - weight @ both / weight.sum()
        if self.repeats:
            bend = (np.roll(slope[:-1], -1, 0) - np.roll(slope[:-1], 1, 0)) / (2 * h)
            bend = np.concatenate([bend, bend[:1]])
        else:
            bend = np.gradient(slope, h, axis=0)
        steps = h / 2 * (slope[1:] + slope[:-1]) + h**2 / 12 * (bend[:-1] - bend[1:])
        whole = np.concatenate([np.zeros((1, slope.shape[1])), np.cumsum(steps, axis=0)])
        whole -= weight @ whole / weight.sum()
        by_load = (np.gradient(each, self.loads, axis=1) for each in (whole, slope))
        return np.stack([whole, slope, *by_load], axis=-1)

    @cached_property
    def friction(self) -> np.ndarray:
        """H_up and H_down at the nodes, (n, m, 2) [N m]."""
        held = self.gain * self.loads + self.ripple[..., 1]
        return np.maximum(np.stack([self.up - held, held - self.down], axis=-1), 0.0)

    @cached_property
    def energy(self) -> np.ndarray:
        """E and its derivative at the loads, (m, 2) [J, m]."""
        step = np.diff(self.loads)
        sums = np.concatenate([[0.0], np.cumsum(step * (self.yielding[1:] + self.yielding[:-1]) / 2)])
        return np.column_stack([sums - np.interp(0.0, self.loads, sums), self.yielding])

    @property
    def damping(self) -> float:
        """tau [s]: elements that stick damp half as much as it takes to damp the pinion on them critically."""
        return float(np.sqrt(self.inertia / self.stiffness.sum()))


class Tables:
    """The tables as plain lists, looked up at one angle and load."""

    def __init__(self, gear: ReducedGear) -> None:
        self.gear = gear
        self.ripple, self.friction = gear.ripple.tolist(), gear.friction.tolist()
        self.energy = gear.energy.tolist()
        self.first, self.step = float(gear.angles[0]), float(gear.angles[1] - gear.angles[0])
        self.least, self.spacing = float(gear.loads[0]), float(gear.loads[1] - gear.loads[0])
        self.cells, self.rows = len(gear.angles) - 1, len(gear.loads) - 1
        self.gain = gear.gain

    def _place(self, angle: float, load: float) -> tuple[int, float, int, float]:
        """Cell and place in it along both axes.

        Raises:
            BeyondTable: there is none.
        """
        x = (angle - self.first) / self.step
        if self.gear.repeats:
            x -= self.cells * (x // self.cells)
        y = (load - self.least) / self.spacing
        if not (-1e-9 <= x <= self.cells + 1e-9 and -1e-9 <= y <= self.rows + 1e-9):
            ends = self.least, self.least + self.rows * self.spacing
            raise BeyondTable(
                f"a load of {load:.4g} N on the rack at {np.degrees(angle):.4g} deg lies beyond the table, which "
                f"has {ends[0]:.4g} to {ends[1]:.4g} N"
            )
        i, j = min(max(int(x), 0), self.cells - 1), min(max(int(y), 0), self.rows - 1)
        return i, x - i, j, y - j

    def potential(self, angle: float, load: float) -> tuple[float, float, float, float]:
        """Return W [J], dW/dphi [N m], dW/dF [m], d^2W/dF^2 [m/N].

        Raises:
            BeyondTable: the table has no such angle or load.
        """
        i, x, j, y = self._place(angle, load)
        at, after = hermite(x, self.step), hermite_slope(x, self.step)
        left, right = self.ripple[i], self.ripple[i + 1]
        ends = []
        for k in (j, j + 1):
            a, b = left[k], right[k]
            ends.append((_sum(at, a[0], b[0], a[1], b[1]), _sum(at, a[2], b[2], a[3], b[3])))
            ends.append((_sum(after, a[0], b[0], a[1], b[1]), _sum(after, a[2], b[2], a[3], b[3])))
        up, rise = hermite(y, self.spacing), hermite_slope(y, self.spacing)
        bend = hermite_bend(y, self.spacing)
        (p, p_f), (q, q_f), (r, r_f), (s, s_f) = ends
        e, f = self.energy[j], self.energy[j + 1]
        return (
            self.gain * angle * load + _sum(up, p, r, p_f, r_f) + _sum(up, e[0], f[0], e[1], f[1]),
            self.gain * load + _sum(up, q, s, q_f, s_f),
            self.gain * angle + _sum(rise, p, r, p_f, r_f) + _sum(rise, e[0], f[0], e[1], f[1]),
            _sum(bend, p, r, p_f, r_f) + _sum(bend, e[0], f[0], e[1], f[1]),
        )

    def limits(self, angle: float, load: float) -> tuple[float, float]:
        """Return H_up and H_down [N m].

        Raises:
            BeyondTable: the table has no such angle or load.
        """
        i, x, j, y = self._place(angle, load)
        a, b = self.friction[i], self.friction[i + 1]
        up, down = (
            (1 - x) * ((1 - y) * a[j][k] + y * a[j + 1][k]) + x * ((1 - y) * b[j][k] + y * b[j + 1][k])
            for k in (0, 1)
        )
        return up, down


def hermite(x: float, h: float) -> Row:
    """Return weights of the values at both ends of a cell of length h, and of the slopes there."""
    return (1 + 2 * x) * (1 - x) ** 2, x * x * (3 - 2 * x), h * x * (1 - x) ** 2, h * x * x * (x - 1)


def hermite_slope(x: float, h: float) -> Row:
    """Return the derivatives of these weights."""
    return 6 * x * (x - 1) / h, 6 * x * (1 - x) / h, (1 - x) * (1 - 3 * x), x * (3 * x - 2)


def hermite_bend(x: float, h: float) -> Row:
    """Return their second derivatives."""
    return (12 * x - 6) / h**2, (6 - 12 * x) / h**2, (6 * x - 4) / h, (6 * x - 2) / h


def _sum(weights: Row, a: float, b: float, a_slope: float, b_slope: float) -> float:
    return weights[0] * a + weights[1] * b + weights[2] * a_slope + weights[3] * b_slope


def elements(slip: np.ndarray, turned: np.ndarray, friction: float) -> tuple[np.ndarray, np.ndarray]:
    """Return shares and stiffness [N m/rad] of the elements whose friction turns about as measured.

    Args:
        slip: pinion angle since the turn, (n,) [rad].
        turned: share of the friction that has turned about by then, (n,).
        friction: half the jump of the torque [N m].
    """
    from scipy.optimize import nnls

    yields = np.geomspace(*YIELDS)
    reached = np.minimum(slip[:, None] / (2 * yields), 1.0)
    weight = np.append(np.ones(len(slip)), WHOLE)  # the shares are the whole friction
    shares, _ = nnls(
        np.vstack([reached, np.ones(len(yields))]) * weight[:, None], np.append(turned, 1.0) * weight
    )
    kept = np.sort(np.argsort(shares)[-MOST_ELEMENTS:])
    kept = kept[shares[kept] > LEAST_SHARE]
    shares = shares[kept] / shares[kept].sum()
    return shares, shares * friction / yields[kept]


YIELDS = (5e-5, 2e-2, 11)  # pinion angles over which elements are tried [rad]
MOST_ELEMENTS = 4
LEAST_SHARE = 0.01  # of the friction, below which an element is none
WHOLE = 100.0  # weight of the sum of all shares beside each measured one


def speed_factors(friction_at: Sequence[float], speeds: np.ndarray) -> np.ndarray:
    """Return friction at speeds over that at the highest one."""
    at = np.asarray(friction_at)
    return np.asarray(at / at[-1]) if at[-1] > 0 else np.ones(len(speeds))
