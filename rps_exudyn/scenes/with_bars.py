"""A run with error bars: two neighbouring levels of the ladder, the finer of which is printed.

    run = run_with_bars(scene_named("reversal"), gear, fidelity, RunOptions(level=1))
    run.summary["torque_jump"], run.errors["torque_jump"]

Level 1 and its companion, level 0, serve by default; level 0 has level 1 as its companion. Where the
companion is lost, the next level serves, and is printed; where that is lost too, the bars are unknown.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from rps_exudyn.base.progress import begin_stage
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Interrupted, Remark
from rps_exudyn.results.quantities import EXTREMES, MOTIONS, SPREADS
from rps_exudyn.scenes.bar_terms import (
    MOST_OF_TERMS,
    MOST_OF_WORK,
    bar_terms,
    leaves_inertia_out,
    missing_share,
    moved_by_inertia,
)
from rps_exudyn.scenes.checks.neglected_inertia import MovedMasses
from rps_exudyn.scenes.checks.rules import GROWN
from rps_exudyn.scenes.error_bars import Metrics, error_bars
from rps_exudyn.scenes.ladder import gear_at, model_at
from rps_exudyn.scenes.scene import RunOptions, Scene
from rps_exudyn.scenes.scene_run import SceneRun

EXCITED = (
    "friction excites a vibration that grows {:.3g} times over a pass and that the steps damp: the errors of "
    "peak to peak values, ranges, largest and smallest values are unknown"
)
FINE_SHARE = 2 / 3  # of the time of two levels, that the finer one takes
MOST_POWER = 20.0  # of e, that a sentence states


def run_with_bars(scene: Scene, gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Run a scene at the level of the options with error bars.

    Raises:
        InputError: a test or a model that the scene cannot have.
        Interrupted: Ctrl-C; it carries what was recorded.
    """
    level = options.level

    def run_at(each: int) -> SceneRun:
        begin_stage(*((0.0, FINE_SHARE) if each == level else (FINE_SHARE, 1.0)))
        return scene.run(gear_at(each, gear), model_at(each, fidelity), replace(options, level=each))

    first = run_at(level)
    if fidelity.solver == "closed-form":
        return _with_terms(scene, gear, fidelity, first.unsure_of(SPREADS | EXTREMES | MOTIONS), {})
    if not first.ok:
        return first
    try:
        other = run_at(level - 1 if level else 1)
        if other.ok:
            coarse, fine = (other, first) if level else (first, other)
            return _barred(scene, gear, fidelity, _described(first, level, other), fine, coarse)
        other = run_at(level + 1)
    except Interrupted:
        raise Interrupted(first) from None
    if not (level and other.ok):
        return _with_terms(scene, gear, fidelity, _described(first, level), None)
    return _barred(scene, gear, fidelity, _described(other, level + 1, first), other, first)


def _described(run: SceneRun, level: int, companion: SceneRun | None = None) -> SceneRun:
    """Return a run with the level that it has, and what both runs took."""
    both = [each.outcome for each in (run, companion) if each]
    names = dict.fromkeys(name for each in both for name in each.counters)
    outcome = replace(
        run.outcome,
        cpu_s=sum(each.cpu_s for each in both),
        counters={name: sum(each.counters.get(name, 0) for each in both) for name in names},
        findings={**run.outcome.findings, "level": level},
    )
    return replace(run, outcome=outcome)


def _barred(
    scene: Scene, gear: SteeringGear, fidelity: Fidelity, printed: SceneRun, fine: SceneRun, coarse: SceneRun
) -> SceneRun:
    """Return the printed run with the bars of two levels."""
    if len(fine.signals["time"]) == len(coarse.signals["time"]):  # a scene that leaves out its options
        return _with_terms(scene, gear, fidelity, printed, None)
    curves = fine.metrics is not None and not (scene.at_rest or scene.has_impacts)
    metrics, values, fewer = metrics_of(fine), fine.summary, coarse.summary
    bars = error_bars(metrics, fine.signals, values, coarse.signals, fewer, curves=curves)
    return _with_terms(scene, gear, fidelity, printed, bars)


def _with_terms(
    scene: Scene, gear: SteeringGear, fidelity: Fidelity, run: SceneRun, bars: Mapping[str, Any] | None
) -> SceneRun:
    """Return a run whose bars have their terms added; None: no level serves, all bars are unknown (nan)."""
    if not run.signals:
        return run
    masses = MovedMasses.of(gear)
    terms = bar_terms(
        scene, fidelity, metrics_of(run), run.signals, run.summary, run.outcome.findings, masses
    )
    found = dict.fromkeys(terms, np.nan) if bars is None else bars
    summed = {name: float(found.get(name, 0.0) + each) for name, each in terms.items()}
    errors = {name: each if np.isfinite(each) else np.nan for name, each in summed.items()}
    if (grown := run.outcome.findings.get("vibration_grows", 0.0)) > GROWN:
        remark = Remark(Code.PEAKS_UNRESOLVED, EXCITED.format(np.exp(min(grown, MOST_POWER))))
        run = run.noting(remark).unsure_of(SPREADS | EXTREMES)
    errors |= dict.fromkeys(errors.keys() & run.unsure, np.nan)
    run = replace(run, errors=errors)
    if not run.ok:
        return run
    if (missing := missing_share(run.signals)) > MOST_OF_WORK:
        text = f"the error of the work balance is {missing:.1%} (limit {MOST_OF_WORK:.0%})"
        return run.invalid(Code.WORK_MISSING, f"{text}; lower fidelity.step_angle")
    if not leaves_inertia_out(scene, fidelity):
        return run
    if (share := moved_by_inertia(scene, run.signals, run.summary, terms)) > MOST_OF_TERMS:
        text = f"the motion is too fast for equilibria: inertia may change {scene.figure} by"
        return run.invalid(
            Code.TURN_TOO_FAST, f"{text} {share:.0%} (limit {MOST_OF_TERMS:.0%}); choose generalized-alpha"
        )
    return run


def metrics_of(run: SceneRun) -> Metrics:
    """Return the function of a run's metrics; of a scene that states none, its summary of any signals."""
    return run.metrics or (lambda signals: run.summary)
