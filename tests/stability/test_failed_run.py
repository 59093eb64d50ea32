"""A run that fails midway keeps what it recorded until then, and says how it failed."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from exudyn.itemInterface import Force, MarkerNodePosition

import rps_exudyn as rps
from rps_exudyn import load
from rps_exudyn.base.screen import silent
from rps_exudyn.multibody import model as model_of_gear
from rps_exudyn.multibody.recorder import RecordedStep, Recorder
from rps_exudyn.multibody.steering_model import SteeringModel
from rps_exudyn.results.outcome import Status
from rps_exudyn.solvers.record import axis_at_pitch_point
from shell import Command

TURNS = 1 / 36
SETTINGS = ["--set", f"test.turns={TURNS}", "--set", "test.speed=60 rpm"]
BREAKS_AT = TURNS / 2  # [s] at one turn per second


@pytest.fixture
def breaking_load(monkeypatch: pytest.MonkeyPatch) -> None:
    """A load on the rack that fails halfway."""
    add_sensors = model_of_gear._add_sensors

    def load(mbs: object, t: float, vector: list[float]) -> list[float]:
        if t > BREAKS_AT:
            raise ZeroDivisionError("broken load")
        return [0.0, 0.0, 0.0]

    def add_sensors_and_load(model: SteeringModel) -> None:
        add_sensors(model)
        marker = model.mbs.AddMarker(MarkerNodePosition(nodeNumber=model.nodes["rack"]))
        model.mbs.AddLoad(Force(markerNumber=marker, loadVector=[0, 0, 0], loadVectorUserFunction=load))

    monkeypatch.setattr(model_of_gear, "_add_sensors", add_sensors_and_load)


@pytest.mark.usefixtures("breaking_load")
@pytest.mark.parametrize("fidelity", ["full", "flank"])
def test_run_that_fails_midway_keeps_its_signals(command: Command, fidelity: str) -> None:
    answer = command(["run", "--fidelity", fidelity, *SETTINGS, "--out", "a.h5"])
    assert answer.status == 1
    result = load("a.h5")
    assert result.status is Status.NO_CONVERGENCE
    assert "broken load" in result.message
    reached = result["pinion_angle"][-1]
    # broken after five degrees of ten, of which the run-in took up to two steps
    assert np.deg2rad(1.5) < reached < np.deg2rad(6)
    assert result["pinion_torque"] == pytest.approx(0.63, rel=0.1)  # sound until then
    assert Path("a.png").exists()
    assert "broken load" in answer.err
    assert "Traceback" not in answer.err


class InterruptedSystem:
    """A system that Ctrl-C interrupts between its coordinates and their rates."""

    def __init__(self, mbs: Any) -> None:
        self._data = mbs.systemData

    @property
    def systemData(self) -> "InterruptedSystem":
        return self

    def GetODE2Coordinates_t(self) -> None:
        raise KeyboardInterrupt

    def __getattr__(self, name: str) -> Any:
        return getattr(self._data, name)


@pytest.fixture
def ctrl_c(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C while the tenth step is kept, as Python sees it: in whatever function Exudyn calls next."""
    keep = Recorder._keep

    def keep_until_interrupted(recorder: Recorder, mbs: Any, t: float) -> bool:
        return keep(recorder, InterruptedSystem(mbs) if len(recorder.steps) == 10 else mbs, t)

    monkeypatch.setattr(Recorder, "_keep", keep_until_interrupted)


@pytest.mark.usefixtures("ctrl_c")
@pytest.mark.parametrize("scene", ["free-pinion-torque", "load-test"])
def test_ctrl_c_ends_a_run_and_keeps_what_was_recorded(command: Command, scene: str) -> None:
    with silent():
        answer = command(["run", scene, *SETTINGS, "--out", "a.h5"])
    assert answer.status == 130
    assert answer.err == "rps-exudyn: interrupted; the record until then is kept in a.h5.\n"
    result = load("a.h5")
    assert result.status is Status.TIMEOUT
    assert "interrupted at" in result.message
    assert 2 <= result["time"].size <= 10


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_passes_through_python() -> None:
    with pytest.raises(KeyboardInterrupt) as interrupt:
        rps.run("free-pinion-torque", turns=TURNS)
    assert interrupt.value.recorded.signals["time"].size >= 2  # type: ignore[attr-defined]


def test_an_instant_that_is_reached_twice_is_kept_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Exudyn ends reduced steps with one of 1e-17 s: two rows at one time would be taken for two motions."""
    keep = Recorder._keep

    def keep_twice(recorder: Recorder, mbs: Any, t: float) -> bool:
        return keep(recorder, mbs, t) and keep(recorder, mbs, float(np.nextafter(t, np.inf)))

    once = rps.run("free-pinion-torque", turns=TURNS)
    monkeypatch.setattr(Recorder, "_keep", keep_twice)
    twice = rps.run("free-pinion-torque", turns=TURNS)
    np.testing.assert_array_equal(twice["time"], once["time"])


def test_bound_of_a_rack_s_lift_is_never_below_it() -> None:
    """Racks anywhere on their travel, rolled by any angle and tilted a little, and one that tilts much."""
    nowhere = SimpleNamespace(axis_offset=0.0)
    model: Any = SimpleNamespace(
        forces=SimpleNamespace(bar=None),
        gear=SimpleNamespace(installation=nowhere),
        columns=lambda stack: np.arange(8),
        stack=(),
    )
    recorder, rng = Recorder(model), np.random.default_rng(3)
    for tilt in (*rng.uniform(0.0, 0.05, 200), 0.2):
        rack = np.concatenate([rng.uniform(-0.2, 0.2, 1), rng.normal(size=2) * 1e-3, rng.uniform(-3, 3, 1)])
        rack = np.append(rack, tilt * rng.choice([-1, 1], 2))
        recorder.steps = [RecordedStep(0.0, np.array([0.0, *rack, 0.0]), np.zeros(8), 0.0, None, np.zeros(0))]
        assert recorder._lift_bound() >= abs(axis_at_pitch_point(rack[None])[0, 0]) - 1e-12
    assert recorder._lift_bound() == np.inf
