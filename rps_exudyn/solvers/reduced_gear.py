"""The gear reduced to one coordinate: a table of its torque, friction elements, inertia. A record of arrays.

Equilibria give the torque T of the pinion at angles phi under loads F, turned up and down
(`scenes.reduced_table`). What is conservative in it follows from one potential, so that the gear makes no
energy; the rest is friction:

    W(phi, F) = X_0(phi) F + R(phi) + int_0^F e(phi, F') dF',   T_c = dW/dphi,    rack travel X = dW/dF
    J phi'' = T - T_c - sum k_i (xi_i + tau xi_i') - c phi'
    - s_i H_down <= k_i xi_i <= s_i H_up,          H_up = T_up - T_c,     H_down = T_c - T_down

X_0 is the perfect rack's travel, g phi or a course, R the potential of the free gear's ripple, e the
transmission error, the mean of both directions; F pulls the rack towards -X. What T_up and T_down have beside
T_c is friction, so that both are those of the table. A course has the inertia of its mean squared gain.
The k_i are elasto-plastic elements side by side (Iwan, J. Appl. Mech. 33, 1966; Dupont et al., IEEE Trans.
Autom. Control 47, 2002). Their limits have the table's friction, and fall with speed as the gear's parts do.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np


class BeyondTable(Exception):
    """An angle or a load outside the table, with the range as text."""


@dataclass(frozen=True, eq=False)
class ReducedGear:
    """The reduced gear; SI units."""

    gain: float  # rack travel per radian, of a variable ratio in the middle [m]
    gain_squared: float  # mean over the angles [m^2]
    inertia: float  # of pinion and rack about the pinion's axis [kg m^2]
    drag: float  # viscous, on the pinion [N m s/rad]
    angles: np.ndarray  # (n,) even; of a gear that repeats they are one period, its end included [rad]
    repeats: bool  # whether the table is that of one period
    loads: np.ndarray  # (m,) even, with 0 among them [N]
    up: np.ndarray  # (n, m) torque on the pinion that turns towards +X [N m]
    down: np.ndarray  # the same of one that turns towards -X
    course: np.ndarray  # (n, 2) what the perfect rack's travel has beside the gain, and its slope [m]
    error: np.ndarray  # (n, m) transmission error, the mean of both ways, which falls with the load [m]
    shares: np.ndarray  # (e,) of the friction that the elements carry
    stiffness: np.ndarray  # (e,) of the elements [N m/rad]
    speeds: np.ndarray = field(default_factory=lambda: np.zeros(1))  # (s,) rising, from 0 [rad/s]
    # (s,) friction over that of the table
    speed_factor: np.ndarray = field(default_factory=lambda: np.ones(1))
    constant: float = 0.0  # part of the friction that depends neither on preload nor on load [N m]
    seat_share: float = 0.0  # share of the rest that is the plunger's
    yokenut_force: float = 0.0  # largest on the yokenut without a load [N]

    @cached_property
    def free(self) -> np.ndarray:
        """R and its slope at the angles, (n, 2) [J, N m]."""
        h, middle = self.angles[1] - self.angles[0], len(self.loads) // 2
        both = (self.up[:, middle] + self.down[:, middle]) / 2
        weight = np.full(len(self.angles), h)
        weight[[0, -1]] = h / 2
        slope = both - weight @ both / weight.sum()
        whole = np.concatenate([[0.0], np.cumsum(h / 2 * (slope[1:] + slope[:-1]))])
        return np.column_stack([whole, slope])

    @cached_property
    def loaded(self) -> np.ndarray:
        """The integral of e and its derivatives by angle, by load and by both at the nodes, (n, m, 4)."""
        h, k = self.angles[1] - self.angles[0], self.loads[1] - self.loads[0]
        if self.repeats:
            rolled = (np.roll(self.error[:-1], shift, 0) for shift in (-1, 1))
            ahead, behind = rolled
            slope = (ahead - behind) / (2 * h)
            slope = np.concatenate([slope, slope[:1]])
        else:
            slope = np.gradient(self.error, h, axis=0)
        integrals = []
        for each in (self.error, slope):
            sums = np.cumsum(k / 2 * (each[:, 1:] + each[:, :-1]), axis=1)
            sums = np.concatenate([np.zeros((len(each), 1)), sums], axis=1)
            integrals.append(sums - sums[:, len(self.loads) // 2, None])
        return np.stack([*integrals, self.error, slope], axis=-1)

    @cached_property
    def friction(self) -> np.ndarray:
        """H_up and H_down at the nodes, (n, m, 2) [N m]."""
        held = (
            (self.gain + self.course[:, 1, None]) * self.loads + self.free[:, 1, None] + self.loaded[..., 1]
        )
        return np.maximum(np.stack([self.up - held, held - self.down], axis=-1), 0.0)

    @cached_property
    def cells(self) -> np.ndarray:
        """Coefficients of R and the integral in each cell, by powers of the place in it, (n-1, m-1, 4, 4)."""
        h, k = self.angles[1] - self.angles[0], self.loads[1] - self.loads[0]
        nodes = self.loaded.copy()
        nodes[..., :2] += self.free[:, None] + self.course[:, None] * self.loads[:, None]
        nodes[..., 2:] += self.course[:, None]
        nodes = (nodes * [1, h, k, h * k]).reshape(*nodes.shape[:2], 2, 2)  # by load, by angle
        ends = np.stack([nodes[:-1], nodes[1:]], axis=-1)
        both = np.stack([ends[:, :-1], ends[:, 1:]], axis=-1)  # (., ., load, angle, end, end of load)
        return np.asarray(np.einsum("aij,bkl,nmkijl->nmab", HERMITE, HERMITE, both))

    @property
    def damping(self) -> float:
        """tau [s]: elements that stick damp the pinion on them half as much as critically."""
        return float(np.sqrt(self.inertia / self.stiffness.sum()))


class Tables:
    """The tables as plain lists, looked up at one angle and load."""

    def __init__(self, gear: ReducedGear) -> None:
        self.gear = gear
        self.friction = gear.friction.tolist()
        self.cell = np.swapaxes(gear.cells, 2, 3).tolist()  # for each power of the load those of the angle
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
                f"a load of {load:.4g} N on the rack at {np.degrees(angle):.4g} deg lies beyond the table, "
                f"which has {ends[0]:.4g} to {ends[1]:.4g} N"
            )
        i, j = min(max(int(x), 0), self.cells - 1), min(max(int(y), 0), self.rows - 1)
        return i, x - i, j, y - j

    def potential(self, angle: float, load: float) -> tuple[float, float, float, float]:
        """Return W [J], dW/dphi [N m], dW/dF [m], d^2W/dF^2 [m/N]."""
        i, x, j, y = self._place(angle, load)
        one, slope = [], []
        for a, b, c, d in self.cell[i][j]:
            one.append(a + x * (b + x * (c + x * d)))
            slope.append(b + x * (2 * c + 3 * x * d))
        (a, b, c, d), (p, q, r, s) = one, slope
        return (
            self.gain * angle * load + a + y * (b + y * (c + y * d)),
            self.gain * load + (p + y * (q + y * (r + y * s))) / self.step,
            self.gain * angle + (b + y * (2 * c + 3 * y * d)) / self.spacing,
            (2 * c + 6 * y * d) / self.spacing**2,
        )

    def limits(self, angle: float, load: float) -> tuple[float, float]:
        """Return H_up and H_down [N m]."""
        i, x, j, y = self._place(angle, load)
        a, b = self.friction[i], self.friction[i + 1]
        up, down = (
            (1 - x) * ((1 - y) * a[j][k] + y * a[j + 1][k]) + x * ((1 - y) * b[j][k] + y * b[j + 1][k])
            for k in (0, 1)
        )
        return up, down


HERMITE = np.array([[[1, 0], [0, 0]], [[0, 0], [1, 0]], [[-3, 3], [-2, -1]], [[2, -2], [1, 1]]], dtype=float)
"""Powers of the place in a cell, from values and slopes at its ends: (power, value or slope, end)."""


def elements(slip: np.ndarray, turned: np.ndarray, friction: float) -> tuple[np.ndarray, np.ndarray]:
    """Return shares and stiffness [N m/rad] of the elements whose friction turns about as measured.

    Args:
        slip: pinion angle since the turn, (n,) [rad].
        turned: share of the friction that has turned about by then, (n,).
        friction: half the jump of the torque [N m].
    """
    from scipy.optimize import nnls

    yields = np.geomspace(*YIELDS)
    # each element counts as much as the next one; what turns about at once is in the fastest one
    places = np.geomspace(2 * YIELDS[0], min(4 * YIELDS[1], slip[-1]), 10 * len(yields))
    turned, reached = np.interp(places, slip, turned), np.minimum(places[:, None] / (2 * yields), 1.0)
    weight = np.append(np.ones(len(places)), WHOLE)  # the shares are the whole friction
    shares, _ = nnls(
        np.vstack([reached, np.ones(len(yields))]) * weight[:, None], np.append(turned, 1.0) * weight
    )
    kept = np.sort(np.argsort(shares)[-MOST_ELEMENTS:])
    kept = kept[shares[kept] > LEAST_SHARE]
    shares = shares[kept] / shares[kept].sum()
    return shares, shares * friction / yields[kept]


YIELDS = (2e-5, 2e-2, 13)  # pinion angles over which elements are tried [rad]
MOST_ELEMENTS = 4
LEAST_SHARE = 0.01  # of the friction, below which an element is none
WHOLE = 100.0  # weight of the sum of all shares beside each measured one
