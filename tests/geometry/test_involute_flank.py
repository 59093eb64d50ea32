"""The analytic flank against the closed forms of ISO 21771 (DIN 3960), over the admissible range.

Tolerances are 1e-12 of the base radius, or 1e-12 rad: four thousand times the rounding of double
precision, and a billionth of the micrometres that torque ripple lives in.
"""

import dataclasses

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from geometry.random_gears import angle_between, gear_pairs, sides
from rps_exudyn.gears.basic_rack import (
    crest_width,
    pointed_radius,
    tip_radius_for_crest,
    undercut_limit,
)
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_limits import path_on_involute
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.trochoid import form_point, trochoid
from rps_exudyn.parameters.gear import SteeringGear

TOLERANCE = 1e-12
fractions = st.floats(0.0, 1.0)


def inv(alpha: float) -> float:
    return np.tan(alpha) - alpha


@given(gear_pairs(), sides, st.integers(0, 5), fractions, fractions)
def test_tooth_thickness_at_any_radius(
    pair: GearPair, side: int, tooth: int, profile: float, axial: float
) -> None:
    """s_yt = d_y (s_t / d + inv alpha_t - inv alpha_yt), cos alpha_yt = d_b / d_y, turned by Z twist."""
    flank = Flank(pair, tooth, side)
    q = flank.form_tangent_length + profile * (flank.tip_tangent_length - flank.form_tangent_length)
    Z = (axial - 0.5) * pair.face_width
    x, y, z = flank.point(flank.generator(q, Z), Z)

    m, alpha_n, r = pair.module, pair.alpha_n, pair.teeth * pair.module / (2 * np.cos(pair.beta_p))
    alpha_t = np.arctan(np.tan(alpha_n) / np.cos(pair.beta_p))
    radius = np.hypot(x, y)
    s_t = m * (np.pi / 2 + 2 * pair.profile_shift * np.tan(alpha_n)) / np.cos(pair.beta_p)
    half = s_t / (2 * r) + inv(alpha_t) - inv(np.arctan2(q, r * np.cos(alpha_t)))
    centre = np.pi / 2 + (2 * tooth + 1) * np.pi / pair.teeth - Z * np.tan(pair.beta_p) / r
    assert z == Z
    assert radius == pytest.approx(np.hypot(r * np.cos(alpha_t), q), rel=TOLERANCE)
    assert angle_between(np.arctan2(y, x), centre + side * half) == pytest.approx(0, abs=TOLERANCE * 10)


@given(gear_pairs(), sides, fractions, fractions, st.floats(-1e-4, 1e-4))
def test_moving_along_the_normal_is_the_distance(
    pair: GearPair, side: int, profile: float, axial: float, height: float
) -> None:
    """The normal is unit, perpendicular, outward: a point moved by h along it is h away from the flank."""
    flank = Flank(pair, 0, side)
    q = flank.form_tangent_length + profile * (flank.tip_tangent_length - flank.form_tangent_length)
    Z = (axial - 0.5) * pair.face_width
    psi = flank.generator(q, Z)
    assume(q > 2e-4)  # else the moved point may lie past the base cylinder, where the normal has no foot
    moved = flank.point(psi, Z) + height * flank.normal(psi)
    assert float(flank.distance(moved)) == pytest.approx(height, abs=TOLERANCE * pair.base_radius * 10)


@given(gear_pairs(), sides, fractions, st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))
def test_generators_are_straight_and_share_one_normal(
    pair: GearPair, side: int, profile: float, low: float, high: float
) -> None:
    flank = Flank(pair, 0, side)
    psi = flank.generator(flank.form_tangent_length + profile * 1e-3, 0.0)
    a, b = (flank.point(psi, share * pair.face_width) for share in (low, high))
    middle = flank.point(psi, (low + high) / 2 * pair.face_width)
    limit = TOLERANCE * (pair.base_radius + pair.face_width)
    np.testing.assert_allclose(middle, (a + b) / 2, rtol=0, atol=limit)
    assert abs((b - a) @ flank.normal(psi)) <= limit


@given(gear_pairs(), sides, fractions)
def test_curvature_is_that_of_the_base_cylinders_unrolled_string(
    pair: GearPair, side: int, profile: float
) -> None:
    """A tangent plane leaves the flank by w^2 / (2 rho), w = q dpsi being the way across the generators.

    rho = q / cos beta_b. The next term is smaller by dpsi / tan(alpha): 1e-3 for 1e-5 rad at 0.01 rad.
    """
    flank, step = Flank(pair, 0, side), 1e-5
    q = flank.form_tangent_length + profile * (flank.tip_tangent_length - flank.form_tangent_length)
    assume(q > 0.01 * pair.base_radius)
    psi = flank.generator(q, 0.0)
    # the point beside it, straight across the generators in the tangent plane
    across = flank.point(psi, 0.0) + q * step * np.array([np.cos(psi), np.sin(psi), 0])
    sagitta = (q * step) ** 2 / (2 * float(flank.area_element(psi, 0.0)))
    # rounding of coordinates as large as the base radius is 1e-17 m, the sagitta above 1e-15 m
    assert float(flank.distance(across)) == pytest.approx(sagitta, rel=0.03)


@given(gear_pairs(), sides)
def test_base_pitch_of_pinion_and_rack_are_equal(pair: GearPair, side: int) -> None:
    """p_bn = pi m_n cos alpha_n: between neighbouring flanks, measured along the normal, on both gears."""
    p_bn = np.pi * pair.module * np.cos(pair.alpha_n)
    here, next_ = Flank(pair, 0, side), Flank(pair, 1, side)
    q = here.tip_tangent_length
    on_next = next_.point(next_.generator(q, 0.0), 0.0)
    distance = float(here.distance(on_next)) * side
    assert distance % (pair.teeth * p_bn) == pytest.approx(p_bn, rel=TOLERANCE * 10)

    bar = RackBar(pair, -1.0, 1.0, 3)
    one, two = bar.flank(0, side), bar.flank(1, side)
    assert side * (two.point - one.point) @ one.normal == pytest.approx(p_bn, rel=TOLERANCE)


@given(gear_pairs())
def test_base_helix_and_base_circle(pair: GearPair) -> None:
    """tan beta_b = tan beta cos alpha_t (the code has sin beta_b = sin beta cos alpha_n)."""
    assert np.tan(pair.beta_b) == pytest.approx(np.tan(pair.beta_p) * np.cos(pair.alpha_t), abs=TOLERANCE)
    assert pair.base_radius * pair.twist == pytest.approx(np.tan(pair.beta_b), abs=TOLERANCE)
    p_bt = 2 * np.pi * pair.base_radius / pair.teeth
    assert p_bt * np.cos(pair.beta_b) == pytest.approx(pair.normal_base_pitch, rel=TOLERANCE)


@given(gear_pairs())
def test_form_point_joins_root_and_flank_smoothly(pair: GearPair) -> None:
    """Without undercut the trochoid begins on the involute, in its direction."""
    form = form_point(pair)
    flank = Flank(pair, -1, +1)  # the right flank of the space on +Y
    psi = flank.generator(form.tangent_length, 0.0)
    start = trochoid(pair, form.eta)
    np.testing.assert_allclose(
        start, flank.point(psi, 0.0)[:2], rtol=0, atol=TOLERANCE * pair.reference_radius
    )
    if pair.fillet_radius > 0.01 * pair.module:  # a sharp cutter leaves a kink
        tangent = trochoid(pair, form.eta + 1e-7) - start
        across = flank.normal(psi)[:2] / np.cos(pair.beta_b)
        # second-order term of the secant over 1e-7 rad of the rounding
        assert abs(tangent @ across) <= 1e-5 * np.linalg.norm(tangent)


@given(gear_pairs())
def test_root_circle_is_the_depth_of_the_cutter(pair: GearPair) -> None:
    """d_f / 2 = r + x m_n - h_fP, reached at eta = pi/2."""
    deepest = np.hypot(*trochoid(pair, np.pi / 2))
    expected = pair.reference_radius + pair.profile_shift * pair.module - pair.rack_dedendum
    assert deepest == pytest.approx(expected, rel=TOLERANCE)


@given(gear_pairs(), st.floats(0.05, 0.6))
def test_topping_is_the_inverse_of_the_crest_width(pair: GearPair, share: float) -> None:
    width = share * crest_width(pair, pair.base_radius)
    radius = tip_radius_for_crest(pair, width)
    assert crest_width(pair, radius) == pytest.approx(width, abs=TOLERANCE * 10 * pair.reference_radius)
    assert crest_width(pair, pointed_radius(pair)) == pytest.approx(
        0, abs=TOLERANCE * 10 * pair.reference_radius
    )


@given(gear_pairs(), st.floats(1e-3, 0.1))
def test_undercut_begins_at_the_limit(pair: GearPair, below: float) -> None:
    """At x_min the involute begins on the base circle; below it the trochoid crosses it further out."""
    limit = undercut_limit(pair)
    at_limit = form_point(dataclasses.replace(pair, profile_shift=limit + 1e-9))
    assert not at_limit.undercut
    length = 1e-9 * pair.module / np.sin(pair.alpha_t)  # (x - x_min) m_n / sin(alpha_t)
    assert at_limit.tangent_length == pytest.approx(length, abs=TOLERANCE * pair.reference_radius)

    under = dataclasses.replace(pair, profile_shift=limit - below)
    form = form_point(under)
    assert form.undercut
    x, y = trochoid(under, form.eta)
    on_root = np.array([x, y, 0.0])
    distance = float(Flank(under, -1, +1).distance(on_root))
    assert distance == pytest.approx(0, abs=TOLERANCE * 10 * pair.reference_radius)


def test_all_addendum_pinion_touches_only_beyond_the_pitch_point() -> None:
    """x = h_aP / m_n: the rack's tips lie on the pitch line, contact is all recess (b = 0 in the paper)."""
    pair = GearPair.of(SteeringGear())
    assert pair.rack_addendum / pair.module == pair.profile_shift == 1.0
    start, end = path_on_involute(pair)
    assert 0 <= start < 1e-6 < end  # h* = 0.99997 m_n in ISO 53, hence not 0 exactly


def test_radius_and_profile_of_the_default_gear() -> None:
    """Numbers worked out by hand from the paper's gear: d = z m_n / cos beta, d_b = d cos alpha_t."""
    pair = GearPair.of(SteeringGear())
    assert 2e3 * pair.reference_radius == pytest.approx(12.1151, abs=1e-4)
    assert 2e3 * pair.base_radius == pytest.approx(11.2424, abs=1e-4)
    assert undercut_limit(pair) == pytest.approx(0.5403, abs=1e-4)
    assert crest_width(pair, pair.tip_radius) / pair.module == pytest.approx(0.28, abs=0.005)
