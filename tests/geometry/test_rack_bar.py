"""The rack bar's mesh and its analytic flanks are one thing."""

import numpy as np
import pytest

from rps_exudyn.gears.polyhedron import defect, from_manifold
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.gear import SteeringGear

ROUNDING = 1e-14  # of booleans on a bar 0.65 m long [m]


@pytest.fixture(params=["10 deg", "0 deg", "-20 deg"])
def bar(request: pytest.FixtureRequest) -> RackBar:
    return RackBar.of(SteeringGear().replace({"rack.tooth_angle": request.param}))


def test_every_flank_face_of_the_mesh_lies_on_its_analytic_plane(bar: RackBar) -> None:
    """All faces parallel to a flank normal belong to the planes of whole teeth; none is missing."""
    vertices, faces = from_manifold(bar.solid(1e-6))
    assert defect(vertices, faces) is None
    corners = vertices[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1)
    for side in (-1, 1):
        first = bar.flank(0, side)
        chosen = corners[cross @ first.normal > (1 - 1e-9) * area].reshape(-1, 3)
        pitch = np.pi * bar.pair.module * np.cos(bar.pair.alpha_n)
        number = side * (chosen - first.point) @ first.normal / pitch
        np.testing.assert_allclose(number, np.round(number), rtol=0, atol=1e-10)
        assert set(np.round(number).astype(int)) == set(bar.teeth)
        assert chosen[:, 1].min() == pytest.approx(first.tip_height, abs=ROUNDING)
        assert chosen[:, 1].max() == pytest.approx(first.form_height, abs=ROUNDING)


def test_width_of_the_tip_land_is_the_bars_chord(bar: RackBar) -> None:
    """The inscribed polygon's chord is short by at most chord_error * R / half chord."""
    vertices, _ = from_manifold(bar.solid(1e-7))
    on_land = np.abs(vertices[:, 1] - bar.tip_height) < ROUNDING
    half = float(bar.flank(0, 1).half_chord(bar.tip_height))
    assert np.abs(vertices[on_land, 2]).max() == pytest.approx(
        half, abs=1e-7 * bar.pair.bar_radius / half * 1.1
    )


def test_tooth_and_space_are_equally_wide_on_the_reference_line(bar: RackBar) -> None:
    """Basic rack (ISO 53): pi m_n / 2 each, across the teeth; tooth 0 centred at X = 0."""
    left, right, next_ = bar.flank(0, -1), bar.flank(0, 1), bar.flank(1, -1)
    across = bar.pair.cross_trace
    assert (right.point - left.point) @ across == pytest.approx(np.pi * bar.pair.module / 2, rel=1e-14)
    assert (next_.point - right.point) @ across == pytest.approx(np.pi * bar.pair.module / 2, rel=1e-13)
    assert left.point[0] == pytest.approx(-right.point[0], rel=1e-14)


def test_teeth_cover_travel_and_pinion(bar: RackBar) -> None:
    last = bar.flank(bar.teeth[-1], 1).point[0]
    assert last >= SteeringGear().rack.travel / 2 + bar.pair.tip_radius
    assert bar.x_max == pytest.approx(0.35 + 0.03 + 0.07 + SteeringGear().bush.end_overhang)
    assert bar.x_max - bar.x_min == pytest.approx(0.65)
