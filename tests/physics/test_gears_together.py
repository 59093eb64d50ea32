"""Gears computed together: metrics and signals of all scenes, laws and frictions are those of single runs."""

import re
from dataclasses import dataclass
from itertools import product

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.parameters.friction_law import RUBBING_PARTS
from rps_exudyn.results.outcome import Status, sentences
from rps_exudyn.results.quantities import WORKS
from verification.law_area import by_law
from verification.population import random_gears

MEANS = {  # by scene; of them `batch` states 1e-5
    "free-pinion-torque": ("torque_mean", "rack_gain"),
    "load-test": ("torque_forward", "torque_reverse", "efficiency_ratio", "rack_gain"),
    "rack-push": ("push_force_mean", "rack_gain"),
}
MEAN, METRIC = 1e-5, 1e-3  # of single runs
SIGNAL = 0.01  # of its range at any instant
# left out by gears together: each takes as long as a gear's whole run there
SINGLE_RUNS_ONLY = {"face_load_factor", "load_centre", "contact_pressure_max"}
CONTACT = 2e-4  # of a force or work: contact forces are found to a few hundredths of a newton
RESIDUAL = 1e-4  # of the work
GEARS = 40
NO_GEAR, NO_RUN = 5, 9  # rows with a negative friction, and with a load that no teeth carry
SINGLES = (0, 11, 23)
NUMBER = re.compile(r"\d[\d.]*")

SETTINGS = {
    "line": {"mesh.law": "line"},
    "teeth": {"mesh.law": "teeth"},
    "coulomb": {},
    "stribeck": {
        f"{part}.{name}": value
        for part in RUBBING_PARTS
        for name, value in (
            ("friction_law", "stribeck"),
            ("static_ratio", 1.4),
            ("stribeck_speed", "20 mm/s"),
        )
    },
    "one-way": {"test.path": "one-way"},
    "there-and-back": {"test.path": "there-and-back", "test.direction": -1},
    "lock-to-lock": {"test.path": "lock-to-lock", "rack.travel": "40 mm"},
}
EVERY_DAY = (("one-way", "line", "stribeck"), ("there-and-back", "teeth", "coulomb"))
"""Each path, law and friction once; the other combinations are long tests."""
CASES = [
    *product(MEANS, ("one-way", "there-and-back"), ("line", "teeth"), ("coulomb", "stribeck")),
    *product(MEANS, ("lock-to-lock",), ("line",), ("coulomb",)),
]


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
    """Gears of one scene together, and some of them run singly."""

    scene: str
    gear: rps.SteeringGear
    found: rps.Batch
    alone: dict[int, rps.Result]


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(each, id="-".join(each), marks=() if each[1:] in EVERY_DAY else pytest.mark.long)
        for each in CASES
    ],
)
def case(request: pytest.FixtureRequest) -> Case:
    scene, *names = request.param
    changes: dict[str, object] = {"test.turns": 1 / 6}
    for name in names:
        changes |= SETTINGS[name]
    gear, values = rps.SteeringGear().replace(changes), table(scene)
    alone = {
        row: rps.run(
            scene,
            gear.replace({path: float(column[row]) for path, column in values.items()}),
            fidelity="quasi-static",
        )
        for row in SINGLES
    }
    return Case(scene, gear, rps.batch(scene, gear, values), alone)


def test_metrics_and_outcomes_are_those_of_single_runs(case: Case) -> None:
    found = case.found
    assert found.in_loop.mean() > 0.9
    for row, alone in case.alone.items():
        assert found.in_loop[row]
        assert found.statuses[row] is alone.status is Status.OK
        assert without_pressure(found.messages[row]) == without_pressure(alone.message)
        ours = {name: column[row] for name, column in found.summary.items() if np.isfinite(column[row])}
        assert set(ours) == set(alone.summary) - SINGLE_RUNS_ONLY
        assert abs(ours.pop("energy_residual")) < RESIDUAL
        for name, value in ours.items():
            allowed = MEAN if name in MEANS[case.scene] else METRIC
            assert value == pytest.approx(alone.summary[name], rel=allowed), name


def without_pressure(message: str) -> list[str]:
    """Sentences without their numbers and without those on the flanks' pressure, which gears together print a
    little earlier where single runs leave out the ends of lines."""
    pressure = "the contact pressure", "the model stays elastic"
    return [NUMBER.sub("", text) for text in sentences(message) if not text.startswith(pressure)]


def test_signals_are_those_of_single_runs(case: Case) -> None:
    assert case.found.found is not None
    for row, alone in case.alone.items():
        ours, signals = case.found.found.signals_of(row), alone.signals
        assert set(ours) == set(signals)
        work = max(np.abs(values).max() for name, values in signals.items() if name == "work_drive")
        for name, values in signals.items():
            size = work if name in WORKS else np.abs(values).max()
            allowed = max(SIGNAL * np.ptp(values), CONTACT * size, 1e-9)
            assert np.abs(ours[name] - values).max() <= allowed, name


def test_gears_without_a_run_keep_their_cause(case: Case) -> None:
    found = case.found
    cause = "test.load_mass is 0 kg" if case.scene == "load-test" else "more than the teeth carry"
    for row, sentence in ((NO_GEAR, "mesh.friction is -0.1"), (NO_RUN, cause)):
        assert not found.in_loop[row]
        assert found.statuses[row] is Status.INVALID
        assert sentence in found.messages[row]
        assert np.isnan(found.summary["rack_gain"][row])


def test_curves_go_both_ways() -> None:
    """At angles that both recorded."""
    gear = rps.SteeringGear().replace({"test.turns": 1 / 6, "test.path": "there-and-back"})
    values = {"yoke.preload": np.linspace(290.0, 310.0, 12)}
    found = rps.batch("free-pinion-torque", gear, values, keep="torque")
    alone = rps.batch("free-pinion-torque", gear, {"yoke.preload": [290.0]})
    angles = np.radians(np.linspace(2, 58, 29))
    for direction in (+1, -1):
        ours, theirs = (each.curves("pinion_torque", angles, direction)[0] for each in (found, alone))
        assert ours == pytest.approx(theirs, abs=SIGNAL * np.ptp(theirs))


def test_a_weight_that_lifts_a_flank_off_is_remarked() -> None:
    """The same limits are met as by a single run."""
    gear = rps.SteeringGear().replace({"test.turns": 1 / 8, "test.load_mass": "100 kg", "mesh.law": "line"})
    values = {"yoke.preload": np.linspace(295.0, 305.0, 12)}
    found = rps.batch("load-test", gear, values, keep="torque")
    alone = rps.run("load-test", gear.replace({"yoke.preload": 295.0}), fidelity="quasi-static")
    assert found.in_loop.all()
    assert "flanks carry no load" in alone.message
    assert NUMBER.sub("", found.messages[0]) == NUMBER.sub("", alone.message)
    numbers = [[float(each) for each in NUMBER.findall(said)] for said in (found.messages[0], alone.message)]
    assert numbers[0] == pytest.approx(numbers[1], rel=0.01)


def test_transmission_error_is_against_each_gears_own_gain() -> None:
    """2 um of the module change the travel by three times the error of a gear."""
    gear = rps.SteeringGear().replace({"test.turns": 1 / 6, "mesh.law": "line"})
    module = float(gear.value_at("pinion.normal_module"))
    values = {"pinion.normal_module": module + np.linspace(-2e-6, 2e-6, 12)}
    found = rps.batch("free-pinion-torque", gear, values, keep="torque")
    first = gear.replace({"pinion.normal_module": module - 2e-6})
    alone = rps.run("free-pinion-torque", first, fidelity="quasi-static")
    assert found.in_loop[0]
    name = "transmission_error_peak_to_peak"
    assert found.summary[name][0] == pytest.approx(alone.summary[name], rel=METRIC)


@pytest.mark.long
def test_a_gear_to_learn_from_is_found_where_its_contact_jumps() -> None:
    """Under a weight by law area the quadrature jumps at single angles, which the follower may not pass; a
    gear of the table that is lost there is run singly. How many are lost depends on the processor."""
    gear = by_law(rps.SteeringGear().replace({"test.turns": 1 / 2, "test.load_mass": "80 kg"}), "area")
    preloads = np.linspace(295.0, 305.0, 12)
    found = rps.batch("load-test", gear, {"yoke.preload": preloads}, keep="torque")
    assert found.in_loop.any()
    for row in (int(np.argmax(found.in_loop)), int(np.argmin(found.in_loop))):
        alone = rps.run("load-test", gear.replace({"yoke.preload": preloads[row]}), fidelity="quasi-static")
        for name in ("torque_forward", "torque_reverse"):
            assert found.summary[name][row] == pytest.approx(alone.summary[name], rel=MEAN)


@pytest.mark.parametrize(
    "number", [4, 10, *(pytest.param(number, marks=pytest.mark.long) for number in (1, 9, 12, 21))]
)
def test_every_metric_of_random_gears_is_that_of_single_runs(number: int) -> None:
    """Gears of the population with loads and frictions 20 % up and down: each metric that both print, to 1 %;
    the first order of a transmission error, which a gear without runout has not, to 1 % of its peak to peak.
    Lift, roll, yaw and transmission error settle slowly: they differed by up to 16 %."""
    rng, scene = np.random.default_rng([2, number]), tuple(MEANS)[number % len(MEANS)]
    path = str(rng.choice(["one-way", "there-and-back"]))
    gear = random_gears(2, number + 1)[number].replace(
        {
            "mesh.law": "line",
            "rack.bow": 0.0,
            "test.path": path,
            "test.turns": float(rng.choice([0.3, 1.0])),
            "test.start_angle": 0.0,
        }
    )
    paths = [each for each in ("pinion.runout", "mesh.friction", "yoke.preload") if gear.value_at(each)]
    table = {path: gear.value_at(path) * rng.uniform(0.8, 1.2, 24) for path in paths}
    found = rps.batch(scene, gear, table)
    assert found.in_loop.any()
    for row in np.flatnonzero(found.in_loop)[[0, -1]].tolist():
        varied = gear.replace({path: float(column[row]) for path, column in table.items()})
        single = rps.run(scene, varied, fidelity="quasi-static")
        alone = single.summary
        ours = {name: float(each[row]) for name, each in found.summary.items() if np.isfinite(each[row])}
        assert alone.keys() - SINGLE_RUNS_ONLY <= ours.keys()
        assert ours.keys() <= alone.keys()
        assert abs(ours.pop("energy_residual")) < RESIDUAL
        for name in ours.keys() & alone.keys():
            value = ours[name]
            whole = alone["transmission_error_peak_to_peak"] if name.endswith("error_first_order") else 0.0
            assert value == pytest.approx(alone[name], rel=0.01, abs=0.01 * whole), name


def test_a_part_of_a_table_ends_as_the_whole() -> None:
    """Gears learn from what the ranges say; what is left is the rounding of sums over other lengths."""
    gear = rps.SteeringGear().replace({"test.turns": 1 / 6})
    values = {"yoke.preload": np.linspace(280.0, 320.0, 40), "mesh.friction": np.linspace(0.11, 0.09, 40)}
    whole = rps.batch("rack-push", gear, values, ranges=values)
    part = rps.batch("rack-push", gear, {path: each[20:24] for path, each in values.items()}, ranges=values)
    assert part.in_loop.all()
    for name, column in part.summary.items():
        assert column == pytest.approx(whole.summary[name][20:24], rel=1e-9), name


@pytest.mark.parametrize("scene", ["rack-push", "free-pinion-torque"])
def test_gears_far_from_the_middle_are_settled_where_the_record_begins(scene: str) -> None:
    """Their motion is not known to first order there; a part of a tooth pitch before it is enough."""
    rng = np.random.default_rng(11)
    gear = rps.SteeringGear().replace({"test.turns": 1 / 6, "test.direction": -1, "yoke.clearance": "60 um"})
    values = {
        "installation.axis_offset": 45e-6 * rng.normal(size=GEARS),
        "pinion.pitch_error": 9e-6 * rng.normal(size=GEARS),
        "pinion.runout": rng.uniform(0, 60e-6, GEARS),
        "installation.angle_error": 1.6e-3 * rng.normal(size=GEARS),
    }
    found = rps.batch(scene, gear, values)
    assert found.found is not None
    for row in np.flatnonzero(found.in_loop)[:12].tolist():
        settings = {path: float(column[row]) for path, column in values.items()}
        alone = rps.run(scene, gear.replace(settings), fidelity="quasi-static")
        lift = found.found.signals_of(row)["rack_y"]
        assert np.abs(lift - alone["rack_y"]).max() < SIGNAL * np.ptp(alone["rack_y"])


def test_gears_of_another_structure_run_singly() -> None:
    """A relief of the tips has more lines of contact than none, for which the others have no room."""
    relief = np.concatenate([np.zeros(20), np.linspace(1e-6, 4e-6, 6)])
    table = {"pinion.tip_relief": relief, "yoke.preload": np.linspace(290, 310, 26)}
    gear = rps.SteeringGear().replace({"mesh.law": "teeth", "test.turns": 0.2})
    found = rps.batch("free-pinion-torque", gear, table)
    assert found.ok.all()
    assert not found.in_loop[relief > 0].any()
