"""Load test, rack push and both ways of a free torque in the loop over many gears end as single runs do."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.outcome import Status
from rps_exudyn.simulate import loop_design
from rps_exudyn.simulate.loop_knows import LEFT_TO_SINGLE_RUNS

MEAN = 1e-4  # of single runs in steps of 1 degree, as `batch` states
CURVE = 0.02  # of the ripple: twice what is stated of its peak to peak, for any angle
SAME_STEP = 1e-5  # of single runs at the loop's own angles: what is left is their first steps
GEARS = 40
NO_GEAR, NO_RUN = 5, 9  # rows with a negative friction, and with a load that no teeth carry
SINGLES = (0, 11, 23)
NUMBER = re.compile(r"\d[\d.]*")


def table(scene: str) -> dict[str, np.ndarray]:
    """Random errors and loads; some of the gears have no run."""
    rng = np.random.default_rng(7)
    values = {
        "pinion.runout": rng.uniform(0, 20e-6, GEARS),
        "mesh.friction": rng.uniform(0.08, 0.12, GEARS),
        "yoke.preload": rng.uniform(270, 330, GEARS),
    }
    values["mesh.friction"][NO_GEAR], values["yoke.preload"][NO_RUN] = -0.1, 5e6
    if scene == "load-test":
        values["test.load_mass"] = rng.uniform(38, 42, GEARS)
        values["test.load_mass"][NO_RUN], values["yoke.preload"][NO_RUN] = 0.0, 300.0
    return values


@dataclass(frozen=True)
class Case:
    """Gears of one scene through the loop, and some of them run singly."""

    scene: str
    gear: rps.SteeringGear
    found: rps.Batch
    alone: dict[int, rps.Result]


@pytest.fixture(
    scope="module",
    params=[
        ("load-test", {"test.direction": -1}, ("torque_forward", "torque_reverse", "efficiency_ratio")),
        ("rack-push", {"test.path": "there-and-back"}, ("push_force_mean",)),
        ("free-pinion-torque", {"test.path": "there-and-back"}, ("torque_mean_backward",)),
    ],
    ids=lambda param: param[0],
)
def case(request: pytest.FixtureRequest) -> tuple[Case, tuple[str, ...]]:
    scene, changes, means = request.param
    gear = rps.SteeringGear().replace({"test.turns": 1 / 6, "mesh.law": "line", **changes})
    values = table(scene)
    alone = {
        row: rps.run(
            scene,
            gear.replace({path: float(column[row]) for path, column in values.items()}),
            fidelity="quasi-static",
        )
        for row in SINGLES
    }
    return Case(scene, gear, rps.batch(scene, gear, values, keep="torque"), alone), means


def test_figures_and_outcomes_are_those_of_single_runs(case: tuple[Case, tuple[str, ...]]) -> None:
    """Means within 1e-4, shares of the losses within 1e-3; remarks quote other angles of the same limits."""
    (case_, means), found = case, case[0].found
    assert found.in_loop.mean() > 0.9
    for row, alone in case_.alone.items():
        assert found.in_loop[row]
        assert found.statuses[row] is alone.status is Status.OK
        assert bool(found.messages[row]) is bool(alone.message)
        for name in (*means, "rack_gain"):
            assert found.summary[name][row] == pytest.approx(alone.summary[name], rel=MEAN)
        for place in ("mesh", "seat", "bush", "bearing"):
            share = f"loss_share_{place}"
            assert found.summary[share][row] == pytest.approx(alone.summary[share], rel=1e-3)
        left_out = {"energy_residual", "torque_closed_form"}
        known = {name for name, column in found.summary.items() if np.isfinite(column[row])}
        assert known == set(alone.summary) - left_out


@pytest.mark.parametrize("direction", [+1, -1])
def test_curves_of_both_ways_are_those_of_single_runs(
    case: tuple[Case, tuple[str, ...]], direction: int
) -> None:
    """At angles that both recorded."""
    case_, found = case[0], case[0].found
    name = "rack_force" if case_.scene == "rack-push" else "pinion_torque"
    angles = case_.gear.test.direction * np.radians(np.linspace(2, 58, 29))
    angles = np.sort(angles)
    curves = found.curves(name, angles, direction)
    alone = rps.Batch(tuple(case_.alone.values())).curves(name, angles, direction)
    for row, expected in zip(case_.alone, alone, strict=True):
        assert curves[row] == pytest.approx(expected, abs=CURVE * np.ptp(expected))


def test_gears_without_a_run_keep_their_cause(case: tuple[Case, tuple[str, ...]]) -> None:
    found = case[0].found
    cause = "test.load_mass is 0 kg" if case[0].scene == "load-test" else "more than the teeth carry"
    for row, sentence in ((NO_GEAR, "mesh.friction is -0.1"), (NO_RUN, cause)):
        assert not found.in_loop[row]
        assert found.statuses[row] is Status.INVALID
        assert sentence in found.messages[row]
        assert np.isnan(found.summary["rack_gain"][row])


@pytest.mark.parametrize(
    ("scene", "name"), [("load-test", "torque_reverse"), ("rack-push", "push_force_mean")]
)
def test_equations_are_those_of_single_runs(scene: str, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """At the same close angles only the rates' differences differ, of the rest against of the whole."""
    monkeypatch.setattr(loop_design, "SPACING", np.radians(0.5))
    fidelity = Fidelity.preset("quasi-static").replace({"step_angle": "0.5 deg"})
    gear = rps.SteeringGear().replace({"test.turns": 1 / 6, "test.load_mass": "40 kg", "mesh.law": "line"})
    values = {"yoke.preload": np.linspace(280.0, 320.0, 12)}
    found = rps.batch(scene, gear, values, fidelity=fidelity, keep="torque")
    alone = rps.run(scene, gear.replace({"yoke.preload": 280.0}), fidelity=fidelity)
    assert found.in_loop.all()
    assert found.summary[name][0] == pytest.approx(alone.summary[name], rel=SAME_STEP)


def test_a_weight_that_lifts_a_flank_off_is_remarked() -> None:
    """The same limits are met as by a single run, at the loop's own angles."""
    gear = rps.SteeringGear().replace({"test.turns": 1 / 8, "test.load_mass": "100 kg", "mesh.law": "line"})
    values = {"yoke.preload": np.linspace(295.0, 305.0, 12)}
    found = rps.batch("load-test", gear, values, keep="torque")
    alone = rps.run("load-test", gear.replace({"yoke.preload": 295.0}), fidelity="quasi-static")
    assert found.in_loop.all()
    assert "flanks carry nothing" in alone.message
    assert NUMBER.sub("", found.messages[0]) == NUMBER.sub("", alone.message)
    numbers = [[float(each) for each in NUMBER.findall(said)] for said in (found.messages[0], alone.message)]
    assert numbers[0] == pytest.approx(numbers[1], rel=0.05)


def test_transmission_error_is_against_each_gears_own_gain() -> None:
    """2 um of the module change the travel by three times the error of a gear; rest is the loop's ripple."""
    gear = rps.SteeringGear().replace({"test.turns": 1 / 6, "mesh.law": "line"})
    module = float(gear.value_at("pinion.normal_module"))
    values = {"pinion.normal_module": module + np.linspace(-2e-6, 2e-6, 12)}
    found = rps.batch("free-pinion-torque", gear, values, keep="torque")
    first = gear.replace({"pinion.normal_module": module - 2e-6})
    alone = rps.run("free-pinion-torque", first, fidelity="quasi-static")
    assert found.in_loop[0]
    name = "transmission_error_peak_to_peak"
    assert found.summary[name][0] == pytest.approx(alone.summary[name], rel=0.05)


def test_a_gear_to_learn_from_is_found_where_its_contact_jumps() -> None:
    """Under a weight by law area the quadrature jumps at single angles, here by more than 0.05 N."""
    gear = rps.SteeringGear().replace({"test.turns": 1 / 2, "test.load_mass": "80 kg", "mesh.law": "area"})
    found = rps.batch("load-test", gear, {"yoke.preload": np.linspace(295.0, 305.0, 12)}, keep="torque")
    alone = rps.run("load-test", gear.replace({"yoke.preload": 295.0}), fidelity="quasi-static")
    assert found.in_loop.all()
    for name in ("torque_forward", "torque_reverse"):
        assert found.summary[name][0] == pytest.approx(alone.summary[name], rel=MEAN)


def test_what_goes_to_single_runs_stands_in_the_pages() -> None:
    page = " ".join((Path(__file__).parents[2] / "docs" / "equilibria.md").read_text().split())
    for sentence in LEFT_TO_SINGLE_RUNS.values():
        for part in re.split(r"\{\w+\}", sentence):
            assert part.strip() in page
