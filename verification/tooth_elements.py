"""Compliance of the teeth of pinion and rack by elastic finite elements, whole teeth on their bodies.

One tooth and half of the roots beside it are meshed, with hexahedra of second order (27 nodes, curved along
fillets and flanks), twisted along a helical pinion and askew along a rack whose teeth stand askew. All other
teeth follow by symmetry: the pinion has z equal sectors, the rack is taken as a ring of `RACK_TEETH` teeth.
A load on one tooth is the mean of loads of all sectors with phases 2 pi k d / N, so that each phase is a
problem of one sector whose right border is its left one, turned and times exp(2 pi i k / N).

             tip    ____               half of the section: rows of cells are level in the tooth; its
                   |    \\              edge runs from B, in the middle of the fillet, to the form
                   |     |             point and along the flank, the root's from B to the border
                   |------\\ B
      core, block  |   |   \\____       pinion: down to a bore, rack: down to the bar's axis
                   |___|___|___|

The pinion's axis stays straight and does not yield across (what bends it is the shaft's matter); its core is
held against turning at one end face. The rack is held at the plane through the bar's axis. Its teeth end at
the bar's round surface.

Loads act on nodes of the flanks along the normal. Yields are those of the tooth's middle plane under a place,
where the flank's normal meets it: what lies between flank and middle is the local part, which Hertz's line
contact describes down to that depth (Weber and Banaschek 1953).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse import coo_array, csc_array, hstack
from scipy.sparse.linalg import splu

from rps_exudyn.gears.basic_rack import cutter_tip_centre, half_angle, straight_depth
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.trochoid import form_point, trochoid

YOUNGS_MODULUS, POISSON_RATIO = 206e9, 0.3  # of steel, as in ISO 6336-2
RACK_TEETH = 7  # in the ring
BORE = 0.25  # of the pinion, over its root circle
GRADING = 1.5  # of the core's rows, finer below the teeth
FINE = 400  # points between which heights of the middle plane are interpolated
SIDES = (-1, 1)  # drive flank, coast flank
SYMMETRIC: dict[str, Any] = {"diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}


@dataclass(frozen=True)
class Division:
    """Elements of a sector: of the flank from form point to tip, along the teeth, of half a tooth's
    thickness, of the fillet above B, of half a root, of the core below."""

    flank: int = 4
    along: int = 10
    half_tooth: int = 2
    fillet: int = 1
    root: int = 1
    core: int = 3


class Body:
    """A sector's section, in the plane of rotation or travel, and how it runs along the teeth."""

    sectors: int
    lowest: float  # radius or height of the core's bottom [m]
    right: int  # side of the right flank: -1 drive, +1 coast
    flank_range: tuple[float, float]  # form point and tip: tangent lengths, or heights [m]

    def __init__(self, pair: GearPair, division: Division) -> None:
        self.pair, self.division = pair, division

    def edge(self, flank: np.ndarray) -> np.ndarray:
        """Points (n, 2) of the right flank from the form point, 0, to the tip, 1 [m]."""
        raise NotImplementedError

    def fillet(self, share: np.ndarray) -> np.ndarray:
        """Points (n, 2) of the right fillet from B, 0, to the form point, 1."""
        raise NotImplementedError

    def root(self, share: np.ndarray) -> np.ndarray:
        """Points (n, 2) from B, 0, to the sector's border, 1."""
        raise NotImplementedError

    def bottom(self, top: np.ndarray) -> np.ndarray:
        """Points at the bottom of the core below points at its top, (n, 2) both."""
        raise NotImplementedError

    def placed(self, section: np.ndarray, share: np.ndarray) -> np.ndarray:
        """Points (n, 3) of the section's points (n, 2) at shares -1 to 1 along the teeth."""
        raise NotImplementedError

    def beneath(self, flank: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Where normals of the right flank at shares (n,) meet the tooth's middle: height there, how far on
        along the axis, and the depth, (n,) each [m]."""
        raise NotImplementedError

    def share_at(self, height: np.ndarray, along: np.ndarray) -> np.ndarray:
        """Shares along the teeth of places along the axis [m] at heights of the section."""
        raise NotImplementedError

    def normals(self, flank: np.ndarray, share: np.ndarray) -> np.ndarray:
        """Outward normals (n, 3) of the right flank."""
        raise NotImplementedError

    def turned(self, steps: float) -> np.ndarray:
        """Rotation (3, 3) from a sector to the one that many further right."""
        raise NotImplementedError


class Pinion(Body):
    """Section across the axis; the tooth's middle is +Y, right is +X, along +Z it turns to the right."""

    def __init__(self, pair: GearPair, division: Division) -> None:
        super().__init__(pair, division)
        self.sectors, self.right = pair.teeth, -1
        self.lowest = BORE * pair.root_radius
        self._form = form_point(pair)
        tip = float(np.sqrt(pair.tip_radius**2 - pair.base_radius**2))
        self.flank_range = self._form.tangent_length, tip

    def _on_flank(self, flank: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Tangent length, radius and angle from the tooth's middle."""
        form, tip = self.flank_range
        q = form + (tip - form) * flank
        radius = np.hypot(q, self.pair.base_radius)
        return q, radius, half_angle(self.pair, radius)

    def edge(self, flank: np.ndarray) -> np.ndarray:
        _, radius, angle = self._on_flank(flank)
        return radius[:, None] * np.stack([np.sin(angle), np.cos(angle)], axis=1)

    def _trochoid(self, eta: np.ndarray) -> np.ndarray:
        left, turn = trochoid(self.pair, eta) * [-1, 1], np.pi / self.pair.teeth
        return left @ np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])

    @property
    def _middle(self) -> float:
        return (self._form.eta + np.pi / 2) / 2

    def fillet(self, share: np.ndarray) -> np.ndarray:
        return self._trochoid(self._middle + (self._form.eta - self._middle) * share)

    def root(self, share: np.ndarray) -> np.ndarray:
        border, radius = np.pi / self.pair.teeth, self.pair.root_radius
        flat = self._trochoid(np.array([np.pi / 2]))[0]
        start, turn = np.arctan2(*flat), 0.7  # share of the cells on the fillet, unless that is all
        turn = 1.0 if border - start < 1e-3 * border else turn
        eta = self._middle + (np.pi / 2 - self._middle) * np.clip(share / turn, 0, 1)
        angle = start + (border - start) * np.clip((share - turn) / max(1 - turn, 1e-9), 0, 1)
        arc = radius * np.stack([np.sin(angle), np.cos(angle)], axis=1)
        return np.where((share < turn)[:, None], self._trochoid(eta), arc)

    def bottom(self, top: np.ndarray) -> np.ndarray:
        return self.lowest * top / np.hypot(*top.T)[:, None]

    def placed(self, section: np.ndarray, share: np.ndarray) -> np.ndarray:
        z = share * self.pair.face_width / 2
        return np.column_stack([_right(section, self.pair.twist * z), z])

    def normals(self, flank: np.ndarray, share: np.ndarray) -> np.ndarray:
        z = share * self.pair.face_width / 2
        across = np.cos(self.pair.beta_b) * _right(self._across(flank), self.pair.twist * z)
        return np.column_stack([across, np.full(len(across), -np.sin(self.pair.beta_b))])

    def _across(self, flank: np.ndarray) -> np.ndarray:
        q, _, angle = self._on_flank(flank)
        lean = angle - np.arctan2(q, self.pair.base_radius)
        return np.stack([np.cos(lean), -np.sin(lean)], axis=1)

    def beneath(self, flank: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        inwards, point = -np.cos(self.pair.beta_b) * self._across(flank), self.edge(flank)
        along, low, high = np.sin(self.pair.beta_b), np.zeros(len(flank)), 4 * point[:, 0]
        for _ in range(50):
            middle = (low + high) / 2
            x, y = (point + middle[:, None] * inwards).T
            inside = np.arctan2(x, y) > self.pair.twist * along * middle
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        return np.hypot(x, y), along * middle, middle

    def share_at(self, height: np.ndarray, along: np.ndarray) -> np.ndarray:
        return along / (self.pair.face_width / 2)

    def turned(self, steps: float) -> np.ndarray:
        angle = 2 * np.pi * steps / self.sectors
        c, s = np.cos(angle), np.sin(angle)
        return np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])


class Rack(Body):
    """Section along the travel +X, heights from the reference line towards the tips; Z across the bar."""

    def __init__(self, pair: GearPair, division: Division) -> None:
        super().__init__(pair, division)
        self.sectors, self.right = RACK_TEETH, 1
        self.lowest = -pair.reference_height
        self.flank_range = -straight_depth(pair), pair.rack_addendum

    def _in_travel(self, points: np.ndarray) -> np.ndarray:
        return points / [np.cos(self.pair.beta_r), 1]

    def _height(self, flank: np.ndarray) -> np.ndarray:
        form, tip = self.flank_range
        return form + (tip - form) * flank

    def _half(self, height: np.ndarray) -> np.ndarray:
        return np.pi * self.pair.module / 4 - height * np.tan(self.pair.alpha_n)

    def edge(self, flank: np.ndarray) -> np.ndarray:
        height = self._height(flank)
        return self._in_travel(np.stack([self._half(height), height], axis=1))

    def _on_fillet(self, angle: np.ndarray) -> np.ndarray:
        """Points of the fillet at angles below the horizontal."""
        u, y = cutter_tip_centre(self.pair)
        centre = np.array([np.pi * self.pair.module / 2 - u, y])
        return centre - self.pair.fillet_radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)

    @property
    def _middle(self) -> float:
        return (self.pair.alpha_n + np.pi / 2) / 2

    def fillet(self, share: np.ndarray) -> np.ndarray:
        return self._in_travel(self._on_fillet(self._middle + (self.pair.alpha_n - self._middle) * share))

    def root(self, share: np.ndarray) -> np.ndarray:
        flat = self._on_fillet(np.array([np.pi / 2]))[0]
        border, turn = np.pi * self.pair.module / 2, 0.7
        turn = 1.0 if border - flat[0] < 1e-3 * border else turn
        curved = self._on_fillet(self._middle + (np.pi / 2 - self._middle) * np.clip(share / turn, 0, 1))
        curved[:, 0] += (border - flat[0]) * np.clip((share - turn) / max(1 - turn, 1e-9), 0, 1)
        return self._in_travel(curved)

    def bottom(self, top: np.ndarray) -> np.ndarray:
        return np.stack([top[:, 0], np.full(len(top), self.lowest)], axis=1)

    def _half_chord(self, height: np.ndarray) -> np.ndarray:
        return np.sqrt(self.pair.bar_radius**2 - (self.pair.reference_height + height) ** 2)

    def placed(self, section: np.ndarray, share: np.ndarray) -> np.ndarray:
        z = share * self._half_chord(section[:, 1])
        return np.column_stack([section[:, 0] + z * np.tan(self.pair.beta_r), section[:, 1], z])

    def normals(self, flank: np.ndarray, share: np.ndarray) -> np.ndarray:
        alpha, beta = self.pair.alpha_n, self.pair.beta_r
        normal = [np.cos(alpha) * np.cos(beta), np.sin(alpha), -np.cos(alpha) * np.sin(beta)]
        return np.tile(normal, (len(flank), 1))

    def beneath(self, flank: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        height = self._height(flank)
        half, alpha = self._half(height), self.pair.alpha_n
        return height - half * np.tan(alpha), half * np.sin(self.pair.beta_r), half / np.cos(alpha)

    def share_at(self, height: np.ndarray, along: np.ndarray) -> np.ndarray:
        return along / self._half_chord(height)

    def turned(self, steps: float) -> np.ndarray:
        return np.eye(3)


def _right(points: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Points (n, 2) turned to the right by angles (n,)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * points[:, 0] + s * points[:, 1], c * points[:, 1] - s * points[:, 0]], axis=1)


# --- nodes -----------------------------------------------------------------------------------------
class Sector:
    """The nodes of a body's sector on a grid: column, row, layer; nodes beside the tooth, above its root, are
    none."""

    def __init__(self, body: Body) -> None:
        self.body, d = body, body.division
        self.columns, self.layers = 4 * (d.root + d.half_tooth) + 1, 2 * d.along + 1
        self.core, self.rows = 2 * d.core, 2 * (d.core + d.fillet + d.flank) + 1
        self.flank_rows = slice(self.rows - 2 * d.flank - 1, self.rows)
        self.first, self.last = 2 * d.root, self.columns - 1 - 2 * d.root  # of the tooth's columns
        exists = np.zeros((self.columns, self.rows), dtype=bool)
        exists[:, : self.core + 1] = exists[self.first : self.last + 1] = True
        self.number = np.full((self.columns, self.rows, self.layers), -1)
        self.number[exists] = np.arange(exists.sum() * self.layers).reshape(self.layers, -1).T

    @property
    def flank(self) -> np.ndarray:
        """Shares of the flank's rows, from form point to tip."""
        return np.linspace(0, 1, 2 * self.body.division.flank + 1)

    @property
    def share(self) -> np.ndarray:
        """Shares of the layers along the teeth, -1 to 1."""
        return np.linspace(-1, 1, self.layers)

    @cached_property
    def section(self) -> np.ndarray:
        """Points of the nodes in the section, shape (columns, rows, 2)."""
        body, d = self.body, self.body.division
        points = np.full((self.columns, self.rows, 2), np.nan)
        fillet = body.fillet(np.arange(2 * d.fillet) / (2 * d.fillet))
        edge = np.concatenate([fillet, body.edge(self.flank)])
        across = np.linspace(-1, 1, self.last - self.first + 1)
        points[self.first : self.last + 1, self.core :, 0] = across[:, None] * edge[:, 0]
        points[self.first : self.last + 1, self.core :, 1] = edge[:, 1]
        right = body.root(np.arange(1, 2 * d.root + 1) / (2 * d.root))
        points[self.last + 1 :, self.core] = right
        points[: self.first, self.core] = right[::-1] * [-1, 1]
        top = points[:, self.core]
        fall = ((self.core - np.arange(self.core)) / self.core) ** GRADING
        bottom = body.bottom(top)
        points[:, : self.core] = top[:, None] + (bottom - top)[:, None] * fall[:, None]
        return points

    @cached_property
    def places(self) -> np.ndarray:
        """Points of the nodes, shape (n, 3) [m]."""
        share = self.share
        made = np.empty((self.number.max() + 1, 3))
        for layer in range(self.layers):
            number = self.number[:, :, layer]
            made[number[number >= 0]] = self.body.placed(
                self.section[number >= 0], np.full((number >= 0).sum(), share[layer])
            )
        return made

    @cached_property
    def elements(self) -> np.ndarray:
        """Nodes of the elements, shape (m, 27), those along the teeth fastest."""
        made = []
        for i in range(0, self.columns - 2, 2):
            for j in range(0, self.rows - 2, 2):
                if self.number[i : i + 3, j : j + 3].min() >= 0:
                    made += [
                        self.number[i : i + 3, j : j + 3, k : k + 3].ravel()
                        for k in range(0, self.layers - 2, 2)
                    ]
        return np.array(made)

    def beneath(self, side: int) -> csc_array:
        """Yields of the middle plane below the nodes of a flank, along their normals: their weights, shape
        (unknowns, rows of the flank x layers)."""
        heights, own = self.section[self.columns // 2, :, 1], self.section[self.last, self.flank_rows, 1]
        row = np.linspace(0, self.rows - 1, FINE)
        at_row = _quadratic(heights, row)
        height, on, _ = self.body.beneath(self.flank)
        hand = 1 if side == self.body.right else -1
        rows, columns, weights = [], [], []
        for f in range(self.flank.size):
            here = self.share / self.body.share_at(own[f], np.ones(1)) + hand * on[f]  # along the axis [m]
            i, by_row = _lagrange(float(np.interp(height[f], at_row, row)), self.rows)
            layer = (np.clip(self.body.share_at(height[f], here), -1, 1) + 1) / 2 * (self.layers - 1)
            inwards = self._inwards(side, np.full(self.layers, self.flank[f]), self.share)
            for k in range(self.layers):
                j, by_layer = _lagrange(float(layer[k]), self.layers)
                nodes = self.number[self.columns // 2, i : i + 3, j : j + 3].ravel()
                shares = np.outer(by_row, by_layer).ravel()
                for axis in range(3):
                    rows.append(3 * nodes + axis)
                    columns.append(np.full(9, f * self.layers + k))
                    weights.append(shares * inwards[k, axis])
        return self._sparse(rows, columns, weights)

    def loads(self, side: int) -> csc_array:
        """Unit loads on the nodes of a flank, into the material, of the same shape."""
        nodes = self.number[self.last if side == self.body.right else self.first, self.flank_rows].ravel()
        places = np.repeat(self.flank, self.layers), np.tile(self.share, self.flank.size)
        inwards, count = self._inwards(side, *places), np.arange(nodes.size)
        axes = range(3)
        return self._sparse([3 * nodes + a for a in axes], [count] * 3, [inwards[:, a] for a in axes])

    def _inwards(self, side: int, flank: np.ndarray, share: np.ndarray) -> np.ndarray:
        """Normals into the material; the left flank is the right one turned half round about the middle."""
        if side == self.body.right:
            return -self.body.normals(flank, share)
        return self.body.normals(flank, -share) * [1, -1, 1]

    def _sparse(self, rows: list[Any], columns: list[Any], weights: list[Any]) -> csc_array:
        shape = 3 * len(self.places), self.flank.size * self.layers
        values, i, j = (np.concatenate(each) for each in (weights, rows, columns))
        return csc_array(coo_array((values, (i, j)), shape=shape))

    # --- what is held, and how sectors join ---------------------------------------------------------
    def held(self, harmonic: int) -> np.ndarray:
        """Which nodes do not move under loads of so many waves around."""
        held = np.zeros(len(self.places), dtype=bool)
        if isinstance(self.body, Pinion) and harmonic == 0:
            held[self.number[:, : self.core + 1, 0]] = True
        else:
            held[self.number[:, 0]] = True
        return held

    def joined(self, harmonic: int) -> csc_array:
        """Unknowns of all nodes from those that are free, (3 n, m): the right border follows the left one."""
        phase = np.exp(2j * np.pi * harmonic / self.body.sectors) if harmonic else 1.0
        free = ~self.held(harmonic)
        left, right = (self.number[i, : self.core + 1].ravel() for i in (0, -1))
        own = free.copy()
        own[right] = False
        column = np.cumsum(own) - 1
        nodes = np.flatnonzero(own)
        moved = free[right]
        i = [3 * nodes + a for a in range(3)]
        j = [3 * column[nodes] + a for a in range(3)]
        values: list[np.ndarray] = [np.ones(nodes.size)] * 3
        turn = self.body.turned(1)
        for a in range(3):
            for b in range(3):
                i.append(3 * right[moved] + a)
                j.append(3 * column[left[moved]] + b)
                values.append(np.full(moved.sum(), phase * turn[a, b]))
        shape = 3 * len(self.places), 3 * int(own.sum())
        return csc_array(
            coo_array((np.concatenate(values), (np.concatenate(i), np.concatenate(j))), shape=shape)
        )


def _lagrange(coordinate: float, count: int) -> tuple[int, np.ndarray]:
    """First of the three nodes of an element at a coordinate counted in nodes, and their weights (3,)."""
    i = min(int(coordinate // 2) * 2, count - 3)
    x = coordinate - i - 1
    return i, np.array([x * (x - 1) / 2, 1 - x * x, x * (x + 1) / 2])


def _quadratic(values: np.ndarray, coordinates: np.ndarray) -> np.ndarray:
    """Values at coordinates counted in nodes."""
    made = []
    for each in coordinates:
        i, weights = _lagrange(float(each), values.size)
        made.append(weights @ values[i : i + 3])
    return np.array(made)


# --- elements ----------------------------------------------------------------------------------------
def stiffness(places: np.ndarray, elements: np.ndarray) -> csc_array:
    """Return the stiffness of 27-node hexahedra, unknowns 3 node + direction [N/m]."""
    nodes, weights = np.polynomial.legendre.leggauss(3)
    shape = np.stack([nodes * (nodes - 1) / 2, 1 - nodes**2, nodes * (nodes + 1) / 2])
    slope = np.stack([nodes - 0.5, -2 * nodes, nodes + 0.5])
    per_local = np.stack(
        [
            np.einsum("ap,bq,cr->abcpqr", *each).reshape(27, 27)
            for each in ((slope, shape, shape), (shape, slope, shape), (shape, shape, slope))
        ]
    )  # (3, nodes, points)
    volume = np.einsum("p,q,r->pqr", weights, weights, weights).ravel()
    jacobian = np.einsum("dnp,enx->epdx", per_local, places[elements])
    per_place = np.einsum("epxd,dnp->epnx", np.linalg.inv(jacobian), per_local, optimize=True)
    dx = np.abs(np.linalg.det(jacobian)) * volume
    lame = YOUNGS_MODULUS * POISSON_RATIO / (1 + POISSON_RATIO) / (1 - 2 * POISSON_RATIO)
    shear = YOUNGS_MODULUS / 2 / (1 + POISSON_RATIO)
    rows = per_place.transpose(0, 2, 3, 1).reshape(len(elements), 81, 27)
    products = ((rows * dx[:, None]) @ rows.transpose(0, 2, 1)).reshape(-1, 27, 3, 27, 3)
    matrices = lame * products + shear * products.transpose(0, 1, 4, 3, 2)
    traces = shear * np.einsum("eicjc->eij", products)
    for a in range(3):
        matrices[:, :, a, :, a] += traces
    unknowns = (3 * elements[:, :, None] + np.arange(3)).reshape(len(elements), -1)
    i, j = np.broadcast_arrays(unknowns[:, :, None], unknowns[:, None, :])
    size = 3 * len(places)
    return csc_array(coo_array((matrices.ravel(), (i.ravel(), j.ravel())), shape=(size, size)))


def compliance(body: Body, mutual: bool = True) -> np.ndarray:
    """Return the yields below nodes of the flanks under unit loads on nodes [m/N], shape (d, 2, p, 2, p).

    d counts teeth to the right from the loaded one, negative ones from the end; then flank (drive, coast)
    and node (row of the flank, layer) of the yield, and of the load. Betti's theorem holds for flank on
    flank, not for flank on middle plane: `mutual` yields are the means of both ways.
    """
    sector = Sector(body)
    whole = stiffness(sector.places, sector.elements)
    loads = hstack([sector.loads(side) for side in SIDES]).tocsc()
    yields = hstack([sector.beneath(side) for side in SIDES]).tocsc()
    count, size = body.sectors, loads.shape[1]
    made = np.zeros((count, size, size))
    for harmonic in range(count // 2 + 1):
        join = sector.joined(harmonic)
        back = join.conj().T
        factor = splu((back @ whole @ join).tocsc(), permc_spec="MMD_AT_PLUS_A", **SYMMETRIC)
        moved = (yields.T @ join) @ factor.solve((back @ loads).toarray())
        twice = 1 if harmonic in (0, count / 2) else 2
        for d in range(count):
            made[d] += twice / count * np.real(np.exp(2j * np.pi * harmonic * d / count) * moved)
    for d in range(count // 2 + 1 if mutual else 0):
        mean = (made[d] + made[-d % count].T) / 2
        made[d], made[-d % count] = mean, mean.T
    return made.reshape(count, 2, size // 2, 2, size // 2)
