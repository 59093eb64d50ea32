"""An accuracy that is asked for: a climb of the ladder, by the cheapest preset first.

    result = climb("reversal", gear, AccuracyGoal.of("1%", ["hysteresis_area"]))
    result.findings["accuracy"]    level, its bar, and what the next level would cost

The climb ends where the bars of the metrics asked for are within the accuracy. It takes 3 times the change
between two levels where printed bars are 2 times that: 98.9 % of metrics lie within these, and 97.8 % within
printed ones. Where a preset fails, or going on with it cannot help, the next one is tried.
"""

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from time import perf_counter, process_time

import numpy as np

from rps_exudyn.base.errors import InputError, unwrapped_interrupts
from rps_exudyn.base.progress import duration
from rps_exudyn.base.units import short
from rps_exudyn.parameters.fidelity import PRESETS, Fidelity, unknown_preset
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Interrupted, Remark, Status, each_once, sentences
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.error_bars import FACTOR, size_of, sizes
from rps_exudyn.scenes.ladder import FINEST
from rps_exudyn.scenes.scene import DEFAULT_OPTIONS, Scene
from rps_exudyn.scenes.two_levels import Levels
from rps_exudyn.simulate.cases.task import hand_over
from rps_exudyn.simulate.cases.time_limit import TimeLimit
from rps_exudyn.simulate.run_plan import Plan

INSIDE = 3.0  # times the change between two levels: covers 98.9 % of metrics
BARS = INSIDE / FACTOR  # printed ones
STILL, MOVING = "quasi-static", "flank"  # presets in the order of their cost
HALVED = 0.5  # what a level makes of all that steps decide


@dataclass(frozen=True)
class AccuracyGoal:
    """The accuracy that a climb of the ladder shall reach."""

    accuracy: float  # largest share of each metric's size that 1.5 bars may be
    metrics: tuple[str, ...] = ()  # names; none stands for the scene's own
    preset: str = ""  # the only one that is taken; "" if any may be

    @classmethod
    def of(
        cls, accuracy: str, metrics: Sequence[str] | None = None, fidelity: str | Fidelity | None = None
    ) -> "AccuracyGoal":
        """Return what a user asks for.

        Raises:
            InputError: no percentage above zero, no metrics with error bars, or a model without a ladder.
        """
        if isinstance(fidelity, Fidelity):
            raise InputError(
                "accuracy chooses the model itself; give fidelity by the name of a preset, or leave it out."
            )
        if fidelity is not None and fidelity not in PRESETS:
            raise InputError(unknown_preset(fidelity))
        if fidelity is not None and Fidelity.preset(fidelity).solver == "closed-form":
            raise InputError(f"fidelity is {fidelity}, which has no ladder to climb; leave out accuracy.")
        if isinstance(metrics, str) or not all(isinstance(name, str) for name in metrics or ()):
            raise InputError(f"metrics is {short(str(metrics))}; it must be a list of names.")
        barred = [name for name, each in SUMMARY.items() if each.simulated]
        _check_metrics(metrics or (), barred, "no metric with an error bar")
        return cls(percent(accuracy) / 100, tuple(metrics or ()), fidelity or "")

    @property
    def words(self) -> str:
        """What is asked for in words."""
        of = f" of {', '.join(self.metrics)}" if self.metrics else ""
        return f"{self.preset or f'{STILL} or {MOVING}'}, accuracy {100 * self.accuracy:g} %{of}"

    def presets(self, scene: Scene) -> list[str]:
        """Return the presets of a climb, cheapest first."""
        return [self.preset] if self.preset else [MOVING] if scene.needs_inertia else [STILL, MOVING]

    def widest(self, run: Result) -> tuple[float, str]:
        """Return 1.5 bars over the metric's size, and the metric's name, of the metric where this share is
        largest; inf of an unknown bar.
        """
        _check_metrics(self.metrics, run.errors, f"no metric of {run.scene}")
        main_metric = scene_named(run.scene).main_metric
        names, of_run = self.metrics or (main_metric,), sizes(dict(run.signals), run.summary)
        shares = [(0.0, main_metric)]  # where nothing is hit there is no peak, and none that is wrong
        for name in names:
            if name in run.errors:
                share = BARS * run.errors[name] / size_of(name, run.summary[name], of_run)
                shares.append((float(share) if np.isfinite(share) else np.inf, name))
        return max(shares)


def percent(text: str) -> float:
    """Return the number in "1%" or "0.1 %".

    Raises:
        InputError: anything else, or not above zero.
    """
    match = re.fullmatch(r"\s*([0-9.eE+-]+)\s*%\s*", str(text))
    try:
        value = float(match[1]) if match else np.nan
    except ValueError:
        value = np.nan
    if not (0 < value < np.inf):
        raise InputError(
            f"accuracy is {short(str(text))}; it must be a percentage greater than 0, for instance 1%."
        )
    return value


def _check_metrics(names: Sequence[str], known: Collection[str], what: str) -> None:
    if unknown := [name for name in names if name not in known]:
        from difflib import get_close_matches

        nearest = get_close_matches(unknown[0], known, n=3) or known
        raise InputError(f"metrics has {short(unknown[0])}, which is {what}; take {', '.join(nearest)}.")


# --- the climb -------------------------------------------------------------------------------------
def climb(scene: str, gear: SteeringGear, goal: AccuracyGoal, time_limit: TimeLimit | None = None) -> Result:
    """Return the first run whose bars are within the goal, else the best one with a remark.

    Raises:
        InputError: metrics that the scene does not have, or a gear or test that no preset can run.
        Interrupted: Ctrl-C, or an alarm; it carries the best run, else what was recorded.
    """
    found = _Climb(scene, gear, goal, time_limit)
    try:
        with unwrapped_interrupts():
            any(found.is_over_by(preset) for preset in goal.presets(scene_named(scene)))
    except KeyboardInterrupt:
        if found.best is None:
            raise
        found.left.setdefault(found.preset, "the next level was interrupted")
        raise Interrupted(found.result()) from None
    if found.best is None and found.problem is not None:
        raise found.problem
    return found.result()


@dataclass(frozen=True, eq=False)
class _Rung:
    """A run with bars: 1.5 bars of the widest as a share, inf of an unknown one; what they are and cost."""

    result: Result
    share: float = np.inf
    bar: str = ""
    above: str = ""  # what the next level would cost

    @property
    def rank(self) -> tuple[float, bool]:
        """Return what is smaller of a better one."""
        return self.share, self.result.status is not Status.OK


class _Climb:
    """The best run so far, and why presets were left: by name a reason, or what they cannot run."""

    def __init__(self, scene: str, gear: SteeringGear, goal: AccuracyGoal, limit: TimeLimit | None) -> None:
        self._scene, self._gear, self._goal, self._limit = scene, gear, goal, limit
        self._wall, self._cpu = perf_counter(), process_time()
        self.best: _Rung | None = None
        self.preset = ""
        self.left: dict[str, str] = {}
        self.problem: InputError | None = None

    def is_over_by(self, preset: str) -> bool:
        """Climb by a preset; return whether the goal is reached, or no time is left for another."""
        self.preset, fidelity = preset, Fidelity.preset(preset)
        plan = Plan(self._scene, self._gear, fidelity)
        if refusal := plan.refusal:
            self._take(_Rung(refusal), f"it is {refusal.message}")
            return False
        levels, level = Levels(plan.scene, plan.tested, fidelity, DEFAULT_OPTIONS), 1
        shares: list[float] = []
        while preset not in self.left:
            try:
                run = levels.with_bars(level)
            except InputError as error:  # its record does not fit into the memory, or it has no such test
                self.problem = error
                self.left[preset] = f"level {level} is refused, {error.problems[0].rstrip('.')}"
                break
            except Interrupted as interrupt:
                raise Interrupted(plan.result(interrupt.recorded)) from None
            result = plan.result(run)
            if not run.ok:
                self._take(_Rung(result), f"level {level} ends {result.status}, {result.message}")
                break
            level = result.findings["level"]
            share, name = self._goal.widest(result)
            shares.append(share)
            rung = _Rung(result, share, *_words(levels, level, share, name))
            if share <= self._goal.accuracy:
                self._take(rung, "")
                return True
            self._take(rung, self._why_no_further(levels, level, name, shares))
            level += 1
        longest = max(levels.seconds.values(), default=0.0)  # another preset takes no less
        return self._limit is not None and self._limit.remaining < longest

    def _take(self, rung: _Rung, left: str) -> None:
        if left:
            self.left[self.preset] = sentences(left)[0]
        if self.best is None or rung.rank <= self.best.rank:
            self.best = rung
            if rung.result.status is Status.OK and not left:
                hand_over(self.result())

    def _why_no_further(self, levels: Levels, level: int, name: str, shares: list[float]) -> str:
        """Return why the next level cannot help, or costs too much; "" if it is to be run."""
        if np.isinf(shares[-2:]).all() and len(shares) > 1:
            return f"the bar of {name} is unknown on two levels"
        run, lasting = levels.runs[level], levels.terms[level].get(name, 0.0)
        size = size_of(name, run.summary[name], sizes(run.signals, run.summary))
        lasts = lasting > HALVED * levels.terms.get(level - 1, {}).get(name, np.inf)
        if lasts and BARS * lasting > self._goal.accuracy * size:
            return f"{100 * BARS * lasting / size:.2g} % of it is not of the steps, and lasts on finer levels"
        if level == FINEST:
            return f"level {level} is the finest"
        if self._limit is not None and levels.seconds_above(level) > self._limit.remaining:
            return f"level {level + 1} would take longer than is left of the time limit"
        return ""

    def result(self) -> Result:
        """Return the best run with what is to be said of it."""
        assert self.best is not None
        best, goal = self.best, self._goal.accuracy
        why = [f"{preset}: {reason}" for preset, reason in self.left.items()]
        remarks = []
        if best.result.status is Status.OK and best.share > goal:
            because = f" ({', '.join(why)})" if why else ""
            text = f"accuracy {100 * goal:g} % is not reached, {best.bar}{because}"
            remarks = [Remark(Code.ACCURACY_NOT_REACHED, text)]
        elif best.result.status is Status.OK:
            remarks = [Remark(Code.PRESET_LEFT, f"another preset was tried first, {each}") for each in why]
        return replace(
            best.result,
            message="; ".join(filter(None, [*(each.text for each in remarks), best.result.message])),
            codes=each_once([*(each.code for each in remarks), *best.result.codes]),
            findings={
                **best.result.findings,
                "accuracy": "; ".join(filter(None, [best.bar, best.above, *why])),
            },
            cpu_s=process_time() - self._cpu,
            wall_s=perf_counter() - self._wall,
        )


def _words(levels: Levels, level: int, share: float, name: str) -> tuple[str, str]:
    """Return what the bar of a level is and costs, and what the next level would cost."""
    bar = f"{BARS:g} bars of {name} are {100 * share:.2g} %" if np.isfinite(share) else f"{name} has no bar"
    spent = f"at {duration(levels.seconds[level])} of CPU time"
    above = f"level {level + 1} would take about {duration(levels.seconds_above(level))}"
    return f"{levels.fidelity.based_on}, level {level}: {bar} {spent}", above if level < FINEST else ""
