"""What the checks before and after a run cost: their fraction of a run's CPU time."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import rps_exudyn as rps
from benchmarks.measure import least_time
from benchmarks.topic import Columns, Topic, digits, load_data, save_data, table_of
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.checks.after_run import validated
from rps_exudyn.scenes.checks.rules import refused
from rps_exudyn.scenes.scene import RunOptions
from rps_exudyn.simulate.run_plan import run_unchecked

PITCH = 1 / SteeringGear().pinion.teeth
CASES: dict[str, tuple[Fidelity, dict[str, Any], float]] = {
    "flank dynamics, a turn": (Fidelity.preset("flank"), {}, 1.0),
    "equilibria, a tooth pitch": (Fidelity.preset("quasi-static"), {}, PITCH),
    "equilibria, a turn": (Fidelity.preset("quasi-static"), {}, 1.0),
    "equilibria, a turn with runout": (Fidelity.preset("quasi-static"), {"pinion.runout": 40e-6}, 1.0),
    "bush of 25 segments, a tooth pitch": (Fidelity.preset("flank").replace({"bush": "chain"}), {}, PITCH),
    "general contact, 2 deg": (Fidelity.preset("full"), {}, 2 / 360),
}
DATA = "check_cost.json"
SLOW = 0.5  # CPU time of a run [s] above which two runs are enough


def timed(work: Callable[..., Any], taken: list[float]) -> Callable[..., Any]:
    """The same function, which adds to a list what CPU time it takes [s]."""

    def with_time(*given: Any, **named: Any) -> Any:
        seconds, found = least_time(lambda: work(*given, **named), 1)
        taken.append(seconds)
        return found

    return with_time


def run(folder: Path, cases: Sequence[str] = tuple(CASES), repeats: int = 20) -> None:
    """Time these cases, each `repeats` times."""
    save_data(folder / DATA, {"cases": {name: cost(*CASES[name], repeats) for name in cases}})


def cost(fidelity: Fidelity, settings: dict[str, Any], turns: float, repeats: int) -> dict[str, float]:
    """CPU time of a run [ms], and what the checks take of it [%]."""
    gear = SteeringGear().replace(settings | {"test.turns": turns})
    scene, before, after, whole = "free-pinion-torque", list[float](), list[float](), list[float]()
    first = rps.run(scene, gear, fidelity=fidelity)  # compiled and loaded
    motion, options = scene_named(scene).motion, RunOptions(check=timed(validated, after))
    for _ in range(repeats if first.cpu_s < SLOW else min(repeats, 2)):
        timed(refused, before)(gear, fidelity, motion=motion)
        timed(run_unchecked, whole)(scene, gear, fidelity, options)
    seconds = sum(before) + sum(whole)
    return {
        "run_ms": round(1e3 * seconds / len(whole), 3),
        "before_percent": round(100 * sum(before) / seconds, 3),
        "after_percent": round(100 * sum(after) / seconds, 3),
    }


COLUMNS: Columns = {
    "run": lambda row: row[0],
    "CPU ms": lambda row: digits(row[1]["run_ms"], 3),
    "checks, %": lambda row: f"{row[1]['before_percent'] + row[1]['after_percent']:.2g}",
}
TOPIC = Topic(
    "30 s",
    "stability",
    run,
    {"cases": ("equilibria, a tooth pitch",), "repeats": 2},
    {"check_cost": lambda folder: table_of(load_data(folder / DATA)["cases"].items(), COLUMNS)},
)
