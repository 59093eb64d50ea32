"""Samples of the posterior of a fit, for bands of the fitted gear, whose parameters vary together.

Parameters of the level are normal in their logarithms, with the fit's covariance: nuisances, what the model
of a weight may be wrong by, and repeatability are in it (the model's discrepancy, as Kennedy and O'Hagan name
it, J. R. Stat. Soc. B 63 (2001) 425). What another contact law moves is added or taken off, with equal
chance, while the levels stay. The runout follows from P e, which is measured, and the sample's preload; bow
and angle error from the shape.
"""

import numpy as np

from rps_exudyn.inference.fitting.level import Runout
from rps_exudyn.inference.fitting.level_fit import LevelModel
from rps_exudyn.inference.fitting.noise import NORMAL
from rps_exudyn.inference.fitting.problem import FitState
from rps_exudyn.inference.fitting.unknowns import SMALLEST, Unknown, settings_of

SAMPLES = 512
CORRECTIONS = 4
RANK = 1e-6  # of the largest variance of levels: what is below it, the unknowns do not move
SEED = 0


def level_samples(model: LevelModel, end: FitState, laws: np.ndarray) -> dict[str, np.ndarray]:
    """Return path -> values (SAMPLES,) of the level's parameters; `laws` (unknowns,) is what another contact
    law moves.

    A level that is known well, of factors that are not, is no straight line of their logarithms: each sample
    is moved as little as the covariance allows, until its levels are those of the straight line.
    """
    drawn, slopes, levels = _drawn(end.u, end.covariance, SEED), model.slopes(end.u), model.at(end.u)
    wanted = levels + (drawn - end.u) @ slopes.T
    together = slopes @ end.covariance @ slopes.T
    back = np.linalg.pinv(together, rcond=RANK, hermitian=True) @ slopes @ end.covariance
    drawn = drawn + _signs(SEED)[:, None] * laws
    for _ in range(CORRECTIONS):
        drawn += np.array([aim - model.at(u) for aim, u in zip(wanted, drawn, strict=True)]) @ back
    return _values(list(model.unknowns), drawn)


def shape_samples(
    unknowns: list[Unknown], u: np.ndarray, covariance: np.ndarray, laws: np.ndarray
) -> dict[str, np.ndarray]:
    """Return path -> values (SAMPLES,) of the parameters of the shape."""
    return _values(unknowns, _drawn(u, covariance, SEED + 2) + _signs(SEED + 2)[:, None] * laws)


def _values(unknowns: list[Unknown], drawn: np.ndarray) -> dict[str, np.ndarray]:
    settings = [settings_of(unknowns, row) for row in drawn]
    return {path: np.array([each[path] for each in settings]) for path in settings[0]}


def _signs(seed: int) -> np.ndarray:
    return np.where(np.random.default_rng(seed).permutation(SAMPLES) % 2, 1.0, -1.0)


def runout_samples(
    runout: Runout, angle: float, offset_sd: float, preload: np.ndarray
) -> dict[str, np.ndarray]:
    """Return path -> values of runout and direction, by P e over the preload of each sample (SAMPLES,) [N];
    `angle` is the direction in the fitted gear, `offset_sd` the deviation of the measured angle's offset."""
    seen = float(np.hypot(*runout.vector))
    across = runout.angle_sd * seen
    along = (runout.stored_interval[1] - (runout.stored if runout.is_found else seen)) / NORMAL
    deviations = np.diag([along, across, offset_sd]) ** 2
    wave = _drawn(np.array([runout.stored, 0.0, angle]), deviations, SEED + 1)
    return {
        "pinion.runout": np.maximum(np.hypot(wave[:, 0], wave[:, 1]) / preload, SMALLEST),
        "pinion.runout_angle": wave[:, 2] + np.arctan2(wave[:, 1], wave[:, 0]),
    }


def _drawn(mean: np.ndarray, covariance: np.ndarray, seed: int) -> np.ndarray:
    """Normal samples (SAMPLES, n) whose mean and covariance are exactly these; n may be 0."""
    if not mean.size:
        return np.zeros((SAMPLES, 0))
    normal = np.random.default_rng(seed).standard_normal((SAMPLES, mean.size))
    normal -= normal.mean(axis=0)
    normal = normal @ np.linalg.inv(np.linalg.cholesky(np.cov(normal.T, bias=True).reshape(mean.size, -1)).T)
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(mean + normal @ (vectors * np.sqrt(np.maximum(values, 0.0))).T)
