"""The law of elastic teeth against closed anchors, and the finite elements that judge it against theirs."""

import dataclasses
import sys
from collections.abc import Callable

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from benchmarks.tooth_compliance import extrapolated
from rps_exudyn.base.compiled import kernel
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.trochoid import form_point
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.teeth_data import pinion_form
from rps_exudyn.tooth_contact.tooth_compliance import (
    PLACE_SIZE,
    RACK,
    RACK_YIELD,
    add_block,
    fill_mode,
    fill_rack_place,
    pinion_tooth,
    rack_tooth,
)
from rps_exudyn.tooth_contact.unilateral import local_yield
from verification.population import random_gears
from verification.rack_tooth_elements import (
    ORDER,
    POISSON_RATIO,
    YOUNGS_MODULUS,
    Section,
    assembled,
    chained,
    finite_elements,
    rack_compliance,
    stiffness,
)
from verification.rack_tooth_law import flattening, half_thickness, law_compliance, lever_of

PAIR = GearPair.of(SteeringGear())
Body = Callable[[GearPair, np.random.Generator, float, np.ndarray], np.ndarray]
AT_PITCH = PAIR.reference_radius * np.sin(PAIR.alpha_t)


# --- Spot values of another program, default gear, tangent lengths from the pitch point --------------
@pytest.mark.parametrize(
    ("q_mm", "zeta", "kappa", "phi"),
    [
        (0.2, 0.0924, 8.929, (1.8528, 1.8451)),
        (2.4, 0.2187, 11.399, (2.6221, 1.2938)),
        (4.7, 0.7266, 27.496, (4.9142, -1.8780)),
    ],
)
def test_pinion_tooth_has_the_spot_values(
    q_mm: float, zeta: float, kappa: float, phi: tuple[float, float]
) -> None:
    """The other program has its own fillet: 0.6 % of the yield, and half of that of its root."""
    tooth, q = pinion_tooth(PAIR), np.array([1e-3 * q_mm + AT_PITCH])
    at, long = pinion_form(PAIR, tooth, q)
    assert at[0] == pytest.approx(zeta, abs=6e-4)
    assert 1e12 * long[0] == pytest.approx(kappa, rel=6e-3)
    terms = np.array(tooth.terms) * np.sqrt(2 * np.array(tooth.length))[:, None]
    found = 1e6 * np.sqrt(long[0]) * terms @ [1, at[0], at[0] ** 2]
    assert found == pytest.approx(phi, rel=4e-3)


@pytest.mark.parametrize(
    ("q_mm", "zeta", "phi"),
    [(0.2, 0.7595, (7.3795, 0.0438)), (2.4, 0.5668, (5.3419, 1.5407)), (4.7, 0.3653, (3.5420, 2.4799))],
)
def test_rack_tooth_has_the_spot_values(q_mm: float, zeta: float, phi: tuple[float, float]) -> None:
    height = PAIR.profile_shift * PAIR.module - 1e-3 * q_mm * np.sin(PAIR.alpha_t)
    at = float(lever_of(PAIR, np.array([height]))[0] / rack_tooth(PAIR).root_width)
    assert at == pytest.approx(zeta, abs=5e-4)
    terms = np.array([mode.terms for mode in RACK])
    assert np.cos(PAIR.alpha_n) * terms @ [1, at, at**2] == pytest.approx(phi, rel=2e-3, abs=6e-3)


# --- Compliance of stations --------------------------------------------------------------------------
@kernel
def rack_matrix(stations, half, scale, tooth):  # type: ignore[no-untyped-def]
    """Compliance of stations (n, 4) on a rack's tooth: zeta, place, offset of the flank, side."""
    n = stations.shape[0]
    matrix, places = np.zeros((n, n)), np.empty((PLACE_SIZE, n))
    for i in range(n):
        zeta, along, offset, side = stations[i, 0], stations[i, 1], stations[i, 2], stations[i, 3]
        fill_rack_place(places, i, zeta, along, offset, half, scale, side, tooth)
    for i in range(n):
        for j in range(n):
            add_block(matrix, places, i, j, 1, stations[i, 3] == stations[j, 3], tooth)
    return matrix


@kernel
def pinion_matrix(stations, half, tooth):  # type: ignore[no-untyped-def]
    """The same on a pinion's tooth: zeta, place, offset of the flank, side, phi of both modes."""
    n = stations.shape[0]
    matrix, places = np.zeros((n, n)), np.empty((PLACE_SIZE, n))
    for i in range(n):
        zeta, along, offset, side = stations[i, 0], stations[i, 1], stations[i, 2], stations[i, 3]
        for mode in range(2):
            length = tooth.length[mode]
            at, off, end = np.exp(along / length), np.exp(offset / length), np.exp(-half / length)
            fill_mode(places, i, mode, stations[i, 4 + mode], at, off, end, zeta, side, tooth)
    for i in range(n):
        for j in range(n):
            add_block(matrix, places, i, j, 1, stations[i, 3] == stations[j, 3], tooth)
    return matrix


def on_rack(pair: GearPair, random: np.random.Generator, half: float, sides: np.ndarray) -> np.ndarray:
    """Compliance of random stations on the flanks of one rack tooth [m/N]."""
    tooth, n = rack_tooth(pair), sides.size
    height = random.uniform(-0.9, 0.9, n) * pair.module
    offset = half_thickness(pair, height) * np.tan(pair.beta_r)
    zeta = lever_of(pair, height) / tooth.root_width
    stations = np.column_stack([zeta, random.uniform(-half, half, n), offset, sides])
    return np.asarray(rack_matrix(stations, half, np.cos(pair.alpha_n) * RACK_YIELD, tooth))


def on_pinion(pair: GearPair, random: np.random.Generator, half: float, sides: np.ndarray) -> np.ndarray:
    """The same of one pinion tooth."""
    tooth, n = pinion_tooth(pair), sides.size
    tip = np.sqrt(pair.tip_radius**2 - pair.base_radius**2)
    q = random.uniform(form_point(pair).tangent_length, tip, n)
    zeta, kappa = pinion_form(pair, tooth, q)
    phi = np.sqrt(kappa) * (tooth.terms @ np.array([np.ones(n), zeta, zeta**2]))
    offset = -random.uniform(0, 0.5, n) * pair.module * np.sign(pair.beta_p)
    stations = np.column_stack([zeta, random.uniform(-half, half, n), offset, sides, *phi])
    return np.asarray(pinion_matrix(stations, half, tooth))


@pytest.mark.parametrize("body", [on_rack, on_pinion])
def test_work_of_any_loads_is_mutual_and_above_zero_on_random_gears(body: Body) -> None:
    """Betti's theorem, and positive definiteness on both flanks of a tooth; against rounding."""
    random = np.random.default_rng(15)
    for gear in random_gears(seed=15, count=20):
        pair = GearPair.of(gear)
        for sides in (np.full(16, -1.0), np.repeat([-1.0, 1.0], 8)):
            matrix = body(pair, random, random.uniform(1, 6) * pair.module, sides)
            assert np.abs(matrix - matrix.T).max() <= 1e-13 * matrix.max()
            assert np.linalg.eigvalsh(matrix).min() > -1e-12 * matrix.max()


def test_mirrored_teeth_yield_alike() -> None:
    """Against the other hand, with the places mirrored, nothing changes."""
    right = SteeringGear()
    left = right.replace(
        {"pinion.helix_angle": -right.pinion.helix_angle, "rack.tooth_angle": -right.rack.tooth_angle}
    )
    made = []
    for gear, hand in ((right, 1), (left, -1)):
        pair = GearPair.of(gear)
        tooth, random = rack_tooth(pair), np.random.default_rng(3)
        height, side = random.uniform(-0.9, 0.9, 8) * pair.module, np.repeat([-1.0, 1.0], 4)
        offset = half_thickness(pair, height) * np.tan(pair.beta_r)
        along = hand * random.uniform(-6e-3, 6e-3, 8)
        stations = np.column_stack([lever_of(pair, height) / tooth.root_width, along, offset, side])
        made.append(rack_matrix(stations, 8e-3, 1.0, tooth))
    assert made[0] == pytest.approx(made[1], rel=1e-12)


def test_law_of_a_rack_tooth_is_near_its_finite_elements() -> None:
    """Even load near the tip, coarse elements of three teeth: the middle's yield is known to 10 %."""
    section, patches = Section(PAIR, block_rows=1), 4
    found, (same, opposite) = rack_compliance(section, patches, 1), law_compliance(section, patches)
    row = slice(2 * patches, 3 * patches)
    local = flattening(section, float(section.row_height(2.5)))
    width = 2 * section.half_length(section.row_height(2.5)) / patches
    even = width * found.same[row, row].sum(axis=0) - local
    across = width * found.opposite[row, row].sum(axis=0)
    assert width * same[row, row].sum(axis=0) == pytest.approx(even, rel=0.25)
    assert width * opposite[row, row].sum(axis=0) == pytest.approx(across, rel=0.25)


# --- Hertz -------------------------------------------------------------------------------------------
def strain_below(depth: np.ndarray, a: float, peak: float) -> np.ndarray:
    """Strain normal to the surface under the middle of Hertz's pressure, plane strain (Johnson, eq. 4.46)."""
    z = depth / a
    root = np.sqrt(1 + z**2)
    down, across = -peak / root, -peak * ((1 + 2 * z**2) / root - 2 * z)
    nu = POISSON_RATIO
    return (1 - nu**2) / YOUNGS_MODULUS * (down - nu / (1 - nu) * across)


@pytest.mark.parametrize("load", [1e3, 3e4, 3e5])  # N/m; flank loads are 5e3 to 5e5
@pytest.mark.parametrize("radius", [1e-3, 5e-3])
def test_local_yield_is_hertzs_line_contact(load: float, radius: float) -> None:
    """A cylinder of steel on a plane of steel: approach of two points h below both surfaces.

    Reference: the strains under the pressure, integrated. The closed form leaves out terms of (a / h)^2, with
    h from 8 to 300 half widths a, times less than a tenth of the yield.
    """
    modulus = YOUNGS_MODULUS / 2 / (1 - POISSON_RATIO**2)
    a = np.sqrt(4 * load * radius / (np.pi * modulus))
    depths = (1.5e-3, 1.1e-3)
    nodes, weights = np.polynomial.legendre.leggauss(400)
    integrated = 0.0
    for h in depths:
        z = a * np.sinh((nodes + 1) / 2 * np.arcsinh(h / a))  # evenly in what the strain falls with
        slope = np.hypot(a, z) * np.arcsinh(h / a) / 2
        integrated -= weights @ (strain_below(z, a, 2 * load / np.pi / a) * slope)
    top = np.log(depths[0] * depths[1] * np.pi * modulus / radius) - POISSON_RATIO / (1 - POISSON_RATIO)
    found, _ = local_yield.py_func(load, top, 2 * (1 - POISSON_RATIO**2) / np.pi / YOUNGS_MODULUS)
    assert found == pytest.approx(integrated, rel=0.1 * (a / min(depths)) ** 2)


# --- finite elements ---------------------------------------------------------------------------------
SMALL = Section(PAIR, block_rows=1)


def test_elimination_by_sheets_solves_the_same_equations() -> None:
    """Against a sparse solution of all equations at once, for loads mirrored at the middle of the tooth."""
    model = assembled(SMALL, patches=2, refinement=1)
    free = ~model.clamped & ~(model.middle & (np.arange(model.middle.size) % 3 == 0))
    loads = model.loads[free]
    at_once = loads.T @ spsolve(model.stiffness[free][:, free].tocsc(), loads)
    assert np.abs(chained(model, even=True) - at_once).max() < 1e-10 * at_once.max()


def test_elements_carry_even_strains_exactly() -> None:
    """Patch test: twice the energy of a linear displacement is volume times stress times strain.

    Elements with straight but askew edges; a random displacement has strains and rotation.
    """
    fem, random = finite_elements(), np.random.default_rng(3)
    mesh = fem.MeshHex.init_tensor(*[np.linspace(0, 1, 3)] * 3)
    inside = ((mesh.p > 0.1) & (mesh.p < 0.9)).all(axis=0)
    mesh = dataclasses.replace(mesh, doflocs=mesh.p + 0.1 * inside * random.uniform(-1, 1, mesh.p.shape))
    basis = fem.Basis(mesh, fem.ElementHexS2(), intorder=ORDER)
    gradient = random.uniform(-1, 1, (3, 3))
    moved = (gradient @ basis.doflocs).T.ravel()
    strain, nu = (gradient + gradient.T) / 2, POISSON_RATIO
    stress = YOUNGS_MODULUS / (1 + nu) * (strain + nu / (1 - 2 * nu) * np.trace(strain) * np.eye(3))
    assert moved @ (stiffness(basis) @ moved) == pytest.approx((stress * strain).sum(), rel=1e-12)


def test_flattening_under_an_even_strip_is_that_of_the_half_plane() -> None:
    """Strains on the axis of the strip, integrated, less the mean dip of its surface against the middle."""
    height = 0.0
    half = (SMALL.row_height(1) - SMALL.row_height(0)) / np.cos(PAIR.alpha_n) / 2
    depth = half_thickness(PAIR, height) / np.cos(PAIR.alpha_n)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    y, nu = depth * (nodes + 1) / 2, POISSON_RATIO
    angle = np.arctan(half / y)
    down, across = (angle + np.sin(angle) * np.cos(angle)), (angle - np.sin(angle) * np.cos(angle))
    plane = (1 - nu**2) / YOUNGS_MODULUS
    middle = plane * 2 / np.pi * depth / 2 * weights @ (down - nu / (1 - nu) * across)  # under 1 Pa
    x = half * nodes
    dip = 2 * half * np.log(half**2) - sum((half + each) * np.log((half + each) ** 2) for each in (x, -x))
    mean = middle + plane / np.pi * weights @ dip / 2
    assert flattening(SMALL, height) == pytest.approx(mean / (2 * half), rel=1e-4)


def test_extrapolation_finds_limit_and_order() -> None:
    """Exact for v + c k^-p."""
    limit, order = extrapolated([7 - 2 * k**-2.5 for k in (1, 2, 3)])
    assert (limit, order) == (pytest.approx(7, rel=1e-9), pytest.approx(2.5, rel=1e-9))


def test_without_scikit_fem_one_sentence_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "skfem", None)
    with pytest.raises(InputError, match=r"install rps-exudyn with its extra \[verification\]"):
        finite_elements()
