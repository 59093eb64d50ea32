"""Bending stiffness of the toothed bar by a periodic cell of solid elements, one pitch long.

The bar is cut into cubes; one that the surface cuts counts by its filled share. The cell is strained as by
stretching, bending in both planes and twisting, and free to find the periodic displacements of least energy:
that gives its stiffness against all four, and the inverse of that how it yields to one bending moment alone.
Cubes have eight nodes and incompatible modes (Wilson 1973), so that they bend without locking; conjugate
gradients solve for the displacements.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.base.compiled import kernel
from rps_exudyn.gears.bar_section import CHORD_ERROR, POISSON_RATIO, root_section, toothed_section
from rps_exudyn.gears.basic_rack import rack_tooth
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.gear import SteeringGear

CASES: dict[str, Mapping[str, object]] = {
    "default": {},
    "tooth angle 0": {"rack.tooth_angle": "0 deg"},
    "tooth angle 25 deg": {"rack.tooth_angle": "25 deg"},
    "tooth angle 40 deg": {"rack.tooth_angle": "40 deg"},
    "pressure angle 30 deg": {"pinion.pressure_angle": "30 deg"},
    "pressure angle 15 deg, fillet 0.2": {
        "pinion.pressure_angle": "15 deg",
        "basic_rack.fillet_radius": 0.2,
    },
    "short teeth": {"basic_rack.addendum": 0.7, "basic_rack.dedendum": 1.0},
    "teeth nearer the axis": {"rack.reference_height": "6 mm"},
    "module 2.5 mm": {"pinion.normal_module": "2.5 mm", "pinion.tip_diameter": "24 mm"},
    "thicker bar": {"rack.bar_diameter": "24.9 mm", "rack.reference_height": "10 mm"},
}
CUBES = 12  # along a pitch; 20 are 0.4 % less stiff
INSIDE = 4  # points along each edge of a cube that say how full it is
EMPTY = 0.01  # share below which a cube is left out
TOLERANCE, MOST = 1e-5, 3000  # of conjugate gradients
CORNERS = np.array([(a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)], dtype=float)
DATA = "cells.json"


@dataclass(frozen=True)
class Cubes:
    """Filled cubes of one pitch: nodes (n, 8), shares (n,), centres (n, 3) [m], edge [m], length [m]."""

    nodes: np.ndarray
    share: np.ndarray
    centre: np.ndarray
    edge: float
    length: float


def run(folder: Path, cubes: int = CUBES, cases: Mapping[str, Mapping[str, object]] = CASES) -> None:
    """Measure the cells of these bars."""
    rows = []
    for name, change in cases.items():
        bar = RackBar.of(SteeringGear().replace(change))
        root, toothed = root_section(bar).second_moments, toothed_section(bar).second_moments
        cell = cell_second_moments(bar, cubes)
        rows.append({"name": name, "root": root, "cell": cell, "section": toothed})
        print(rows[-1], flush=True)
    save_data(folder / DATA, {"cubes": cubes, "cells": rows})
    print(cells_table(folder))


def cell_second_moments(bar: RackBar, cubes: int) -> tuple[float, float]:
    """Bending stiffness over Young's modulus in the planes y and z [m^4]."""
    cell = filled_cubes(bar, cubes)
    stiffness, loads, energy = _element(cell)
    forces = np.zeros((4, cell.nodes.max() + 1, 3))
    diagonal = np.zeros(forces.shape[1:])
    for a in range(8):
        of_node = slice(3 * a, 3 * a + 3)
        np.add.at(diagonal, cell.nodes[:, a], cell.share[:, None] * np.diag(stiffness)[of_node])
        for case in range(4):
            np.add.at(forces[case], cell.nodes[:, a], cell.share[:, None] * loads[case][:, of_node])
    solved = [_solved(cell, stiffness, diagonal, -force) for force in forces]
    whole = energy + np.array([[np.sum(force * moved) for moved in solved] for force in forces])
    compliance = np.linalg.inv((whole + whole.T) / 2 / cell.length)
    return float(1 / compliance[1, 1]), float(1 / compliance[2, 2])


def filled_cubes(bar: RackBar, cubes: int) -> Cubes:
    """The cubes of one pitch that are not empty."""
    pair, length = bar.pair, bar.pair.rack_pitch
    edge = length / cubes
    across = 2 * int(np.ceil(pair.bar_radius / edge))
    tooth, pitch = rack_tooth(pair, CHORD_ERROR), np.pi * pair.module
    x = (np.arange(cubes * INSIDE) + 0.5) * edge / INSIDE
    y = (np.arange(across * INSIDE) + 0.5) * edge / INSIDE - across * edge / 2
    share = np.zeros((cubes, across, across))
    for i in range(cubes):
        here = x[i * INSIDE : (i + 1) * INSIDE, None, None]
        u = here * np.cos(pair.beta_r) - y * np.sin(pair.beta_r)
        top = np.interp((u + pitch / 2) % pitch - pitch / 2, tooth[:, 0], tooth[:, 1])
        full = (y[:, None] ** 2 + y**2 < pair.bar_radius**2) & (-(y[:, None] + pair.reference_height) < top)
        share[i] = full.reshape(INSIDE, across, INSIDE, across, INSIDE).mean(axis=(0, 2, 4))
    at = np.stack(np.nonzero(share > EMPTY))
    corners = at[:, :, None] + (CORNERS.T[:, None] > 0)
    number = ((corners[0] % cubes) * (across + 1) + corners[1]) * (across + 1) + corners[2]  # periodic
    nodes = np.unique(number, return_inverse=True)[1].reshape(-1, 8)
    centre = (at.T + 0.5) * edge - np.array([0, across, across]) * edge / 2
    return Cubes(nodes, share[tuple(at)], centre, edge, length)


def _element(cell: Cubes) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stiffness of a full cube (24, 24), loads of the cubes under four strains (4, n, 24), and the strains'
    energy (4, 4), over Young's modulus."""
    material = _material()
    weight = cell.edge**3 / 8
    points = [(p, *_strains(p, cell.edge)) for p in CORNERS / np.sqrt(3)]
    inner = sum(weight * own.T @ material @ own for _, _, own in points)
    coupling = sum(weight * nodal.T @ material @ own for _, nodal, own in points)
    stiffness = sum(weight * nodal.T @ material @ nodal for _, nodal, _ in points)
    stiffness = stiffness - coupling @ np.linalg.solve(inner, coupling.T)
    shape = 4, len(cell.share)
    loads, own_loads, energy = np.zeros((*shape, 24)), np.zeros((*shape, 9)), np.zeros((4, 4))
    for point, nodal, own in points:
        imposed = _imposed(cell.centre + point * cell.edge / 2)
        stress = weight * imposed @ material
        loads, own_loads = loads + stress @ nodal, own_loads + stress @ own
        energy = energy + np.einsum("ane,bne,n->ab", stress, imposed, cell.share)
    released = np.linalg.solve(inner, np.swapaxes(own_loads, 1, 2))
    energy = energy - np.einsum("ane,ben,n->ab", own_loads, released, cell.share)
    loads = loads - own_loads @ np.linalg.solve(inner, coupling.T)
    return stiffness, loads, energy


def _material() -> np.ndarray:
    """Elasticity of strains (xx, yy, zz, xy, xz, yz) over Young's modulus."""
    lame = POISSON_RATIO / (1 + POISSON_RATIO) / (1 - 2 * POISSON_RATIO)
    shear = 1 / (2 * (1 + POISSON_RATIO))
    material = np.diag([2 * shear] * 3 + [shear] * 3)
    material[:3, :3] += lame
    return material


def _strains(point: np.ndarray, edge: float) -> tuple[np.ndarray, np.ndarray]:
    """Strains by the nodes' displacements (6, 24) and by the incompatible modes (6, 9) at a point."""
    factors = (1 + CORNERS * point) / 2
    gradients = np.stack(
        [np.prod(np.where(np.arange(3) == k, CORNERS / 2, factors), axis=1) for k in range(3)], axis=1
    )
    nodal = np.concatenate([_symmetric(gradient * 2 / edge) for gradient in gradients], axis=1)
    own = np.concatenate([_symmetric(gradient) for gradient in np.diag(-4 * point / edge)], axis=1)
    return nodal, own


def _symmetric(gradient: np.ndarray) -> np.ndarray:
    """Strains of a displacement with a gradient, along each of the axes, shape (6, 3)."""
    x, y, z = gradient
    return np.array([[x, 0, 0], [0, y, 0], [0, 0, z], [y, x, 0], [z, 0, x], [0, z, y]])


def _imposed(place: np.ndarray) -> np.ndarray:
    """Strains of stretching, bending in y, bending in z, and twisting, shape (4, n, 6)."""
    _, y, z = place.T
    strain = np.zeros((4, len(place), 6))
    strain[0, :, 0], strain[1, :, 0], strain[2, :, 0] = 1.0, -y, -z
    strain[3, :, 3], strain[3, :, 4] = -z, y
    return strain


@kernel
def _multiplied(moved, nodes, share, stiffness):  # type: ignore[no-untyped-def]
    """Forces of the cubes on all nodes for displacements (n, 3)."""
    out, local = np.zeros_like(moved), np.empty(24)
    for e in range(nodes.shape[0]):
        for a in range(8):
            for k in range(3):
                local[3 * a + k] = moved[nodes[e, a], k]
        for a in range(8):
            for k in range(3):
                total = 0.0
                for j in range(24):
                    total += stiffness[3 * a + k, j] * local[j]
                out[nodes[e, a], k] += share[e] * total
    return out


def _solved(cell: Cubes, stiffness: np.ndarray, diagonal: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Displacements under forces, by conjugate gradients scaled with the diagonal."""
    multiply: Callable[..., Any] = _multiplied
    moved, rest = np.zeros_like(force), force.copy()
    direction = rest / diagonal
    size = first = float(np.sum(rest * direction))
    for _ in range(MOST):
        if size <= TOLERANCE**2 * first:
            break
        image = multiply(direction, cell.nodes, cell.share, stiffness)
        step = size / float(np.sum(direction * image))
        moved += step * direction
        rest -= step * image
        scaled = rest / diagonal
        new = float(np.sum(rest * scaled))
        direction, size = scaled + new / size * direction, new
    return moved


def cells_table(folder: Path) -> str:
    """Bending stiffness over that of the root section, by cells and by the section that stands for teeth."""
    rows = []
    for row in load_data(folder / DATA)["cells"]:
        factors = [
            [value / root for value, root in zip(row[kind], row["root"], strict=True)] for kind in KINDS
        ]
        cells = [f"{factors[kind][plane]:.3f}" for plane in (0, 1) for kind in (0, 1)]
        rows.append([row["name"], *cells])
    return markdown(["bar", "y, cell", "y, section", "z, cell", "z, section"], rows)


KINDS = ("cell", "section")
TOPIC = Topic(
    "bending stiffness of the toothed bar by periodic cells of solid elements, against the section used",
    "3 min",
    "flexible_rack",
    run,
    {"cubes": 4, "cases": {"default": {}}},
)
