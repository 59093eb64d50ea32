"""Plain, with fallback, with a time limit, by accuracy: one entry, whoever asks."""

import re
from pathlib import Path

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.outcome import Status
from shell import Command

TOO_COARSE = Fidelity.preset("quasi-static").replace({"step_angle": "40 deg"})


def test_python_gets_fallback_and_time_limit() -> None:
    result = rps.run("free-pinion-torque", fidelity=TOO_COARSE, robust=True, time_limit="60 s", turns=0.2)
    assert result.status is Status.OK
    assert result.findings["tries"][-1]["status"] == "ok"
    assert result.fidelity["step_angle"] < TOO_COARSE.step_angle
    assert re.search(r"ok with step_angle \d+ deg", result.message)  # an angle in its unit


def test_all_ways_give_the_same_numbers() -> None:
    """A process of its own, and a fallback that is not needed, change nothing but the times."""
    plain, other = (
        rps.run("free-pinion-torque", fidelity="quasi-static", turns=0.2, **ways)
        for ways in ({}, {"robust": True, "time_limit": 60.0})
    )
    assert plain.summary == other.summary
    assert all(np.array_equal(plain[name], other[name]) for name in plain.signals)


def test_time_limit_that_is_none_is_refused() -> None:
    with pytest.raises(rps.InputError, match="more than 0 s"):
        rps.run("free-pinion-torque", time_limit=0.0)


def test_what_an_accuracy_reached_is_printed_and_stays_in_the_file(command: Command) -> None:
    answer = command(["run", "--accuracy", "1%", "--set", "test.turns=0.5", "--out", "a.h5"])
    assert answer.status == 0
    reached = rps.load(Path("a.h5")).findings["accuracy"]
    assert "quasi-static, level 1: 1.5 bars of torque_mean are" in reached
    assert "level 2 would take about" in reached
    assert reached in " ".join(answer.err.split())


def test_accuracy_with_a_time_limit_keeps_both(command: Command) -> None:
    answer = command(["run", "--accuracy", "1%", "--time-limit", "60 s", "--robust", "--out", "a.h5"])
    assert answer.status == 0
    assert "level 1" in rps.load(Path("a.h5")).findings["accuracy"]
