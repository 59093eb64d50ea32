"""What every scene gives for the default gear: the paper's Figures 16, 17 and 18, and what it did not show.

Free pinion torque lock to lock, load test, runout; contact pattern, losses, orders, hysteresis, rack push,
yoke impact; and how far solvers and closed form agree about laws that hold exactly or nearly.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.charts import losses_figure, spectrum_figure, torques_figure
from benchmarks.measure import run_ok
from benchmarks.topic import Columns, Topic, rows_table, save_data
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.pages.charts import style
from rps_exudyn.pages.charts.analyses import pattern_figure
from rps_exudyn.pages.charts.scene_figures import draw
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.result import Result
from rps_exudyn.solvers.closed_form import GRAVITY, free_torque, pushing_force, runout_harmonics

GEAR = SteeringGear()
RUNOUT = {"pinion.runout": "40 um"}
STOPPED = RUNOUT | {"yoke.clearance": "20 um"}
HEAVY = 33.0  # weight with which the default gear has the paper's ratio [kg]
DATA = "scenes.json"
SOLVERS = ("flank", "quasi-static")
SHOWN = {
    "free-pinion-torque": ("torque_mean_forward", "torque_mean_backward"),
    "load-test": ("torque_forward", "torque_reverse"),
    "rack-push": ("push_force_mean", "push_force_peak_to_peak"),
    "reversal": ("hysteresis_area", "torque_jump"),
    "yoke-impact": ("impacts", "impact_peak_force"),
}
OF_RUNOUT = ("torque_mean", "torque_peak_to_peak")
Settings = dict[str, Any]


def run(
    folder: Path,
    path: str = "lock-to-lock",
    turns: float = 2,
    scenes: Sequence[str] = tuple(SHOWN),
    laws: Sequence[str] | None = None,
) -> None:
    """Run these scenes over this path and runouts over `turns`, draw them, and check these laws."""
    rows = []
    for scene in scenes:
        result = done(scene, {"test.path": path})
        draw(result, folder / f"{scene.replace('-', '_')}.png")
        rows.append(figures(scene, result, SHOWN[scene]))
    heavy = done("load-test", {"test.load_mass": HEAVY})
    rows.append(figures(f"load-test, {HEAVY:g} kg, one turn", heavy, SHOWN["load-test"]))
    test = {"test.turns": turns, "test.start_angle": -np.pi * turns}
    runouts = {
        "runout 0": done("free-pinion-torque", test),
        "40 µm": done("free-pinion-torque", test | RUNOUT),
        "40 µm, yoke clearance 20 µm": done("free-pinion-torque", test | STOPPED),
    }
    rows += [figures(name, result, OF_RUNOUT) for name, result in runouts.items()]
    draw_runouts(runouts, folder)
    checked = [[name, *(LAWS[name](preset) for preset in SOLVERS)] for name in laws or LAWS]
    save_data(folder / DATA, {"scenes": rows, "laws": checked})


def done(scene: str, settings: Settings, preset: str = "flank") -> Result:
    """The result, which must be ok."""
    return run_ok(scene, GEAR.replace(settings), preset)


def figures(title: str, result: Result, names: Sequence[str]) -> dict[str, Any]:
    """Return what is published of a run: figures of its summary [SI], cost, work balance."""
    return {
        "title": title,
        "figures": {name: result.summary[name] for name in names if name in result.summary},
        "solver_cpu_s": result.counters["solver_cpu"],
        "energy_residual": result.summary["energy_residual"],
    }


def draw_runouts(runouts: dict[str, Result], folder: Path) -> None:
    """Torques, orders and losses without and with runout, and with a yoke that stops; contact pattern."""
    free = dict(list(runouts.items())[:2])
    eccentric = free["40 µm"]
    drawn = {
        "runout": torques_figure(free, "Runout of the pinion: free pinion torque"),
        "runout_stopped": torques_figure(runouts, "The same with a yoke that stops"),
        "spectrum": spectrum_figure(free),
        "losses": losses_figure(eccentric),
        "contact_pattern": pattern_figure(runouts["runout 0"]),
    }
    for name, figure in drawn.items():
        style.save(figure, folder / f"{name}.png")


def mean(preset: str, settings: Settings | None = None) -> float:
    """Mean free pinion torque of one turn [N m]."""
    return done("free-pinion-torque", settings or {}, preset).summary["torque_mean"]


def load_sum(preset: str, mass: float) -> float:
    """Half sum of the torques off W s'; of the larger of W s' and T_0, since W s' is small at 10 kg."""
    found = done("load-test", {"test.load_mass": mass}, preset).summary
    half, ideal = (found["torque_forward"] + found["torque_reverse"]) / 2, GRAVITY * mass * _gain()
    return (half - ideal) / max(ideal, found["free_torque"])


def load_difference(preset: str, mass: float) -> float:
    """Half difference of the torques off the free torque T_0."""
    found = done("load-test", {"test.load_mass": mass}, preset).summary
    return (found["torque_forward"] - found["torque_reverse"]) / 2 / found["free_torque"] - 1


def first_order(preset: str) -> float:
    """First order of a runout off the closed form's."""
    found = done("free-pinion-torque", RUNOUT, preset).summary["torque_first_order"]
    return found / float(np.hypot(*runout_harmonics(GEAR.replace(RUNOUT)))) - 1


def bend(preset: str, path: str, values: Sequence[float]) -> float:
    """Mean torque at the middle of three values off the straight line through the others."""
    low, middle, high = (mean(preset, {path: value}) for value in values)
    return middle / ((low + high) / 2) - 1


def _gain() -> float:
    return float(GearPair.of(GEAR).gain)


LAWS: dict[str, Callable[[str], float]] = {
    "mean torque, off the formula": lambda preset: mean(preset) / free_torque(GEAR) - 1,
    "load test 10 kg: half sum of the torques, off W s', of the free torque": lambda p: load_sum(p, 10.0),
    "load test 10 kg: half difference, off the free torque": lambda p: load_difference(p, 10.0),
    "load test 40 kg: half sum, off W s'": lambda p: load_sum(p, 40.0),
    "load test 40 kg: half difference, off the free torque": lambda p: load_difference(p, 40.0),
    "rack push, off the formula": lambda preset: (
        done("rack-push", {}, preset).summary["push_force_mean"] / pushing_force(GEAR, +1) - 1
    ),
    "first order of a runout of 40 um, off the formula": first_order,
    "bend over the preload, 150 to 600 N": lambda p: bend(p, "yoke.preload", (150.0, 375.0, 600.0)),
    "bend over the friction of the teeth, 0.05 to 0.2": lambda p: bend(
        p, "mesh.friction", (0.05, 0.125, 0.2)
    ),
    "mean torque at 1 rpm, off that at 15 rpm": lambda p: mean(p, {"test.speed": "1 rpm"}) / mean(p) - 1,
    "mean torque at 300 rpm, off that at 15 rpm": lambda p: mean(p, {"test.speed": "300 rpm"}) / mean(p) - 1,
}


def _shown(row: Mapping[str, Any]) -> str:
    figures = list(row["figures"].items())[:2]
    return ", ".join(f"{name.replace('_', ' ')} {SUMMARY[name].show(x)}" for name, x in figures)


def _percent(off: float) -> str:
    return f"{round(100 * off, 6) + 0.0:+.2g}"


RUNS: Columns = {
    "run": "{title}",
    "metrics": _shown,
    "solver CPU s": "{solver_cpu_s:.2g}",
    "energy residual %": lambda row: f"{100 * row['energy_residual']:+.1g}",
}
DEVIATIONS: Columns = {
    "law": lambda row: row[0],
    "flank %": lambda row: _percent(row[1]),
}
TOY = {
    "path": "there-and-back",
    "turns": 1,
    "scenes": ("free-pinion-torque",),
    "laws": ("mean torque, off the formula",),
}
TOPIC = Topic(
    "30 s",
    "scenes",
    run,
    TOY,
    {"scenes": rows_table(DATA, "scenes", RUNS), "laws": rows_table(DATA, "laws", DEVIATIONS)},
)
