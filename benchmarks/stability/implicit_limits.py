"""The largest step of implicit dynamics and of equilibria whose mean is right, bisected to 5 %.

Along lines of stiffness, speed, friction zone, teeth, inertia and segments, over a record of 5.4 tooth
pitches: no step is then a fraction of the pitch. Beside each stands what the check before a run allows,
`STEPS_PER_PITCH` steps per tooth pitch.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.checks.before_run import STEPS_PER_PITCH
from verification.law_area import by_law
from verification.stability import (
    STILL,
    STRIP,
    ScenePlan,
    bisected,
    cpu_time_limit,
    error_of,
    reference,
    run_and_check,
    unchecked,
)

DATA = "implicit.json"
GEAR = by_law(SteeringGear(), "area")  # whose stiffness is varied
FINEST, COARSEST, LADDER = 2.0, 40.0, 1.35  # [deg], [deg], from step to step
PITCHES = 5.4  # of a record
BOUNDS = (0.01, 0.05)
TIME_LIMIT = 10.0  # CPU time of a run [s]


@dataclass(frozen=True)
class Sweep:
    """One parameter at several values."""

    line: str
    path: str
    values: tuple[float, ...]
    show: str = "{:g}"
    unit: float = 1.0
    scene: str = "free-pinion-torque"
    choices: dict[str, Any] = field(default_factory=dict)
    along: Mapping[str, tuple[float, ...]] = field(default_factory=dict)  # parameters that move with it

    def plans(self) -> Iterator[tuple[str, ScenePlan]]:
        """The value as text and the plan, for each value."""
        for k, value in enumerate(self.values):
            gear = GEAR.replace({self.path: value} | {path: values[k] for path, values in self.along.items()})
            gear = gear.replace({"test.turns": PITCHES / gear.pinion.teeth})
            shown = self.show.format(round(value / self.unit, 9))
            yield shown, ScenePlan(self.scene, gear, Fidelity().replace(self.choices))


RPM = np.pi / 30
SPEEDS = tuple(n * RPM for n in (0.5, 3, 15, 60, 300))
TEETH = {
    "pinion.tip_diameter": (16.2e-3, 18.2e-3, 22.2e-3, 26.2e-3),
    "pinion.shaft_diameter": (9e-3, 11e-3, 11e-3, 11e-3),
}
PUSH = "rack-push"
EQUILIBRIUM = {"solver": "equilibrium"}
STIFFNESSES = (1e12, 2e13, 5e14)
SWEEPS = (
    Sweep("contact stiffness", "mesh.stiffness", STIFFNESSES, "{:g} N/m³"),
    Sweep("test speed", "test.speed", SPEEDS, "{:g} rpm", RPM),
    Sweep("friction zone of 0.01", "test.speed", SPEEDS[::2], "{:g} rpm", RPM, choices={"zone_ratio": 0.01}),
    Sweep("friction zone of 1", "test.speed", SPEEDS[::2], "{:g} rpm", RPM, choices={"zone_ratio": 1.0}),
    Sweep("teeth", "pinion.teeth", (5, 6, 8, 10), along=TEETH),
    Sweep("pinion's density, rack driven", "pinion.density", (785.0, 785e3), "{:g} kg/m³", scene=PUSH),
    Sweep("segments of the bush", "bush.segments", (1, 5, 25), choices={"bush": "chain"}),
    Sweep("equilibria, stiffness", "mesh.stiffness", STIFFNESSES, "{:g} N/m³", choices=EQUILIBRIUM),
)


@dataclass(frozen=True)
class CoarseStep:
    """The largest step that is right, as all finer ones are [deg]; nan if not even the finest is."""

    line: str
    at: str
    mean_1: float  # error of the mean 1 %
    mean_5: float  # 5 %
    curve_1: float  # error of the curve, joined by straight lines, RMS in % of the mean
    curve_5: float
    allowed: float  # by the check before a run
    beyond: str  # what comes after the limit of 5 % of the mean


@dataclass(frozen=True)
class Trial:
    """Errors of a run with one step."""

    mean: float  # relative error, infinite of a run that fails
    curve: float  # likewise
    words: str


def run(folder: Path, sweeps: Sequence[Sweep] = SWEEPS) -> None:
    """Bisect the limits of these sweeps."""
    steps = []
    for sweep in sweeps:
        for at, plan in sweep.plans():
            steps.append(asdict(_coarse_step(sweep.line, at, plan)))
            print(steps[-1], flush=True)
    save_data(folder / DATA, {"steps": steps})


def _coarse_step(line: str, at: str, plan: ScenePlan) -> CoarseStep:
    finest = plan.with_step(FINEST)
    still = unchecked(ScenePlan(plan.scene, plan.gear, plan.fidelity.replace(STILL | STRIP)))
    true = reference(finest)
    seen: dict[float, Trial] = {}

    def trial(step: float) -> Trial:
        if step not in seen:
            seen[step] = _trial(plan.with_step(step), true, still)
        return seen[step]

    means = (
        _largest(lambda step: trial(step).mean <= BOUNDS[0]),
        _largest(lambda step: trial(step).mean <= BOUNDS[1]),
    )
    curves = (
        _largest(lambda step: trial(step).curve <= BOUNDS[0]),
        _largest(lambda step: trial(step).curve <= BOUNDS[1]),
    )
    wrong = min((step for step, found in seen.items() if not found.mean <= BOUNDS[1]), default=None)
    beyond = seen[wrong].words if wrong else "none up to the largest step allowed"
    return CoarseStep(line, at, *means, *curves, 360 / plan.gear.pinion.teeth / STEPS_PER_PITCH, beyond)


def _trial(plan: ScenePlan, true: float, still: Result) -> Trial:
    try:
        with cpu_time_limit(TIME_LIMIT):
            result, flagged = run_and_check(plan)
    except TimeoutError as error:
        return Trial(np.inf, np.inf, str(error))
    if result.status is not Status.OK:
        return Trial(np.inf, np.inf, result.status.value)
    off, signal = error_of(plan.figure(result), true), scene_named(plan.scene).signal
    joined = np.interp(still["pinion_angle"], result["pinion_angle"], result[signal])
    curve = float(np.sqrt(np.mean((joined - still[signal]) ** 2)) / abs(true))
    return Trial(abs(off), curve, f"{off:+.1%} of the mean, {'flagged' if flagged else 'not flagged'}")


def _largest(holds: Callable[[float], bool]) -> float:
    """The largest step [deg] up to which all hold, on a ladder and then bisected to 5 %."""
    good = FINEST
    if not holds(good):
        return float("nan")
    while good < COARSEST:
        bad = min(good * LADDER, COARSEST)
        if not holds(bad):
            return bisected(holds, good, bad)
        good = bad
    return COARSEST


def limits_table(folder: Path) -> str:
    """The largest right step [deg] at the worst point of each line."""
    steps = load_data(folder / DATA)["steps"]
    names = ("mean_1", "curve_1")
    rows = []
    for line in dict.fromkeys(step["line"] for step in steps):
        own = [step for step in steps if step["line"] == line]
        worst = [min(own, key=lambda step, name=name: step[name] / step["allowed"]) for name in names]  # type: ignore[misc]
        rows.append((line, *(_limit(step, name) for step, name in zip(worst, names, strict=True))))
    head = ("line", "mean within 1 %", "curve within 1 % RMS, joined by lines")
    return markdown(head, rows)


def _limit(step: dict[str, Any], name: str) -> str:
    return "any" if step[name] >= COARSEST else f"{step[name]:.3g} deg"


TOPIC = Topic(
    "the largest right step of implicit methods, bisected",
    "2 min",
    "stability",
    run,
    {"sweeps": (Sweep("equilibria, stiffness", "mesh.stiffness", (1e12,), choices=EQUILIBRIUM),)},
    {"implicit_limits": limits_table},
)
