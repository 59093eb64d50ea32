"""Sensitivity indices of a study that was sampled for them: elementary effects (Morris), Sobol indices.

    found = indices(CaseTable.of(store), "torque_mean")
    found.rows["friction"]["total"].value

By SALib, which the extra `[sensitivity]` installs. A case whose number is unknown takes its whole trajectory
(Morris) or block (Saltelli) with it. Sources: Morris, Technometrics 33 (1991) 161; Campolongo et al.,
Environmental Modelling & Software 22 (2007) 1509; Saltelli et al., Computer Physics Communications 181
(2010) 259.
"""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.study.table import CaseTable

MORRIS, SALTELLI = "morris", "saltelli"
DESIGNS = (MORRIS, SALTELLI)
"""Designs that were laid out for indices."""

MORRIS_LEVELS = 4  # of the samples: SALib's default
LEAST_GROUPS = 2  # trajectories or blocks, for the confidence intervals
SEED = 0  # of the bootstrap: the same study tells the same intervals

KINDS = {
    MORRIS: {
        "mean absolute effect": "mu*: mean change of the number over the whole axis, without its sign",
        "mean effect": "mu: the same with its sign",
        "spread of the effect": "sigma: large if the axis acts non-linearly, or together with others",
    },
    SALTELLI: {
        "first order": "S1: share of the variance that the axis explains alone",
        "total": "ST: share of the variance in which the axis takes part, with all its interactions",
    },
}
"""Design -> name of each index, and what it means."""


@dataclass(frozen=True)
class Index:
    """One index with the half width of its 95 % confidence interval (nan if it has none)."""

    value: float
    confidence: float = float("nan")


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
        InputError: the study's design tells no indices, too few cases are known, or SALib is not installed.
    """
    design = table.description.design
    if design not in DESIGNS:
        raise InputError(
            f"{table.path} has the design {design}; indices need the design {' or '.join(DESIGNS)}."
        )
    if name not in table.numbers:
        known = ", ".join(table.numbers) or "none yet"
        raise InputError(f"{name} is no number of this study; there are {known}.")
    _check_installed()
    return (_morris if design == MORRIS else _sobol)(table, name)


def _check_installed() -> None:
    try:
        import SALib  # noqa: F401
    except ImportError:
        raise InputError(
            "Sensitivity indices need SALib: install rps-exudyn with its extra [sensitivity]."
        ) from None


def _morris(table: CaseTable, name: str) -> Indices:
    from SALib.analyze import morris

    inputs, numbers = _inputs(table), table.numbers[name]
    kept, left_out = _whole_groups(numbers, len(table.axes) + 1, table)
    lows, highs = inputs.min(axis=0), inputs.max(axis=0)
    told = morris.analyze(
        _problem(table),
        ((inputs - lows) / np.where(highs > lows, highs - lows, 1))[kept],
        numbers[kept],
        num_levels=MORRIS_LEVELS,
        seed=SEED,
    )
    rows = {
        axis: {
            "mean absolute effect": Index(float(told["mu_star"][at]), float(told["mu_star_conf"][at])),
            "mean effect": Index(float(told["mu"][at])),
            "spread of the effect": Index(float(told["sigma"][at])),
        }
        for at, axis in enumerate(table.axes)
    }
    return Indices(MORRIS, rows, int(kept.sum()) // (len(table.axes) + 1), left_out)


def _sobol(table: CaseTable, name: str) -> Indices:
    from SALib.analyze import sobol

    numbers, count = table.numbers[name], len(table.axes)
    second_order = _has_second_order(_inputs(table))
    size = 2 * count + 2 if second_order else count + 2
    kept, left_out = _whole_groups(numbers, size, table)
    told = sobol.analyze(_problem(table), numbers[kept], calc_second_order=second_order, seed=SEED)
    rows = {
        axis: {
            "first order": Index(float(told["S1"][at]), float(told["S1_conf"][at])),
            "total": Index(float(told["ST"][at]), float(told["ST_conf"][at])),
        }
        for at, axis in enumerate(table.axes)
    }
    return Indices(SALTELLI, rows, int(kept.sum()) // size, left_out)


def _inputs(table: CaseTable) -> np.ndarray:
    """Values of the axes, shape (cases, axes); the words of a choice are numbered."""
    columns = [
        values if values.dtype.kind == "f" else np.unique(values, return_inverse=True)[1].astype(float)
        for values in table.axes.values()
    ]
    return np.stack(columns, axis=1)


def _problem(table: CaseTable) -> dict[str, object]:
    """As SALib wants it; its methods used here look only at the names."""
    names = list(table.axes)
    return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}


def _whole_groups(numbers: np.ndarray, size: int, table: CaseTable) -> tuple[np.ndarray, int]:
    """Which cases stand in groups of `size` without an unknown number, shape (cases,); how many do not.

    Raises:
        InputError: too few.
    """
    if numbers.size % size:
        raise InputError(
            f"{table.path} has {numbers.size} cases, which are no whole groups of {size} as its design "
            f"{table.description.design} needs them."
        )
    whole = np.isfinite(numbers).reshape(-1, size).all(axis=1)
    if whole.sum() < LEAST_GROUPS:
        raise InputError(
            f"{table.path} has {whole.sum()} complete groups of {size} cases; indices need at least "
            f"{LEAST_GROUPS}."
        )
    return np.repeat(whole, size), int((~whole).sum())


def _has_second_order(inputs: np.ndarray) -> bool:
    """Whether blocks have the 2 D + 2 cases of second-order indices, not D + 2.

    A block is A, then A with each column from B, (then B with each column from A,) then B: the diagonal of
    the second part is B's own.
    """
    count = inputs.shape[1]
    last = 2 * count + 1
    diagonal = inputs[1 : count + 1].diagonal()
    return inputs.shape[0] > last and bool((diagonal == inputs[last]).all())
