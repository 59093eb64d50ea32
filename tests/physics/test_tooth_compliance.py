"""The law of elastic teeth against closed anchors, and the finite elements that judge it against theirs."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.sparse import csc_array
from scipy.sparse.linalg import spsolve

from benchmarks.tooth_compliance import DATA
from benchmarks.topic import RESULTS, load_data
from rps_exudyn.base.kernel_compiler import from_python
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
from verification.tooth_elements import (
    POISSON_RATIO,
    YOUNGS_MODULUS,
    Body,
    Division,
    Pinion,
    Rack,
    Sector,
    compliance,
    stiffness,
)

PAIR = GearPair.of(SteeringGear())
Stations = Callable[[GearPair, np.random.Generator, float, np.ndarray], np.ndarray]
AT_PITCH = PAIR.reference_radius * np.sin(PAIR.alpha_t)


def half_thickness(pair: GearPair, height: np.ndarray | float) -> np.ndarray:
    """Half the rack's tooth at a height of its plane flanks [m]."""
    return np.asarray(np.pi * pair.module / 4 - height * np.tan(pair.alpha_n))


def lever_of(pair: GearPair, height: np.ndarray) -> np.ndarray:
    """Where a load's direction meets the middle of the rack's tooth, above the root's section [m]."""
    return np.asarray(height - half_thickness(pair, height) * np.tan(pair.alpha_n) + rack_tooth(pair).root)


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
@from_python
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


@from_python
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
def test_work_of_any_loads_is_mutual_and_above_zero_on_random_gears(body: Stations) -> None:
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
TINY = Division(flank=1, along=2, half_tooth=1, fillet=1, root=1, core=1)
BODIES = pytest.mark.parametrize("body", [Pinion, Rack])


@BODIES
def test_elements_have_no_force_in_a_rigid_motion_and_carry_even_strains(body: type[Body]) -> None:
    """Patch test: twice the energy of a linear displacement is volume times stress times strain."""
    sector = Sector(body(PAIR, TINY))
    matrix, (x, y, z) = stiffness(sector.places, sector.elements), sector.places.T
    spin = np.stack([-y, x, 0 * z], axis=1).ravel()
    assert np.abs(matrix @ spin).max() < 1e-12 * np.abs(matrix).max()
    gradient = np.random.default_rng(3).uniform(-1, 1, (3, 3))
    moved = (sector.places @ gradient.T).ravel()
    strain, nu = (gradient + gradient.T) / 2, POISSON_RATIO
    stress = YOUNGS_MODULUS / (1 + nu) * (strain + nu / (1 - 2 * nu) * np.trace(strain) * np.eye(3))
    widened = sector.places.ravel()  # an even dilatation has the energy of the volume alone
    volume = widened @ (matrix @ widened) / (3 * YOUNGS_MODULUS / (1 - 2 * nu))
    assert moved @ (matrix @ moved) == pytest.approx((stress * strain).sum() * volume, rel=1e-9)


def test_phases_around_solve_the_whole_ring() -> None:
    """The rack's seven sectors, their borders joined, against harmonics of one."""
    body = Rack(PAIR, TINY)
    sector, count = Sector(body), 7
    whole, size = stiffness(sector.places, sector.elements), len(sector.places)
    own = np.ones(size, dtype=bool)
    left, right = (sector.number[i, : sector.core + 1].ravel() for i in (0, -1))
    own[right] = False
    column = np.cumsum(own) - 1
    maps = []
    for d in range(count):
        node = column + d * own.sum()
        node[right] = column[left] + (d + 1) % count * own.sum()
        unknown = (3 * node[:, None] + np.arange(3)).ravel()
        shape = 3 * size, 3 * count * int(own.sum())
        maps.append(csc_array((np.ones(3 * size), (np.arange(3 * size), unknown)), shape=shape))
    ring = sum(each.T @ whole @ each for each in maps)
    held = sum(each.T @ np.repeat(sector.held(0), 3).astype(float) for each in maps) > 0
    free = np.flatnonzero(~held)
    force = (maps[0].T @ sector.loads(-1).toarray()[:, 4])[free]
    moved = np.zeros(ring.shape[0])
    moved[free] = spsolve(ring.tocsc()[free][:, free], force)
    found = compliance(body, mutual=False)
    for d, tooth in enumerate(maps):
        expected = sector.beneath(1).T @ (tooth @ moved)
        assert found[d, 1, :, 0, 4] == pytest.approx(expected, abs=1e-9 * np.abs(found[0]).max())


def test_flanks_of_a_rack_tooth_are_alike() -> None:
    """The tooth turned half round about its middle: drive flank to coast flank, one end to the other."""
    found = compliance(Rack(PAIR, TINY))
    rows, layers = 2 * TINY.flank + 1, 2 * TINY.along + 1
    drive, coast = (found[0, i, :, i].reshape(rows, layers, rows, layers) for i in (0, 1))
    assert drive == pytest.approx(coast[:, ::-1, :, ::-1], rel=1e-8)


@pytest.mark.parametrize(
    ("body", "flank", "within"), [("pinion", "same", 0.2), ("rack", "same", 0.1), ("rack", "opposite", 0.1)]
)
def test_law_is_near_the_published_elements(body: str, flank: str, within: float) -> None:
    """Yields along lines of contact, median over a gear's stations, over gears: 10 %; of the pinion 20 %,
    whose core the law twists by as much everywhere along the face."""
    gears = load_data(RESULTS / "tooth_compliance" / DATA)["gears"]
    assert len(gears) >= 10
    assert np.median([each["yields"][f"{body}, {flank} flank"][0] for each in gears.values()]) < within
