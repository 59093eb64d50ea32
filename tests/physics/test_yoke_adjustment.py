"""The turn of the yoke's plug that a fit leads to, against gears that are turned and simulated again."""

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.base.errors import InputError
from rps_exudyn.inference.fitting.adjustment import adjustment_of
from rps_exudyn.inference.fitting.bench_tests import measurement_of
from rps_exudyn.inference.fitting.findings import adjustment_rows, fit_as_dict
from rps_exudyn.inference.fitting.fit import fit
from rps_exudyn.inference.fitting.fitted import Fit
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.limit import Limit
from rps_exudyn.results.requirements import read_limits
from rps_exudyn.results.result import Result
from rps_exudyn.scenes.yoke_setting import turned_back
from rps_exudyn.solvers.yoke_stop import lift_of_torque
from verification.made_up_curves import FREE, BenchNoise, measured_curve, with_noise

NOISE = BenchNoise(0.01, step=0.005, zero=0.02)
TOUCHING = {"pinion.runout": "30 um", "pinion.runout_angle": "50 deg", "yoke.clearance": "10 um"}
TURN = {"test.path": "there-and-back", "test.start_angle": "-180 deg"}


def gear_of(law: str = "line", **settings: object) -> SteeringGear:
    paths = {path.replace("__", "."): value for path, value in settings.items()}
    return SteeringGear().replace(TURN | {"mesh.law": law} | paths)


def run_of(gear: SteeringGear) -> Result:
    return rps.run("free-pinion-torque", gear, fidelity="quasi-static")


def fit_of(gear: SteeringGear, noise: BenchNoise = NOISE) -> Fit:
    """The fit of a gear's free torque, which expects the default gear."""
    result = run_of(gear)
    curve = {"pinion_angle": result["pinion_angle"], "value": result["pinion_torque"]}
    noisy = with_noise(curve, noise, np.random.default_rng(1))
    return fit(measurement_of([measured_curve(noisy, FREE)]), other_law=False)


@cache
def touching(law: str) -> tuple[SteeringGear, Fit]:
    gear = gear_of(law).replace(TOUCHING)
    return gear, fit_of(gear)


def test_turn_back_and_in_again_is_no_turn() -> None:
    gear = SteeringGear()
    again = turned_back(turned_back(gear, 0.7), -0.7)
    assert again.yoke.preload == pytest.approx(gear.yoke.preload, rel=1e-12)
    assert again.yoke.clearance == pytest.approx(gear.yoke.clearance, rel=1e-12)


@pytest.mark.parametrize("law", ["line", "teeth"])
def test_contact_is_found_with_its_depth(law: str) -> None:
    """Runout less clearance is 20 um, at the pinion angle that brings the high point into the mesh."""
    gear, found = touching(law)
    contact = found.adjustment.contact
    assert abs(np.log(contact.depth / 20e-6)) < 1.96 * contact.depth_sd < 0.7
    off = np.angle(np.exp(1j * (contact.angle + gear.pinion.runout_angle)))
    assert abs(off) < np.radians(5)  # one section of the turn
    assert contact.clearance == pytest.approx(10e-6, abs=5e-6)


@pytest.mark.parametrize("law", ["line", "teeth"])
def test_turn_of_the_line_ends_the_contact(law: str) -> None:
    """Turned and simulated again, the gear varies as one without plug, and has the mean that was stated."""
    gear, found = touching(law)
    free = run_of(gear.replace({"yoke.clearance": "1 mm"})).summary
    after = run_of(turned_back(gear, found.adjustment.turn)).summary
    assert run_of(gear).summary["torque_on_centre_variation"] > 10 * free["torque_on_centre_variation"]
    # the spring relaxes by some newton
    assert after["torque_on_centre_variation"] == pytest.approx(free["torque_on_centre_variation"], rel=0.05)
    assert found.adjustment.mean == pytest.approx(after["torque_mean"], abs=1.96 * found.level.sd)


@pytest.mark.parametrize(
    ("settings", "noise"),
    [
        ({"pinion__runout": "30 um"}, NOISE),  # less than the clearance of 50 um
        ({"pinion__runout": "30 um"}, BenchNoise(0.01, coupling=0.1)),  # a wave of any phase
        ({"installation__angle_error": "0.1 deg"}, NOISE),  # a large ripple of the teeth
    ],
)
def test_gears_without_contact_have_none(settings: dict[str, object], noise: BenchNoise) -> None:
    assert fit_of(gear_of("teeth", **settings), noise).adjustment.contact is None


def test_small_excess_is_a_turn_and_a_large_one_another_spring() -> None:
    """The mean of the gear that is adjusted falls as it was aimed: by a turn to 10 % of the fall, as preload
    and rate are the true ones here, by a spring to the interval of the level."""
    gear = gear_of()
    found = fit_of(gear)
    before, half = found.level.value, 1.96 * found.level.sd
    true_mean = run_of(gear).summary["torque_mean"]
    for fall in (0.01, 0.1):
        most = Limit(-np.inf, before - fall + half, "test")
        line = adjustment_of(found, read_limits() | {"free_torque": most})
        assert line.mean == pytest.approx(before - fall, rel=1e-5)
        spring = line.spring_change
        turned = turned_back(gear, line.turn)
        adjusted = turned.replace({"yoke.preload": turned.yoke.preload * (1 + spring)})
        assert (spring < 0) == (fall == 0.1)
        assert (line.turn > 0) == (fall == 0.01)
        assert true_mean - run_of(adjusted).summary["torque_mean"] == pytest.approx(fall, rel=0.1)
        assert line.interval[0] <= line.turn <= line.interval[1]


def test_room_of_the_plug_ends_at_the_limits_of_the_lift() -> None:
    found = fit_of(gear_of())
    line = found.adjustment
    gear, limit = found.gear, read_limits()["rated_lift"].most
    after = turned_back(gear, line.room[1])
    assert lift_of_torque(after, gear.test.lift_torque) == pytest.approx(limit, rel=0.01)
    assert turned_back(gear, line.room[0]).yoke.clearance == pytest.approx(found.runout.interval[1])


def test_one_direction_leads_to_no_turn_and_says_so() -> None:
    found = fit_of(gear_of(), BenchNoise(0.01, one_way=True))
    assert found.adjustment is None
    assert fit_as_dict(found)["adjustment"] is None
    assert dict(adjustment_rows(found))["plug"] == "not identifiable: the free torque has one direction"


def test_words_state_the_numbers_of_the_result() -> None:
    found = touching("line")[1]
    said, line = dict(adjustment_rows(found)), found.adjustment
    assert f"turn back by {np.degrees(line.turn):.0f}\u00b0" in said["plug"]
    assert "plunger touches the plug" in said["once per turn"]
    assert json.loads(json.dumps(fit_as_dict(found)))["adjustment"]["turn"] == line.turn


def test_wrong_limits_are_refused_before_anything_is_read(tmp_path: Path) -> None:
    (tmp_path / "limits.toml").write_text('free_torqe = { most = "1 N*m" }')
    with pytest.raises(InputError, match="free_torqe is no requirement"):
        rps.fit(["no_such_file.csv"], limits=tmp_path / "limits.toml")
