"""Tables about accuracy, from a whole measurement and from a stopped one."""

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.accuracy_speed.measurement import Measurement, Point, load_measurement
from rps_exudyn.parameters.fidelity import Fidelity


def point(step: float, cost: float, error: float, message: str = "") -> Point:
    fidelity = Fidelity.preset("quasi-static").replace({"step_angle": np.deg2rad(step), "strip_stations": 6})
    numbers = {} if message else {"rms": error**2, "rms_linear": error, "bias": 0.0}
    return Point(
        "quasi_static",
        f"step {step:g}",
        "quasi-static",
        json.dumps(fidelity.model_dump()),
        "no-convergence" if message else "ok",
        message,
        cost,
        3,
        **numbers,
    )


@pytest.fixture
def stopped() -> Measurement:
    """Lines of order 2 in the step; one point failed, one was not measured."""
    points = [point(step, 1e-3 / step, 0.01 * step**2) for step in (1, 2, 4)]
    points += [point(5, 1e-3, 0.01, message="<no equilibrium>")]
    planned = [("quasi_static", f"step {step}") for step in (1, 2, 4, 5, 8)]
    differences = {"one - another": 1e-5}
    return Measurement("free-pinion-torque", 1e-5, differences, points, planned, {"date": "today"})


def test_a_stopped_measurement_keeps_its_failures(stopped: Measurement, tmp_path: Path) -> None:
    stopped.save(tmp_path / "free-pinion-torque.h5")
    failed = [each for each in load_measurement(tmp_path / "free-pinion-torque.h5").points if not each.ok]
    assert [(each.status, each.message) for each in failed] == [("no-convergence", "<no equilibrium>")]
