"""The bar as a beam against closed forms and against three-dimensional finite elements of the whole rack.

Finite elements: solid rack of the default gear, 394 000 degrees of freedom, E 206 GPa, nu 0.3: an independent
discretisation of the true shape. `SOLID` gives what they say.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh, null_space

from rps_exudyn.forces.bush import bush_chain, housing_station
from rps_exudyn.gears.bar_bow import BarBow
from rps_exudyn.gears.bar_section import (
    SIDEWAYS,
    mass_and_moments,
    plain_section,
    root_section,
    tooth_layer,
    toothed_section,
)
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.rack_beam import RackBeam, RackModes, TimoshenkoBeam
from rps_exudyn.gears.solids import rack_solid
from rps_exudyn.parameters.gear import SteeringGear

GEAR = SteeringGear()
HEIGHT = {"rack.reference_height": "8.5 mm"}  # which would follow from the module
SOLID = {"free": ((232.9, 632.2, 1257.6), (255.3, 702.0, 1366.0)), "cantilever": (28.776e-3, 27.459e-3)}
FREE_FREE = np.array([4.730040745, 7.853204624, 10.995607838])  # roots of cos(x) cosh(x) = 1


def tip_deflection(beam: TimoshenkoBeam, force: float) -> float:
    """Deflection of the first node under a force there, the last node clamped [m]."""
    stiffness, _ = beam.matrices()
    load = np.zeros(len(stiffness) - 2)
    load[0] = force
    return float(np.linalg.solve(stiffness[:-2, :-2], load)[0])


def uniform(elements: int, shear: float = 1e12, rotary: float = 0.0) -> TimoshenkoBeam:
    one = np.ones(elements)
    return TimoshenkoBeam(np.linspace(0, 1, elements + 1), 100 * one, shear * one, 2 * one, rotary * one)


def test_slender_uniform_bar_has_the_frequencies_of_the_closed_form() -> None:
    """omega = (beta L)^2 sqrt(EI / (mu L^4)); 40 elements are off by (beta h)^4 / 720 at most, 1e-5."""
    frequencies, _ = uniform(40).free_modes(3)
    np.testing.assert_allclose(frequencies, FREE_FREE**2 * np.sqrt(100 / 2), rtol=1e-5)


def test_static_deflection_of_a_cantilever_is_exact_whatever_the_number_of_elements() -> None:
    """F L^3 / (3 EI) + F L / (kGA)."""
    for elements in (1, 7):
        exact = 5 * (1 / 300 + 1 / 4e3)
        assert tip_deflection(uniform(elements, shear=4e3), 5.0) == pytest.approx(exact, rel=1e-9)


def test_a_stocky_beam_has_the_frequencies_of_timoshenkos_equation() -> None:
    """Pinned at both ends, w = sin(n pi x), k = n pi (Timoshenko 1921):
    mu J / kGA omega^4 - (mu + k^2 (J + mu EI / kGA)) omega^2 + EI k^4 = 0.

    Shear lowers the third frequency to less than half; 60 elements are 7e-4 off, which falls as h^2.
    """
    EI, kGA, mu, J = 100.0, 3e3, 2.0, 0.03
    stiffness, mass = TimoshenkoBeam(
        np.linspace(0, 1, 61), *(v * np.ones(60) for v in (EI, kGA, mu, J))
    ).matrices()
    free = np.delete(np.arange(len(mass)), [0, len(mass) - 2])
    squares = eigh(stiffness[np.ix_(free, free)], mass[np.ix_(free, free)], eigvals_only=True)
    k = np.arange(1, 4) * np.pi
    b = mu + k**2 * (J + mu * EI / kGA)
    exact = (b - np.sqrt(b**2 - 4 * mu * J / kGA * EI * k**4)) / (2 * mu * J / kGA)
    assert exact[2] < 0.25 * EI / mu * k[2] ** 4
    np.testing.assert_allclose(np.sqrt(squares[:3]), np.sqrt(exact), rtol=1e-3)


def test_free_modes_are_those_of_solid_finite_elements() -> None:
    """1 %: what a beam leaves out, and the layer that stands for the teeth."""
    modes = RackBeam.of(GEAR).modes(3)
    expected = np.array(SOLID["free"]).ravel()
    np.testing.assert_allclose(modes.frequencies / (2 * np.pi), expected, rtol=0.01)


@pytest.mark.parametrize("plane", [0, 1])
def test_cantilever_deflects_as_solid_finite_elements(plane: int) -> None:
    """1 kN at the end beside the pinion, the other end clamped; 0.5 %, of which the layer may be half."""
    deflection = tip_deflection(RackBeam.of(GEAR).elements(plane), 1000.0)
    assert deflection == pytest.approx(SOLID["cantilever"][plane], rel=0.005)


@pytest.mark.parametrize(
    ("plane", "deflection", "frequency"), [(0, 2.732e-3, 193.0), (1, 1.924e-3, 214.0)], ids=["y", "z"]
)
def test_bar_pinned_at_the_mesh_in_its_bush(plane: int, deflection: float, frequency: float) -> None:
    """Static deflection of the end under 1 kN and first mode, against a prototype with its own calibration of
    the bar to the same finite elements: 1 %."""
    beam, chain = RackBeam.of(GEAR).elements(plane), bush_chain(GEAR)
    stiffness, mass = beam.matrices()
    held = chain.lateral_stiffness[np.ix_(*[((0, 3), (1, 2))[plane]] * 2)]
    deflected, turned = _at(beam, housing_station(GEAR, chain.end_station))
    motion = np.stack([deflected, turned if plane == 0 else -turned])  # about Y, sections turn by -psi
    stiffness += motion.T @ held @ motion
    free = null_space(_at(beam, 0.0)[0][None])
    stiffness, mass = free.T @ stiffness @ free, free.T @ mass @ free
    end = free[0]
    assert end @ np.linalg.solve(stiffness, 1000 * end) == pytest.approx(deflection, rel=0.01)
    lowest = eigh(stiffness, mass, eigvals_only=True, subset_by_index=[0, 0])[0]
    assert np.sqrt(lowest) / (2 * np.pi) == pytest.approx(frequency, rel=0.01)


def _at(beam: TimoshenkoBeam, station: float) -> tuple[np.ndarray, np.ndarray]:
    """Deflection and rotation at a station as rows over the beam's coordinates."""
    i = int(np.searchsorted(beam.nodes, station)) - 1
    shape = beam.shape_functions(np.array([(station - beam.nodes[i]) / beam.lengths[i]]))
    rows = np.zeros((2, 2 * beam.nodes.size))
    rows[:, 2 * i : 2 * i + 4] = shape.deflection[i, :, 0], shape.rotation[i, :, 0]
    return rows[0], rows[1]


def test_beam_weighs_what_the_solid_weighs() -> None:
    """Mean area of the teeth times their length; the slanted ends of the toothed part are off by 2e-4."""
    beam = RackBeam.of(GEAR)
    mass = float(beam.mass_per_length @ np.diff(beam.stations))
    assert mass == pytest.approx(rack_solid(GEAR).mass_properties.mass, rel=3e-4)


def test_root_section_is_a_circle_cut_by_a_chord() -> None:
    """Area R^2 (pi - a + sin a cos a), a the half angle of what is cut away; of a round bar, no chord."""
    bar = RackBar.of(GEAR)
    radius = bar.pair.bar_radius
    a = np.arccos(-bar.root_height / radius)
    area = radius**2 * (np.pi - a + np.sin(a) * np.cos(a))
    assert root_section(bar).area == pytest.approx(area, rel=1e-5)
    assert plain_section(bar).second_moments[0] == pytest.approx(np.pi * radius**4 / 4)


def second_moments(y: np.ndarray, z: np.ndarray) -> tuple[float, float]:
    """int y^2 and int z^2 over a polygon about its centroid, by Green's theorem along its outline."""
    y_2, z_2 = np.roll(y, -1), np.roll(z, -1)
    cross = y * z_2 - y_2 * z
    area = cross.sum() / 2
    squares = [cross @ (u**2 + u * v + v**2) / 12 for u, v in ((y, y_2), (z, z_2))]
    centre = [cross @ (u + v) / (6 * area) for u, v in ((y, y_2), (z, z_2))]
    return tuple(abs(float(square - area * c**2)) for square, c in zip(squares, centre, strict=True))


@pytest.mark.parametrize("change", [{}, {"rack.reference_height": "6 mm", "rack.tooth_angle": "25 deg"}])
def test_second_moments_are_those_of_the_outlines(change: dict[str, str]) -> None:
    """Of the circle, of it above the chord at the roots, and with the layer on that; 4000 chords of a circle
    lack 1e-6, 64 points over the height 1e-5."""
    bar = RackBar.of(GEAR.replace(change))
    radius, root, layer = bar.pair.bar_radius, bar.root_height, tooth_layer(bar)
    turn = np.linspace(0, 2 * np.pi, 4000, endpoint=False)
    circle = second_moments(radius * np.cos(turn), radius * np.sin(turn))
    half = np.arccos(root / radius)
    turn = np.linspace(-half, half, 4000)
    y, z = radius * np.cos(turn), radius * np.sin(turn)
    cut = second_moments(y, z)
    full = second_moments(np.array([root - layer, *y, root - layer]), np.array([z[0], *z, z[-1]]))
    toothed = full[0], cut[1] + SIDEWAYS * (full[1] - cut[1])
    expected = {plain_section: circle, root_section: cut, toothed_section: toothed}
    for section, moments in expected.items():
        assert section(bar).second_moments == pytest.approx(moments, rel=1e-4)


@pytest.mark.parametrize(
    ("change", "y", "z"),
    [
        ({}, 1.0795, 1.0221),
        ({"rack.tooth_angle": "0 deg"}, 1.0708, 1.0177),
        ({"rack.tooth_angle": "25 deg"}, 1.0872, 1.0242),
        ({"rack.tooth_angle": "40 deg"}, 1.1186, 1.0310),
        ({"pinion.pressure_angle": "30 deg"}, 1.1292, 1.0353),
        ({"pinion.pressure_angle": "15 deg", "basic_rack.fillet_radius": 0.2}, 1.0649, 1.0181),
        ({"basic_rack.addendum": 0.7, "basic_rack.dedendum": 1.0, **HEIGHT}, 1.0675, 1.0182),
        ({"rack.reference_height": "6 mm"}, 1.1096, 1.0385),
        ({"pinion.normal_module": "2.5 mm", "pinion.tip_diameter": "24 mm", **HEIGHT}, 1.1106, 1.0304),
        ({"rack.bar_diameter": "24.9 mm", "rack.reference_height": "10 mm"}, 1.0627, 1.0125),
    ],
)
def test_teeth_stiffen_as_in_a_periodic_cell_of_solid_elements(change: dict, y: float, z: float) -> None:
    """Bending stiffness over that of the root section, as by periodic cells of solid elements."""
    bar = RackBar.of(GEAR.replace(change))
    root, toothed = root_section(bar).second_moments, toothed_section(bar).second_moments
    assert toothed[0] / root[0] == pytest.approx(y, rel=0.015)
    assert toothed[1] / root[1] == pytest.approx(z, rel=0.025)


def test_modes_are_orthonormal_and_free_of_momentum() -> None:
    """phi^T M phi = 1, and no mode moves or turns the whole bar; rounding of 1e-9 relative."""
    beam = RackBeam.of(GEAR)
    modes = beam.modes(4)
    for plane in (0, 1):
        _, mass = beam.elements(plane).matrices()
        own = modes.plane == plane
        shapes = np.stack([modes.shape[own], modes.slope[own]], axis=2).reshape(4, -1)
        np.testing.assert_allclose(shapes @ mass @ shapes.T, np.eye(4), atol=1e-8)
        rigid = np.stack([np.ravel([(1, 0) for _ in modes.nodes]), np.ravel([(x, 1) for x in modes.nodes])])
        assert np.abs(shapes @ mass @ rigid.T).max() < 1e-8


def test_interpolated_modes_have_their_derivatives() -> None:
    """Central differences over 10 um, error h^2 phi''' / 6; and straight lines beyond the ends."""
    modes = RackBeam.of(GEAR).modes(2)
    for station in (-0.1733, 0.0, 0.2221, 0.5):
        at, before, after = (modes.at(station + step) for step in (0, -1e-5, 1e-5))
        difference = (after - before) / 2e-5
        np.testing.assert_allclose(difference[[0, 2]], at[[1, 3]], atol=1e-5 * np.abs(modes.curvature).max())


def test_stiffer_bar_vibrates_faster() -> None:
    """omega ~ sqrt(E / rho)."""
    beam = RackBeam.of(GEAR)
    other = replace(beam, youngs_modulus=4 * beam.youngs_modulus)
    np.testing.assert_allclose(other.modes(2).frequencies, 2 * beam.modes(2).frequencies, rtol=1e-9)


@pytest.mark.parametrize("shape", ["half-wave", "arc"])
def test_bow_has_its_height_over_the_chord_of_the_toothed_part(shape: str) -> None:
    """Middle minus mean of both ends of the toothed part, in the direction of the bow; Hermite's cubics over
    10 mm are off by h^4 / 384 w'''' = 3e-6 of the height, an arc's edges inside an element by 0.1 %."""
    gear = GEAR.replace({"rack.bow": "0.3 mm", "rack.bow_angle": "30 deg", "rack.bow_shape": shape})
    bow, stations = BarBow.of(gear), RackBeam.of(gear).stations
    height = bow.at(0.0)[0] - (bow.at(stations[1])[0] + bow.at(stations[2])[0]) / 2
    np.testing.assert_allclose(height, 0.3e-3 * np.array([np.sqrt(3) / 2, 0.5]), rtol=2e-3)
    np.testing.assert_allclose(bow.at(0.0)[:3], 0, atol=1e-3 * np.abs(bow.gradient).max())
    assert not bow.straight


def test_bow_in_modal_coordinates_bends_the_bar_as_the_bow_does() -> None:
    """With many modes the curved part of the bow comes back: bow minus modes is a rigid motion to 2 %."""
    gear = GEAR.replace({"rack.bow": "0.3 mm", "rack.bow_angle": "90 deg"})
    beam, bow = RackBeam.of(gear), BarBow.of(gear)
    modes = beam.modes(12)
    coordinates = np.zeros(modes.count)  # phi^T M offset
    for plane in range(len(bow.offset)):
        _, mass = beam.elements(plane).matrices()
        own = modes.plane == plane
        shapes = np.stack([modes.shape[own], modes.slope[own]], axis=2).reshape(own.sum(), len(mass))
        coordinates[own] = shapes @ mass @ np.stack([bow.offset[plane], bow.gradient[plane]], axis=1).ravel()
    left = bow.offset[1] - coordinates @ modes.shape
    line = np.polynomial.Polynomial.fit(bow.nodes, left, 1)
    assert np.abs(left - line(bow.nodes)).max() < 0.02 * 0.3e-3
    assert isinstance(modes, RackModes)
    assert coordinates[modes.plane == 0] == pytest.approx(0)


@pytest.mark.parametrize("settings", [{}, {"rack.travel": "80 mm", "pinion.helix_angle": "0 deg"}])
def test_mass_and_moments_are_those_of_the_solid(settings: dict[str, object]) -> None:
    """By sections and by the mesh of the whole bar: its chords lack 1e-4 of the circle."""
    gear = SteeringGear().replace(settings)
    solid = rack_solid(gear).mass_properties
    centre = solid.centre_of_mass
    mass, moments = mass_and_moments(RackBar.of(gear), gear.rack.density)
    assert mass == pytest.approx(solid.mass, rel=5e-4)
    about_the_origin = np.diag(solid.inertia) + solid.mass * (centre @ centre - centre**2)
    assert moments == pytest.approx(about_the_origin, rel=1e-3)
