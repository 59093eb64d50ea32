"""The published tables: what `--accuracy` reads, and the points behind the charts."""

from pathlib import Path

import numpy as np
import pytest

from rps_exudyn.accuracy.choice import choose, scene_table
from rps_exudyn.accuracy.measurement import PRESET_FAMILIES, load_measurement
from rps_exudyn.analysis.work_precision import pareto_front
from rps_exudyn.charts.work_precision import is_default
from rps_exudyn.parameters import SteeringGear

PUBLISHED = Path(__file__).parents[2] / "results" / "accuracy_speed"
GEAR = SteeringGear()
FLOORS = {"free-pinion-torque": 0.01, "load-test": 0.05, "rack-push": 0.05}
"""How well the default gear's references must be known [%]."""


@pytest.mark.parametrize("scene", [*FLOORS, "yoke-impact"])
def test_references_are_known_as_well_as_asked(scene: str) -> None:
    assert load_measurement(PUBLISHED / f"{scene}.h5").reference.uncertainty <= FLOORS.get(scene, 0.05)


STEADY_TURNING_ASKS_LESS = pytest.mark.xfail(
    strict=True,
    reason="tolerance 1e-2 gives the free pinion torque in half the time; the default 1e-4 is for impacts",
)


@pytest.mark.parametrize(
    "preset", ["full", pytest.param("flank", marks=STEADY_TURNING_ASKS_LESS), "quasi-static", "closed-form"]
)
def test_the_default_of_a_preset_is_on_its_familys_pareto_front(preset: str) -> None:
    published = load_measurement(PUBLISHED / "free-pinion-torque.h5")
    points = [point for point in published.of_family(PRESET_FAMILIES[preset]) if point.ok]
    floor = published.reference.uncertainty
    front = pareto_front(
        np.array([point.cost for point in points]),
        np.maximum([point.error for point in points], floor),
    )
    on_front = [point for point, best in zip(points, front, strict=True) if best]
    assert any(is_default(point, preset) for point in on_front)


def test_costs_at_one_and_a_tenth_of_a_percent() -> None:
    points = load_measurement(PUBLISHED / "free-pinion-torque.h5").points

    def cheapest(family: str, error: float) -> float:
        return min(p.cost for p in points if p.family == family and p.ok and p.error <= error)

    assert cheapest("quasi-static", 1.0) <= 1e-3
    assert cheapest("quasi-static", 0.1) <= 3e-3
    assert cheapest("flank", 0.02) <= 0.1
    assert np.isfinite(cheapest("general contact", 0.5))


@pytest.mark.parametrize("scene", FLOORS)
def test_stricter_is_never_cheaper(scene: str) -> None:
    table = scene_table(scene)
    strictest = min(each.promised for each in table.settings)
    wanted = np.geomspace(max(strictest, table.floor), 10.0, 12)
    costs = [choose(scene, GEAR, float(each)).setting.cost for each in wanted * (1 + 1e-9)]
    assert costs == sorted(costs, reverse=True)
    assert costs[0] > costs[-1]


def test_the_step_follows_the_tooth_pitch() -> None:
    few, many = (choose("free-pinion-torque", GEAR.replace({"pinion.teeth": z}), 1.0) for z in (6, 8))
    assert few.fidelity.step_angle * 6 == pytest.approx(many.fidelity.step_angle * 8)
