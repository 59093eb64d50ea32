"""What measurements share: runs that must end well, and the least CPU time of repeats."""

from collections.abc import Callable
from time import process_time
from typing import TypeVar

import numpy as np

import rps_exudyn as rps
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear

Found = TypeVar("Found")


def run_ok(scene: str, gear: SteeringGear, fidelity: Fidelity | str) -> rps.Result:
    """Run a scene, which must end well.

    Raises:
        SystemExit: it does not.
    """
    result = rps.run(scene, gear, fidelity=fidelity)
    if result.status is not rps.Status.OK:
        raise SystemExit(f"{scene}, {gear.changes()}: {result.status}, {result.message}")
    return result


def quickest(run: Callable[[], rps.Result], repeats: int, slow: float = np.inf) -> rps.Result:
    """The run with the least CPU time of the solver; one that takes `slow` [s] is not repeated."""
    runs = [run()]
    while len(runs) < repeats and runs[0].counters["solver_cpu"] < slow:
        runs.append(run())
    return min(runs, key=lambda result: result.counters["solver_cpu"])


def least_time(work: Callable[[], Found], repeats: int = 5) -> tuple[float, Found]:
    """CPU time of this process [s], the least of repeats, and what the last one found."""
    best = np.inf
    for _ in range(repeats):
        start = process_time()
        found = work()
        best = min(best, process_time() - start)
    return best, found
