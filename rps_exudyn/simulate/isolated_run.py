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
from rps_exudyn.simulate import run as simulate
from rps_exudyn.simulate.fallback import robust_run
from rps_exudyn.simulate.processes import Processes


def run(scene: str, gear: SteeringGear, fidelity: Fidelity, robust: bool, limit: float | None) -> Result:
    """A run as the command line asks for it: with fallback, or with a time limit [s], or both, or neither.

    Raises:
        InputError: a gear that cannot exist, or a test that it does not allow.
    """
    if limit is not None:
        return limited_run(scene, gear, fidelity, limit, robust)
    if robust:
        return robust_run(scene, gear, fidelity)
    return simulate.run(scene, gear, fidelity=fidelity)


def seconds(text: str) -> float:
    """A time limit as the user writes it, in seconds.

    Raises:
        InputError: it is none.
    """
    try:
        limit = units.to_si(text, "s")
    except ValueError as error:
        raise InputError(f"--time-limit: {error}.") from None
    if not 0 < limit < float("inf"):
        raise InputError(f"--time-limit is {text}; it must be more than 0 s and finite.")
    return limit


def limited_run(
    scene: str, gear: SteeringGear, fidelity: Fidelity, seconds: float, robust: bool = False
) -> Result:
    """As `simulate.run`, or as `robust_run`; loading and compiling is on no clock.

    The outcome is `timeout` if the time was over, `crashed` if the process ended otherwise.
    """
    with tempfile.TemporaryDirectory() as folder, Processes(1, seconds) as processes:
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
    if done.timeout:
        status, message = Status.TIMEOUT, f"the run took longer than its time limit of {seconds:g} s"
    else:
        status, message = Status.CRASHED, done.ended
    return failed(scene, gear, fidelity, status, message, 0.0, done.wall_s)
