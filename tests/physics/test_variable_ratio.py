"""Gears of variable ratio: contact against closed forms, energy, local gears, triangles; scenes; refusals."""

from statistics import NormalDist
from typing import Any

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.assessment.requirements.judging import numbers_without_runs
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.generated_rack import GeneratedRack
from rps_exudyn.gears.local_gear import local_gear
from rps_exudyn.gears.tooth_strength import flank_stress
from rps_exudyn.inference.uncertainty.quick_band import quick_band
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.parameters.fidelity import FOR_MEANS, Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.requirements import read_limits
from rps_exudyn.solvers.closed_form import mean_state, pushing_force
from rps_exudyn.tooth_contact.flank_data import pack
from rps_exudyn.tooth_contact.wrench import ELASTIC_ENERGY, NORMAL_COAST, NORMAL_DRIVE, PENETRATION
from verification.contact_at import flank_contact

TURN = 2 * np.pi
PLAIN = SteeringGear().replace({"mesh.law": "line"})
COURSE = {"rack.ratio.centre": TURN * 5.4e-3, "rack.ratio.lock": TURN * 6.48e-3, "rack.ratio.to": "150 deg"}
GEAR = PLAIN.replace(COURSE)
SLOW = PLAIN.replace(
    {"rack.ratio.centre": TURN * 5.4e-3, "rack.ratio.lock": TURN * 5.9e-3, "rack.ratio.to": "550 deg"}
)
PITCH = {"test.turns": 1 / 6}


def wrench(gear: SteeringGear, angle: float, shift: Any = (0, 0, 0), turned: float = 0.0) -> np.ndarray:
    """The contact at a pinion angle, the rack shifted from where it belongs, the pinion turned beyond."""
    pair = GearPair.of(gear)
    place = np.array([float(pair.travel_at(angle)), pair.bar_axis_height, 0.0]) + shift
    rate = np.array([float(pair.gain_at(angle)), 0.0, 0.0])
    return flank_contact(-angle - turned, -1.0, place, np.eye(3), rate, np.zeros(3), pack(gear, along=8))


# --- the contact -----------------------------------------------------------------------------------
def test_constant_course_has_the_contact_of_a_constant_ratio() -> None:
    same = PLAIN.replace({"rack.ratio.centre": TURN * GearPair.of(PLAIN).gain})
    for angle in (0.0, 0.3, -1.2):
        expected = wrench(PLAIN, angle, (2e-6, -10e-6, 1e-6))
        found = wrench(same, angle, (2e-6, -10e-6, 1e-6))
        np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("angle", [-2.2, -1.0, 0.0, 1.3, 2.4, 4.0])
def test_perfect_rack_neither_touches_nor_gapes(angle: float) -> None:
    """No lift and no transmission error: pressed by 1 nm both sides bear, parted by 1 nm neither does."""
    pressed, parted = (wrench(GEAR, angle, (0, height, 0)) for height in (-1e-9, 1e-9))
    alpha = float(GearPair.of(GEAR).design_mesh.pressure_angle(GearPair.of(GEAR).gain_at(angle)))
    assert pressed[PENETRATION] == pytest.approx(1e-9 * np.sin(alpha), rel=1e-5)
    assert min(pressed[NORMAL_DRIVE], pressed[NORMAL_COAST]) > 0
    assert parted[NORMAL_DRIVE] == parted[NORMAL_COAST] == 0


def test_lifted_rack_departs_from_its_course_on_one_flank() -> None:
    """Theory page: held away by y and driven on one flank it lags by y g c / r_b, of first order in y."""
    pair, angle, y = GearPair.of(GEAR), 1.6, 1e-7
    gain = float(pair.gain_at(angle))
    c = np.sqrt(1 - float(pair.design_mesh.sine(gain)) ** 2)
    lag = y * gain * c / pair.base_radius
    for beyond, touches in ((0.99, False), (1.01, True)):
        bears = wrench(GEAR, angle, (-beyond * lag, y, 0))[[NORMAL_DRIVE, NORMAL_COAST]].max() > 0
        assert bears == touches


def test_force_is_the_gradient_of_the_energy() -> None:
    """Virtual work, where only the pinion's faces end the lines: two Newton steps leave 1e-8. Where tips or
    bar end them, loads at edges take up to 0.4 % of it, of the local gears of constant ratio 0.5 %."""
    gear = GEAR.replace(
        {
            "pinion.face_width": "6 mm",
            "rack.bar_diameter": "30 mm",
            "bush.inner_diameter": "31 mm",
            "bush.outer_diameter": "36 mm",
            "yoke.plunger_diameter": "34 mm",
            "basic_rack.addendum": 1.3,
            "pinion.tip_diameter": "18.2 mm",
            "rack.reference_height": "8.5 mm",
            "mesh.friction": 0.0,
        }
    )
    angle, press = -1.7, np.array([0.0, -40e-6, 0.0])
    out = wrench(gear, angle, press)

    def energy(shift: Any = 0.0, turned: float = 0.0) -> float:
        return float(wrench(gear, angle, press + shift, turned)[ELASTIC_ENERGY])

    gradient = [-(energy(turned=1e-6) - energy(turned=-1e-6)) / 2e-6]
    gradient += [(energy(1e-8 * e) - energy(-1e-8 * e)) / 2e-8 for e in np.eye(3)]
    normal = out[NORMAL_DRIVE] + out[NORMAL_COAST]
    np.testing.assert_allclose(out[:4] / normal, -np.array(gradient) / normal, atol=1e-8)


# --- whole gears -----------------------------------------------------------------------------------
def mean_torque(gear: SteeringGear, fidelity: Fidelity | str = "quasi-static", **settings: object) -> float:
    at = {path.replace("__", "."): value for path, value in settings.items()}
    return float(
        rps.run("free-pinion-torque", gear.replace(PITCH | at), fidelity=fidelity).summary["torque_mean"]
    )


@pytest.mark.parametrize("degrees", [150, 450])
def test_slow_course_has_the_torque_of_local_gears(degrees: float) -> None:
    """At q_a / Q < 0.1 a pitch has the torque of the constant ratio in its middle within 0.5 %."""
    pair = GearPair.of(SLOW)
    assert GeneratedRack.of(pair).steepest < 0.1
    local = local_gear(SLOW, float(pair.gain_at(np.radians(degrees))))
    start = {"test__start_angle": f"{degrees - 30} deg"}
    assert mean_torque(SLOW, **start) == pytest.approx(mean_torque(local, **start), rel=5e-3)


def test_torque_is_even_and_dynamics_agree_with_equilibria() -> None:
    """A turn by 180 degrees about Y is a symmetry of a guided rack, which its bush does not see."""
    guided = Fidelity.preset("quasi-static").replace({"rack": "guided"})
    outwards = mean_torque(GEAR, guided, test__start_angle="60 deg")
    mirrored = mean_torque(GEAR, guided, test__start_angle="-60 deg", test__direction=-1)
    assert abs(mirrored) == pytest.approx(outwards, rel=1e-6)
    still, moving = (
        mean_torque(GEAR, each, test__start_angle="60 deg") for each in ("quasi-static", "flank")
    )
    assert moving == pytest.approx(still, rel=1e-3)


def test_triangles_agree_with_lines() -> None:
    """An independent contact of faces with corners on the exact flank: 0.4 % less, as at a constant ratio."""
    model = Fidelity.preset("quasi-static").replace({"mesh": "triangles", "chord_error": 4e-7})
    start = {"test__start_angle": "60 deg"}
    assert mean_torque(GEAR, model, **start) == pytest.approx(mean_torque(GEAR, **start), rel=1e-2)


def test_lock_to_lock_reaches_the_travel_and_keeps_the_course() -> None:
    gear = GEAR.replace({"test.path": "lock-to-lock", "rack.travel": "50 mm"})
    result = rps.run("free-pinion-torque", gear, fidelity="quasi-static")
    travel = np.asarray(result.signals["rack_displacement"])
    assert np.ptp(travel) == pytest.approx(50e-3, rel=1e-3)
    assert result.summary["transmission_error_peak_to_peak"] < 5e-6  # elasticity alone
    assert result.summary["torque_closed_form"] == pytest.approx(result.summary["torque_mean"], rel=5e-3)


def test_closed_form_is_that_of_the_place_and_of_a_constant_ratio() -> None:
    """Five pressure angles leave 1e-4 of a local gear's torque."""
    gear = GEAR.replace({"test.start_angle": "-10 deg", "test.turns": 1})
    laws = {
        "free-pinion-torque": ("pinion_torque", lambda local: mean_state(local, 1, 0.0).torque),
        "rack-push": ("rack_force", lambda local: pushing_force(local, 1)),
    }
    for scene, (name, law) in laws.items():
        signals = rps.run(scene, gear, fidelity="closed-form").signals
        for angle in np.radians([0, 70, 120, 300]):
            local = local_gear(GEAR, float(GearPair.of(GEAR).gain_at(angle)))
            found = np.interp(angle, signals["pinion_angle"], signals[name])
            assert found == pytest.approx(law(local), rel=1e-3)
    same = PLAIN.replace({"rack.ratio.centre": TURN * GearPair.of(PLAIN).gain})
    assert mean_state(same, 1, 50.0).torque == pytest.approx(mean_state(PLAIN, 1, 50.0).torque, rel=1e-9)


def test_quick_band_follows_the_preload() -> None:
    """A mean torque is linear in the preload, so its quantiles are those of the preload."""
    gear = GEAR.replace({**PITCH, "test.start_angle": "60 deg"})
    band = quick_band(gear, FOR_MEANS, {"yoke.preload": Distribution.read("300 N +- 10 N", "N")}, runs=8)
    ends = [mean_torque(gear.replace({"yoke.preload": preload}), FOR_MEANS) for preload in (280, 320)]
    at = 300 + 10 * NormalDist().inv_cdf(0.95)
    expected = np.interp(at, [280, 320], ends)
    assert band.metrics["torque_mean"].high == pytest.approx(expected, rel=2e-3)


def test_sheet_has_the_worst_place_and_the_mean_gain() -> None:
    """The mean travel per turn from lock to lock; the contact stress of the place with the largest."""
    pair, half = GearPair.of(GEAR), GEAR.rack.travel / 2
    found = numbers_without_runs(["gain", "rated_flank", "rated_root_rack"], GEAR, read_limits(), 30.0)
    assert found["gain"] == pytest.approx(GEAR.rack.travel / (2 * float(pair.angle_at(half))) * TURN)
    local = [flank_stress(local_gear(GEAR, gain), 30.0) for gain in (5.4e-3, 5.6e-3, 6.48e-3)]
    worst = flank_stress(GEAR, 30.0)
    assert max(local) < worst < max(local) / np.sqrt(1 - GeneratedRack.of(pair).steepest)
    same = PLAIN.replace({"rack.ratio.centre": TURN * GearPair.of(PLAIN).gain})
    assert flank_stress(same, 30.0) == pytest.approx(flank_stress(PLAIN, 30.0), rel=1e-4)
    assert 0 < found["rated_root_rack"] < found["rated_flank"]


@pytest.mark.parametrize("scene", ["reversal", "steering-torque"])
def test_reduced_gear_agrees_with_equilibria(scene: str) -> None:
    settings = {"rack.travel": "60 mm", "test.tyre_stiffness": "40 N/mm", "test.steer_torque": "2.5 N*m"}
    gear = GEAR.replace(settings)
    one, other = (rps.run(scene, gear, fidelity=each).summary for each in ("reduced", "quasi-static"))
    name = "hysteresis_area" if scene == "reversal" else "feel_area"
    assert one[name] == pytest.approx(other[name], rel=1.5e-2)  # equilibria of the wheel: 0.6 % of it


def test_no_pitch_stands_for_another_one() -> None:
    """From where the ratio is constant, too: whole pitches are followed one by one, both ways."""
    gear = GEAR.replace({"test.path": "there-and-back", "test.start_angle": "0 deg", "test.turns": 1})
    signals = rps.run("free-pinion-torque", gear, fidelity="quasi-static").signals
    angle, torque = (np.asarray(signals[name]) for name in ("pinion_angle", "pinion_torque"))
    turn = int(angle.argmax())
    forth, back = torque[:turn], torque[turn + 1 :][::-1]
    pitches = len(forth) // 60
    means = [np.abs(way[: 60 * pitches]).reshape(pitches, 60).mean(axis=1) for way in (forth, back)]
    assert np.ptp(means[0]) > 0.1
    np.testing.assert_allclose(means[1], means[0], rtol=0.03)  # of a free rack both ways differ a little


def test_load_test_takes_the_mean_ratio() -> None:
    gear = GEAR.replace({**PITCH, "test.start_angle": "60 deg"})
    found = rps.run("load-test", gear, fidelity="quasi-static").summary
    assert 0.97 < found["efficiency_forward_net"] < 1.0


@pytest.mark.parametrize("scene", ["free-pinion-torque", "load-test"])
def test_gears_computed_together_are_those_run_singly(scene: str) -> None:
    """Of one course. Means agree within 1e-5, what varies within 1e-4 (see `batch`)."""
    gear = GEAR.replace({**PITCH, "test.start_angle": "60 deg"})
    table = {"yoke.preload": np.linspace(250, 350, 7).tolist(), "mesh.friction": np.linspace(0.06, 0.1, 7)}
    table = {name: [*values, *values] for name, values in table.items()}
    gears = rps.batch(scene, gear, table)
    assert gears.in_loop.all()
    settings = {name: values[1] for name, values in table.items()}
    one = rps.run(scene, gear.replace(settings), fidelity="quasi-static")
    names = [name for name in gears.summary if name != "energy_residual"]
    for name in names:
        rel = 1e-5 if "mean" in name else 1e-4
        assert gears.summary[name][1] == pytest.approx(one.summary[name], rel=rel)
    main = "torque_mean" if "torque_mean" in names else "torque_forward"
    assert gears.errors[main][1] == pytest.approx(one.errors[main], rel=0.05)


def test_gears_of_several_courses_are_run_singly() -> None:
    """The course follows from the base radius, too; and a driven rack turns the pinion unevenly."""
    gear = GEAR.replace({**PITCH, "test.start_angle": "60 deg"})
    angles = np.radians(np.linspace(24.9, 25.1, 6))
    for scene, table in (
        ("free-pinion-torque", {"pinion.helix_angle": angles}),
        ("rack-push", {"yoke.preload": 290 + angles}),
    ):
        gears = rps.batch(scene, gear, table)
        assert not gears.in_loop.any()
        assert gears.ok.all()


def test_result_file_keeps_the_course(tmp_path: Any) -> None:
    result = rps.run("free-pinion-torque", GEAR.replace(PITCH), fidelity="quasi-static")
    result.save(tmp_path / "r.h5")
    assert rps.load(tmp_path / "r.h5").gear.rack.ratio == GEAR.rack.ratio


def test_general_contact_and_fits_refuse_a_course() -> None:
    with pytest.raises(InputError, match="the fidelity full needs a rack of constant ratio"):
        rps.run("free-pinion-torque", GEAR, fidelity="full")
    with pytest.raises(InputError, match="a fit needs a rack of constant ratio"):
        rps.fit(["curve.csv"], GEAR)
