"""Setting the yoke's cap, and the lift of the rack on the stopped yoke, against their closed forms."""

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.scenes.yoke_setting import thread_lever, yoke_setting
from rps_exudyn.solvers.closed_form import torque_per_preload
from rps_exudyn.solvers.yoke_stop import lift_of_torque

GEAR = SteeringGear()
MODEL = Fidelity.preset("quasi-static").replace({"step_angle": "4 deg"})
RIGID = MODEL.replace({"rack": "free"})
SHORT = {"test.path": "there-and-back", "test.turns": 0.5, "test.centre_window": "90 deg"}


def setting_run(settings: dict[str, object]) -> Result:
    return rps.run("yoke-setting", GEAR.replace(SHORT | settings), fidelity=MODEL)


@pytest.fixture(scope="module")
def backed_off() -> dict[int, Result]:
    return {angle: setting_run({"test.back_off": f"{angle} deg"}) for angle in (5, 25, 45)}


def test_thread_without_friction_turns_all_work_into_force() -> None:
    """One turn's work 2 pi T lifts F by the pitch: lever = p / 2 pi exactly."""
    smooth = GEAR.replace({"yoke.thread_friction": 0.0})
    assert thread_lever(smooth) == pytest.approx(smooth.yoke.thread_pitch / (2 * np.pi), rel=1e-12)
    assert thread_lever(GEAR) > 10 * thread_lever(smooth)  # friction of 0.15 takes nine tenths


def test_tightened_gear_of_the_model_bears_the_cap_force() -> None:
    """Equilibrium of the gear with the cap screwed in by the formula's compression; its flanks are
    as wide as the face, the model's lines longer or shorter: 9 % of the flanks' share of the travel."""
    setting = yoke_setting(GEAR)
    touching = GEAR.yoke.preload + GEAR.yoke.spring_rate * GEAR.yoke.clearance
    tight = GEAR.replace({"yoke.clearance": -setting.compression, "yoke.preload": touching})
    rest = rps.run("radial-play", tight, fidelity=RIGID)["seat_force"][0]
    assert setting.cap_force == pytest.approx(4.9 / thread_lever(GEAR))
    assert rest - touching == pytest.approx(setting.cap_force - touching, rel=0.09)


def test_setting_is_that_of_the_angle(backed_off: dict[int, Result]) -> None:
    """Pitch times turns of clearance; the spring relaxes along its line, which the given gear lies on."""
    twenty = 1.5e-3 * 20 / 360
    near, far = backed_off[25].summary, backed_off[45].summary
    assert far["clearance_set"] - near["clearance_set"] == pytest.approx(twenty, rel=1e-9)
    assert near["preload_set"] - far["preload_set"] == pytest.approx(50e3 * twenty, rel=1e-9)
    on_line = near["preload_set"] + 50e3 * near["clearance_set"]
    assert on_line == pytest.approx(300 + 50e3 * 50e-6, rel=1e-9)


def test_torque_falls_as_the_spring_relaxes(backed_off: dict[int, Result]) -> None:
    """Free of the cap the torque falls by dT/dP times the spring's loss, to the 6 % that the formula is good
    to; while the cap presses it is much larger, and the result says so."""
    pressed, near, far = backed_off.values()
    assert {each.status for each in backed_off.values()} == {Status.OK}
    fall = near.summary["torque_on_centre"] - far.summary["torque_on_centre"]
    relaxed = near.summary["preload_set"] - far.summary["preload_set"]
    assert fall == pytest.approx(torque_per_preload(GEAR) * relaxed, rel=0.06)
    assert pressed.summary["clearance_set"] < 0
    assert pressed.summary["torque_on_centre"] > 1.2 * near.summary["torque_on_centre"]
    assert "cap still presses" in pressed.message
    assert "cap still presses" not in near.message


def test_scene_is_the_rotation_torque_of_the_gear_as_set(backed_off: dict[int, Result]) -> None:
    setting = yoke_setting(GEAR)
    as_set = setting.of(GEAR.replace(SHORT))
    torque = rps.run("free-pinion-torque", as_set, fidelity=MODEL)
    np.testing.assert_array_equal(torque["pinion_torque"], backed_off[25]["pinion_torque"])


def test_range_on_centre_is_that_of_the_test(backed_off: dict[int, Result]) -> None:
    """From 0 to 180 degrees and back, 90 degrees of the window on each side."""
    result = backed_off[25]
    angle, torque = np.rad2deg(result["pinion_angle"]), np.abs(result["pinion_torque"])
    far = torque[angle > 90 + 1e-6]
    assert result.summary["torque_off_centre_max"] == pytest.approx(far.max())
    assert result.summary["torque_on_centre_max"] == pytest.approx(torque[angle < 90 + 1e-6].max())
    assert result.summary["torque_off_centre"] == pytest.approx(far.mean(), rel=0.01)  # mean over time


def test_spring_alone_holds_a_cap_that_is_hardly_tightened() -> None:
    """The force of the thread is that of the spring where the cap stands: P + k (c - gap)."""
    loose = GEAR.replace({"test.cap_torque": "0.5 N*m", "test.back_off": "0 deg"})
    setting = yoke_setting(loose)
    assert setting.compression == 0
    assert setting.preload == pytest.approx(setting.cap_force)
    assert setting.clearance == pytest.approx(50e-6 + (300 - setting.cap_force) / 50e3)


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (
            {"test.cap_torque": "0.1 N*m", "test.back_off": "2000 deg"},
            "test.back_off unloads the yoke's spring",
        ),
        ({"yoke.spring_rate": "1 N/mm", "test.back_off": "3600 deg"}, "yoke.clearance"),
    ],
)
def test_setting_that_cannot_be(settings: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        setting_run(settings)


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"yoke.clearance": "120 um"},
        {"yoke.preload": "600 N"},
        {"test.lift_torque": "9.8 N*m"},
        {"yoke.nut_stiffness": 2e7},
        {"yoke.seat_stiffness": 6e7},
        {"pinion.pressure_angle": "22 deg"},
    ],
)
def test_lift_is_within_five_percent_of_its_closed_form(settings: dict[str, object]) -> None:
    """Left out is what the flanks yield with one instead of two in mesh, 1 to 3 um of 55 to 140."""
    gear = GEAR.replace(settings)
    lift = rps.run("rack-lift", gear, fidelity=RIGID).summary
    assert lift["rack_lift"] == pytest.approx(lift["rack_lift_closed_form"], rel=0.05)
    assert lift["rack_lift_closed_form"] == lift_of_torque(gear, gear.test.lift_torque)


def test_lift_of_a_rack_that_bends() -> None:
    """The bar bends away by less than it lifts: still within 5 %."""
    lift = rps.run("rack-lift", GEAR, fidelity=MODEL).summary
    assert lift["rack_lift"] == pytest.approx(lift["rack_lift_closed_form"], rel=0.05)


def test_preload_holds_the_rack_against_a_small_torque() -> None:
    """300 N hold up to 4.5 N m; the spring alone yields above that."""
    assert lift_of_torque(GEAR, 4.0) == 0
    soft = lift_of_torque(GEAR, 4.54)
    assert 0 < soft < GEAR.yoke.clearance
