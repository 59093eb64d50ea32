"""Equilibria in steps as fine as the drive's force asks for."""

from dataclasses import replace

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.solvers.drive import Drive
from rps_exudyn.solvers.equilibrium import Balance, EquilibriumPath
from rps_exudyn.solvers.settled_start import Approach, settled_path

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
    path = settled_path(balance, pair, drive, approach, time)
    evaluations, iterations, tangents = path.evaluations, path.iterations, path.tangents
    for _ in range(MAX_HALVINGS):
        if not path.converged:
            break
        missed = _missed(time, path.forces[-len(time) :, drive.coordinate]) > tolerance
        halved = missed[:-1] | missed[1:]
        if not halved.any():
            break
        time = np.insert(time, np.flatnonzero(halved) + 1, ((time[:-1] + time[1:]) / 2)[halved])
        path = settled_path(balance, pair, drive, approach, time)
        evaluations += path.evaluations
        iterations += path.iterations
        tangents += path.tangents
    return replace(path, evaluations=evaluations, iterations=iterations, tangents=tangents)


def _missed(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Distance of each value from the cubic through its four neighbours; 0 at the two ends each way."""
    missed = np.zeros(len(x))
    at = x[2:-2]
    nodes = [x[:-4], x[1:-3], x[3:-1], x[4:]]
    values = [y[:-4], y[1:-3], y[3:-1], y[4:]]
    cubic = np.zeros(len(at))
    for i, value in enumerate(values):
        weight = np.ones(len(at))
        for j, node in enumerate(nodes):
            if j != i:
                weight *= (at - node) / (nodes[i] - node)
        cubic += weight * value
    missed[2:-2] = np.abs(y[2:-2] - cubic)
    return missed
