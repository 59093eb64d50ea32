"""What a fit could follow together: gears known at once, and what following them takes.

Gears of a fit depend on each other: each step says where the next one goes. Known at once are those of the
slopes, one an unknown that shows in the shape. Gears together begin with some to learn from, about the middle
of each new table; from how many gears on that pays follows from both CPU times, measured in turn.
"""

import traceback
from collections.abc import Sequence
from pathlib import Path
from time import process_time
from typing import Any
from unittest.mock import patch

import numpy as np

from benchmarks.measured_fit import FREE, SET, WHITE, measured, true_gear
from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.inference.fitting.bench_tests import BenchTest, measurement_of
from rps_exudyn.inference.fitting.fit import fit
from rps_exudyn.inference.fitting.prediction import Prediction
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.simulate.batch import batch
from rps_exudyn.solvers.closed_form import GRAVITY

DATA = "fit_designs.json"
FITS = {"free torque": (FREE,), "all six tests": SET}
WEIGHED = BenchTest("load-test", 80.0 * GRAVITY)
TABLES = {"free-pinion-torque": FREE, "load-test": WEIGHED}  # scene of a table -> test of the fit
SPREAD = 0.01  # of the gears of a table about their middle: a step of a fit
SLOPES = ("first_slopes",)  # functions that ask for gears which are known at once


def run(
    folder: Path,
    fits: Sequence[str] = tuple(FITS),
    scenes: Sequence[str] = tuple(TABLES),
    gears: int = 32,
    repeats: int = 5,
) -> None:
    """Count the gears of fits, and measure tables about new gears beside the fit's own simulations."""
    counted = {name: gears_of_fit(FITS[name]) for name in fits}
    timed = {scene: together_and_single(scene, gears, repeats) for scene in scenes}
    print(counted, timed, flush=True)
    save_data(folder / DATA, {"fits": counted, "loops": timed})


def gears_of_fit(tests: Sequence[BenchTest]) -> dict[str, int]:
    """Number of gears that one fit simulates, and the most that it knows at once."""
    asked: list[bool] = []
    simulated = Prediction.simulated

    def recorded(self: Prediction, gear: SteeringGear, *nuisances: Any) -> np.ndarray:
        asked.append(any(frame.name in SLOPES for frame in traceback.extract_stack()))
        return simulated(self, gear, *nuisances)

    random = np.random.default_rng(0)
    with patch.object(Prediction, "simulated", recorded):
        fit(measurement_of([measured(test, WHITE, random) for test in tests]))
    runs = "".join("x" if at_once else " " for at_once in asked).split()
    return {"gears": len(asked), "at_once": max(map(len, runs), default=1)}


def together_and_single(scene: str, gears: int, repeats: int) -> dict[str, float]:
    """CPU times [s]: to learn about a new gear, of each gear together, of a gear by itself; medians."""
    random, test = np.random.default_rng(0), TABLES[scene]
    prediction = Prediction.of([test])
    tries = []
    rig: dict[str, Any] = {"test.path": "there-and-back"}
    if test.load:
        rig["test.load_mass"] = test.load / GRAVITY
    for _ in range(repeats + 1):
        gear = true_gear().replace({"yoke.preload": float(random.uniform(250.0, 350.0)), **rig})
        middle = {"yoke.preload": gear.yoke.preload, "pinion.runout": gear.pinion.runout}
        table = {
            path: value * random.uniform(1 - SPREAD, 1 + SPREAD, gears) for path, value in middle.items()
        }
        ranges = {path: (float(each.min()), float(each.max())) for path, each in table.items()}
        times = [process_time()]
        for _ in range(2):  # the second knows what the first has learned
            found = batch(scene, gear, table, keep="torque", ranges=ranges)
            times.append(process_time())
        for row in range(3):
            prediction.simulated(gear.replace({path: float(each[row]) for path, each in table.items()}))
        times.append(process_time())
        tries.append((*np.diff(times), found.in_loop.mean()))
    first, again, three, share = np.median(tries[1:], axis=0)  # the first try loads kernels
    return {
        "begin": float(first - again),
        "each": float(again / gears),
        "single": float(three / 3),
        "in_loop": float(share),
    }


def table(folder: Path) -> str:
    """Both sides: gears at once in fits, and gears from which on a table pays."""
    data = load_data(folder / DATA)
    fits = [
        (f"fit of {name}", f"{each['gears']} gears simulated, at most {each['at_once']} known at once")
        for name, each in data["fits"].items()
    ]
    loops = [
        (
            f"together, {scene}",
            f"{1e3 * each['begin']:.0f} ms to begin about a new gear, {1e3 * each['each']:.1f} ms a gear; "
            f"the fit's own {1e3 * each['single']:.0f} ms a gear: {_pays(each)}, "
            f"{100 * each['in_loop']:.0f} % of them found",
        )
        for scene, each in data["loops"].items()
    ]
    return markdown(("what", "found"), [*fits, *loops])


def _pays(times: dict[str, float]) -> str:
    saved = times["single"] - times["each"]
    return "never pays" if saved <= 0 else f"pays from {int(np.ceil(times['begin'] / saved))} gears on"


TOPIC = Topic(
    "what a fit could follow together",
    "1 min",
    "fit",
    run,
    {"fits": ("free torque",), "scenes": ("free-pinion-torque",), "gears": 4, "repeats": 1},
    {"fit_designs": table},
)
