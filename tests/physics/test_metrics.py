"""Metrics of signals whose answers are known in closed form: harmonics, Coulomb loops, pulses."""

import numpy as np
import pytest

from rps_exudyn.analysis.efficiency import LoadTest, describe_load_test, free_torque_of, measured_load_test
from rps_exudyn.analysis.harmonics import order_amplitude
from rps_exudyn.analysis.hysteresis import describe_reversal, loop_area
from rps_exudyn.analysis.impacts import describe_impacts, find_impacts
from rps_exudyn.analysis.passes import passes
from rps_exudyn.analysis.rack_motion import describe_rack
from rps_exudyn.analysis.torque import describe_directions, describe_on_centre, describe_torque
from rps_exudyn.analysis.work_balance import describe_balance, describe_losses
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.rounding import rounded_range
from rps_exudyn.scenes.metrics import metrics_of_motion
from verification.orders import loss_torques, order_spectrum

TURN = 2 * np.pi


def there_and_back(steps: int = 721, turns: float = 2.0) -> np.ndarray:
    """Pinion angles [rad] to `turns` and back to zero."""
    forward = np.linspace(0, TURN * turns, steps)
    return np.concatenate([forward, forward[-2::-1]])


# --- orders ----------------------------------------------------------------------------------------
def known_curve(angle: np.ndarray) -> np.ndarray:
    return 0.6 + 0.05 * np.cos(angle + 0.3) + 0.02 * np.cos(6 * angle - 1.2) + 0.004 * np.cos(12 * angle + 2)


@pytest.mark.parametrize(
    "angle",
    [
        np.linspace(0.4, 0.4 + 1.7 * TURN, 2000),
        np.linspace(9.0, 9.0 - 1.7 * TURN, 2000),
        TURN * 1.3 * np.linspace(0, 1, 3000) ** 1.3,  # uneven
    ],
    ids=["rising", "falling", "uneven"],
)
def test_spectrum_finds_amplitudes_and_phases(angle: np.ndarray) -> None:
    spectrum = order_spectrum(angle, known_curve(angle), 18)
    expected = np.zeros(19)
    expected[[0, 1, 6, 12]] = 0.6, 0.05, 0.02, 0.004
    np.testing.assert_allclose(spectrum.amplitude, expected, atol=2e-6)
    np.testing.assert_allclose(spectrum.phase[[1, 6, 12]], [0.3, -1.2, 2], atol=2e-3)
    assert spectrum.orders.tolist() == list(range(19))


def test_tooth_order_needs_one_pitch_and_the_spectrum_one_turn() -> None:
    angle = np.linspace(0, TURN / 6 * 1.2, 200)
    assert order_amplitude(angle, 0.02 * np.cos(6 * angle), 6) == pytest.approx(0.02, rel=1e-3)
    assert order_amplitude(angle, angle, 1) is None
    assert order_spectrum(angle, angle, 3) is None


def test_a_tooth_order_needs_more_than_five_points_in_a_pitch() -> None:
    metrics = [
        describe_torque(angle, known_curve(angle), 6)
        for angle in (np.linspace(0, TURN / 3, 2 * points + 1) for points in (5, 11))
    ]
    assert ["torque_peak_to_peak" in each for each in metrics] == [True, True]
    assert ["torque_tooth_order" in each for each in metrics] == [False, True]


def test_spectrum_ends_with_the_highest_resolved_order() -> None:
    angle = np.linspace(0, TURN, 61)
    assert order_spectrum(angle, np.cos(angle), 100).orders[-1] == 10


# --- passes and directions -----------------------------------------------------------------------
def test_passes_are_monotone_and_leave_out_standstill_and_jitter() -> None:
    angle = np.concatenate([np.zeros(5), np.linspace(0, 2, 50), np.full(5, 2.0), np.linspace(2, -1, 70)])
    angle += 1e-4 * np.sin(np.arange(angle.size) * 1.7)
    first, second = passes({"pinion_angle": angle, "time": np.arange(angle.size)})
    assert (first.direction, second.direction) == (1, -1)
    assert (np.diff(first.angle) > 0).all()
    assert (np.diff(second.angle) < 0).all()
    assert first.angle[-1] == angle.max()
    assert second.angle[-1] == angle.min()


def test_records_put_together_are_parted_where_one_ends() -> None:
    """The second begins where elasticity has it, beyond the end of the first."""
    angle = np.concatenate([np.linspace(0, 1, 11), np.linspace(1.02, 0, 11)])
    time = np.concatenate([np.arange(11.0), np.arange(10.0, 21)])
    first, second = passes({"time": time, "pinion_angle": angle})
    assert (first.angle[-1], second.angle[0], first.angle.size, second.angle.size) == (1, 1.02, 11, 11)


@pytest.mark.parametrize("angle", [np.zeros(0), np.zeros(4), np.array([0, np.nan, 1.0])])
def test_pinion_that_never_moves_makes_no_pass(angle: np.ndarray) -> None:
    assert passes({"pinion_angle": angle}) == []


def test_a_gear_that_stays_has_no_gain_and_no_transmission_error() -> None:
    still = {"time": np.arange(5.0), "pinion_angle": np.ones(5), "rack_displacement": np.zeros(5)}
    assert metrics_of_motion(still, SteeringGear()) == {}


def test_directions_are_compared_over_common_angles_only() -> None:
    angle = np.concatenate([np.linspace(0, 4, 801), np.linspace(3.995, 1, 600)])
    forward = np.arange(angle.size) < 801
    torque = np.where(forward, 0.6 + 0.1 * angle, -0.5)  # mean of the first over 1..4 is 0.85
    metrics = describe_directions(passes({"pinion_angle": angle, "pinion_torque": torque}))
    assert metrics["torque_mean_forward"] == pytest.approx(0.85, rel=1e-3)
    assert metrics["torque_mean_backward"] == pytest.approx(0.5)
    assert metrics["torque_direction_difference"] == pytest.approx(0.35, rel=1e-3)
    assert describe_directions(passes({"pinion_angle": angle[:500], "pinion_torque": torque[:500]})) == {}


def test_on_centre_window_and_outside() -> None:
    angle = np.deg2rad(np.linspace(-300, 300, 6001))
    torque = 0.6 + np.where(np.abs(angle) <= np.deg2rad(100), 0.01, 0.04) * np.sin(6 * angle)
    metrics = describe_on_centre(passes({"pinion_angle": angle, "pinion_torque": torque}), teeth=6)
    assert metrics["torque_on_centre"] == pytest.approx(0.6, abs=1e-4)
    assert metrics["torque_on_centre_variation"] == pytest.approx(0.02, rel=1e-3)
    assert metrics["torque_off_centre_variation"] == pytest.approx(0.08, rel=1e-3)
    backward = {"pinion_angle": -angle, "pinion_torque": -torque}
    assert describe_on_centre(passes(backward), teeth=6)["torque_on_centre"] == pytest.approx(0.6, abs=1e-4)
    short = {"pinion_angle": angle[3000:3100], "pinion_torque": torque[3000:3100]}
    assert describe_on_centre(passes(short), teeth=6) == {}


# --- load test -------------------------------------------------------------------------------------
def test_efficiencies_follow_from_the_two_means() -> None:
    load, gain, free = 98.0665, 0.035 / TURN, 0.1
    ideal = load * gain
    angle = there_and_back()
    raising = np.arange(angle.size) <= 720
    torque = np.where(raising, ideal + free, ideal - free) + 0.02 * np.cos(6 * angle)
    signals = {"pinion_angle": angle, "pinion_torque": torque}
    test = measured_load_test(signals, load, gain, free, TURN / 6)
    metrics = describe_load_test(test)
    assert metrics["torque_forward"] == pytest.approx(ideal + free, rel=1e-4)
    assert metrics["efficiency_forward"] == pytest.approx(1 / (1 + free / ideal), rel=1e-3)
    assert metrics["efficiency_reverse"] == pytest.approx(1 - free / ideal, rel=1e-3)
    assert metrics["efficiency_forward_net"] == pytest.approx(1, rel=1e-3)
    assert metrics["efficiency_reverse_net"] == pytest.approx(1, rel=1e-3)
    assert metrics["efficiency_ratio"] == pytest.approx(1 - (free / ideal) ** 2, rel=1e-3)
    assert not test.self_locking
    with pytest.raises(ValueError, match="raising and of lowering"):
        measured_load_test(
            {name: values[:300] for name, values in signals.items()}, load, gain, free, TURN / 6
        )


def test_weight_that_must_be_pushed_down_is_self_locking() -> None:
    assert LoadTest(10, 0.1, 0.7, -0.5, 0.6).self_locking
    assert "efficiency_forward" not in describe_load_test(LoadTest(0, 0, 0.6, -0.6, 0.6))


@pytest.mark.parametrize("turns", [1.0, 0.25, 1.9])
def test_efficiencies_are_means_over_whole_pitches(turns: float) -> None:
    """Law: the ripple of the teeth averages out, whatever the turns recorded. Trapezoids of a sine over a
    whole period are exact but for the last step, which is interpolated: 1e-3 of the ripple."""
    forth = np.linspace(0, turns * TURN, 1500)
    angle = np.concatenate([forth, forth[-2::-1]])
    torque = np.where(np.arange(angle.size) < forth.size, 0.8, 0.3) + 0.1 * np.sin(6 * angle)
    test = measured_load_test({"pinion_angle": angle, "pinion_torque": torque}, 100.0, 5e-3, 0.1, TURN / 6)
    assert (test.torque_forward, test.torque_reverse) == pytest.approx((0.8, 0.3), abs=1e-4)
    free = {"pinion_angle": forth, "pinion_torque": 0.6 + 0.1 * np.sin(6 * forth)}
    backward = {"pinion_angle": -forth, "pinion_torque": -0.6 + 0.1 * np.sin(6 * forth)}
    assert free_torque_of(free, TURN / 6) == pytest.approx(0.6, abs=1e-4)
    assert free_torque_of(backward, TURN / 6) == pytest.approx(0.6, abs=1e-4)


def test_numbers_that_are_no_efficiencies_are_said_with_their_reason() -> None:
    """Reverse below 0: self-locking. Net above 1: friction under load is less than the free torque tared."""
    assert list(LoadTest(10, 1.0, 1.2, 0.8, 0.2).remarks()) == []
    locking, above = (remark.text for remark in LoadTest(10, 0.55, 1.19, -0.08, 0.64).remarks())
    assert locking.startswith("the gear is self-locking: the weight must be pushed down with 0.08 N m")
    assert "friction takes 0.63 N m and the weight gives 0.55" in locking
    assert above.startswith("efficiency_reverse_net is 101.8% and no efficiency")
    assert "friction takes 0.63 N m, and the free torque of 0.64 N m is tared" in above


def test_a_net_efficiency_is_left_out_where_the_free_torque_takes_nearly_all() -> None:
    """Means right to half a percent would leave it wrong by a tenth; of many gears it is nan."""
    cancelling, usual = (10.0, 0.4, 1.05, -0.99, 1.0), (10.0, 1.0, 2.0, 0.2, 1.0)
    test = LoadTest(*cancelling)
    assert not {"efficiency_forward_net", "efficiency_reverse_net"} & describe_load_test(test).keys()
    _, forward, reverse = (remark.text for remark in test.remarks())
    assert forward.startswith("efficiency_forward_net is omitted: while the weight is raised, 0.05 N m")
    assert reverse.startswith("efficiency_reverse_net is omitted: while the weight is lowered, 0.01 N m")
    both = LoadTest(*(np.array(numbers) for numbers in zip(cancelling, usual, strict=True)))
    assert np.isnan(describe_load_test(both)["efficiency_forward_net"]).tolist() == [True, False]


def test_rounding_is_shown_as_nothing() -> None:
    """A number below what the quantity can mean is 0, with its unit; what it can mean is not."""
    torque, error = SUMMARY["torque_first_order"], SUMMARY["transmission_error_first_order"]
    assert [torque.show(value) for value in (1.264e-16, -3e-9, 2e-6)] == ["0 N m", "0 N m", "2e-06 N m"]
    assert [error.show(value) for value in (5e-11, 2e-9)] == ["0 µm", "0.002 µm"]
    assert SUMMARY["impacts"].show(0.0) == "0"


def test_a_range_has_the_unit_of_its_value() -> None:
    """0.0076 N m are 7.6 N mm: so are the ends of its band, of which one is more than 10 N mm."""
    torque = SUMMARY["torque_first_order"]
    assert rounded_range(torque, 5.5e-3, 11e-3) == "0.0055 to 0.011 N m"
    assert rounded_range(torque, 5.5e-3, 11e-3, 7.6e-3) == "5.5 to 11 N mm"


# --- rack ------------------------------------------------------------------------------------------
def test_transmission_error_is_of_one_direction_and_free_of_lost_motion() -> None:
    angle, gain = there_and_back(), 0.0056
    behind = np.where(np.arange(angle.size) <= 720, -1e-5, 1e-5)
    signals = {
        "pinion_angle": angle,
        "rack_displacement": gain * angle + 4e-5 * np.sin(angle) + behind,
        "rack_y": 3e-6 * np.cos(angle),
        "rack_roll": 1e-3 * np.cos(angle),
        "rack_yaw": 0 * angle,
        "seat_force": 300 + 2 * np.cos(angle),
    }
    metrics = describe_rack(signals, passes(signals), gain)
    assert metrics["transmission_error_peak_to_peak"] == pytest.approx(8e-5, rel=1e-4)
    assert metrics["transmission_error_first_order"] == pytest.approx(4e-5, rel=1e-3)
    assert metrics["rack_lift_range"] == pytest.approx(6e-6)
    assert metrics["rack_roll_range"] == pytest.approx(2e-3)
    assert metrics["rack_yaw_range"] == 0
    assert (metrics["yoke_force_min"], metrics["yoke_force_max"]) == pytest.approx((298, 302))


# --- losses ----------------------------------------------------------------------------------------
def test_loss_shares_and_their_torques() -> None:
    angle = np.linspace(0, -3, 301)
    turned = np.abs(angle)
    signals = {
        "pinion_angle": angle,
        "work_drive": 1.0 * turned,
        "work_mesh_friction": 0.2 * turned + 0.01 * turned**2,
        "work_mesh_damping": 0.01 * turned,
        "work_seat_friction": 0.1 * turned,
        "work_load": -0.6 * turned,
        "stored_energy": 0.06 * turned - 0.01 * turned**2,
    }
    torques = loss_torques(signals)
    np.testing.assert_allclose(torques["mesh"][1:-1], (0.21 + 0.02 * turned)[1:-1], rtol=1e-9)
    np.testing.assert_allclose(torques["seat"], 0.1)
    mesh = 0.63 + 0.09
    assert describe_losses(signals) == pytest.approx(
        {"loss_share_mesh": mesh / (mesh + 0.3), "loss_share_seat": 0.3 / (mesh + 0.3)}
    )
    assert describe_balance(signals) == pytest.approx({"energy_residual": 0.03})


# --- reversal --------------------------------------------------------------------------------------
FRICTION, STIFFNESS = 0.6, 40.0  # [N m], [N m/rad]


def elastic_coulomb(angle: np.ndarray) -> np.ndarray:
    """Torque of a spring that slips at FRICTION."""
    torque = np.zeros_like(angle)
    for i, step in enumerate(np.diff(angle)):
        torque[i + 1] = np.clip(torque[i] + STIFFNESS * step, -FRICTION, FRICTION)
    return torque


@pytest.mark.parametrize("cycles", [1.25, 2.0])
def test_hysteresis_of_a_slipping_spring(cycles: float) -> None:
    """Area 4 F (a - F/k); 90 % of F is reached after 1.9 F/k; the rack lags by twice its own lag."""
    amplitude, lag = 0.5, 2e-5
    angle = amplitude * np.sin(TURN * np.linspace(0, cycles, 20001))
    sense = np.sign(np.gradient(angle))
    signals = {
        "pinion_angle": angle,
        "pinion_torque": elastic_coulomb(angle),
        "rack_displacement": 0.0056 * angle - lag * sense,
    }
    metrics = describe_reversal(signals)
    assert metrics["torque_jump"] == pytest.approx(2 * FRICTION)
    assert metrics["reversal_angle"] == pytest.approx(1.9 * FRICTION / STIFFNESS, rel=1e-3)
    assert metrics["lost_motion"] == pytest.approx(2 * lag, rel=1e-3)
    area = 4 * FRICTION * (amplitude - FRICTION / STIFFNESS)
    assert metrics["hysteresis_area"] == pytest.approx(area, rel=1e-4)


def test_one_way_there_and_back_is_a_cycle_if_it_closes() -> None:
    angle = np.concatenate([np.linspace(0, 1, 101), np.linspace(0.99, 0, 100)])
    torque = np.where(np.arange(201) <= 100, 0.6, -0.4)
    assert loop_area({"pinion_angle": angle, "pinion_torque": torque}) == pytest.approx(1.0, rel=0.01)
    assert loop_area({"pinion_angle": angle[:150], "pinion_torque": torque[:150]}) is None
    assert describe_reversal({"pinion_angle": angle[:90], "pinion_torque": torque[:90]}) == {}


# --- impacts ---------------------------------------------------------------------------------------
def test_half_sine_pulses_are_counted_and_measured() -> None:
    """A half sine of peak F and duration T has the impulse 2 F T / pi and the mean square F^2 / 2."""
    time = np.linspace(0, 0.1, 100001)
    force = np.zeros_like(time)
    for start, duration, peak in ((0.02, 0.004, 100.0), (0.05, 0.002, 60.0)):
        inside = (time > start) & (time < start + duration)
        force[inside] = peak * np.sin(np.pi * (time[inside] - start) / duration)
    displacement = 0.03 * time
    first, second = find_impacts(time, force, displacement)
    assert first.impulse == pytest.approx(2 * 100 * 0.004 / np.pi, rel=1e-4)
    assert second.duration == pytest.approx(0.002, rel=2e-3)
    metrics = describe_impacts({"time": time, "yokenut_force": force, "plunger_displacement": displacement})
    assert metrics["impacts"] == 2
    assert metrics["impact_peak_force"] == pytest.approx(100, rel=1e-4)
    assert metrics["impact_speed"] == pytest.approx(0.03)
    assert metrics["impact_contact_share"] == pytest.approx(0.06, rel=2e-3)
    mean_square = (100**2 * 0.004 + 60**2 * 0.002) / 2 / 0.1
    assert metrics["impact_force_rms"] == pytest.approx(np.sqrt(mean_square), rel=1e-3)


def test_contact_from_the_start_is_no_impact_and_one_at_the_end_counts() -> None:
    time = np.arange(10.0)
    force = np.array([5, 5, 0, 0, 0, 0, 0, 0, 3, 4.0])
    (impact,) = find_impacts(time, force, time)
    assert (impact.start, impact.duration, impact.peak_force) == (7, 2, 4)
    assert "impact_peak_force" not in describe_impacts(
        {"time": time, "yokenut_force": 0 * force, "plunger_displacement": time}
    )
    assert describe_impacts({"time": time}) == {}


def test_a_place_on_the_face_and_a_small_share_are_judged_beside_their_whole() -> None:
    assert SUMMARY["load_centre"].size(1e-6) == 0.01
    assert SUMMARY["loss_share_bush"].size(1e-3) == 0.02
    assert SUMMARY["loss_share_bush"].size(0.3) == 0.3
