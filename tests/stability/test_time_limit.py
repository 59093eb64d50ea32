"""A time limit holds wherever a run is, and what was recorded until then is kept."""

import ctypes
import gc
import signal
import subprocess
import sys
import time
import weakref
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from rps_exudyn import load
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.progress import following
from rps_exudyn.gears.geometry_report import geometry_report
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.scenes.checks import before_run
from rps_exudyn.simulate.cases.processes import Processes
from rps_exudyn.simulate.cases.task import Task, answer_to
from rps_exudyn.simulate.cases.time_limit import TimeLimit, alarm, place_of
from rps_exudyn.simulate.run import simulate
from shell import Command, refusal_of
from verification.stability import cpu_time_limit

# Half a million equilibria or time steps: minutes, wherever the tests run
LONG = {"fidelity.step_angle": "0.001 deg", "test.turns": 1.4, "pinion.runout": "10 um"}
PATIENCE = 90  # [s] with a busy machine; less than any run here takes that is not ended


def run(preset: str, **changes: object) -> Task:
    settings = {name: value for name, value in LONG.items() if not name.startswith("fidelity")}
    fidelity = Fidelity.preset(preset).replace(changes)
    return Task(partial(simulate, "free-pinion-torque", SteeringGear().replace(settings), fidelity))


@pytest.mark.parametrize("preset", ["quasi-static", "flank"])
def test_run_ended_by_its_limit_keeps_what_it_recorded(preset: str) -> None:
    simulate("free-pinion-torque", SteeringGear().replace({"test.turns": 0.01}), preset)  # loads kernels
    begun, cpu_begun = time.monotonic(), time.process_time()
    answer = answer_to(run(preset, step_angle=LONG["fidelity.step_angle"]), 1.5)
    assert answer.timeout
    assert 1.5 <= answer.wall_s <= time.monotonic() - begun
    assert time.process_time() - cpu_begun < 4.5  # of CPU time: the machine may do something else
    result = answer.failure("", SteeringGear(), Fidelity())
    assert result.status is Status.TIMEOUT
    assert "time limit of 1.5 s (interrupted at " in result.message
    assert "s of CPU time in" in result.message
    assert result["pinion_torque"].size > 100
    assert np.diff(result["time"]).min() > 0
    assert result["pinion_torque"] == pytest.approx(0.62, rel=0.1)  # sound until then


def test_interrupt_that_is_passed_on_brings_back_what_was_recorded() -> None:
    """From a process that is at work; nothing is lost of a run that Ctrl-C ends."""
    long = run("quasi-static", step_angle=LONG["fidelity.step_angle"])
    with Processes(1, 100.0) as processes:

        def then_interrupted(_: object) -> None:
            time.sleep(2.0)  # the run has begun
            raise KeyboardInterrupt

        with following(then_interrupted), pytest.raises(KeyboardInterrupt):
            list(processes.run(iter([long])))
        ((task, answer),) = processes.interrupted()
    assert task is long
    assert answer.recorded is not None
    assert answer.recorded["pinion_torque"].size > 100


def test_limit_that_is_over_at_once_ends_the_command(tmp_path: Path, command: Command) -> None:
    """While libraries are loaded, nothing hears the alarm; the process is ended."""
    begun, cpu_begun = time.monotonic(), time.process_time()
    answer = command(["run", "--time-limit", "0.1 s", "--out", "a.h5"])
    assert answer.status == 1
    assert time.process_time() - cpu_begun < 0.1 + 2 + 5  # five for the libraries of this process
    assert time.monotonic() - begun < PATIENCE
    result = load("a.h5")
    assert result.status is Status.TIMEOUT
    # where they are loaded within the second that a run has to end by itself, it hears the alarm first of all
    ends = ("while libraries were loaded", "interrupted before it began")
    assert any(f"time limit of 0.1 s ({end}" in result.message for end in ends)


def child_of(parent: int) -> int | None:
    """The process that a command runs in, not those that it asks for a version."""
    for child in Path(f"/proc/{parent}/task/{parent}/children").read_text().split():
        try:
            if "python" in Path(f"/proc/{child}/cmdline").read_text():
                return int(child)
        except OSError:  # over already
            continue
    return None


def runs(pid: int) -> bool:
    """Return whether the process does anything: one that nobody has waited for yet does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


def test_ctrl_c_reaches_a_run_with_a_time_limit(tmp_path: Path) -> None:
    settings = [word for name, value in LONG.items() for word in ("--set", f"{name}={value}")]
    process = subprocess.Popen(
        [sys.executable, "-m", "rps_exudyn", "run", "--time-limit", "100 s", "--out", "a.h5", *settings],
        cwd=tmp_path,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    end, child = time.monotonic() + PATIENCE, None
    while child is None and time.monotonic() < end:
        time.sleep(0.05)
        child = child_of(process.pid)
    assert child is not None
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 130
    assert "Traceback" not in err
    assert "interrupted" in err
    # A child that was still loading Python ends when it finds its input closed.
    end = time.monotonic() + PATIENCE
    while runs(child) and time.monotonic() < end:
        time.sleep(0.05)
    assert not runs(child)


def test_alarm_tells_where_it_found_the_run() -> None:
    def work_for_ever() -> None:
        with alarm(0.05):
            while True:
                geometry_report(SteeringGear())

    with pytest.raises(KeyboardInterrupt) as interrupt:
        work_for_ever()
    places = ("while the gear's geometry was made", "while it was prepared", "before it began")
    assert place_of(interrupt.tb) in places


def test_limit_begins_when_it_is_made() -> None:
    assert TimeLimit.of("20 s").remaining == pytest.approx(20, abs=1)
    assert TimeLimit(5.0, begun=time.monotonic() - 7).remaining < -1.9


@pytest.mark.parametrize(
    "settings",
    [
        {"test.turns": 1.4, "fidelity.step_angle": "0.001 deg"},
        {"test.amplitude": "300 deg", "test.cycles": 100, "fidelity.step_angle": "0.001 deg"},
        {
            "fidelity.mesh": "general-contact",
            "fidelity.profile_samples": 2000,
            "fidelity.axial_samples": 2000,
        },
    ],
)
def test_plan_that_no_memory_holds_is_refused_before_it_starts(
    settings: dict[str, object], command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(before_run, "free_memory", lambda: 5e8)
    words = [word for name, value in settings.items() for word in ("--set", f"{name}={value}")]
    scene = "reversal" if "test.cycles" in settings else "free-pinion-torque"
    said = refusal_of(command(["run", scene, *words]))
    assert "GB of memory; 0.5 GB are free" in said
    assert said.count("\n") == 1


def test_memory_that_is_enough_is_not_refused() -> None:
    assert before_run.free_memory() > 1e8
    before_run.check_memory(1000)
    with pytest.raises(InputError, match="1e\\+12 steps"):
        before_run.check_memory(10**12)


def in_a_callback_of_the_collector() -> None:
    gc.callbacks.append(busy)
    try:
        gc.collect()
    finally:
        gc.callbacks.remove(busy)


def in_a_callback_of_a_weak_reference() -> None:
    class Thing:
        pass

    thing = Thing()
    _reference = weakref.ref(thing, busy)
    del thing


def in_a_finalizer() -> None:
    class Dying:
        def __del__(self) -> None:
            busy()

    Dying()


def in_a_callback_of_ctypes() -> None:
    ctypes.CFUNCTYPE(None)(busy)()


def busy(*_: object) -> None:
    end = time.monotonic() + 0.1
    while time.monotonic() < end:
        pass


CALLBACKS = [
    in_a_callback_of_the_collector,
    in_a_callback_of_a_weak_reference,
    in_a_finalizer,
    in_a_callback_of_ctypes,
]


@pytest.mark.parametrize("work", CALLBACKS)
def test_alarm_that_python_drops_rings_again(work: Callable[[], None]) -> None:
    def then_wait() -> None:
        with alarm(0.05):
            work()
            time.sleep(5)

    with pytest.raises(KeyboardInterrupt):
        then_wait()


@pytest.mark.parametrize("work", CALLBACKS)
def test_limit_of_cpu_time_that_python_drops_rings_again(work: Callable[[], None]) -> None:
    def then_work() -> None:
        with cpu_time_limit(0.02):
            work()
            while True:
                pass

    with pytest.raises(TimeoutError):
        then_work()
