"""Exact integrals of pinion and rack against the solids, whose chords cut off what vanishes with them."""

import numpy as np
import pytest

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.masses import pinion_inertia, rack_masses, section
from rps_exudyn.gears.solids import pinion_solid, rack_solid
from rps_exudyn.parameters.gear import SteeringGear

GEAR = SteeringGear()
CHORDS = (4e-6, 1e-6, 2.5e-7)  # [m]
RACKS = (
    {},
    {"rack.tooth_angle": "-20 deg"},
    {"rack.tooth_angle": "0 deg", "pinion.helix_angle": "0 deg"},
    {"rack.length": "900 mm", "rack.bar_diameter": "24 mm"},
)
PINIONS = (
    {},
    {"pinion.runout": "40 um", "pinion.pitch_error": "10 um", "pinion.lead_error": "20 um"},
    {"pinion.shaft_diameter": "9 mm"},
)


@pytest.mark.parametrize("changes", RACKS)
def test_the_racks_solid_converges_to_the_integrals(changes: dict[str, str]) -> None:
    """Chords are off by a fourth each time, which leaves a fourth of every difference (27 % to 23 %: segments
    are whole numbers); the finest solid lacks 3e-5 of the mass."""
    gear = GEAR.replace(changes)
    exact = rack_masses(gear)
    solids = [rack_solid(gear, each).mass_properties for each in CHORDS]
    missing = np.array([1 - each.mass / exact.mass for each in solids])
    np.testing.assert_allclose(missing[1:] / missing[:-1], 0.25, atol=0.02)
    assert 0 < missing[-1] < 4e-5
    scale = np.abs(exact.inertia).max()
    assert np.abs(solids[-1].inertia - exact.inertia).max() < 1e-4 * scale
    away = np.array([np.abs(each.centre_of_mass - exact.centre_of_mass).max() for each in solids])
    assert (away[1:] < 0.35 * away[:-1]).all()


@pytest.mark.parametrize("changes", PINIONS)
def test_the_pinions_solid_converges_to_the_integral(changes: dict[str, str]) -> None:
    """As the rack's; the solid's crests may be off by ten chords, so that 2e-4 are missing at the finest."""
    gear = GEAR.replace(changes)
    exact = pinion_inertia(gear)
    missing = np.array([1 - _about_axis(gear, each) / exact for each in CHORDS])
    np.testing.assert_allclose(missing[1:] / missing[:-1], 0.25, atol=0.05)
    assert 0 < missing[-1] < 3e-4


def test_crowning_takes_its_mean_off_the_flanks() -> None:
    """Per flank, the integral of c / 3 R^2 q / r_b over the tangent length q: 20 um count as 6.7 um.

    Second orders of 20 um in 2 mm of tooth are 1e-4 of it.
    """
    pair = GearPair.of(GEAR)
    flank = Flank(pair, 0, -1)
    q = np.linspace(flank.form_tangent_length, flank.tip_tangent_length, 1001)
    off = np.trapezoid((pair.base_radius**2 + q**2) * q / pair.base_radius, q) * 20e-6 / 3
    wanted = GEAR.pinion.density * pair.face_width * 2 * pair.teeth * off
    crowned = pinion_inertia(GEAR.replace({"pinion.crowning": "20 um"}))
    assert pinion_inertia(GEAR) - crowned == pytest.approx(wanted, rel=5e-3)


def test_bar_that_ends_within_its_teeth_is_weighed_as_a_solid() -> None:
    """The integrals know whole teeth only."""
    short = GEAR.replace({"rack.length": "420 mm", "bush.distance": "250 mm"})
    assert rack_masses(short) is rack_solid(short).mass_properties


def test_relief_larger_than_the_tooth_is_refused() -> None:
    with pytest.raises(InputError, match="leave no tooth"):
        section(GearPair.of(GEAR), FlankForm(profile_slope=-9e-3), 0.0)
    with pytest.raises(InputError, match="leave no tooth"):
        section(GearPair.of(GEAR), FlankForm(crowning=np.nan), 0.0)


def _about_axis(gear: SteeringGear, chord_error: float) -> float:
    """The solid's moment of inertia about the axis of rotation [kg m^2]."""
    solid = pinion_solid(gear, chord_error).mass_properties
    away = solid.centre_of_mass[:2]
    return float(solid.inertia[2, 2] + solid.mass * (away @ away))
