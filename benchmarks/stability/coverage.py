"""Coverage of error bars: how many metrics of random plans lie within their bars, and each one that does not.

Plans are drawn over every declared parameter, scene and choice, by a seed that no constant was set on, and
run as a user runs them.
Their references are made without the ladder: by other methods where there are any, else by finer runs in two
lengths of steps, with a doubt of their own. A metric is judged where that doubt is no more than its bar, and
covered where it lies within both. A run that is stopped goes on where it was.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import isfinite, nan
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from benchmarks.stability.plan_worker import Child, described, go_on
from benchmarks.stability.references import references
from benchmarks.topic import Columns, Topic, load_rows, markdown, table_of
from rps_exudyn.base.errors import InputError
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import EXTREMES, LOSS_SHARES, VARIATIONS
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.scene import DEFAULT_OPTIONS
from rps_exudyn.simulate.run_plan import run_unchecked
from rps_exudyn.solvers.temperature_and_wear import tested_gear
from verification.sampler import random_plan, usual_plan
from verification.stability import ScenePlan

SEED = 20261128
PLANS = 500
TIME_LIMIT = 60.0  # [s] of CPU time of one plan with its references
DATA = "coverage.csv"
COLUMNS = "number", "plan", "scene", "friction", "model", "status", "seconds", "message", "metrics"
KINDS = {"shares of losses": LOSS_SHARES, "extremes and ranges": EXTREMES | VARIATIONS}
ROUNDING = 1e-9  # of a metric: references and runs round otherwise


def plan_of(number: int) -> ScenePlan:
    """The random plan of that number: every other one a preset, as a user would run it."""
    rng = np.random.default_rng([SEED, number])
    return random_plan(rng) if number % 2 else usual_plan(rng)


def outcome_of(number: int, done: Callable[[dict[str, Any]], None] = lambda found: None) -> dict[str, Any]:
    """Outcome of a plan; of each metric that is judged its value, bar, right value and the doubt of that."""
    plan, start = plan_of(number), process_time()
    try:
        result = run_unchecked(plan.scene, plan.gear, plan.fidelity, DEFAULT_OPTIONS)
    except InputError as error:
        return {"status": "input-error", "message": str(error)}
    found: dict[str, Any] = {"status": result.status.value, "message": result.message}
    found["seconds"] = process_time() - start
    if result.status is not Status.OK:
        return found
    done(found)
    tested = replace(plan, gear=tested_gear(plan.gear))
    right: dict[str, tuple[float, float]] = {}
    for _, values in references(tested, result.summary.keys()):
        right = values | right  # the first that states it
    judged = {}
    for name, bar in result.errors.items():
        value, doubt = right.get(name, (nan, nan))
        if isfinite(value) and isfinite(doubt):
            judged[name] = result.summary[name], bar, value, doubt
    text = ";".join(f"{name}={a:.9g}/{b:.3g}/{c:.9g}/{d:.3g}" for name, (a, b, c, d) in judged.items())
    return found | {"metrics": text}


def run(folder: Path, plans: int = PLANS) -> None:
    """Run the first plans, one after the other in a process of their own.

    What stands in the data file already is left as it is: delete the file to begin again.
    """
    worker = Child(outcome_of)

    def row_of(number: int) -> dict[str, Any]:
        return described(number, plan_of(number)) | worker.do(number, TIME_LIMIT)

    go_on(folder / DATA, COLUMNS, plans, plan_of, row_of)


class Judged:
    """One metric of one plan beside its right value."""

    def __init__(self, row: Mapping[str, str], text: str) -> None:
        """Read what a row of the data file holds of a metric."""
        self.number, self.scene, self.model = row["number"], row["scene"], row["model"]
        self.name, _, numbers = text.partition("=")
        self.value, self.bar, self.right, self.doubt = map(float, numbers.split("/"))
        self.off = max(abs(self.value - self.right) - self.doubt - ROUNDING * abs(self.right), 0.0)
        self.is_main_metric = self.name == scene_named(self.scene).main_metric

    @property
    def kind(self) -> str:
        """What the metric is."""
        if self.is_main_metric:
            return "figure of the scene"
        return next((kind for kind, names in KINDS.items() if self.name in names), "means, works, motions")

    @property
    def share(self) -> float:
        """Bar over value."""
        return self.bar / abs(self.value) if self.value else np.inf


def judged(folder: Path) -> list[Judged]:
    """Return all metrics that are judged: of references that are surer than the bar."""
    rows = [row for row in load_rows(folder / DATA) if row["metrics"]]
    every = [Judged(row, text) for row in rows for text in row["metrics"].split(";")]
    return [each for each in every if each.doubt <= each.bar]


def coverage_table(folder: Path) -> str:
    """Coverage by scene, model and kind of metric."""
    found = judged(folder)
    groups: dict[str, list[Judged]] = {"all": found}
    for group in ("scene", "model", "kind"):
        names = sorted({getattr(each, group) for each in found})
        groups |= {name: [each for each in found if getattr(each, group) == name] for name in names}
    head = "metrics of", "plans", "judged", "within the bar", "beyond two bars", "median bar"
    return markdown(head, [_row(name, some) for name, some in groups.items() if some])


def _row(name: str, some: list[Judged]) -> tuple[str, ...]:
    within = sum(each.off <= each.bar for each in some) / len(some)
    beyond = sum(each.off > 2 * each.bar for each in some) / len(some)
    plans = len({each.number for each in some})
    median = float(np.median([each.share for each in some]))
    bar = f"{median:.2%}" if np.isfinite(median) else "of metrics that are 0"
    return name, str(plans), str(len(some)), f"{within:.1%}", f"{beyond:.2%}", bar


def misses_table(folder: Path) -> str:
    """Plans with metrics beyond their bars, by scene and model, and the largest error of these."""
    groups: dict[tuple[str, str], list[Judged]] = {}
    for each in judged(folder):
        if each.off > each.bar:
            groups.setdefault((each.scene, each.model), []).append(each)
    columns: Columns = {
        "scene": lambda group: group[0].scene,
        "model": lambda group: group[0].model,
        "plans": lambda group: ", ".join(dict.fromkeys(each.number for each in group)),
        "metrics beyond": len,
        "largest error over bar": _largest_miss,
    }
    return table_of([groups[key] for key in sorted(groups)], columns)


def _largest_miss(group: Sequence[Judged]) -> str:
    worst = max(group, key=lambda each: each.off / each.bar if each.bar else np.inf)
    return f"{worst.off / worst.bar:.1f}, {worst.name}" if worst.bar else f"no bar, {worst.name}"


def outcomes_table(folder: Path) -> str:
    """How the plans ended."""
    counts = Counter(row["status"] for row in load_rows(folder / DATA))
    return markdown(("outcome", "plans"), [(name, str(count)) for name, count in counts.most_common()])


TOPIC = Topic(
    "2 h",
    "coverage",
    run,
    {"plans": 2},
    {"coverage": coverage_table, "coverage_misses": misses_table, "coverage_outcomes": outcomes_table},
)
