"""The run of a scene before it becomes a result, and how several maneuvers of the rig become one."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from rps_exudyn.analysis.passes import plain
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Outcome, Remark, Status, each_once, joined_text
from rps_exudyn.results.quantities import WORKS
from rps_exudyn.scenes.checks.rules import REMARKS, RuleInput, remarks
from rps_exudyn.solvers.equilibrium import EquilibriumPath
from rps_exudyn.solvers.settling import TOLERANCE

Signals = dict[str, np.ndarray]


@dataclass(frozen=True, eq=False)
class SceneRun:
    """Outcome, and what was recorded until then."""

    outcome: Outcome  # how it ended
    signals: Signals = field(default_factory=dict)  # name -> values over the time
    summary: dict[str, float] = field(default_factory=dict)  # name -> metric
    errors: dict[str, float] = field(default_factory=dict)  # name -> half width of the metric's error bar
    # the function that gave the summary of the signals
    metrics: Callable[[Signals], dict[str, float]] | None = None
    unsure: frozenset[str] = frozenset()  # metrics whose errors no finer run shows

    @property
    def ok(self) -> bool:
        """Return whether it ended well."""
        return self.outcome.status is Status.OK

    def noting(self, *remarks: Remark | None) -> "SceneRun":
        """Return a run that is all right with remarks for its reader added; a failed one keeps its cause."""
        added = [remark for remark in remarks if remark]
        if not (self.ok and added):
            return self
        text = "; ".join(part for part in (self.outcome.message, joined_text(added)) if part)
        codes = each_once([*self.outcome.codes, *(remark.code for remark in added)])
        return replace(self, outcome=replace(self.outcome, message=text, codes=codes))

    def invalid(self, code: Code, message: str) -> "SceneRun":
        """Return the run with what was recorded, as one that cannot be relied on."""
        changed = replace(self.outcome, status=Status.INVALID, codes=(code,), message=message)
        return replace(self, outcome=changed)

    def unsure_of(self, names: Collection[str]) -> "SceneRun":
        """Return the run with metrics whose errors no finer run shows."""
        return replace(self, unsure=self.unsure | frozenset(names))

    def described(
        self, metrics: Callable[[Signals], dict[str, float]], gear: SteeringGear | None = None
    ) -> "SceneRun":
        """Return the run with the metrics of its signals, and with remarks on the limits that they met."""
        if not self.signals:
            return self
        run = replace(self, summary=plain(metrics(self.signals)), metrics=metrics)
        return run.noting(*remarks(REMARKS, RuleInput(gear, signals=self.signals))) if gear else run


def joined(runs: Sequence[SceneRun]) -> SceneRun:
    """Join maneuvers one after the other to one record without a pause: time and works go on.

    The outcome is that of the first maneuver that failed; maneuvers after it should not have been made.
    """
    outcomes = [run.outcome for run in runs]
    outcome = next((each for each in outcomes if each.status is not Status.OK), outcomes[0])
    outcome = replace(
        outcome,
        time_reached=sum(each.time_reached for each in outcomes),
        findings={**outcome.findings, **_worst_findings(outcomes)},
        **summed_cost(outcomes),
    )
    recorded = [run.signals for run in runs if run.signals]
    unsure = frozenset().union(*(run.unsure for run in runs))
    return SceneRun(outcome, one_after_another(recorded) if recorded else {}, unsure=unsure)


def summed_cost(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Return CPU time and counters of outcomes together."""
    names = dict.fromkeys(name for each in outcomes for name in each.counters)
    counters = {name: sum(each.counters.get(name, 0) for each in outcomes) for name in names}
    return {"cpu_s": sum(each.cpu_s for each in outcomes), "counters": counters}


def one_after_another(records: Sequence[Signals]) -> Signals:
    """Join signals (..., n) of maneuvers to one record; time and works go on where they stood."""
    signals = dict(records[0])
    for maneuver in records[1:]:
        # a maneuver has no pressure of teeth that it has lost
        for name in [*signals]:
            before = signals.pop(name)
            if name in maneuver:
                stood = before[..., -1:] if name == "time" or name in WORKS else 0.0
                signals[name] = np.concatenate([before, stood + maneuver[name]], axis=-1)
    return signals


def _worst_findings(outcomes: Sequence[Outcome]) -> dict[str, float]:
    """What the outcomes found about vibration and about their starts, of each the worst."""
    worst = {"vibration_grows": max, "vibration_dies": min, "start_unsettled": max}
    known = {name: [each.findings[name] for each in outcomes if name in each.findings] for name in worst}
    return {name: worst[name](values) for name, values in known.items() if values}


def outcome_of_path(path: EquilibriumPath, cpu_s: float) -> Outcome:
    """Return what it took to follow equilibria, and how well they balance; where they end is not judged."""
    return Outcome(
        Status.OK,
        time_reached=float(path.time[-1]) if path.time.size else 0.0,
        cpu_s=cpu_s,
        counters=path.counters,
        settings={"name": "equilibrium", "tolerance": TOLERANCE},
        findings={"residual": path.residual, "rescues": path.rescues},
    )


def lost(path: EquilibriumPath, where: str, outcome: Outcome) -> Outcome:
    """Return the outcome of a path that ends where no equilibrium was found, for instance "at 12 deg"."""
    if path.jumps:
        message = f"the gear jumps {where}: {path.jumps}"
        return replace(outcome, status=Status.INVALID, codes=(Code.GEAR_JUMPS,), message=message)
    message = f"no equilibrium was found {where}; {path.residual:.3g} N remain unbalanced"
    return replace(outcome, status=Status.NO_CONVERGENCE, codes=(Code.NO_EQUILIBRIUM,), message=message)
