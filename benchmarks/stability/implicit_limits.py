"""The largest step of implicit dynamics and of equilibria whose mean is right, bisected to 5 %.

Along lines of stiffness, speed, friction zone, teeth, inertia and segments, over a record of 5.4 tooth
pitches: no step is then a fraction of the pitch. Beside each stands what the check before a run allows,
`STEPS_PER_PITCH` steps per tooth pitch.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.checks.rules import STEPS_PER_PITCH
from verification.law_area import by_law
from verification.stability import (
    STILL,
    STRIP,
    ScenePlan,
    bisected,
    cpu_time_limit,
    error_of,
    reference,
    unchecked,
)

DATA = "implicit.json"
GEAR = by_law(SteeringGear(), "area")  # whose stiffness is varied
FINEST, COARSEST, LADDER = 2.0, 40.0, 1.35  # [deg], [deg], from step to step
PITCHES = 5.4  # of a record
BOUND = 0.01
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


def run(folder: Path, sweeps: Sequence[Sweep] = SWEEPS) -> None:
    """Bisect the limits of these sweeps."""
    steps = []
    for sweep in sweeps:
        for at, plan in sweep.plans():
            steps.append({"line": sweep.line, "at": at, **_largest_steps(plan)})
            print(steps[-1], flush=True)
    save_data(folder / DATA, {"steps": steps})


def _largest_steps(plan: ScenePlan) -> dict[str, float]:
    """The largest steps that are right, as all finer ones are, nan if not even the finest is, and the one
    that the check before a run allows [deg]."""
    still = unchecked(ScenePlan(plan.scene, plan.gear, plan.fidelity.replace(STILL | STRIP)))
    true = reference(plan.with_step(FINEST))

    @cache
    def errors(step: float) -> tuple[float, float]:
        return _errors(plan.with_step(step), true, still)

    return {
        "mean_1": _largest(lambda step: errors(step)[0] <= BOUND),
        "curve_1": _largest(lambda step: errors(step)[1] <= BOUND),
        "allowed": 360 / plan.gear.pinion.teeth / STEPS_PER_PITCH,
    }


def _errors(plan: ScenePlan, true: float, still: Result) -> tuple[float, float]:
    """Error of the mean, and of the curve joined by straight lines, RMS, both of the mean; infinite of a run
    that fails."""
    try:
        with cpu_time_limit(TIME_LIMIT):
            result = unchecked(plan)
    except TimeoutError:
        return np.inf, np.inf
    if result.status is not Status.OK:
        return np.inf, np.inf
    signal = scene_named(plan.scene).signal
    joined = np.interp(still["pinion_angle"], result["pinion_angle"], result[signal])
    curve = float(np.sqrt(np.mean((joined - still[signal]) ** 2)) / abs(true))
    return abs(error_of(plan.main_metric(result), true)), curve


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
    lines: dict[str, list[dict[str, Any]]] = {}
    for step in load_data(folder / DATA)["steps"]:
        lines.setdefault(step["line"], []).append(step)
    means: dict[str, list[str]] = {}
    for line, steps in lines.items():
        means.setdefault(f"{_worst(steps, 'mean_1')}, {_worst(steps, 'curve_1')}", []).append(line)
    rows = [(", ".join(same), *text.split(", ")) for text, same in means.items()]
    return markdown(("lines", "mean within 1 %", "curve within 1 % RMS, joined by lines"), rows)


def _worst(steps: Sequence[dict[str, Any]], name: str) -> str:
    limit = min(steps, key=lambda step: step[name] / step["allowed"])[name]
    return "any" if limit >= COARSEST else f"{limit:.3g} deg"


TOPIC = Topic(
    "2 min",
    "stability",
    run,
    {"sweeps": (Sweep("equilibria, stiffness", "mesh.stiffness", (1e12,), choices=EQUILIBRIUM),)},
    {"implicit_limits": limits_table},
)
