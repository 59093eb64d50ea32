"""Spheres of general contact of which only those within reach are looked at: nothing may change by it."""

from itertools import product
from typing import Any

import numpy as np
import pytest

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.simulate.run import run
from rps_exudyn.solvers import gear_forces
from rps_exudyn.solvers.sphere_groups import by_touching_angle
from rps_exudyn.tooth_contact.sampled_contact import SampledContactData
from rps_exudyn.tooth_contact.spheres import contact_data
from rps_exudyn.tooth_contact.wrench import PENETRATION
from verification.contact_at import sampled_wrench
from verification.law_area import by_law

WITH_ERRORS: dict[str, Any] = {
    "pinion.runout": "40 um",
    "pinion.pitch_error": "10 um",
    "pinion.profile_slope": "5 um",
    "pinion.crowning": "5 um",
}
FEW_TEETH: dict[str, Any] = {"pinion.helix_angle": "-20 deg", "test.direction": -1}


@pytest.mark.parametrize("settings", [{}, WITH_ERRORS, FEW_TEETH], ids=["paper", "errors", "other hand"])
def test_spheres_in_groups_press_as_all_spheres_do(settings: dict[str, Any]) -> None:
    """The same sum in another order, 1e-12, as deep as the law holds; also where the rack is rolled by half
    of what is allowed for and touches with its ends alone."""
    gear = SteeringGear().replace(settings)
    pair = GearPair.of(gear)
    whole = contact_data(gear, profile=13, axial=9, friction_zone=1e-5)
    groups = by_touching_angle(whole, pair)
    assert groups.gate < whole.gate / 2  # so that most are left out
    compared = {0.0: 0, 1.5: 0}
    for angle in np.linspace(-7, 7, 15):
        for roll, depth in product(compared, np.linspace(-200e-6, whole.radius / 2, 11)):
            args = pressed(pair, whole, angle, depth, np.deg2rad(roll))
            expected = sampled_wrench(*args, whole)
            if 0 < expected[PENETRATION] <= whole.radius / 2:
                found, largest = sampled_wrench(*args, groups), np.abs(expected).max()
                np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12 * largest)
                compared[roll] += 1
    assert min(compared.values()) > 10


def pressed(pair: GearPair, data: SampledContactData, angle: float, depth: float, roll: float) -> Any:
    """A kernel's arguments: the rack pressed in by a depth [m] from where it touches, and rolled about X."""
    lift = -depth / np.sin(pair.alpha_n) + pair.runout * np.cos(angle + pair.runout_angle)
    along = -angle * pair.gain
    position = data.rack_reference + np.array([along, lift, 0.0])
    c, s = np.cos(roll), np.sin(roll)
    turned = np.array([[1.0, 0, 0], [0, c, -s], [0, s, c]])
    return angle, 1.0, position, turned, np.array([-pair.gain, 0, 0]), np.zeros(3)


def test_spheres_out_of_reach_do_not_change_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """A tenth of a turn with the spheres within reach against one that holds all of them, there and back.
    Newton's tolerance is 1e-4 of the preload: restarts begin where rounding decides, so that the first
    angles after the reversal are apart by up to 0.15 % of the torque; the others are so by 0.01 %."""
    held = turned()
    monkeypatch.setattr(gear_forces, "by_touching_angle", without_gate)
    free = turned()
    planned, own, other = np.intersect1d(held["time"], free["time"], return_indices=True)
    assert planned.size > 0.5 * held["time"].size  # restarts add others
    apart = held["pinion_torque"][own] - free["pinion_torque"][other]
    apart = np.sort(np.abs(apart)) / held["pinion_torque"].max()
    assert apart[-1] < 2e-3
    assert apart[-apart.size // 10] < 2e-4


def without_gate(data: SampledContactData, pair: GearPair) -> SampledContactData:
    """The same groups, all of them near the mesh at any angle."""
    return by_touching_angle(data, pair)._replace(gate=np.pi)


def turned() -> Result:
    """General contact there and back, over more angles than a contact is held for."""
    choices = {"bush": "condensed", "profile_samples": 14, "axial_samples": 10, "step_angle": "3 deg"}
    fidelity = Fidelity.preset("full").replace(choices)
    gear = by_law(SteeringGear().replace({"test.path": "there-and-back"}), "area")
    result = run("free-pinion-torque", gear, fidelity=fidelity, turns=0.2)
    assert result["pinion_angle"].max() - result["pinion_angle"].min() > np.deg2rad(70)
    return result


def test_slow_pinion_needs_no_other_torque() -> None:
    """Friction of Coulomb knows no speed: at a thirtieth of the speed, in steps of a second, the mean is the
    same to 0.01 % (the steps are the same angles). Such steps began far from the contact once, and failed."""
    coarse = Fidelity.preset("full").replace(
        {"bush": "condensed", "profile_samples": 20, "axial_samples": 14, "step_angle": "6 deg"}
    )
    slow, fast = (
        run(
            "free-pinion-torque",
            SteeringGear().replace({"test.turns": 1 / 12, "test.speed": speed}),
            fidelity=coarse,
        )
        for speed in ("0.5 rpm", "15 rpm")
    )
    assert slow.status is Status.OK, slow.message
    assert slow.summary["torque_mean"] == pytest.approx(fast.summary["torque_mean"], rel=1e-4)
