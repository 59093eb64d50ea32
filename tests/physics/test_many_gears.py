"""Gears in one compiled loop end as single runs of them end; what the loop does not find is run singly."""

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.outcome import Status
from rps_exudyn.simulate.loop_knows import why_not
from rps_exudyn.solvers.gear_numbers import REST_GAP
from rps_exudyn.solvers.gear_rows import ZONE_COLUMNS, packed_rows, rows_of_table

SCENE, QUASI_STATIC = "free-pinion-torque", Fidelity.preset("quasi-static")
MEAN, RIPPLE = 1e-4, 0.01  # of single runs in steps of 1 degree, as `batch` states
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


def test_gears_in_the_loop_are_single_runs(gear: rps.SteeringGear, found: rps.Batch) -> None:
    assert found.in_loop.mean() > 0.8
    angles = np.radians(np.linspace(-59, -1, 30))
    curves = found.curves("pinion_torque", angles, direction=-1)
    for row in np.flatnonzero(found.in_loop)[:4].tolist():
        alone = single(gear, table(), row)
        assert (found.statuses[row], found.messages[row]) == (alone.status, alone.message)
        ripple = alone.summary["torque_peak_to_peak"]
        assert found.summary["torque_mean"][row] == pytest.approx(alone.summary["torque_mean"], rel=MEAN)
        assert found.summary["torque_peak_to_peak"][row] == pytest.approx(ripple, rel=RIPPLE)
        assert found.summary["loss_share_mesh"][row] == pytest.approx(
            alone.summary["loss_share_mesh"], rel=1e-3
        )
        expected = np.interp(angles, alone["pinion_angle"][::-1], alone["pinion_torque"][::-1])
        assert curves[row] == pytest.approx(expected, abs=RIPPLE * ripple)


def test_gears_that_do_not_run_keep_their_cause(gear: rps.SteeringGear, found: rps.Batch) -> None:
    assert found.statuses[NO_GEAR] is Status.INVALID
    assert "mesh.friction is -0.1" in found.messages[NO_GEAR]
    assert not found.in_loop[[NO_GEAR, TOO_STRONG]].any()
    settings = {path: float(column[TOO_STRONG]) for path, column in table().items()}
    with pytest.raises(InputError, match="more than the teeth carry") as refused:
        rps.run(SCENE, gear.replace(settings), fidelity="quasi-static")
    assert found.messages[TOO_STRONG] == " ".join(refused.value.problems)
    assert np.isnan(found.summary["torque_mean"][[NO_GEAR, TOO_STRONG]]).all()


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


def test_numbers_of_rows_are_those_of_packed_gears() -> None:
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
        rows = rows_of_table(gear, QUASI_STATIC, values)
        gears = [gear.replace({path: float(v[i]) for path, v in values.items()}) for i in range(8)]
        exact = packed_rows(gears, QUASI_STATIC)
        compared = np.isfinite(exact.numbers).all(axis=0)  # no relief begins at infinity
        compared[REST_GAP] = False  # which the loop finds
        size = np.abs(exact.numbers[:, compared]).max(axis=0)
        error = np.abs(rows.numbers[:, compared] - exact.numbers[:, compared])
        allowed = np.where(np.isin(np.flatnonzero(compared), ZONE_COLUMNS), 1e-4, 1e-9)
        assert (error <= allowed * size).all()


@pytest.mark.parametrize(
    ("scene", "changes", "values", "sentence"),
    [
        ("reversal", {}, {"yoke.preload": [300.0]}, "knows the scenes free-pinion-torque"),
        (SCENE, {"test.path": "lock-to-lock"}, {"yoke.preload": [300.0]}, "one-way and there-and-back"),
        (SCENE, {"mesh.law": "teeth"}, {"yoke.preload": [300.0]}, "no teeth that bend"),
        (SCENE, {"yoke.friction_law": "bristle"}, {"yoke.preload": [300.0]}, "Coulomb's friction alone"),
        (SCENE, {}, {"pinion.teeth": [6]}, "differ in pinion.teeth"),
        (SCENE, {}, {"yoke.preload": ["300 N"]}, "no plain numbers"),
    ],
)
def test_what_the_loop_does_not_know_is_said(
    scene: str, changes: dict[str, str], values: dict[str, list[object]], sentence: str
) -> None:
    gear = rps.SteeringGear().replace(changes)
    assert sentence in why_not(scene, gear, QUASI_STATIC, values)


def test_few_gears_are_run_singly(gear: rps.SteeringGear) -> None:
    found = rps.batch(SCENE, gear, {"yoke.preload": [290.0, 310.0]}, keep="torque")
    assert not found.in_loop.any()
    assert "too few gears" in found.alone


def test_what_to_keep_is_one_of_two(gear: rps.SteeringGear) -> None:
    with pytest.raises(InputError, match="signals or torque"):
        rps.batch(SCENE, gear, {"yoke.preload": [300.0]}, keep="all")  # type: ignore[arg-type]
