"""Sensitivity indices of a study that was sampled for them: elementary effects (Morris), Sobol indices.

    found = indices(CaseTable.of(store), "torque_mean")
    found.rows["friction"]["total"].value

By SALib, which the extra `[sensitivity]` installs. A case whose number is unknown takes its whole trajectory
(Morris) or block (Saltelli) with it. Sources: Morris, Technometrics 33 (1991) 161; Campolongo et al.,
Environmental Modelling & Software 22 (2007) 1509; Saltelli et al., Computer Physics Communications 181
(2010) 259.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.study.designs import MORRIS_LEVELS, points_per_sample, salib, unit_problem
from rps_exudyn.study.table import CaseTable

MORRIS, SALTELLI = "morris", "saltelli"
DESIGNS = (MORRIS, SALTELLI)
"""Designs that were laid out for indices."""

LEAST_GROUPS = 2  # trajectories or blocks, for the confidence intervals
SEED = 0  # of the bootstrap: the same study gives the same intervals

KINDS = {
    MORRIS: {
        "mean absolute effect": "mu*: mean absolute change of the metric over the whole axis",
        "mean effect": "mu: mean change of the metric over the whole axis",
        "spread of the effect": "sigma: large if the axis acts nonlinearly or together with others",
    },
    SALTELLI: {
        "first order": "S1: fraction of the variance that the axis explains by itself",
        "total": "ST: fraction of the variance to which the axis contributes, with all its interactions",
    },
}
"""Design -> name of each index, and its meaning behind its symbol, by which SALib names it."""


@dataclass(frozen=True)
class Index:
    """One index with the half width of its 95 % confidence interval (nan if it has none)."""

    value: float
    confidence: float


@dataclass(frozen=True)
class Indices:
    """All indices of one number."""

    design: str
    rows: dict[str, dict[str, Index]]  # axis -> name of the index -> value
    groups: int  # trajectories or blocks that entered
    left_out: int  # trajectories or blocks with an unknown number


def indices(table: CaseTable, name: str) -> Indices:
    """The indices of the summary's number `name`.

    Raises:
        InputError: the design yields no indices, too few cases have a number, or SALib is not installed.
    """
    design = table.description.design
    if design not in DESIGNS:
        raise InputError(
            f"{table.path} has the design {design}; indices need the design {' or '.join(DESIGNS)}."
        )
    if name not in table.numbers:
        known = ", ".join(table.numbers) or "none yet"
        raise InputError(f"{name} is no number of this study; there are {known}.")
    inputs, numbers = _inputs(table), table.numbers[name]
    size = points_per_sample(design, len(table.axes))
    whole = _whole_groups(numbers, size, table)
    known_inputs, known_numbers = inputs[np.repeat(whole, size)], numbers[np.repeat(whole, size)]
    problem = unit_problem(table.axes)
    if design == MORRIS:
        lows, highs = inputs.min(axis=0), inputs.max(axis=0)
        scaled = (known_inputs - lows) / np.where(highs > lows, highs - lows, 1)
        analyze = salib("analyze.morris").analyze
        found = analyze(problem, scaled, known_numbers, num_levels=MORRIS_LEVELS, seed=SEED)
    else:
        analyze = salib("analyze.sobol").analyze
        found = analyze(problem, known_numbers, calc_second_order=False, seed=SEED)
    rows = {
        axis: {kind: _index(found, meaning, at) for kind, meaning in KINDS[design].items()}
        for at, axis in enumerate(table.axes)
    }
    return Indices(design, rows, int(whole.sum()), int((~whole).sum()))


def _index(found: Mapping[str, Any], meaning: str, at: int) -> Index:
    """The index of the axis number `at` from SALib's answer."""
    name = meaning.partition(":")[0].replace("*", "_star")
    confidence = found.get(f"{name}_conf")
    return Index(float(found[name][at]), float("nan") if confidence is None else float(confidence[at]))


def _inputs(table: CaseTable) -> np.ndarray:
    """Values of the axes, shape (cases, axes); the words of a choice are numbered."""
    columns = [
        values if values.dtype.kind == "f" else np.unique(values, return_inverse=True)[1].astype(float)
        for values in table.axes.values()
    ]
    return np.stack(columns, axis=1)


def _whole_groups(numbers: np.ndarray, size: int, table: CaseTable) -> np.ndarray:
    """Return which groups of `size` cases have no unknown number, shape (groups,).

    Raises:
        InputError: too few.
    """
    if numbers.size % size:
        raise InputError(
            f"{table.path} has {numbers.size} cases, which are not whole groups of {size} as its design "
            f"{table.description.design} needs them."
        )
    whole = np.isfinite(numbers).reshape(-1, size).all(axis=1)
    if whole.sum() < LEAST_GROUPS:
        raise InputError(
            f"{table.path} has {whole.sum()} complete groups of {size} cases; indices need at least "
            f"{LEAST_GROUPS}."
        )
    return np.asarray(whole)
