"""What the teeth bear along the face: K_H-beta, load centre and pressure from the contact forces."""

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.analysis.load_distribution import at_ends, face_loading, load_distribution
from rps_exudyn.gears.tooth_stiffness import EFFECTIVE_MODULUS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import Result

RATED = {"test.load_mass": "500 kg", "test.turns": 1 / 6}
NAMES = "face_load_factor", "load_centre", "contact_pressure_max"


def raised(changes: dict[str, object], rack: str = "free") -> Result:
    model = rps.Fidelity.preset("quasi-static").replace({"rack": rack})
    return rps.run("load-test", SteeringGear().replace({**RATED, **changes}), fidelity=model)


@pytest.fixture(scope="module")
def rated() -> Result:
    return raised({})


def test_rated_torque_runs_on_the_default_gear(rated: Result) -> None:
    """30 N m: the free round bar rolls, and the load moves to the ends of the teeth."""
    assert rated.status is rps.Status.OK
    assert rated.gear.mesh.law == "teeth"
    assert abs(rated.summary["torque_forward"]) > 30
    assert rated.summary["face_load_factor"] > 2
    assert 2e-3 < abs(rated.summary["load_centre"]) < 7e-3


def test_numbers_are_those_of_the_record(rated: Result) -> None:
    found = face_loading(rated.gear, rated.signals)
    assert {name: rated.summary[name] for name in NAMES} == pytest.approx(found, rel=0.05)


def test_face_load_counts_by_time_where_a_part_of_the_record_has_shorter_steps(rated: Result) -> None:
    """Of a gear whose weight was raised in 1024 steps and lowered in 32 the load centre was 1.7 mm off."""
    half, steps = len(rated["time"]) // 2, 8
    place = np.concatenate([np.arange(0, half, 1 / steps), np.arange(half, len(rated["time"]))])
    uneven = {
        name: np.interp(place, np.arange(values.size), values) for name, values in rated.signals.items()
    }
    found = face_loading(rated.gear, uneven)
    assert found["face_load_factor"] == pytest.approx(rated.summary["face_load_factor"], rel=0.02)
    assert found["load_centre"] == pytest.approx(rated.summary["load_centre"], rel=0.02)


def test_pressure_leaves_out_edges_and_shortest_lines(rated: Result) -> None:
    """Hertz's line contact holds a contact's width from a line's ends; the rest has its local curvature."""
    loads = load_distribution(rated.gear, rated.signals)
    edge = at_ends(loads)
    assert loads.pressure[edge].max() > 1.3 * loads.pressure[~edge].max()
    width = 4 * loads.load / (np.pi * np.maximum(loads.pressure, 1.0))
    for instant, side, tooth in {(k, -1, t) for k, t in zip(loads.instant, loads.tooth, strict=True)}:
        line = (loads.instant == instant) & (loads.side == side) & (loads.tooth == tooth)
        if line.any() and loads.length[line].sum() < 2 * width[line].min():
            assert edge[line][loads.load[line] > 0].all()
    largest = np.where(edge, 0.0, loads.pressure).argmax()
    radius = EFFECTIVE_MODULUS * loads.load[largest] / (np.pi * loads.pressure[largest] ** 2)
    assert radius == pytest.approx(loads.roll[largest] / 0.92, rel=0.03)  # q / cos beta_b
    assert rated["mesh_pressure"].max() == pytest.approx(loads.pressure[~edge].max(), rel=0.1)


def test_lead_error_moves_the_load_centre() -> None:
    """Either way by as much, beside where it is; a guided rack cannot roll away from it."""
    light = {"test.load_mass": "80 kg"}
    centres = [
        raised({**light, "pinion.lead_error": error}, "guided").summary["load_centre"]
        for error in (-10e-6, 0.0, 10e-6)
    ]
    assert centres[0] < centres[1] < centres[2] or centres[0] > centres[1] > centres[2]
    assert abs(centres[2] - centres[0]) > 1e-3
