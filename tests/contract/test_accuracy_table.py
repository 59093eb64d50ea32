"""The published tables: what `--accuracy` reads, and the points behind the charts."""

from pathlib import Path

import numpy as np
import pytest

from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.simulate.by_accuracy import choose, scene_table
from rps_exudyn.verification.measurement import FAMILIES, PRESET_FAMILIES, load_measurement
from rps_exudyn.verification.runs import HEADLINE_SIGNAL
from benchmarks.accuracy_speed.chart import is_default

PUBLISHED = Path(__file__).parents[2] / "results" / "accuracy_speed"
GEAR = SteeringGear()
STEADY = ("free-pinion-torque", "load-test", "rack-push")


@pytest.mark.parametrize("scene", HEADLINE_SIGNAL)
def test_references_are_known_as_well_as_asked(scene: str) -> None:
    published = load_measurement(PUBLISHED / f"{scene}.h5")
    assert published.reference.uncertainty <= (0.01 if scene == "free-pinion-torque" else 0.05)
    assert len(published.reference.differences) >= 3
    assert published.missing == []


@pytest.mark.parametrize("scene", STEADY)
def test_orders_of_convergence_are_those_expected(scene: str) -> None:
    """Kinks of the torque cost cubics some of their order."""
    orders = load_measurement(PUBLISHED / f"{scene}.h5").orders
    assert {each.family for each in orders} >= {"quasi-static", "flank"}
    for each in orders:
        lost = 1.5 if "splines" in each.error else 0.35
        assert each.expected - lost <= each.observed <= each.expected + 0.8, each


def test_every_family_was_measured() -> None:
    points = load_measurement(PUBLISHED / "free-pinion-torque.h5").points
    assert {point.family for point in points if point.ok} == set(FAMILIES)
    failed = [point for point in points if not point.ok]
    assert {"explicit", "quasi-static"} <= {point.family for point in failed}
    assert all(point.message for point in failed)


def test_the_report_is_small_and_whole() -> None:
    page = (PUBLISHED / "report.html").read_text(encoding="utf-8")
    assert len(page.encode()) < 300_000
    assert page.count("<svg") == len(HEADLINE_SIGNAL) + 2
    assert "unfinished" not in page


@pytest.mark.parametrize("preset", PRESET_FAMILIES)
def test_the_default_of_a_preset_is_on_its_familys_pareto_front(preset: str) -> None:
    """No other point costs no more, is no less exact, and better by a tenth in either: costs are repeated to
    about that, and between errors nearer than that the friction zone's last digits decide."""
    published = load_measurement(PUBLISHED / "free-pinion-torque.h5")
    points = [point for point in published.of_family(PRESET_FAMILIES[preset]) if point.ok]
    floor = published.reference.uncertainty
    default = min((p for p in points if is_default(p, preset)), key=lambda point: point.cost)
    error = max(default.error, floor)
    better = [
        point.label
        for point in points
        if point.cost <= default.cost
        and max(point.error, floor) <= error
        and (point.cost < 0.9 * default.cost or max(point.error, floor) < 0.9 * error)
    ]
    assert not better


def test_costs_at_one_and_a_tenth_of_a_percent() -> None:
    points = load_measurement(PUBLISHED / "free-pinion-torque.h5").points

    def cheapest(family: str, error: float) -> float:
        return min(p.cost for p in points if p.family == family and p.ok and p.error <= error)

    assert cheapest("quasi-static", 1.0) <= 1e-3
    assert cheapest("quasi-static", 0.1) <= 3e-3
    assert cheapest("flank", 0.02) <= 0.1
    assert np.isfinite(cheapest("general contact", 0.5))


@pytest.mark.parametrize("scene", STEADY)
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
