"""Derivatives of metrics by parameters: closed forms, central differences of single runs, kinks, limits."""

import numpy as np
import pytest
from xarray import Dataset

import rps_exudyn as rps
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import FOR_MEANS
from rps_exudyn.scenes.scene import WITHOUT_BARS
from rps_exudyn.simulate.run_plan import Plan
from rps_exudyn.solvers.closed_form import GRAVITY, load_test
from verification.population import random_gears
from verification.slopes import beside_single_runs

TURN = "free-pinion-torque"
GEAR = rps.SteeringGear()
PATHS = [
    "bush.drag",
    "bearing.friction_torque",
    "yoke.preload",
    "mesh.friction",
    "rack.density",
    "pinion.runout",
    "installation.angle_error",
]


@pytest.fixture(scope="module")
def found() -> Dataset:
    return rps.sensitivities(TURN, GEAR, parameters=PATHS, fidelity=FOR_MEANS)


def test_frictions_that_add_have_the_slopes_of_the_closed_form(found: Dataset) -> None:
    """A drag along the rack acts by the travel per radian over the efficiency, as a load; a torque of the
    bearings by itself."""
    slope = found["slope"].sel(metric="torque_mean")
    error = found["error"].sel(metric="torque_mean")
    gain = float(GearPair.of(GEAR).gain)
    forward = load_test(GEAR, 10.0)
    net = gain * GRAVITY * 10.0 / (forward.torque_forward - forward.free_torque)
    assert 0.97 < net < 0.99
    assert float(slope.sel(parameter="bush.drag")) == pytest.approx(gain / net, rel=0.006)
    assert float(slope.sel(parameter="bearing.friction_torque")) == pytest.approx(1, rel=0.002)
    assert float(error.sel(parameter="bush.drag")) < 0.01 * gain
    assert float(slope.sel(parameter="rack.density")) == float(error.sel(parameter="rack.density")) == 0
    assert found["together"].values.tolist() == [True] * 5 + [False, True]


def test_slopes_are_central_differences_of_single_runs(found: Dataset) -> None:
    """Within the error bars, and of what acts clearly within 1 %."""
    for path in PATHS[:4]:
        step = float(found["step"].sel(parameter=path))
        sides = [
            Plan(TURN, GEAR.replace({path: GEAR.value_at(path) + sign * step}), FOR_MEANS).run(WITHOUT_BARS)
            for sign in (1, -1)
        ]
        for name in found["metric"].values.tolist():
            right = (sides[0].summary[name] - sides[1].summary[name]) / (2 * step)
            slope, error = (
                float(found[kind].sel(metric=name, parameter=path)) for kind in ("slope", "error")
            )
            assert slope == pytest.approx(right, rel=1e-9, abs=error)
            if name == "torque_mean":
                assert slope == pytest.approx(right, rel=0.01)


@pytest.mark.long
def test_errors_hold_for_random_gears() -> None:
    """Against central differences of single runs; results/drawing has the shares of 20 gears."""
    found = [
        beside_single_runs(TURN, gear, rps.sensitivities(TURN, gear, fidelity=FOR_MEANS))
        for gear in random_gears(1, 3)
    ]
    difference, error, slope = (
        np.concatenate(each)
        for each in zip(*((one.apart, one.error, one.size) for one in found), strict=True)
    )
    clear = slope > 10 * error
    assert (difference <= error).mean() > 0.99
    assert (difference <= 0.01 * slope)[clear].mean() > 0.98
    assert clear.sum() > 200


def test_error_holds_the_one_sided_slopes_of_a_kink(found: Dataset) -> None:
    """A misalignment either way adds to the ripple: the central difference is no slope."""
    one = found.sel(metric="torque_peak_to_peak", parameter="installation.angle_error")
    step = float(one["step"])
    up = Plan(TURN, GEAR.replace({"installation.angle_error": step}), FOR_MEANS).run(WITHOUT_BARS)
    base = Plan(TURN, GEAR, FOR_MEANS).run(WITHOUT_BARS)
    one_sided = (up.summary["torque_peak_to_peak"] - base.summary["torque_peak_to_peak"]) / step
    assert abs(one_sided - float(one["slope"])) <= 1.5 * float(one["error"])


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        ({"metrics": ["torque_meen"]}, "torque_meen is no metric; the nearest"),
        (
            {"metrics": ["rack_lift"]},
            "free-pinion-torque has no rack_lift; the nearest",
        ),
        (
            {"parameters": ["yoke.preloads"]},
            "yoke.preloads is no number of a gear; the nearest one is yoke.pre",
        ),
        (
            {"parameters": ["pinion.teeth"]},
            "pinion.teeth is a whole number or a choice, which cannot vary by small steps",
        ),
    ],
)
def test_wrong_names_are_one_sentence(wanted: dict[str, list[str]], said: str) -> None:
    with pytest.raises(rps.InputError) as refused:
        rps.sensitivities(TURN, GEAR, fidelity=FOR_MEANS, **wanted)  # type: ignore[arg-type]
    assert [problem.startswith(said) for problem in refused.value.problems] == [True]


def test_a_parameter_at_its_limit_has_a_slope_to_the_side_that_is_allowed() -> None:
    found = rps.sensitivities(
        TURN, GEAR, metrics=["torque_mean"], parameters=["bush.viscous_drag"], fidelity=FOR_MEANS
    )
    gain = float(GearPair.of(GEAR).gain)
    assert float(found["slope"][0, 0]) == pytest.approx(gain**2 * GEAR.test.speed, rel=0.02)  # efficiency
    assert np.isfinite(found["error"].values).all()


def test_metrics_that_gears_together_lack_are_run_singly_where_asked_for() -> None:
    """The face load factor is one; by default the load test leaves it out and computes the gears together."""
    path = {"parameters": ["yoke.preload"], "fidelity": FOR_MEANS}
    asked = rps.sensitivities("load-test", GEAR, ["face_load_factor", "efficiency_forward"], **path)
    usual = rps.sensitivities("load-test", GEAR, **path)
    assert np.isfinite(asked["slope"].values).all()
    assert not asked["together"].values.any()
    assert usual["together"].values.all()
    assert "face_load_factor" not in usual["metric"].values
    slopes = [float(each["slope"].sel(metric="efficiency_forward").values[0]) for each in (asked, usual)]
    assert slopes[0] == pytest.approx(slopes[1], rel=0.01)
