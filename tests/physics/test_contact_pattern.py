"""The contact pattern is that of the recorded motion: its pressures add up to the contact law's forces."""

import dataclasses

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.analysis.contact_pattern import contact_pattern, one_pitch, unrolled
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.pages.charts.analyses import pattern_figure
from rps_exudyn.results.result import Result
from verification.area_pattern import pressures
from verification.law_area import by_law

STIFFNESS = 2e13  # [N/m^3], mesh.stiffness


@pytest.fixture(scope="module")
def pitch() -> Result:
    """One tooth pitch of a gear with every motion of the rack, away from the centre."""
    settings = {"pinion.runout": 40e-6, "mesh.stiffness": STIFFNESS}
    gear = by_law(rps.SteeringGear().replace(settings), "area")
    return rps.run("free-pinion-torque", gear, fidelity="quasi-static", turns=1 / 6, start_angle=4.0)


@pytest.fixture(scope="module")
def lines() -> Result:
    """One tooth pitch by law "line"."""
    gear = rps.SteeringGear().replace({"mesh.law": "line"})
    return rps.run("free-pinion-torque", gear, fidelity="quasi-static", turns=1 / 6)


@pytest.mark.long
@pytest.mark.parametrize(("side", "name"), [(-1, "mesh_normal_force_drive"), (+1, "mesh_normal_force_coast")])
def test_pressure_over_the_flanks_is_the_normal_force(side: int, name: str, pitch: Result) -> None:
    few = {signal: values[::20] for signal, values in pitch.signals.items()}
    pair = GearPair.of(pitch.gear)
    roll, face = unrolled(pitch.gear, (200, 200))
    area = roll / np.cos(pair.beta_b) * (roll[1] - roll[0]) / pair.base_radius * (face[1] - face[0])
    forces = (pressures(pitch.gear, few, side, roll, face) * area[:, None]).sum(axis=(1, 2, 3))
    np.testing.assert_allclose(forces, few[name], rtol=2e-3)


@pytest.mark.long
def test_highest_pressure_belongs_to_the_deepest_penetration(pitch: Result) -> None:
    places = unrolled(pitch.gear)
    highest = max(pressures(pitch.gear, pitch.signals, side, *places).max() for side in (-1, +1))
    assert highest == pytest.approx(STIFFNESS * pitch["mesh_penetration"].max(), rel=0.05)


def test_pattern_of_a_law_without_lines_is_that_of_lines(lines: Result) -> None:
    both = contact_pattern(by_law(lines.gear, "area"), lines.signals)
    assert [pattern.side for pattern in both] == [-1, +1]
    for pattern, own in zip(both, contact_pattern(lines.gear, lines.signals), strict=True):
        np.testing.assert_array_equal(pattern.pressure, own.pressure)


def test_picture_says_the_highest_pressures(lines: Result) -> None:
    both = contact_pattern(lines.gear, one_pitch(lines.signals, 6))
    titles = [axes.get_title(loc="left") for axes in pattern_figure(lines).axes[:2]]
    for title, pattern in zip(titles, both, strict=True):
        assert title.endswith(f"up to {pattern.pressure.max() / 1e6:.0f} MPa")


def test_what_has_no_pattern_is_told(lines: Result) -> None:
    without = {name: values for name, values in lines.signals.items() if name != "rack_roll"}
    with pytest.raises(InputError, match="no rack_roll"):
        pattern_figure(dataclasses.replace(lines, signals=without))


@pytest.mark.parametrize("law", ["line", "teeth"])
def test_pattern_of_lines_has_the_pressure_of_hertz(law: str) -> None:
    """What lies between the stations of a pitch's lines is no higher than they, and not much lower."""
    gear = by_law(rps.SteeringGear(), law)
    result = rps.run("free-pinion-torque", gear, fidelity="quasi-static", turns=1 / 6)
    both = contact_pattern(result.gear, one_pitch(result.signals, 6))
    highest = max(pattern.pressure.max() for pattern in both)
    assert 0.85 < highest / result["mesh_pressure"].max() < 1.1
    assert all((pattern.pressure > 0).mean() > 0.5 for pattern in both)
