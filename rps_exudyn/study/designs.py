"""Designs of experiments: the points of a grid or of a sampled design, axis by axis.

Sampled designs draw in the unit cube and map each coordinate by the inverse of its axis' distribution. The
same seed gives the same points everywhere.
"""

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from importlib import import_module
from types import MappingProxyType
from typing import Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.inference.uncertainty.input_sets import carried, uncertain_inputs
from rps_exudyn.inference.uncertainty.joint import correlated, read_pairs
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.parameters.gear import CORRELATION, POSTERIOR, SteeringGear
from rps_exudyn.study.definition import GRID_DESIGN, UNCERTAIN_DESIGN, Axis, Value

MORRIS_LEVELS = 4  # levels that an axis takes in a Morris design


def points(
    axes: tuple[Axis, ...],
    design: str,
    samples: int,
    seed: int,
    correlation: Mapping[str, float] = MappingProxyType({}),
) -> Iterator[dict[str, Value]]:
    """Axis name -> SI value of every case; a grid's last axis changes fastest."""
    names = [axis.name for axis in axes]
    if design == GRID_DESIGN:
        rows: Iterable[Iterable[Value]] = itertools.product(*(axis.values or () for axis in axes))
    else:
        unit = _unit_points(design, len(axes), samples, seed)
        unit = correlated(unit, names, read_pairs(correlation, CORRELATION, []))
        rows = zip(*(drawn(axis, column) for axis, column in zip(axes, unit.T, strict=True)), strict=True)
    return (dict(zip(names, row, strict=True)) for row in rows)


def points_per_sample(design: str, axes: int) -> int:
    """Number of points that a sampled design draws for each of its samples."""
    return {"morris": axes + 1, "saltelli": axes + 2}.get(design, 1)


def drawn(axis: Axis, fractions: np.ndarray) -> Sequence[Value]:
    """The quantiles (0 to 1) of a sampled axis' distribution, one for each fraction."""
    if axis.values is not None:
        last = len(axis.values) - 1
        return [axis.values[min(int(u * (last + 1)), last)] for u in fractions.tolist()]
    return _distribution(axis).quantiles(fractions)


def ends(axis: Axis) -> tuple[float, float]:
    """Least and greatest value that a sampled axis may draw."""
    return _distribution(axis).ends


def _distribution(axis: Axis) -> Distribution:
    return Distribution(axis.distribution["kind"], *axis.distribution["numbers"])


def salib(module: str) -> Any:
    """A module of SALib, for instance "sample.morris".

    Raises:
        InputError: SALib is not installed.
    """
    try:
        return import_module(f"SALib.{module}")
    except ImportError:
        raise InputError(
            "Sensitivity designs and indices need SALib: install rps-exudyn with its extra [sensitivity]."
        ) from None


def unit_problem(names: Iterable[str]) -> dict[str, Any]:
    """SALib's description of axes that go from 0 to 1."""
    names = list(names)
    return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}


def _unit_points(design: str, axes: int, samples: int, seed: int) -> np.ndarray:
    """Points of a sampled design in the unit cube, shape (points, axes)."""
    rng, problem = np.random.default_rng(seed), unit_problem(map(str, range(axes)))
    if design in ("latin-hypercube", UNCERTAIN_DESIGN):
        from scipy.stats import qmc  # loads in a second

        points = qmc.LatinHypercube(axes, rng=rng).random(samples)
    elif design == "sobol":
        from scipy.stats import qmc

        power = max(0, math.ceil(math.log2(samples)))  # the sequence is even over powers of two
        points = qmc.Sobol(axes, rng=rng).random_base2(power)[:samples]
    elif design == "random":
        points = rng.random((samples, axes))
    elif design == "morris":
        points = salib("sample.morris").sample(problem, samples, num_levels=MORRIS_LEVELS, seed=seed)
    else:
        points = salib("sample.sobol").sample(problem, samples, calc_second_order=False, seed=seed)
    return np.asarray(points)


# --- The axes of the design `uncertain`: one for each parameter that carries a distribution


def uncertain_axes(
    gear: Mapping[str, Any], settings: Mapping[str, Any], inputs: str, others: Sequence[Axis]
) -> tuple[tuple[Axis, ...], dict[str, float]]:
    """Return axes for the distributions of the gear's file, settings and a set of inputs; their correlations.

    Args:
        gear: tables of the gear's file.
        settings: path -> value of single parameters.
        inputs: name of the set; "" for `own` where a parameter carries a distribution, else `series`.
        others: axes of the study's own tables, whose parameters are left to them.

    Raises:
        InputError: a distribution that cannot be, no such set, or samples of a fit.
    """
    own = carried(gear, settings)
    if own.posterior:
        raise InputError(
            f"the gear's file has a table {POSTERIOR}, from which run --band and check draw, but no study; "
            "leave it out, or give distributions."
        )
    given = {path for axis in others for path in (*axis.paths, *axis.along)}
    nominal = SteeringGear.from_tables(gear, settings)
    found = uncertain_inputs(nominal, inputs, own, bool(others))
    declared = {item.path: item for item in SteeringGear.declared()}
    axes = []
    for path, each in found.items():
        if path not in given:
            unit = declared[path].unit
            distribution = {"kind": each.kind, "numbers": [each.first, each.second]}
            name, shown = path, unit.display if unit else ""
            axes.append(Axis(name, (path,), shown, None, "sampled", distribution=distribution))
    pairs = {pair: value for pair, value in found.pairs.items() if not pair & given}
    return tuple(axes), {", ".join(sorted(pair)): value for pair, value in pairs.items()}
