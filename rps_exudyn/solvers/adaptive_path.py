"""Equilibria in steps as fine as the drive's force asks for."""

from dataclasses import replace

import numpy as np

from rps_exudyn.analysis.resolution import missed
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.solvers.balance import Balance
from rps_exudyn.solvers.drive import Drive
from rps_exudyn.solvers.equilibrium import EquilibriumPath
from rps_exudyn.solvers.settled_start import Approach, path_from, settled_start

MAX_HALVINGS = 8


def adaptive_path(
    balance: Balance,
    pair: GearPair,
    drive: Drive,
    approach: Approach | None,
    time: np.ndarray,
    tolerance: float,
) -> EquilibriumPath:
    """Follow as `settled_path`, with instants put between those of `time` where the drive's force bends.

    An instant is missed by as much as the force differs from the cubic through its four neighbours; the
    intervals beside one that is missed by more than `tolerance` [N m or N] are halved, until none is.
    """
    led = settled_start(balance, pair, drive, approach, time[:1])
    path = path_from(led, balance, pair, drive, time)
    evaluations, iterations, tangents = path.evaluations, path.iterations, path.tangents
    for _ in range(MAX_HALVINGS):
        if not path.converged:
            break
        coarse = missed(time, path.forces[-len(time) :, drive.coordinate]) > tolerance
        halved = coarse[:-1] | coarse[1:]
        if not halved.any():
            break
        time = np.insert(time, np.flatnonzero(halved) + 1, ((time[:-1] + time[1:]) / 2)[halved])
        path = path_from(led, balance, pair, drive, time)
        evaluations += path.evaluations - (led.evaluations if led else 0)
        iterations += path.iterations - (led.iterations if led else 0)
        tangents += path.tangents - (led.tangents if led else 0)
    return replace(path, evaluations=evaluations, iterations=iterations, tangents=tangents)
