"""Gears computed together end as single runs of them end; what is not found so is run singly."""

from pathlib import Path

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.outcome import Status
from rps_exudyn.simulate.gear_table import UNSUPPORTED, unsupported_reason
from rps_exudyn.solvers.many_gears import REST_GAP, ZONE_COLUMNS, as_numbers, packed, packed_table

SCENE, QUASI_STATIC = "free-pinion-torque", Fidelity.preset("quasi-static")
MEAN, RIPPLE = 1e-5, 1e-3  # of single runs, as `batch` states
GEARS = 36
NO_GEAR, TOO_STRONG = 5, 9  # rows with a negative friction, and with a load that no teeth carry


def table(gears: int = GEARS) -> dict[str, np.ndarray]:
    """Random errors and loads; two of the gears have no run."""
    rng = np.random.default_rng(3)
    values = {
        "pinion.runout": rng.uniform(0, 20e-6, gears),
        "pinion.runout_angle": rng.uniform(0, 2 * np.pi, gears),
        "mesh.friction": rng.uniform(0.08, 0.12, gears),
        "yoke.preload": rng.uniform(250, 350, gears),
    }
    values["mesh.friction"][NO_GEAR], values["yoke.preload"][TOO_STRONG] = -0.1, 5e6
    return values


@pytest.fixture(scope="module")
def gear() -> rps.SteeringGear:
    return rps.SteeringGear().replace({"test.turns": 1 / 6, "test.direction": -1})


@pytest.fixture(scope="module")
def found(gear: rps.SteeringGear) -> rps.Batch:
    return rps.batch(SCENE, gear, table(), keep="torque")


def single(gear: rps.SteeringGear, values: dict[str, np.ndarray], row: int) -> rps.Result:
    settings = {path: float(column[row]) for path, column in values.items()}
    return rps.run(SCENE, gear.replace(settings), fidelity="quasi-static")


def test_gears_together_are_single_runs(gear: rps.SteeringGear, found: rps.Batch) -> None:
    assert found.in_loop.mean() > 0.8
    angles = np.radians(np.linspace(-59, -1, 30))
    curves = found.curves("pinion_torque", angles, direction=-1)
    for row in np.flatnonzero(found.in_loop)[:4].tolist():
        alone = single(gear, table(), row)
        assert (found.statuses[row], found.messages[row]) == (alone.status, alone.message)
        ripple = alone.summary["torque_peak_to_peak"]
        assert found.summary["torque_mean"][row] == pytest.approx(alone.summary["torque_mean"], rel=MEAN)
        assert found.summary["torque_peak_to_peak"][row] == pytest.approx(ripple, rel=RIPPLE)
        expected = np.interp(angles, alone["pinion_angle"][::-1], alone["pinion_torque"][::-1])
        assert curves[row] == pytest.approx(expected, abs=0.01 * ripple)


def test_what_is_kept_changes_no_number(gear: rps.SteeringGear, found: rps.Batch) -> None:
    whole = rps.batch(SCENE, gear, table())
    assert whole.found is not None
    assert found.found is not None
    assert np.array_equal(whole.in_loop, found.in_loop)
    assert set(whole.summary) == set(found.summary)
    for name, values in found.summary.items():
        assert np.array_equal(values, whole.summary[name], equal_nan=True)
    assert set(found.found.signals) == {"time", "pinion_angle", "pinion_torque"}
    assert {"rack_roll", "seat_force", "mesh_pressure", "stored_energy"} < set(whole.found.signals)


def test_gears_that_do_not_run_keep_their_cause(gear: rps.SteeringGear, found: rps.Batch) -> None:
    assert found.statuses[NO_GEAR] is Status.INVALID
    assert "mesh.friction is -0.1" in found.messages[NO_GEAR]
    assert not found.in_loop[[NO_GEAR, TOO_STRONG]].any()
    settings = {path: float(column[TOO_STRONG]) for path, column in table().items()}
    with pytest.raises(InputError, match="more than the teeth carry") as refused:
        rps.run(SCENE, gear.replace(settings), fidelity="quasi-static")
    assert found.messages[TOO_STRONG] == " ".join(refused.value.problems)
    assert np.isnan(found.summary["torque_mean"][[NO_GEAR, TOO_STRONG]]).all()


def test_a_gear_that_two_values_together_forbid_keeps_its_cause(gear: rps.SteeringGear) -> None:
    """Each alone could be: a long seat, and a wide one."""
    length, angle = np.full(24, gear.yoke.seat_length), np.full(24, gear.yoke.seat_angle)
    length[-2:], angle[[0, -1]] = 23.6e-3, np.radians(68)
    found = rps.batch(SCENE, gear, {"yoke.seat_length": length, "yoke.seat_angle": angle})
    assert found.in_loop[0]
    assert found.in_loop[-2]
    assert found.statuses[-1] is Status.INVALID
    assert "The seat's corners reach" in found.messages[-1]


def test_alike_pitches_are_repeated() -> None:
    gear, rng = rps.SteeringGear(), np.random.default_rng(4)
    values = {"yoke.preload": rng.uniform(280, 320, 12)}
    found = rps.batch(SCENE, gear, values, keep="torque")
    alone = single(gear, values, 7)
    assert found.in_loop[7]
    for name in ("torque_mean", "torque_on_centre", "torque_off_centre", "rack_gain", "loss_share_seat"):
        assert found.summary[name][7] == pytest.approx(alone.summary[name], rel=MEAN)
    assert found.summary["torque_peak_to_peak"][7] == pytest.approx(
        alone.summary["torque_peak_to_peak"], rel=RIPPLE
    )


def test_formulas_stand_where_they_hold(gear: rps.SteeringGear) -> None:
    """Of no gear whose axis is offset."""
    values = {
        "yoke.preload": np.linspace(290.0, 310.0, 12),
        "installation.axis_offset": np.array([0.0, 5e-6] * 6),
    }
    found = rps.batch(SCENE, gear, values, keep="torque")
    assert found.in_loop.all()
    formula = found.summary["torque_closed_form"]
    assert np.isnan(formula).tolist() == [False, True] * 6
    assert formula[0] == single(gear, values, 0).summary["torque_closed_form"]


def test_records_of_a_table_are_those_of_packed_gears() -> None:
    """Random columns of all kinds: polynomials where they are exact, packed gears where not."""
    gear, rng = rps.SteeringGear(), np.random.default_rng(5)
    spread = {
        "installation.angle_error": 1e-3 * rng.normal(size=8),
        "pinion.profile_slope": 3e-6 * rng.normal(size=8),
        "bush.drag": rng.uniform(10, 40, 8),
        "yoke.seat_stiffness": gear.yoke.seat_stiffness * rng.uniform(0.5, 2, 8),
        "pinion.helix_angle": np.radians(rng.uniform(24, 26, 8)),
    }
    for paths in (list(spread)[:3], list(spread)):
        values = {path: spread[path] for path in paths}
        quick = as_numbers(packed_table(gear, QUASI_STATIC, values))
        gears = [gear.replace({path: float(v[i]) for path, v in values.items()}) for i in range(8)]
        exact = as_numbers(packed(gears, QUASI_STATIC))
        compared = np.isfinite(exact).all(axis=0)  # no relief begins at infinity
        compared[REST_GAP] = False  # which the preload's adjustment finds
        size = np.abs(exact[:, compared]).max(axis=0)
        error = np.abs(quick[:, compared] - exact[:, compared])
        allowed = np.where(np.isin(np.flatnonzero(compared), ZONE_COLUMNS), 1e-4, 1e-9)
        assert (error <= allowed * size).all()


@pytest.mark.parametrize(
    ("scene", "changes", "values", "sentence"),
    [
        ("reversal", {}, {"yoke.preload": [300.0]}, UNSUPPORTED["scene"]),
        (SCENE, {"rack.side_force": "10 N"}, {"yoke.preload": [300.0]}, UNSUPPORTED["parts"]),
        (SCENE, {"yoke.friction_law": "bristle"}, {"yoke.preload": [300.0]}, UNSUPPORTED["friction"]),
        (SCENE, {}, {"pinion.teeth": [6]}, "differ in pinion.teeth"),
        (SCENE, {}, {"rack.travel": [0.14]}, "differ in rack.travel"),
        (SCENE, {"test.path": "lock-to-lock"}, {"pinion.normal_module": [0.0018]}, "differ in pinion.normal"),
        (SCENE, {}, {"yoke.preload": ["300 N"]}, "not plain numbers"),
    ],
)
def test_what_asks_for_single_runs_is_said(
    scene: str, changes: dict[str, str], values: dict[str, list[object]], sentence: str
) -> None:
    gear = rps.SteeringGear().replace(changes)
    assert sentence in unsupported_reason(scene, gear, QUASI_STATIC, values)


def test_another_model_asks_for_single_runs() -> None:
    values = {"yoke.preload": [300.0]}
    assert unsupported_reason(SCENE, rps.SteeringGear(), Fidelity.preset("flank"), values)
    coarse = QUASI_STATIC.replace({"step_angle": "2 deg"})
    assert not unsupported_reason(SCENE, rps.SteeringGear(), coarse, values)


def test_what_asks_for_single_runs_stands_in_the_pages() -> None:
    page = " ".join((Path(__file__).parents[2] / "docs" / "equilibria.md").read_text().split())
    for sentence in UNSUPPORTED.values():
        for part in sentence.split("{path}"):
            assert part.strip() in page


def test_few_gears_are_run_singly(gear: rps.SteeringGear) -> None:
    found = rps.batch(SCENE, gear, {"yoke.preload": [290.0, 310.0]}, keep="torque")
    assert not found.in_loop.any()
    assert "too few gears" in found.single_run_reason


def test_a_test_that_leaves_the_teeth_is_the_cause_of_every_row(gear: rps.SteeringGear) -> None:
    values = {"yoke.preload": np.linspace(290.0, 310.0, 12)}
    found = rps.batch(SCENE, gear.replace({"test.turns": 5}), values)
    assert not found.in_loop.any()
    assert all("teeth for rack.travel" in said for said in found.messages)


def test_what_to_keep_is_one_of_two(gear: rps.SteeringGear) -> None:
    with pytest.raises(InputError, match="signals or torque"):
        rps.batch(SCENE, gear, {"yoke.preload": [300.0]}, keep="all")  # type: ignore[arg-type]
