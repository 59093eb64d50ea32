"""Laws of the scenes: what a load, a pushed rack, a reversal and an impact must do, whatever the numbers."""

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.analysis.efficiency import measured_load_test
from rps_exudyn.analysis.work_balance import missing_work
from rps_exudyn.forces.bush import bush_chain, housing_station
from rps_exudyn.forces.yoke import seat_wedge_factor
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.masses import rack_masses
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Outcome, Status
from rps_exudyn.results.result import Result
from rps_exudyn.scenes.load_test import oriented
from rps_exudyn.scenes.scene_run import SceneRun, joined
from rps_exudyn.solvers.closed_form import GRAVITY, pushing_force, unloading_force
from rps_exudyn.solvers.record import repeated

GEAR = SteeringGear()
PITCH = 1 / GEAR.pinion.teeth  # [turns]
PRESSURE_ANGLE = GEAR.pinion.pressure_angle
GAIN = float(GearPair.of(GEAR).gain)
MODELS = ["flank", "quasi-static", "closed-form"]
FINE = Fidelity.preset("quasi-static").replace({"step_angle": "0.5 deg"})


def ran(
    scene: str, settings: dict[str, object] | None = None, fidelity: str | Fidelity = "quasi-static"
) -> Result:
    """A scene over one tooth pitch, all right."""
    gear = GEAR.replace({"test.turns": PITCH, **(settings or {})})
    result = rps.run(scene, gear, fidelity=fidelity)
    assert result.status is Status.OK, result.message
    return result


# --- settled start ---------------------------------------------------------------------------------
@pytest.mark.parametrize("model", ["flank", "quasi-static"])
@pytest.mark.parametrize("direction", [1, -1])
def test_the_first_teeth_ask_for_the_same_torque_as_those_after_them(model: str, direction: int) -> None:
    """Where this gear first rests, its rack is pressed aside: from there half a tooth asks for 40 % more."""
    aside = {
        "basic_rack.addendum": 0.96,
        "pinion.teeth": 10,
        "pinion.normal_module": "1.76 mm",
        "pinion.pressure_angle": "21 deg",
        "pinion.helix_angle": "20.6 deg",
        "pinion.profile_shift": 1.0,
        "pinion.tip_diameter": "25.42 mm",
        "pinion.shaft_diameter": "11 mm",
        "rack.reference_height": "8.5 mm",
        "pinion.face_width": "10.34 mm",
        "rack.tooth_angle": "1.8 deg",
        "installation.angle_error": "-0.14 deg",
        "yoke.preload": "62 N",
        "yoke.friction": 0.22,
        "mesh.friction": 0.22,
        "bush.youngs_modulus": "67 MPa",
        "test.turns": 0.05,
        "test.direction": direction,
    }
    turned = direction * 2 * np.pi * 0.1
    first, later = (
        ran("free-pinion-torque", {**aside, "test.start_angle": start}, model).summary["torque_mean"]
        for start in (0.0, turned)
    )
    assert first == pytest.approx(later, rel=5e-3)


# --- load test -------------------------------------------------------------------------------------
@pytest.mark.parametrize("fidelity", MODELS)
@pytest.mark.parametrize("mass", [10.0, 40.0])
def test_raising_and_lowering_differ_by_twice_the_free_torque(fidelity: str, mass: float) -> None:
    """(tau_f + tau_r) / 2 = W s', (tau_f - tau_r) / 2 = T_0 while both flanks touch: 1.5 % of the larger."""
    found = ran("load-test", {"test.load_mass": mass}, fidelity).summary
    forward, reverse, ideal = found["torque_forward"], found["torque_reverse"], GRAVITY * mass * GAIN
    largest = max(ideal, found["free_torque"])
    assert (forward + reverse) / 2 == pytest.approx(ideal, abs=0.015 * largest)
    assert (forward - reverse) / 2 == pytest.approx(found["free_torque"], abs=0.015 * largest)


def test_the_load_test_counts_every_instant() -> None:
    """The second maneuver begins where the first ended, up to rounding, which cost a step each way."""
    signals = {
        "time": np.array([0.0, 1, 2, 2, 3, 4]),
        "pinion_angle": np.array([0.0, 0.5, 1, 1 + 1e-15, 0.5, 0]),
        "pinion_torque": np.array([2.0, 2, 8, -1, -1, -5]),
    }
    found = measured_load_test(oriented(signals, GEAR), 100.0, GAIN, 1.0, 2 * np.pi * PITCH)
    assert (found.torque_forward, found.torque_reverse) == pytest.approx((3.5, -2.0))


@pytest.mark.parametrize("direction", [1, -1])
def test_a_light_weight_cannot_drive_the_gear(direction: int) -> None:
    """Self-locking below T_0 / s' = 11.6 kg, whichever way the weight pulls: said, with the torque."""
    light = ran("load-test", {"test.load_mass": 10.0, "test.direction": direction})
    assert light.summary["torque_reverse"] < 0
    assert light.summary["torque_forward"] > 0
    assert "self-locking" in light.message
    heavy = ran("load-test", {"test.load_mass": 13.0, "test.direction": direction})
    assert heavy.summary["torque_reverse"] > 0
    assert "self-locking" not in heavy.message


def test_a_heavy_weight_lifts_one_flank() -> None:
    """Above the unloading force said, below not. A stiff spring keeps the rack in mesh then; the preset's own
    yields until the teeth leave it."""
    limit = unloading_force(GEAR) / GRAVITY
    stiff = {"yoke.spring_rate": "5 kN/mm", "mesh.law": "line", "mesh.line_stiffness": 13.8265e9}
    both = ran("load-test", {"test.load_mass": 0.9 * limit, **stiff})
    one = ran("load-test", {"test.load_mass": 1.1 * limit, **stiff})
    assert both["mesh_normal_force_coast"].min() > 0
    assert "coast flanks carry no load" in one.message


def test_a_weight_that_lifts_the_rack_out_of_mesh_is_said_to() -> None:
    """At 1.3 times the unloading force the spring still holds the rack on one flank; at 1.6 times the rack
    is 2 mm out of its place, twice what counts as mesh."""
    limit = unloading_force(GEAR) / GRAVITY
    gear = GEAR.replace({"test.turns": PITCH, "test.load_mass": 1.6 * limit, "yoke.clearance": "5 mm"})
    result = rps.run("load-test", gear, fidelity="quasi-static")
    assert result.status is not Status.OK
    assert f"above {limit:.4g} kg" in result.message
    assert len(result["pinion_angle"]) > 2  # what was recorded stays readable


def test_work_on_the_load_is_its_weight_times_the_travel() -> None:
    result = ran("load-test")
    travel = result["rack_displacement"]
    weight = GRAVITY * GEAR.test.load_mass
    half = len(travel) // 2
    raised = travel[half - 1] - travel[0]
    assert result["work_load"][half - 1] == pytest.approx(-weight * raised, rel=1e-4)
    assert result["load_force"] == pytest.approx(weight)


# --- rack push -------------------------------------------------------------------------------------
@pytest.mark.parametrize("fidelity", ["flank", "quasi-static"])
def test_pushed_rack_needs_the_force_of_the_formula(fidelity: str) -> None:
    """The formula drives the guided gear back by a mean force: 1 %."""
    found = ran("rack-push", {}, fidelity).summary["push_force_mean"]
    assert found == pytest.approx(pushing_force(GEAR, +1), rel=0.01)


def test_pushing_the_rack_is_lowering_the_weight_that_just_drives_the_gear() -> None:
    """Two scenes, one state, one law: a weight of the pushing force needs no torque; 0.3 % of T_0."""
    force = ran("rack-push", fidelity=FINE).summary["push_force_mean"]
    lowered = ran("load-test", {"test.load_mass": force / GRAVITY, "mesh.law": "line"}, FINE).summary
    assert lowered["torque_reverse"] == pytest.approx(0, abs=3e-3 * lowered["free_torque"])


def test_pushed_pinion_follows_with_the_gears_gain() -> None:
    result = ran("rack-push", {"test.path": "there-and-back"})
    assert result.summary["rack_gain"] == pytest.approx(2 * np.pi * GAIN, rel=1e-4)
    assert "pinion_torque" not in result.signals
    half = len(result["rack_force"]) // 2
    assert result["rack_force"][1:half].min() > 0 > result["rack_force"][half:].max()


# --- rack on rollers -------------------------------------------------------------------------------
@pytest.mark.parametrize("fidelity", ["flank", "quasi-static", "closed-form"])
def test_rollers_leave_the_forces_of_bush_and_plunger(fidelity: str) -> None:
    """D + kappa mu_yoke P, whatever the friction, runout and bearings of the pinion; 1e-4."""
    seat = seat_wedge_factor(GEAR.yoke.seat_angle) * GEAR.yoke.friction * GEAR.yoke.preload
    for changed in ({}, {"mesh.friction": 0.2, "pinion.runout": "20 um", "bearing.friction_torque": 0.1}):
        found = ran("rack-on-rollers", changed, fidelity).summary["roller_force_mean"]
        assert found == pytest.approx(GEAR.bush.drag + seat, rel=1e-4)


# --- there and back --------------------------------------------------------------------------------
@pytest.mark.parametrize("fidelity", ["flank", "quasi-static"])
def test_way_back_mirrors_the_way_there(fidelity: str) -> None:
    """Even in direction to 1 %: the teeth's load moves the other way over them."""
    found = ran("free-pinion-torque", {"test.path": "there-and-back"}, fidelity).summary
    assert found["torque_mean_backward"] == pytest.approx(found["torque_mean_forward"], rel=0.01)


def test_lock_to_lock_covers_the_travel_both_ways() -> None:
    gear = GEAR.replace({"test.path": "lock-to-lock", "test.start_angle": "10 deg"})
    result = rps.run("free-pinion-torque", gear, fidelity="quasi-static")
    assert result.status is Status.OK
    half = GEAR.rack.travel / 2
    assert result["rack_displacement"].max() == pytest.approx(half, abs=0.1e-3)
    assert result["rack_displacement"].min() == pytest.approx(-half, abs=0.1e-3)
    assert result["pinion_angle"][-1] == pytest.approx(result["pinion_angle"][0])


@pytest.mark.parametrize("fidelity", ["flank", "quasi-static"])
def test_speed_does_not_matter_to_coulomb(fidelity: str) -> None:
    """1 to 300 rpm, the friction zone scaled to the sliding: 0.5 %."""
    means = [
        ran("free-pinion-torque", {"test.speed": f"{rpm} rpm"}, fidelity).summary["torque_mean"]
        for rpm in (1, 15, 60, 300)
    ]
    assert means == pytest.approx(np.full(4, means[1]), rel=5e-3)


# --- simpler models --------------------------------------------------------------------------------
def test_guided_rack_is_what_the_formula_assumes() -> None:
    """No roll, no yaw, no pitch: the mean comes to 0.3 % of the closed form, whose only rest is the curve of
    the load along a line."""
    for name in ("quasi-static", "flank"):
        guided = ran("free-pinion-torque", fidelity=Fidelity.preset(name).replace({"rack": "guided"}))
        assert np.ptp(guided["rack_roll"]) < 1e-12
        assert guided.summary["torque_mean"] == pytest.approx(guided.summary["torque_closed_form"], rel=3e-3)


def test_weight_of_the_rack_rests_on_teeth_and_bush() -> None:
    """A beam on two supports: the teeth take m g (1 - x_m / x_fit) more, the seat as much as before; 3 %."""
    gravity = 9.81
    loaded, free = (ran("free-pinion-torque", {"installation.gravity": g}) for g in (gravity, 0.0))
    bar = rack_masses(GEAR)
    to_fit = housing_station(GEAR, bush_chain(GEAR).end_station)
    on_teeth = bar.mass * gravity * (1 - bar.centre_of_mass[0] / to_fit)
    added = (loaded["mesh_normal_force"] - free["mesh_normal_force"]).mean() * np.sin(PRESSURE_ANGLE)
    assert added == pytest.approx(on_teeth, rel=0.03)
    assert loaded["seat_force"].mean() == pytest.approx(free["seat_force"].mean(), abs=0.1)


def test_gravity_turned_by_half_a_turn_is_gravity_the_other_way() -> None:
    turned = ran(
        "free-pinion-torque", {"installation.gravity": 9.81, "installation.gravity_angle": "180 deg"}
    )
    against = ran("free-pinion-torque", {"installation.gravity": -9.81})
    assert turned.summary["torque_mean"] == pytest.approx(against.summary["torque_mean"], rel=1e-9)


def test_gravity_along_the_bar_is_a_load_on_the_rack() -> None:
    """Half the difference of both directions is m g s' sin(slope), with the teeth's friction; 5 %."""
    settings = {
        "installation.gravity": 9.81,
        "installation.gravity_slope": "20 deg",
        "test.path": "there-and-back",
    }
    found = ran("free-pinion-torque", settings).summary
    weight = rack_masses(GEAR).mass * 9.81 * np.sin(np.radians(20))
    drawn = weight * GearPair.of(GEAR).gain
    assert -found["torque_direction_difference"] / 2 == pytest.approx(drawn, rel=0.05)


def test_energies_grow_from_period_to_period() -> None:
    """As those of a rack whose weight falls along its bar: repeated, a period has its balance of work."""
    place = np.linspace(0.0, 1.0, 5)
    period = {"time": place, "pinion_torque": 2 + np.sin(2 * np.pi * place), "work_drive": 2 * place}
    period |= {"work_mesh_friction": 3 * place, "stored_energy": -place}
    whole = repeated(period, 3)
    assert whole["stored_energy"][-1] == -3.0
    assert missing_work(whole) == pytest.approx(0.0)
    assert whole["pinion_torque"][-1] == pytest.approx(2.0)


# --- reversal --------------------------------------------------------------------------------------
@pytest.mark.parametrize("fidelity", ["flank", "quasi-static"])
def test_loop_encloses_what_friction_takes(fidelity: str) -> None:
    """Work over a cycle = T_0 times the angle turned, but for the ends, where the gear yields: 1 %."""
    found = ran("reversal", {}, fidelity).summary
    turned = 4 * GEAR.test.amplitude
    free = rps.run("free-pinion-torque", GEAR, fidelity="quasi-static").summary["torque_mean"]
    assert found["hysteresis_area"] == pytest.approx(free * turned, rel=0.01)
    assert found["torque_jump"] == pytest.approx(2 * free, rel=0.01)


def test_reversal_angle_at_the_limit_of_no_friction_zone() -> None:
    """By as many stations of a line, the default zone and steps are within 2 % of a zone and steps five times
    as narrow; of fifty times the zone, and of few stations, which turn about one after the other, the bar
    covers the error."""
    gear, many = {"test.amplitude": "30 deg"}, {"strip_stations": 12}
    changes = many | {"zone_ratio": 0.0002, "step_angle": "0.2 deg"}, many, many | {"zone_ratio": 0.1}, {}
    limit, here, *others = (
        ran("reversal", gear, Fidelity.preset("quasi-static").replace(each)) for each in changes
    )
    angle = limit.summary["reversal_angle"]
    assert here.summary["reversal_angle"] == pytest.approx(angle, rel=0.02)
    for each in others:
        assert abs(each.summary["reversal_angle"] - angle) <= each.errors["reversal_angle"]


# --- impact ----------------------------------------------------------------------------------------
SHORT = {"test.pulse_period": "8 ms", "test.pulse_duration": "4 ms"}


def test_pulse_drives_the_plunger_into_the_yokenut() -> None:
    result = ran("yoke-impact", SHORT, "flank")
    assert result.summary["impacts"] >= 1
    assert result["plunger_displacement"].max() > GEAR.yoke.clearance
    assert abs(result.summary["energy_residual"]) < 2e-3


def test_without_a_pulse_nothing_moves() -> None:
    still = ran("yoke-impact", {**SHORT, "test.pulse_force": 0.0}, "flank")
    assert np.ptp(still["plunger_displacement"]) < 1e-9
    assert still.summary.get("impacts", 0) == 0


def test_impulse_of_the_pulse_is_taken_up_by_the_parts_it_meets() -> None:
    """Without clearance or inertia to speak of: a slow weak pulse across the rack is shared by spring and
    bush; the plunger moves by less than the pulse over the spring's rate."""
    weak = {"test.pulse_force": "20 N", "test.pulse_period": "30 ms", "test.pulse_duration": "30 ms"}
    moved = np.ptp(ran("yoke-impact", weak, "flank")["plunger_displacement"])
    assert 0 < moved < 2 * 20 / GEAR.yoke.spring_rate


def test_a_clearance_that_is_closed_is_said() -> None:
    """Pressing on a yokenut that the plunger already touches is no impact, but carries load."""
    result = ran("yoke-impact", {**SHORT, "yoke.clearance": "-10 um"}, "flank")
    assert "yoke.clearance = -10 um is closed from the start" in result.message


@pytest.mark.parametrize("fidelity", ["flank", "quasi-static"])
def test_a_small_reversal_is_followed_in_small_steps(fidelity: str) -> None:
    """Half a degree either way: the torque still jumps by nearly twice the running torque. Slow enough for
    the rack's inertia."""
    found = ran("reversal", {"test.amplitude": "0.5 deg", "test.speed": "3 rpm"}, fidelity).summary
    free = ran("free-pinion-torque").summary["torque_mean"]
    assert found["torque_jump"] == pytest.approx(2 * free, rel=0.15)


def test_a_rack_that_weighs_is_followed_over_all_periods() -> None:
    """It tilts more the farther it is out: tooth pitches are not alike, and one of them stands for none."""
    heavy = GEAR.replace({"installation.gravity": 9.81, "test.start_angle": "-360 deg"})
    whole, nearly = (
        rps.run("free-pinion-torque", heavy, fidelity="quasi-static", turns=t) for t in (2.0, 1.999)
    )
    assert "periods_alike" not in whole.findings
    assert whole.summary["torque_mean"] == pytest.approx(nearly.summary["torque_mean"], rel=1e-4)
    light = rps.run(
        "free-pinion-torque", heavy.replace({"installation.gravity": 0}), fidelity="quasi-static", turns=2
    )
    assert light.findings["periods_alike"] == 12


def test_path_gets_past_an_angle_where_the_contact_changes() -> None:
    """From the angle before, Newton's method and a search ended 3 N off at 258 degrees; from halfway not."""
    drawn = {"yoke.preload": 449.0972388324507, "mesh.friction": 0.09467799724228954}
    gear = GEAR.replace({**drawn, "pinion.runout": 1.1068749838074344e-05})
    coarse = rps.run("free-pinion-torque", gear, fidelity="quasi-static")
    finer = Fidelity.preset("quasi-static").replace({"step_angle": "0.5 deg"})
    fine = rps.run("free-pinion-torque", gear, fidelity=finer)
    assert coarse.status is Status.OK
    assert np.diff(coarse["pinion_angle"]) == pytest.approx(np.deg2rad(1), rel=1e-9)  # as asked for
    assert fine.summary["torque_mean"] == pytest.approx(coarse.summary["torque_mean"], rel=1e-4)


def test_maneuvers_of_which_one_lost_its_teeth_are_joined() -> None:
    """Flanks that carry nothing have no pressure: a load test would end in a traceback instead."""
    time, lost = np.array([0.0, 1.0]), Outcome(Status.CONTACT_LOST, "the teeth carry no load")
    raised = SceneRun(Outcome(Status.OK), {"time": time, "work_drive": time, "mesh_pressure": 1e9 * time})
    lowered = SceneRun(lost, {"time": time, "work_drive": 2 * time})
    both = joined([raised, lowered])
    assert both.outcome.status is Status.CONTACT_LOST
    assert {name: values.tolist() for name, values in both.signals.items()} == {
        "time": [0.0, 1.0, 1.0, 2.0],
        "work_drive": [0.0, 1.0, 1.0, 3.0],
    }
