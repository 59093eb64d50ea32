"""Derivatives of all metrics of a scene with respect to the parameters of a gear, with their errors.

    found = sensitivities("free-pinion-torque", gear)
    found["slope"].sel(metric="torque_mean", parameter="yoke.preload")     # N m per N

The gears a step above and below are computed together, from the reference gear's motion, where the scene
allows it; the others run singly. The error of a slope has three parts:

    2 |D_1(h) - D_0(2 h)|              levels of the ladder, and curvature
    |2 S_1(h) - S_0(2 h) / 2| / 2 h    a kink, as of |x|; of a parabola it is 0
    NOISE size / h                     equilibria are found to a hundred thousandth of their forces, and a
                                       ripple is a difference of torques

D_k(h) is the central difference at level k of the ladder with the step h, S_k(h) the second difference.

Where one side is not allowed, D is the difference to the gear itself, and there is no S.
"""

from collections.abc import Sequence
from contextlib import suppress
from typing import NamedTuple

import numpy as np
from xarray import Dataset

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear, check_gear, declared_number
from rps_exudyn.parameters.wrong_values import nearest_names
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.contact_law import resolve_contact_law
from rps_exudyn.scenes.error_bars import size_of, sizes
from rps_exudyn.scenes.scene import RunOptions
from rps_exudyn.simulate.gear_table import TABLES, is_weighted, metrics_nearby, record_at, unsupported_reason
from rps_exudyn.simulate.run import simulate
from rps_exudyn.simulate.run_plan import Plan
from rps_exudyn.simulate.shared_maneuver import SINGLE_OUT, is_alike

STEP = 0.01  # of a value: 1000 times the noise of equilibria
STEPS = {"m": 2e-6, "rad": 5e-4, "N": 1.0, "N*m": 1e-3, "": 0.01, "N*s/m": 10.0, "m/s^2": 0.1, "s": 1e-5}
"""SI unit -> step from 0: what gears of a series scatter by."""
NOISE = 1e-5  # of the size of a metric, or of the run's torque, force or work
FACTOR = 2.0  # as of the error bars of metrics
SIZES = {1: 1, 0: 2}  # level -> steps up and down
LINE_STIFFNESS = "mesh.line_stiffness"  # whose 0 stands for a value that follows from the gear
NUMBERS = [item for item in SteeringGear.declared() if item.unit is not None]


def sensitivities(
    scene: str,
    gear: SteeringGear,
    metrics: Sequence[str] | None = None,
    parameters: Sequence[str] | None = None,
    *,
    fidelity: str | Fidelity = "quasi-static",
) -> Dataset:
    """Return value, slope and error over the dimensions `metric` and `parameter`, all SI.

    Beside them stand the `step` of each parameter, whether its gears were computed `together`, and the
    `value_error` of each metric. A slope is nan where no gear a step away can exist or ends ok.

    Args:
        scene: one of `scenes.SCENE_NAMES`.
        gear: about which the slopes are.
        metrics: names; by default all that the scene simulates and gears together have.
        parameters: paths; by default all numbers of the gear but choices of the model.
        fidelity: name of a preset, or a `Fidelity`.

    Raises:
        InputError: no such scene, metric or parameter, or a gear whose run fails.

    Examples:
        >>> found = rps.sensitivities("free-pinion-torque", rps.SteeringGear(), parameters=["bush.drag"])
        >>> float(found["slope"].sel(metric="torque_mean", parameter="bush.drag").round(4))
        0.0057
    """
    check_gear(gear)
    chosen = fidelity if isinstance(fidelity, Fidelity) else Fidelity.preset(fidelity)
    gear = resolve_contact_law(gear, chosen, scene_named(scene).law)
    paths = _paths(parameters)
    wrong = [name for name in metrics or () if name not in SUMMARY]
    if wrong:
        raise InputError(
            [f"{name} is no metric; {nearest_names(name, [*SUMMARY], ['torque_mean'])}." for name in wrong]
        )
    nominal = simulate(scene, gear, chosen)
    if nominal.status is not Status.OK:
        raise InputError(f"the run of the gear ends {nominal.status}: {nominal.message}.")
    names = [name for name in nominal.summary if SUMMARY[name].simulated] if metrics is None else [*metrics]
    if missing := [name for name in names if name not in nominal.summary]:
        near = nearest_names(missing[0], [*nominal.summary], nominal.summary)
        raise InputError(f"{scene} has no {missing[0]}; {near}.")
    test = scene_named(scene).test is not None
    weighted = test and is_weighted(scene_named(scene), gear)
    own: Records = {level: record_at(gear, chosen, level, weighted) if test else None for level in SIZES}
    stencils = [_stencil(scene, gear, path, chosen, own, weighted) for path in paths]
    value = np.array([nominal.summary[name] for name in names])
    differences, together = _differences(scene, gear, chosen, stencils, names, own, metrics is not None)
    fine, coarse = differences[1], differences[0]
    of_run = sizes(dict(nominal.signals), nominal.summary)
    size = np.array(  # small metrics are differences of the forces that balance
        [
            max(size_of(name, each, of_run), of_run.get(SUMMARY[name].unit, 0.0))
            for name, each in zip(names, value, strict=True)
        ]
    )
    step = np.array([each.step for each in stencils])
    slope, kink = fine[0], np.abs(2 * fine[1] - coarse[1] / 2) / (2 * step)
    error = FACTOR * np.abs(slope - coarse[0]) + np.nan_to_num(kink) + NOISE * size[:, None] / step
    unmoved = np.array([each.is_idle for each in stencils])
    slope[:, unmoved] = error[:, unmoved] = 0.0
    if metrics is None and (moved := together & ~unmoved).any():
        kept = np.isfinite(slope[:, moved]).any(axis=1)
        names = [name for name, each in zip(names, kept.tolist(), strict=True) if each]
        value, slope, error = value[kept], slope[kept], error[kept]
    bars = [nominal.errors.get(name, np.nan) for name in names]
    units = [item.unit.si if item.unit else "" for path in paths for item in SteeringGear.declared_at(path)]
    both = ("metric", "parameter")
    return Dataset(
        {"value": ("metric", value), "slope": (both, slope), "error": (both, error)},
        coords={
            "metric": names,
            "parameter": paths,
            "step": ("parameter", step),
            "together": ("parameter", together),
            "unit": ("metric", [SUMMARY[name].unit for name in names]),
            "parameter_unit": ("parameter", units),
            "value_error": ("metric", bars),
        },
        attrs={"scene": scene, "fidelity": chosen.name, "contact_law": gear.mesh.law},
    )


def _paths(parameters: Sequence[str] | None) -> list[str]:
    """The parameters asked for, or the gear's own numbers.

    Raises:
        InputError: no such parameter, or one that is no number.
    """
    if parameters is None:
        return [
            each.path for each in NUMBERS if each.source != "choice" and each.path.partition(".")[0] in TABLES
        ]
    for path in parameters:
        declared_number(path, [*TABLES])
    return list(parameters)


Records = dict[int, np.ndarray | None]
"""Level -> record of the gear itself; None where gears are not computed together."""


class _Stencil(NamedTuple):
    """A parameter's step [SI]; level -> gears above and below, None of one that cannot exist, and the records
    of those that may be computed together; whether the scene's model does not contain the parameter."""

    step: float
    sides: dict[int, list[tuple[SteeringGear | None, np.ndarray | None]]]
    is_idle: bool = False


def _stencil(
    scene: str, gear: SteeringGear, path: str, fidelity: Fidelity, own: Records, weighted: bool
) -> _Stencil:
    """About the gear: a step up and down at level 1, two of them at level 0."""
    value = float(gear.value_at(path)) or (line_stiffness(gear) if path == LINE_STIFFNESS else 0.0)
    unit = SteeringGear.declared_at(path)[0].unit
    step = abs(value) * STEP or STEPS.get(unit.si if unit else "", 1.0)
    apart = path in SINGLE_OUT and is_alike(gear, {})
    apart |= bool(unsupported_reason(scene, gear, fidelity, {path: [value]}))
    sides: dict[int, list[tuple[SteeringGear | None, np.ndarray | None]]] = {level: [] for level in own}
    for level, base in own.items():
        for sense in (1, -1):
            one = made = None
            with suppress(InputError):
                one = gear.replace({path: value + sense * SIZES[level] * step})
            if one is not None and not apart:
                made = record_at(one, fidelity, level, weighted)
                one = None if made is None else one
            if made is not None and base is not None and made.tobytes() == base.tobytes():
                return _Stencil(step, {}, is_idle=True)
            sides[level].append((one, made))
    return _Stencil(step, sides)


def _differences(
    scene: str,
    gear: SteeringGear,
    fidelity: Fidelity,
    stencils: Sequence[_Stencil],
    names: Sequence[str],
    own: Records,
    complete: bool,
) -> tuple[dict[int, np.ndarray], np.ndarray]:
    """Return, by level, first differences over the step and second differences, (2, metrics, parameters), and
    which parameters were computed together, (parameters,).

    Gears that lack a metric together run singly if all are to be `complete`.
    """

    def run(one: SteeringGear, level: int) -> list[float]:
        with suppress(InputError):
            done = Plan(scene, one, fidelity).run(RunOptions(bars=False, level=level))
            if done.status is Status.OK:
                return [done.summary.get(name, np.nan) for name in names]
        return [np.nan] * len(names)

    found, alone, step = {}, set[int](), np.array([each.step for each in stencils])
    for level, record in own.items():
        rows = [
            (i, j, one, made)
            for j, each in enumerate(stencils)
            for i, (one, made) in enumerate(each.sides.get(level, ()), 1)
            if one is not None
        ]
        values = np.full((3, len(names), len(stencils)), np.nan)  # of the gear itself, above, below
        nearby = [(i, j, one, made) for i, j, one, made in rows if made is not None]
        if nearby and record is not None:
            gears, records = [gear, *(each[2] for each in nearby)], [record, *(each[3] for each in nearby)]
            ended, metrics = metrics_nearby(scene, gear, fidelity, level, gears, records)
            unknown = np.full(len(gears), np.nan)
            for k, (i, j, *_) in enumerate(nearby, 1):
                if ended[0] and ended[k]:
                    values[i, :, j] = [metrics.get(name, unknown)[k] for name in names]
                    values[0, :, j] = [metrics.get(name, unknown)[0] for name in names]
        lacking = np.any if complete else np.all
        singly = {j for i, j, *_ in rows if lacking(np.isnan(values[i, :, j]))}
        if singly:
            values[0][:, [*singly]] = np.array(run(gear, level))[:, None]
        for i, j, one, _ in rows:
            if j in singly:
                values[i, :, j] = run(one, level)
        base, above, below = values
        sides = np.isfinite(above).astype(int) + np.isfinite(below)
        width = np.where(sides > 0, SIZES[level] * step * sides, np.nan)
        first = np.where(np.isnan(above), base, above) - np.where(np.isnan(below), base, below)
        found[level] = np.stack([first / width, above + below - 2 * base])
        alone |= singly
    return found, ~np.isin(np.arange(len(stencils)), [*alone])
