"""Laws of the whole gear, kept by the equilibrium model, and by the dynamic one where inertia could matter.

Domain of the formulas: a guided rack with uniformly loaded flanks. The model's rack is free to tilt and
roll, and its flanks share the load as they please; where that matters the tolerance says how much.
"""

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.forces.yoke import seat_wedge_factor
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.multibody.model import build_model
from rps_exudyn.multibody.recorder import Recorder
from rps_exudyn.multibody.solve import SolverPlan, solve
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.solvers.closed_form import free_torque, mean_state, runout_harmonics

GEAR = SteeringGear()
PITCH = 1 / GEAR.pinion.teeth  # [turns]
FRICTIONLESS = {"mesh.friction": 0.0, "yoke.friction": 0.0, "bush.drag": 0.0, "bearing.friction_torque": 0.0}


def turned(
    settings: dict[str, object], fidelity: str | Fidelity = "quasi-static", turns: float = PITCH
) -> Result:
    """The gear with some parameters changed, turned over whole tooth pitches."""
    result = rps.run("free-pinion-torque", GEAR.replace(settings), fidelity=fidelity, turns=turns)
    assert result.status is Status.OK, result.message
    return result


@pytest.mark.parametrize("fidelity", ["quasi-static", "flank"])
def test_without_friction_it_turns_by_itself(fidelity: str) -> None:
    """The mean is zero but for what the contact loses where loaded material passes an edge of the rack,
    0.01 % of the torque with friction; within a pitch the elastic energy of contact and bush swings."""
    result = turned(FRICTIONLESS, fidelity)
    assert abs(result.summary["torque_mean"]) < 2e-4
    assert np.abs(result["pinion_torque"]).max() < 5e-3


def test_without_friction_both_flanks_carry_the_wedged_preload() -> None:
    """N1 = N2 = P / (2 sin alpha_n) on average; the tilting rack takes up to 1 % to the bush."""
    result = turned(FRICTIONLESS)
    wedged = GEAR.yoke.preload / (2 * np.sin(GEAR.pinion.pressure_angle))
    for side in ("drive", "coast"):
        assert result[f"mesh_normal_force_{side}"].mean() == pytest.approx(wedged, rel=0.01)
    drive, coast = result["mesh_normal_force_drive"], result["mesh_normal_force_coast"]
    assert drive.mean() == pytest.approx(coast.mean(), rel=1e-3)


def test_preset_means_agree_with_the_closed_form() -> None:
    """Within 1 %: the closed form guides the rack, the models let it tilt."""
    exact = free_torque(GEAR)
    for fidelity in ("quasi-static", "flank"):
        assert turned({}, fidelity).summary["torque_mean"] == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize(
    ("path", "values"), [("yoke.preload", [150, 300, 600]), ("mesh.friction", [0.05, 0.1, 0.15])]
)
def test_torque_is_linear(path: str, values: list[float]) -> None:
    """Equal steps to 1 %, with the slope of the closed form to 2 %: friction across the rack, taken by its
    guides, is no part of the formula."""
    low, middle, high = (turned({path: value}).summary["torque_mean"] for value in values)
    fraction = (values[1] - values[0]) / (values[2] - values[0])
    assert middle == pytest.approx(low + fraction * (high - low), rel=0.01)
    first, last = (free_torque(GEAR.replace({path: value})) for value in (values[0], values[2]))
    assert high - low == pytest.approx(last - first, rel=0.02)


def test_power_of_the_drive_is_what_friction_takes_and_springs_store() -> None:
    """At every instant: torque times rate = dissipated power + rate of the stored energy. The energy's rate
    is taken by differences over 0.1 degrees, which leaves 0.5 %."""
    fine = Fidelity.preset("quasi-static").replace({"step_angle": "0.1 deg"})
    result = turned({}, fine)
    spent = sum(
        values for name, values in result.signals.items() if name.startswith("work_") and name != "work_drive"
    )
    balance = result["work_drive"] - spent - result["stored_energy"]
    rate = np.gradient(balance, result["work_drive"])
    assert np.abs(rate).max() < 0.005


def test_loss_shares_add_up_to_the_closed_forms() -> None:
    result = turned({})
    angle = np.ptp(result["pinion_angle"])
    mean = mean_state(GEAR, 1, 0.0)
    for name, loss in (
        ("mesh", mean.mesh_loss),
        ("seat", mean.plunger_loss),
        ("bush", mean.bush_loss),
        ("bearing", mean.bearing_loss),
    ):
        assert result[f"work_{name}_friction"][-1] / angle == pytest.approx(loss, rel=0.02)


def test_seat_friction_has_the_wedge_factor() -> None:
    result = turned({})
    friction = result["work_seat_friction"][-1] / np.ptp(result["rack_displacement"])
    kappa = seat_wedge_factor(GEAR.yoke.seat_angle)
    assert friction == pytest.approx(kappa * GEAR.yoke.friction * result["seat_force"].mean(), rel=2e-3)


@pytest.mark.parametrize("runout", [20e-6, 40e-6])
def test_runout_makes_one_wave_per_turn(runout: float) -> None:
    """First order to 5 %: 2.6 % are found. The formula leaves out that the friction's lever changes with the
    centre distance, 6 % of the amplitude in the cosine."""
    settings = {"pinion.runout": runout}
    result = turned(settings, turns=1.0)
    angle, torque = result["pinion_angle"], result["pinion_torque"]
    waves = [np.trapezoid(torque * wave(angle), angle) / np.pi for wave in (np.cos, np.sin)]
    expected = runout_harmonics(GEAR.replace(settings))
    amplitude = np.hypot(*expected)
    assert result.summary["torque_first_order"] == pytest.approx(amplitude, rel=0.05)
    assert waves == pytest.approx(expected, abs=0.06 * amplitude)


def test_condensed_bush_is_the_chain() -> None:
    """The chain's static stiffness is condensed exactly; in slow turning its inertia does nothing."""
    chain = turned({}, Fidelity.preset("flank").replace({"bush": "chain"}))
    condensed = turned({}, "flank")
    # Newton's method in the stiff chain misses 1.2e-4
    assert chain.summary["torque_mean"] == pytest.approx(condensed.summary["torque_mean"], rel=2e-4)
    assert np.std(chain["rack_y"] - condensed["rack_y"]) < 2e-8


def test_dynamics_are_the_equilibria_when_slow() -> None:
    """RMS over a pitch below 0.08 % of the mean, at 15 and at 60 rpm: vibration as a tooth enters."""
    for speed in ("15 rpm", "60 rpm"):
        settings: dict[str, object] = {"test.speed": speed}
        still, moving = (turned(settings, preset) for preset in ("quasi-static", "flank"))
        difference = np.interp(still["pinion_angle"], moving["pinion_angle"], moving["pinion_torque"])
        difference -= still["pinion_torque"]
        assert np.std(difference) < 8e-4 * still.summary["torque_mean"]


def test_yokenut_is_met_alike_by_statics_and_dynamics() -> None:
    """No clearance, 40 um of runout: the plunger bottoms once per turn, and the torque more than doubles."""
    settings = {"pinion.runout": 40e-6, "yoke.clearance": 0.0}
    still, moving = (turned(settings, preset, turns=1.0) for preset in ("quasi-static", "flank"))
    assert still["yokenut_force"].max() > 900
    assert still["yokenut_force"].min() == 0
    assert still["pinion_torque"].max() > 2 * turned({}).summary["torque_mean"]
    assert moving.summary["torque_mean"] == pytest.approx(still.summary["torque_mean"], rel=1e-3)
    assert moving.summary["torque_peak_to_peak"] == pytest.approx(
        still.summary["torque_peak_to_peak"], rel=5e-3
    )


@pytest.mark.parametrize(
    "settings", [{"installation.axis_offset": "-0.2 mm"}, {"installation.angle_error": "0.3 deg"}]
)
def test_errors_of_the_installation_find_their_equilibrium(settings: dict[str, object]) -> None:
    """Far from the design position the start is found by creeping; the mean stays within 3 %."""
    design = turned({}).summary["torque_mean"]
    assert turned(settings).summary["torque_mean"] == pytest.approx(design, rel=0.03)


@pytest.mark.parametrize("turn", [0.7e-3, -0.7e-3])
def test_lead_error_makes_the_teeth_of_a_turned_rack_parallel_again(turn: float) -> None:
    """Both take the contact lines off each other by an angle over the face; together they leave the ripple of
    the aligned gear to 13 %, and 15 times less than the turned rack has alone.

    A turned rack keeps its normal pitch, a lead error the transverse one: the difference, tan(beta_b)
    times the angle, moves the mean by 2 %, the same with the lead error and without.
    """
    pair = GearPair.of(GEAR)
    lead = -turn * pair.face_width * np.cos(pair.alpha_t)
    guided = Fidelity.preset("quasi-static").replace({"rack": "guided"})
    line = {"mesh.law": "line", "mesh.line_stiffness": 13.8265e9}  # c', soft enough to touch the whole face
    askew = line | {"installation.angle_error": turn}
    aligned, turned_rack = turned(line, guided).summary, turned(askew, guided).summary
    parallel = turned(askew | {"pinion.lead_error": lead}, guided).summary
    ripple = aligned["torque_peak_to_peak"]
    assert parallel["torque_peak_to_peak"] == pytest.approx(ripple, rel=0.2)
    assert turned_rack["torque_peak_to_peak"] > 10 * ripple
    assert parallel["torque_mean"] == pytest.approx(turned_rack["torque_mean"], rel=3e-3)
    assert np.sign(parallel["torque_mean"] - aligned["torque_mean"]) == np.sign(turn)


def test_exudyn_users_find_their_sensors() -> None:
    """The model's own record and Exudyn's sensors show the same motion."""
    model = build_model(GEAR, Fidelity.preset("flank"))
    recorder = Recorder(model).attach()
    model.mbs.Assemble()
    outcome = solve(model.mbs, SolverPlan(end_time=0.05, steps=10, relative_tolerance=1e-4))
    assert outcome.status is Status.OK
    sensed = model.mbs.GetSensorStoredData(model.sensors["rack"])
    recorded = recorder.record().of("rack")[:, 0]
    assert len(sensed) == len(recorded)
    assert sensed[:, 1] == pytest.approx(recorded, abs=1e-15)


def test_a_period_stands_for_all() -> None:
    """Two turns of an eccentric pinion are one turn twice; followed angle by angle they are the same, but for
    the chords between other angles: across the kinks where teeth enter they miss 0.1 %."""
    eccentric: dict[str, object] = {"pinion.runout": 40e-6}
    once, twice, apart = (turned(eccentric, turns=turns) for turns in (1.0, 2.0, 2.01))
    first = slice(0, len(once["time"]) - 1)
    assert twice["pinion_torque"][first] == pytest.approx(once["pinion_torque"][first], rel=1e-12)
    followed = np.interp(twice["pinion_angle"], apart["pinion_angle"], apart["pinion_torque"])
    assert np.abs(followed - twice["pinion_torque"]).max() < 1.5e-3 * twice.summary["torque_mean"]
