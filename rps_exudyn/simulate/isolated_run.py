"""A run with a hard time limit: in a process of its own, which is killed when its time is over.

Exudyn's own limit ends with a success flag, and some of its solvers never look at it.
"""

import tempfile
from dataclasses import replace
from pathlib import Path

from rps_exudyn.base import units
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result, failed, load
from rps_exudyn.simulate.processes import Done, Processes


def seconds(limit: str | float) -> float:
    """Return a time limit as the user writes it in seconds; bare numbers are seconds.

    Raises:
        InputError: no time, or none that ends a run.
    """
    try:
        value = units.to_si(limit, "s")
    except ValueError as error:
        raise InputError(f"--time-limit: {error}.") from None
    if not 0 < value < float("inf"):
        raise InputError(f"--time-limit is {limit}; it must be more than 0 s and finite.")
    return float(value)


def isolated_run(
    scene: str, gear: SteeringGear, fidelity: Fidelity, time_limit: float, *, robust: bool = False
) -> Result:
    """Simulate in another process for at most `time_limit` [s]; loading and compiling do not count.

    The outcome is `timeout` if the time was over, `crashed` if the process ended otherwise.
    """
    with tempfile.TemporaryDirectory() as folder, Processes(1, time_limit) as processes:
        path = Path(folder) / "run.h5"
        task = {
            "hash": "run",
            "scene": scene,
            "gear": gear.model_dump(),
            "fidelity": fidelity.model_dump(),
            "keep": {"signals": None, "samples": None},
            "path": str(path),
            "robust": robust,
        }
        (done,) = processes.run(iter([task]))
        if done.answer is not None:
            return replace(load(path), wall_s=done.answer["wall_s"])
    return result_of_ended_process(done, scene, gear, fidelity, time_limit)


def result_of_ended_process(
    done: Done, scene: str, gear: SteeringGear, fidelity: Fidelity, time_limit: float
) -> Result:
    """Return what stands for a run whose process came to an end over it; the time limit in seconds."""
    status, message = Status.CRASHED, done.ended
    if done.timeout:
        status, message = Status.TIMEOUT, f"the run took longer than its time limit of {time_limit:g} s"
    return failed(scene, gear, fidelity, status, message, 0.0, done.wall_s)
