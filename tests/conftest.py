"""Made-up results and an in-process command line, for tests that need no simulation."""

import dataclasses
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from rps_exudyn.cli import commands as cli
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from shell import Answer, Command


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-references",
        action="store_true",
        help="write the values of tests/regression anew and print what changed",
    )


@pytest.fixture
def made_up_result() -> Result:
    """One revolution with plausible torque, lift and roll; no simulation behind it."""
    angle = np.linspace(0, 2 * np.pi, 121)
    return Result(
        scene="free-pinion-torque",
        gear=SteeringGear(),
        fidelity={"name": "flank", "mesh": "flank"},
        solver={"name": "generalized-alpha", "step": 1e-3},
        status=Status.OK,
        signals={
            "time": angle / 1.57,
            "pinion_angle": angle,
            "pinion_torque": 0.6 + 0.01 * np.cos(6 * angle),
            "rack_displacement": 0.0056 * angle,
            "rack_y": 3e-6 * np.cos(angle),
            "rack_roll": 1e-3 + 1e-4 * np.cos(angle),
            "mesh_normal_force_drive": np.full_like(angle, 450.0),
            "work_drive": 0.6 * angle,
            "work_mesh_friction": 0.3 * angle,
            "work_bearing_friction": 0.03 * angle,
        },
        summary={"torque_mean": 0.6, "torque_peak_to_peak": 0.02, "rack_gain": 0.035},
        counters={"steps": 120, "newton_iterations": 250},
        cpu_s=1.5,
        wall_s=2.0,
    )


@pytest.fixture
def failed_result(made_up_result: Result) -> Result:
    return dataclasses.replace(made_up_result, status=Status.DIVERGED, message="NaN at t = 0.1 s.")


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Command:
    """`rps-exudyn` with these arguments, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("FORCE_COLOR", raising=False)  # which makes lines as short as a terminal's

    def call(arguments: Sequence[str]) -> Answer:
        status = cli.main(list(arguments))
        captured = capsys.readouterr()
        return Answer(status, captured.out, captured.err)

    return call
