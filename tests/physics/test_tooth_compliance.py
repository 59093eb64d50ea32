"""The law of elastic teeth against closed anchors, and the finite elements that judge it against theirs."""

import dataclasses
import sys

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from benchmarks.rack_tooth_elements import (
    ORDER,
    POISSON_RATIO,
    YOUNGS_MODULUS,
    Section,
    assembled,
    chained,
    finite_elements,
    stiffness,
)
from benchmarks.rack_tooth_law import add_compliance, flattening, half_thickness, places_of
from benchmarks.tooth_compliance import extrapolated
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.basic_rack import half_angle
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.trochoid import form_point
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.tooth_compliance import (
    PINION,
    RACK,
    Spread,
    pinion_tooth,
    rack_tooth,
)
from rps_exudyn.tooth_contact.unilateral import local_yield
from verification.population import random_gears

PAIR = GearPair.of(SteeringGear())
Station = tuple[float, float, float, float]
"""cos(alpha), cos(alpha) y, cos(alpha) tan(alpha), and s."""


def stations_on(stations: list[Station], half_length: float, tooth: np.record) -> np.ndarray:
    """What the law keeps of stations on a tooth of some half length."""
    return np.asarray(places_of(np.array(stations), np.full(len(stations), half_length), tooth))


def compliance(stations: list[Station], half_length: float, tooth: np.record) -> np.ndarray:
    """Compliance of stations on one flank [m/N]."""
    matrix = np.zeros((len(stations),) * 2)
    add_compliance(matrix, stations_on(stations, half_length, tooth), 0, 0, len(stations), 1.0, tooth)
    return matrix


def on_rack(pair: GearPair, height: float, s: float = 0.0) -> Station:
    """A station at a height above the reference line."""
    cos, tan = np.cos(pair.alpha_n), np.tan(pair.alpha_n)
    lever = height - half_thickness(pair, height) * tan + rack_tooth(pair).root
    return cos, cos * lever, cos * tan, s


def on_pinion(pair: GearPair, q: float, s: float = 0.0) -> Station:
    """A station at a tangent length: the load's direction meets the tooth's middle at r_b / cos(alpha_x)."""
    alpha = np.arctan(q / pair.base_radius) - float(half_angle(pair, np.hypot(q, pair.base_radius)))
    tan = np.tan(alpha) * np.cos(pair.beta_p)
    cos = 1 / np.hypot(1, tan)
    return cos, cos * (pair.base_radius / np.cos(alpha) - pinion_tooth(pair).root), cos * tan, s


def kappa(station: Station, tooth: np.record, spread: Spread) -> float:
    """Weber and Banaschek's foundation of a long tooth [nm/(N/mm)]: yield without its spread."""
    (yields,) = compliance([station], 1.0, tooth)[0]  # both ends a metre away
    return float(1e12 * yields * 2 * tooth.length / spread.strength)


# --- Weber and Banaschek -----------------------------------------------------------------------------
@pytest.mark.parametrize(("q_mm", "expected"), [(0.2, 7.427), (2.4, 8.039), (4.7, 12.866)])
def test_pinion_tooth_has_weber_and_banascheks_foundation(q_mm: float, expected: float) -> None:
    """Values of another program, with four digits, at places of the path of contact from the pitch point."""
    q = 1e-3 * q_mm + PAIR.reference_radius * np.sin(PAIR.alpha_t)
    assert kappa(on_pinion(PAIR, q), pinion_tooth(PAIR), PINION) == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize(("q_mm", "expected"), [(0.2, 22.467), (2.4, 15.896), (4.7, 10.801)])
def test_rack_tooth_has_weber_and_banascheks_foundation(q_mm: float, expected: float) -> None:
    height = PAIR.profile_shift * PAIR.module - 1e-3 * q_mm * np.sin(PAIR.alpha_t)
    assert kappa(on_rack(PAIR, height), rack_tooth(PAIR), RACK) == pytest.approx(expected, rel=2e-3)


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


# --- symmetry and definiteness -----------------------------------------------------------------------
def test_work_of_any_loads_on_one_flank_is_mutual_and_above_zero_on_random_gears() -> None:
    """Betti's theorem, and positive definiteness; the smallest eigenvalue is held against rounding.

    16 stations each on a tooth of pinion and rack, at random places along and up its flank.
    """
    random = np.random.default_rng(15)
    for gear in random_gears(seed=15, count=20):
        pair = GearPair.of(gear)
        half, form = random.uniform(1, 6) * pair.module, form_point(pair).tangent_length
        tip = np.sqrt(pair.tip_radius**2 - pair.base_radius**2)
        along = random.uniform(-half, half, (2, 16))
        tangents, heights = random.uniform(form, tip, 16), random.uniform(-0.9, 0.9, 16) * pair.module
        for stations, tooth in (
            ([on_pinion(pair, *at) for at in zip(tangents, along[0], strict=True)], pinion_tooth(pair)),
            ([on_rack(pair, *at) for at in zip(heights, along[1], strict=True)], rack_tooth(pair)),
        ):
            matrix = compliance(stations, half, tooth)
            assert np.abs(matrix - matrix.T).max() <= 1e-14 * matrix.max()
            assert np.linalg.eigvalsh(matrix).min() > 1e-9 * matrix.max()


COUNT = 12  # stations of a line


def lines_in_a_row(pair: GearPair, random: np.random.Generator) -> np.ndarray:
    """Stations on four lines: tangent lengths, heights on the rack, places along the teeth [m], (3, n).

    Each line runs up or down the flanks between random ends within the field of contact.
    """
    at_pitch, half = pair.reference_radius * np.sin(pair.alpha_t), pair.face_width / 2
    least = max(form_point(pair).tangent_length, at_pitch + pair.active_path[0])
    most = at_pitch + pair.active_path[1]
    ends = np.stack([random.uniform(least, most, (2, 4)), random.uniform(-half, half, (2, 4))])
    tangents, along = np.linspace(ends[:, 0], ends[:, 1], COUNT, axis=2).reshape(2, -1)
    heights = pair.profile_shift * pair.module - (tangents - at_pitch) * np.sin(pair.alpha_t)
    return np.stack([tangents, heights, along])


def add_tooth(matrix: np.ndarray, places: np.ndarray, drive: int, coast: int, tooth: np.record) -> None:
    """Add one body's compliance of two lines that lie on the two flanks of one tooth."""
    rows = [drive * COUNT, coast * COUNT]
    for i in rows:
        for j in rows:
            sigma = 1.0 if i == j else -float(tooth.coupling)
            add_compliance(matrix, places, i, j, COUNT, sigma, tooth)


def compliance_of_row(pair: GearPair, random: np.random.Generator) -> np.ndarray:
    """Compliance of four lines, drive and coast flank in turn [m/N].

    Lines 0 and 1 lie on one tooth of the pinion, 1 and 2 on one of the rack, 2 and 3 on the pinion's next.
    """
    tangents, heights, along = lines_in_a_row(pair, random)
    half, pinion, rack = pair.face_width / 2, pinion_tooth(pair), rack_tooth(pair)
    rolled = stations_on([on_pinion(pair, *at) for at in zip(tangents, along, strict=True)], half, pinion)
    milled = stations_on([on_rack(pair, *at) for at in zip(heights, along, strict=True)], half, rack)
    matrix = np.zeros((4 * COUNT,) * 2)
    add_tooth(matrix, rolled, 0, 1, pinion)
    add_tooth(matrix, rolled, 2, 3, pinion)
    add_tooth(matrix, milled, 1, 2, rack)
    for line in (0, 3):  # alone on its tooth of the rack
        add_compliance(matrix, milled, line * COUNT, line * COUNT, COUNT, 1.0, rack)
    return matrix


def test_work_of_loads_on_both_flank_sides_is_above_zero_on_random_gears() -> None:
    """What the loads' solution rests on: the coupling in the rack takes no more than the pinion gives."""
    random = np.random.default_rng(16)
    for gear in random_gears(seed=16, count=20):
        for _ in range(3):
            matrix = compliance_of_row(GearPair.of(gear), random)
            assert np.abs(matrix - matrix.T).max() <= 1e-14 * matrix.max()
            assert np.linalg.eigvalsh(matrix).min() > 1e-9 * matrix.max()


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
