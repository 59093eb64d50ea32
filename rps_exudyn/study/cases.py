"""From a study to its cases: the design's points, each case's hash, and the folder's description."""

import hashlib
import itertools
import json
import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.parameters.setup import Setup
from rps_exudyn.study.axis_tables import CUT
from rps_exudyn.study.definition import Study
from rps_exudyn.study.description import GRID_DESIGN, Axis, Case, Description, Value

MODEL_VERSION = 1
"""To be raised when the same parameters give other numbers: finished cases are then done anew."""

MOST_CASES = 1_000_000


def case_hash(scene: str, gear: SteeringGear, fidelity: Fidelity) -> str:
    """Sixteen hex digits that name a case: all that its numbers depend on, and nothing else."""
    content = {
        "scene": scene,
        "gear": gear.model_dump(include=set(SteeringGear.model_fields)),
        "fidelity": fidelity.model_dump(exclude={"name", "based_on"}),
        "model": MODEL_VERSION,
    }
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()[:16]


def count_of(study: Study) -> int:
    """How many cases the design has, without laying them out.

    Raises:
        InputError: more than anyone could run.
    """
    if study.design == GRID_DESIGN:
        count = math.prod(len(axis.values or ()) for axis in study.axes)
    else:
        count = study.samples * _PER_SAMPLE.get(study.design, lambda axes: 1)(len(study.axes))
    if count > MOST_CASES:
        raise InputError(f"{study.file}: the design has {count} cases; at most {MOST_CASES} are allowed.")
    return count


_PER_SAMPLE = {"morris": lambda axes: axes + 1, "saltelli": lambda axes: axes + 2}


def describe(study: Study, provenance: Mapping[str, Any]) -> Description:
    """The study with all its cases laid out and named.

    Raises:
        InputError: values of several axes that do not fit each other.
    """
    base = study.base
    return Description(
        name=study.name,
        title=study.title,
        scene=study.scene,
        fidelity=base.fidelity.model_dump(),
        base=base.steering_gear.changed(),
        axes=study.axes,
        design=study.design,
        seed=None if study.design == GRID_DESIGN else study.seed,
        cases=tuple(_cases(study)),
        signals=study.keep,
        time_limit=study.time_limit,
        provenance=dict(provenance),
    )


def setup_of(study: Study, case: Case) -> Setup:
    """Gear and fidelity of a case."""
    return study.setup(_settings(study, case.values))


def _settings(study: Study, values: Mapping[str, Value]) -> dict[str, Value]:
    """Path -> value of all that the axes move."""
    return {path: value for axis in study.axes for path, value in axis.settings(values[axis.name]).items()}


def _cases(study: Study) -> Iterator[Case]:
    problems: dict[str, None] = {}
    for values in points(study.axes, study.design, study.samples, study.seed):
        settings = _settings(study, values)
        try:
            setup = study.setup(settings)
        except InputError as error:
            told = ", ".join(f"{path} = {value}" for path, value in settings.items())
            problems |= dict.fromkeys(f"{study.file}: the case {told}: {item}" for item in error.problems)
            if len(problems) >= 10:
                break
        else:
            yield Case(case_hash(study.scene, setup, setup.fidelity), values)
    if problems:
        raise InputError(problems)


# --- designs -----------------------------------------------------------------------------------


def points(axes: tuple[Axis, ...], design: str, samples: int, seed: int) -> Iterator[dict[str, Value]]:
    """Axis name -> SI value of every case.

    A grid's last axis changes fastest. Sampled designs draw in the unit cube and map each coordinate by the
    inverse of its axis' distribution, so that the same seed gives the same points everywhere.

    Raises:
        InputError: a sensitivity design without the package that draws it.
    """
    names = [axis.name for axis in axes]
    if design == GRID_DESIGN:
        rows: Iterable[Iterable[Value]] = itertools.product(*(axis.values or () for axis in axes))
    else:
        unit = _DRAW[design](len(axes), samples, seed)
        rows = ([drawn(axis, float(u)) for axis, u in zip(axes, row, strict=True)] for row in unit)
    for row in rows:
        yield dict(zip(names, row, strict=True))


def drawn(axis: Axis, u: float) -> Value:
    """The axis' value below which it lies with probability u."""
    if axis.values is not None:
        return axis.values[min(int(u * len(axis.values)), len(axis.values) - 1)]
    first, second = axis.distribution["numbers"]
    kind = axis.distribution["kind"]
    if kind == "uniform":
        return float(first + u * (second - first))
    if kind == "loguniform":
        return float(first * (second / first) ** u)
    from scipy.special import ndtr, ndtri

    within = ndtr(-CUT) + u * (ndtr(CUT) - ndtr(-CUT))  # cut off at CUT deviations
    return float(first + second * np.clip(ndtri(within), -CUT, CUT))


def _latin_hypercube(axes: int, samples: int, seed: int) -> np.ndarray:
    from scipy.stats import qmc

    return np.asarray(qmc.LatinHypercube(axes, rng=np.random.default_rng(seed)).random(samples))


def _sobol(axes: int, samples: int, seed: int) -> np.ndarray:
    from scipy.stats import qmc

    power = max(0, math.ceil(math.log2(samples)))  # the sequence is even over powers of two
    return np.asarray(qmc.Sobol(axes, rng=np.random.default_rng(seed)).random_base2(power)[:samples])


def _random(axes: int, samples: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).random((samples, axes))


def _unit_problem(axes: int) -> dict[str, Any]:
    """As SALib wants it: every coordinate from 0 to 1."""
    return {"num_vars": axes, "names": [str(k) for k in range(axes)], "bounds": [[0.0, 1.0]] * axes}


def _morris(axes: int, samples: int, seed: int) -> np.ndarray:
    return np.asarray(_salib("morris").sample(_unit_problem(axes), samples, num_levels=4, seed=seed))


def _saltelli(axes: int, samples: int, seed: int) -> np.ndarray:
    return np.asarray(
        _salib("sobol").sample(_unit_problem(axes), samples, calc_second_order=False, seed=seed)
    )


def _salib(name: str) -> Any:
    from importlib import import_module

    try:
        return import_module(f"SALib.sample.{name}")
    except ImportError:
        raise InputError(
            "morris and saltelli designs need SALib: pip install 'rps-exudyn[sensitivity]'."
        ) from None


_DRAW = {
    "latin-hypercube": _latin_hypercube,
    "sobol": _sobol,
    "random": _random,
    "morris": _morris,
    "saltelli": _saltelli,
}
