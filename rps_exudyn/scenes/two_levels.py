"""A run with error bars: two neighbouring levels of the ladder, the finer of which is printed.

    levels = Levels(scene_named("reversal"), gear, fidelity, DEFAULT_OPTIONS)
    run = levels.with_bars(1)    # two runs
    run.summary["torque_jump"], run.errors["torque_jump"]
    levels.with_bars(2)          # one more: level 1 is its companion

Level 1 and its companion, level 0, serve by default; level 0 has level 1 as its companion. Where the
companion is lost, the next level serves, and is printed; where that is lost too, the bars are unknown.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from time import process_time
from typing import Any

import numpy as np

from rps_exudyn.base.progress import begin_stage
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Interrupted
from rps_exudyn.results.quantities import EXTREMES, MOTIONS, VARIATIONS
from rps_exudyn.scenes.checks.neglected_inertia import MovedMasses
from rps_exudyn.scenes.checks.rules import OF_BARS, SHORT_BARS, VIBRATES, RuleInput, breaches, remarks
from rps_exudyn.scenes.error_bar_terms import bar_terms
from rps_exudyn.scenes.error_bars import FLOOR, Metrics, error_bars
from rps_exudyn.scenes.ladder import gear_at, model_at
from rps_exudyn.scenes.scene import RunOptions, Scene
from rps_exudyn.scenes.scene_run import SceneRun, summed_cost

FINE_SHARE = 2 / 3  # of the time of two levels, that the finer one takes
GROWTH = 2.0  # at least, of CPU time from one level to the next
LEAST_SECONDS = 1e-6  # of a run that ends at once


@dataclass
class Levels:
    """Runs of one plan on levels of the ladder, each made once, whichever level it serves."""

    scene: Scene
    gear: SteeringGear
    fidelity: Fidelity
    options: RunOptions
    runs: dict[int, SceneRun] = field(default_factory=dict)  # level -> its run
    # level -> what is added to the bars of its metrics, whatever its companion
    terms: dict[int, Mapping[str, float]] = field(default_factory=dict)
    seconds: dict[int, float] = field(default_factory=dict)  # level -> CPU time of its run

    def with_bars(self, level: int) -> SceneRun:
        """Return the run of a level with error bars.

        Raises:
            Interrupted: Ctrl-C; it carries what was recorded.
        """
        first = self._at(level, (0.0, FINE_SHARE))
        if self.fidelity.solver == "closed-form":
            return self._with_terms(first.unsure_of(VARIATIONS | EXTREMES | MOTIONS), level, {})
        if not first.ok:
            return first
        try:
            other = self._at(level - 1 if level else 1, (FINE_SHARE, 1.0))
            if other.ok:
                coarse, fine = (other, first) if level else (first, other)
                return self._with_terms(
                    _described(first, level, other), level, self._bars(level, fine, coarse)
                )
            other = self._at(level + 1, (FINE_SHARE, 1.0))
        except Interrupted:
            raise Interrupted(first) from None
        if not (level and other.ok):
            return self._with_terms(_described(first, level), level, None)
        bars = self._bars(level + 1, other, first)
        return self._with_terms(_described(other, level + 1, first), level + 1, bars)

    def _at(self, level: int, stage: tuple[float, float]) -> SceneRun:
        """Return the run of a level, which takes a stage of the progress where it is made."""
        if level not in self.runs:
            begin_stage(*stage)
            gear, model, begun = gear_at(level, self.gear), model_at(level, self.fidelity), process_time()
            self.runs[level] = self.scene.run(gear, model, replace(self.options, level=level))
            self.seconds[level] = process_time() - begun
        return self.runs[level]

    def seconds_above(self, level: int) -> float:
        """Return about what the level above a level with bars takes [s of CPU time]."""
        first, companion = list(self.seconds)[:2]  # kernels may have been compiled in the first run
        spent = {**self.seconds, first: min(self.seconds[first], GROWTH**2 * self.seconds[companion])}
        return spent[level] * max(GROWTH, spent[level] / max(spent[level - 1], LEAST_SECONDS))

    def _bars(self, level: int, fine: SceneRun, coarse: SceneRun) -> dict[str, Any] | None:
        """Return the bars of two levels; None of a scene that leaves out its options."""
        if len(fine.signals["time"]) == len(coarse.signals["time"]):
            return None
        curves = fine.metrics is not None and not (self.scene.at_rest or self.scene.has_impacts)
        metrics, values, fewer = metrics_of(fine), fine.summary, coarse.summary
        floor = FLOOR / 2.0 ** max(level - 1, 0)
        return error_bars(metrics, fine.signals, values, coarse.signals, fewer, curves=curves, floor=floor)

    def _with_terms(self, run: SceneRun, level: int, bars: Mapping[str, Any] | None) -> SceneRun:
        """Return a run whose bars have their terms added; None: no level serves, bars are unknown (nan)."""
        if not run.signals:
            return run
        scene, fidelity, masses = self.scene, self.fidelity, MovedMasses.of(self.gear)
        recorded = run.signals, run.summary, run.outcome.findings
        terms, measured = bar_terms(scene, fidelity, metrics_of(run), *recorded, masses)
        self.terms[level] = terms
        found = dict.fromkeys(terms, np.nan) if bars is None else bars
        summed = {name: float(found.get(name, 0.0) + each) for name, each in terms.items()}
        errors = {name: each if np.isfinite(each) else np.nan for name, each in summed.items()}
        if vibrates := list(remarks((VIBRATES,), RuleInput(self.gear, numbers=run.outcome.findings))):
            run = run.noting(*vibrates).unsure_of(VARIATIONS | EXTREMES)
        run = run.noting(*remarks(SHORT_BARS, RuleInput(self.gear, fidelity)))
        errors |= dict.fromkeys(errors.keys() & run.unsure, np.nan)
        run = replace(run, errors=errors)
        for breach in breaches(OF_BARS, RuleInput(self.gear, numbers=measured)) if run.ok else ():
            return run.invalid(breach.rule.code, breach.sentence)
        return run


def _described(run: SceneRun, level: int, companion: SceneRun | None = None) -> SceneRun:
    """Return a run with the level that it has, and what both runs took."""
    cost = summed_cost([each.outcome for each in (run, companion) if each])
    return replace(
        run, outcome=replace(run.outcome, findings={**run.outcome.findings, "level": level}, **cost)
    )


def metrics_of(run: SceneRun) -> Metrics:
    """Return the function of a run's metrics; of a scene that states none, its summary of any signals."""
    return run.metrics or (lambda signals: run.summary)
