"""Compliance of a rack's tooth by elastic finite elements.

The upper half of a round bar with 2 n + 1 teeth is clamped at `depth` below its root and free elsewhere. Its
section is a sheet of hexahedra of second order (20 nodes, curved along the fillets); sheets follow each other
along the teeth, as wide at each height as the bar's chord is, and are chained by block elimination.

          tip   ____           ____            half of the section, mirrored at x = 0, where the tooth
    x = 0 |    /    \\         /    \\           in the middle is cut: loads on one of its flanks are the
          |   /      \\       /      \\          mean of an even and an odd part
          |  (   ^    \\_____/        \\___
          |  y   |            |          |
          |______|____________|__________|     clamped

Patches, over which loads press evenly and yields are averaged, are `ROWS` strips of the plane flank from
root to tip, cut into equal pieces along the tooth. With G the patches' unit loads and K = L L^T the
stiffness, their compliance is G^T K^-1 G = (L^-1 G)^T (L^-1 G): one sweep along the tooth.

The teeth's ends stand square to the tooth, where those of a real rack are askew by the tooth angle.

scikit-fem (the extra `[verification]`) gives the elements' shape functions and the integration.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.sparse import coo_array, csr_array

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.basic_rack import cutter_tip_centre, straight_depth
from rps_exudyn.gears.gear_pair import GearPair

YOUNGS_MODULUS, POISSON_RATIO = 206e9, 0.3  # of steel, as in ISO 6336-2
ROWS = 3  # strips of patches between fillet and tip
FILLET, TIP = 1, 1 + ROWS  # rows of cells above the block: one along the fillet, the others along the flank
GRADING = 1.6  # of the block's rows, finer below the teeth
LEAN = 0.5  # over the module: depth in which the columns' edges become upright
ORDER = 5  # of the integration
NEAR = 1e-6  # of coordinates counted in cells
RIGHT_FLANKS = (1, 3)  # columns' edges: the tooth in the middle, the next tooth


def finite_elements() -> Any:
    """Return scikit-fem.

    Raises:
        InputError: it is not installed.
    """
    try:
        import skfem
    except ImportError:
        raise InputError(
            "Finite elements need scikit-fem: install rps-exudyn with its extra [verification]."
        ) from None
    return skfem


@dataclass(frozen=True)
class Section:
    """The rack's half section, mapped from cells: x counts columns from the middle, y rows from the root."""

    pair: GearPair
    beside: int = 1  # teeth on either side of the one in the middle, at least one
    depth: float = 3.0  # of the block below the middle of the fillets, over the module
    block_rows: int = 3

    def half_width(self, height: np.ndarray) -> np.ndarray:
        """Half the tooth's thickness at heights of its flanks or fillets [m]."""
        (x, y), radius, _ = self._fillet
        below = np.clip(y - height, radius * np.sin(self.pair.alpha_n), radius)
        flank = np.pi * self.pair.module / 4 - height * np.tan(self.pair.alpha_n)
        return np.where(height > -straight_depth(self.pair), flank, x - np.sqrt(radius**2 - below**2))

    @property
    def columns(self) -> int:
        """Half a tooth, then root and tooth in turn, and half a root."""
        return 2 + 2 * self.beside

    def row_height(self, row: float | np.ndarray) -> float | np.ndarray:
        """Height above the reference line of a place on the flank, 0 at the fillet, `ROWS` at the tip [m]."""
        straight = straight_depth(self.pair)
        return -straight + (self.pair.rack_addendum + straight) * row / ROWS

    def half_length(self, height: float | np.ndarray) -> np.ndarray:
        """Half the length along the tooth at a height above the reference line, the round bar's chord [m]."""
        pair = self.pair
        chord = np.sqrt(pair.bar_radius**2 - np.square(pair.reference_height + height))
        return np.asarray(chord / np.cos(pair.beta_r))

    def points(self, cells: np.ndarray) -> np.ndarray:
        """Return the points (x, y) [m] of places (column, row) counted in cells, shape (2, n) both."""
        column = np.clip(np.floor(cells[0] + NEAR), 0, self.columns - 1)
        in_tooth = (column % 2 == 0) | (cells[1] > NEAR)
        return np.where(in_tooth, self._tooth(cells), self._root(cells, column))

    def _tooth(self, cells: np.ndarray) -> np.ndarray:
        """Rows of a tooth and of the column below it are straight and level."""
        tooth = np.round((cells[0] - 0.5) / 2)
        across = np.where(tooth == 0, cells[0], 2 * (cells[0] - 2 * tooth) - 1)
        edge = self._edge(cells[1])
        return np.stack([tooth * np.pi * self.pair.module + across * edge[0], edge[1]])

    def _root(self, cells: np.ndarray, column: np.ndarray) -> np.ndarray:
        """Rows below a root are level but for the root's curve, which fades with depth."""
        across = (cells[0] - column) * np.where(column == self.columns - 1, 0.5, 1.0)
        row = np.minimum(cells[1], 0)
        pitch = np.pi * self.pair.module

        def level(edge: np.ndarray) -> np.ndarray:
            return np.stack([edge[0] + across * (pitch - 2 * edge[0]), edge[1]])

        curve = self._root_curve(across) - level(self._edge(np.zeros_like(row)))
        place = level(self._edge(row)) + curve * (1 - self._fall(row))
        return place + np.stack([(column - 1) / 2 * pitch, np.zeros_like(row)])

    # --- edges, right of the middle of a tooth ----------------------------------------------------
    @cached_property
    def _fillet(self) -> tuple[np.ndarray, float, float]:
        """Centre and radius of the fillet, and the angle at which tooth and root meet on it."""
        u, y = cutter_tip_centre(self.pair)
        middle = (self.pair.alpha_n + np.pi / 2) / 2
        return np.array([np.pi * self.pair.module / 2 - u, y]), self.pair.fillet_radius, middle

    def _on_fillet(self, angle: np.ndarray) -> np.ndarray:
        """Points of the fillet at angles below the horizontal."""
        centre, radius, _ = self._fillet
        return centre[:, None] - radius * np.stack([np.cos(angle), np.sin(angle)])

    def _fall(self, row: np.ndarray) -> np.ndarray:
        """How far down the block a row lies, 0 to 1."""
        return np.clip(-row / self.block_rows, 0, 1) ** GRADING

    def _edge(self, row: np.ndarray) -> np.ndarray:
        """Right edge of a tooth and of the column below it, shape (2, n)."""
        pair, (_, _, middle) = self.pair, self._fillet
        up = np.clip(row, 0, FILLET) / FILLET
        fillet = self._on_fillet(middle + (pair.alpha_n - middle) * up)
        height = self.row_height(np.clip(row - FILLET, 0, ROWS))
        flank = np.stack([np.pi * pair.module / 4 - height * np.tan(pair.alpha_n), height])
        start, fall = self._on_fillet(np.full_like(row, middle)), self._fall(row)
        inwards = LEAN / np.tan(middle) * (1 - (1 - fall) ** (self.depth / LEAN))  # first along the normal
        below = start - pair.module * np.stack([inwards, self.depth * fall])
        return np.where(row >= FILLET, flank, np.where(row >= 0, fillet, below))

    def _root_curve(self, across: np.ndarray) -> np.ndarray:
        """The root from fillet to fillet, from the middle of the tooth on its left; `across` from 0 to 1."""
        centre, radius, middle = self._fillet
        pitch = np.pi * self.pair.module
        half = np.minimum(across, 1 - across)
        arc = radius * (np.pi / 2 - middle)
        path = half * 2 * (arc + pitch / 2 - centre[0])
        curved = self._on_fillet(middle + np.minimum(path, arc) / radius)
        x = curved[0] + np.maximum(path - arc, 0)
        return np.stack([np.where(across > 0.5, pitch - x, x), curved[1]])


class Compliance(NamedTuple):
    """Mean yield of a patch along its flank's normal under a unit load on another, shape (p, p) each [m/N].

    Patches are counted along the tooth first, then from the fillet up. Yields count into the material.
    """

    same: np.ndarray  # on the same flank
    opposite: np.ndarray  # between the two flanks of a tooth
    next: np.ndarray  # on the same side of the next tooth
    unknowns: int


class Model(NamedTuple):
    """The elements' equations, three unknowns at each node."""

    stiffness: csr_array  # [N/m]
    loads: np.ndarray  # unit loads on the patches of the middle tooth, then of the next, (unknowns, 2 p)
    planes: list[np.ndarray]  # unknowns on the sheets' planes
    between: list[np.ndarray]  # unknowns between these planes
    clamped: np.ndarray  # whether an unknown stands at the bottom
    middle: np.ndarray  # whether it stands at x = 0


def rack_compliance(section: Section, patches: int, refinement: int) -> Compliance:
    """Return the compliance of a tooth with `patches` patches along it.

    Cells of the section, and patches, are divided into `refinement` elements each way.

    Raises:
        InputError: scikit-fem is not installed.
    """
    model = assembled(section, patches, refinement)
    even, odd = chained(model, even=True), chained(model, even=False)
    mean, half, count = (even + odd) / 2, (even - odd) / 2, patches * ROWS
    return Compliance(mean[:count, :count], half[:count, :count], mean[:count, count:], model.loads.shape[0])


# --- elements ----------------------------------------------------------------------------------------
def assembled(section: Section, patches: int, refinement: int) -> Model:
    """Assemble the elements."""
    fem = finite_elements()
    columns = np.linspace(0, section.columns, section.columns * refinement + 1)
    rows = np.linspace(-section.block_rows, TIP, (section.block_rows + TIP) * refinement + 1)
    cells = fem.MeshHex.init_tensor(columns, rows, np.linspace(-1, 1, patches * refinement + 1))
    x, y = cells.p[:2, cells.t].mean(axis=1)
    cells = cells.remove_elements(np.flatnonzero((y > 0) & (np.floor(x) % 2 == 1)))
    curved = fem.MeshHex2.from_mesh(cells)
    places = section.points(curved.doflocs[:2])
    mesh = replace(curved, doflocs=np.stack([*places, curved.doflocs[2] * section.half_length(places[1])]))
    basis = fem.Basis(mesh, fem.ElementHexS2(), intorder=ORDER)

    x, y, z = np.repeat(basis.doflocs, 3, axis=1)
    step = np.round((z / section.half_length(y) + 1) * patches * refinement).astype(int)  # two to a sheet
    order = np.lexsort((np.round(y, 10), np.round(x, 10)))
    layers = [order[step[order] == number] for number in range(2 * patches * refinement + 1)]
    return Model(
        stiffness(basis),
        pressed(fem, mesh, cells, patches),
        layers[::2],
        layers[1::2],
        clamped=y < y.min() + NEAR * section.pair.module,
        middle=abs(x) < NEAR * section.pair.module,
    )


def stiffness(basis: Any) -> csr_array:
    """Return the elements' stiffness, unknowns 3 node + direction [N/m].

    K_ia,jb = integral of lambda N_i,a N_j,b + mu (N_i,b N_j,a + delta_ab sum_c N_i,c N_j,c).
    """
    slopes = np.stack([shape[0].grad for shape in basis.basis])  # (nodes, 3, elements, points)
    nodes, _, elements, points = slopes.shape
    rows = slopes.transpose(2, 0, 1, 3).reshape(elements, 3 * nodes, points)
    products = rows @ (rows * basis.dx[:, None, :]).transpose(0, 2, 1)
    products = products.reshape(elements, nodes, 3, nodes, 3)
    lame = YOUNGS_MODULUS * POISSON_RATIO / (1 + POISSON_RATIO) / (1 - 2 * POISSON_RATIO)
    shear = YOUNGS_MODULUS / 2 / (1 + POISSON_RATIO)
    traces = np.einsum("eicjc->eij", products)
    matrices = lame * products + shear * products.transpose(0, 1, 4, 3, 2)
    matrices += shear * traces[:, :, None, :, None] * np.eye(3)[None, None, :, None, :]
    unknowns = (3 * basis.element_dofs.T[:, :, None] + np.arange(3)).reshape(elements, -1)
    i, j = np.broadcast_arrays(unknowns[:, :, None], unknowns[:, None, :])
    return csr_array(coo_array((matrices.ravel(), (i.ravel(), j.ravel())), shape=(3 * basis.N, 3 * basis.N)))


def pressed(fem: Any, mesh: Any, cells: Any, patches: int) -> np.ndarray:
    """Return unit normal loads, spread evenly over each patch, shape (unknowns, patches of both flanks)."""
    place = cells.p[:, cells.facets].mean(axis=1)  # of the facets, counted in cells
    on_flank = (np.abs(place[0][:, None] - RIGHT_FLANKS) < NEAR) & (place[1] > FILLET)[:, None]
    facets = np.flatnonzero(on_flank.any(axis=1))
    flank = fem.FacetBasis(mesh, fem.ElementHexS2(), facets=facets, intorder=ORDER)
    side, row = on_flank[facets, 1].astype(int), (place[1, facets] - FILLET).astype(int)
    patch = (side * ROWS + row) * patches + ((place[2, facets] + 1) / 2 * patches).astype(int)
    areas = np.bincount(patch, weights=flank.dx.sum(axis=1))
    loads = np.zeros((flank.N, 3, areas.size))
    for (shape, *_), nodes in zip(flank.basis, flank.element_dofs, strict=True):
        forces = np.einsum("eq,eq,aeq->ea", np.asarray(shape), flank.dx, flank.normals)
        for axis in range(3):
            np.add.at(loads[:, axis], (nodes, patch), forces[:, axis])
    return (loads / areas).reshape(3 * flank.N, -1)


# --- elimination -------------------------------------------------------------------------------------
def chained(model: Model, even: bool) -> np.ndarray:
    """Return the compliance of all patches under loads mirrored at x = 0, or mirrored and turned round.

    Each sheet's front plane and inner nodes are eliminated together; what is left acts on the next plane.
    """
    across = np.arange(model.middle.size) % 3 == 0
    free = ~model.clamped & ~(model.middle & (across if even else ~across))
    planes = [each[free[each]] for each in model.planes]
    between = [each[free[each]] for each in model.between]
    n, total = planes[0].size, np.zeros((model.loads.shape[1],) * 2)
    taken, carried = np.zeros((n, n)), np.zeros((n, model.loads.shape[1]))
    none = np.empty(0, dtype=int)
    for plane, inner, following in zip(planes, [*between, none], [*planes[1:], none], strict=True):
        block = np.concatenate([plane, inner])
        rows = model.stiffness[block]
        matrix, loads = rows[:, block].toarray(), model.loads[block]
        matrix[:n, :n] -= taken
        loads[:n] -= carried
        factor = cholesky(matrix, lower=True, overwrite_a=True, check_finite=False)
        solved = solve_triangular(factor, loads, lower=True, check_finite=False)
        reach = solve_triangular(factor, rows[:, following].toarray(), lower=True, check_finite=False)
        total += solved.T @ solved
        taken, carried = reach.T @ reach, reach.T @ solved
    return total
