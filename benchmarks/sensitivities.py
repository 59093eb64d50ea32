"""Derivatives of all metrics by all parameters of random gears, beside differences of single runs."""

from functools import partial
from pathlib import Path

import numpy as np

import rps_exudyn as rps
from benchmarks.measure import least_time
from benchmarks.topic import Topic, digits, load_data, markdown, save_data
from rps_exudyn.parameters.fidelity import FOR_MEANS
from verification.population import random_gears
from verification.slopes import beside_single_runs

DATA, SCENE = "sensitivities.json", "free-pinion-torque"
CLOSE = 0.01  # of the larger one of slope and error
CLEAR = 10  # times its error: a slope that is clear


def run(folder: Path, gears: int = 20, seed: int = 2, parameters: list[str] | None = None) -> None:
    """Keep of each gear how many slopes are close to the differences, or within their errors, and CPU times
    [s] of all derivatives and of the default gear's."""
    derivatives, rows = partial(rps.sensitivities, SCENE, parameters=parameters, fidelity=FOR_MEANS), []
    for number, gear in enumerate(random_gears(seed, gears)):
        seconds, found = least_time(partial(derivatives, gear), 1)
        slopes = beside_single_runs(SCENE, gear, found)
        close = slopes.apart <= CLOSE * np.maximum(slopes.size, slopes.error)
        covered = slopes.apart <= np.maximum(CLOSE * slopes.size, slopes.error)
        clear = slopes.size > CLEAR * slopes.error
        counts = {"close": close, "covered": covered, "clear": clear, "clear_close": clear & close}
        row = {"law": found.attrs["contact_law"], "seconds": seconds, "pairs": len(close)}
        rows.append(row | {name: int(each.sum()) for name, each in counts.items()})
        print(number, rows[-1], flush=True)
    usual, _ = least_time(partial(derivatives, rps.SteeringGear()), 3)
    save_data(folder / DATA, {"default_gear": usual, "rows": rows})


def slopes_table(folder: Path) -> str:
    """Return shares of all slopes, and the cost."""
    data = load_data(folder / DATA)
    total = {name: sum(row[name] for row in data["rows"]) for name in data["rows"][0] if name != "law"}
    seconds = [row["seconds"] for row in data["rows"]]
    rows = [
        ("slopes", total["pairs"]),
        (
            "within 1 % of the larger one of slope and error [%]",
            digits(100 * total["close"] / total["pairs"], 3),
        ),
        ("within the error, or 1 % of the slope [%]", digits(100 * total["covered"] / total["pairs"], 4)),
        (
            "of slopes above ten errors, within 1 % [%]",
            digits(100 * total["clear_close"] / total["clear"], 3),
        ),
        (
            "CPU time of a gear, median and largest [s]",
            f"{digits(np.median(seconds))}, {digits(max(seconds))}",
        ),
        ("of the default gear [s]", digits(data["default_gear"])),
    ]
    return markdown((f"derivatives of {len(data['rows'])} gears", ""), rows)


TOPIC = Topic(
    "3 min",
    "drawing",
    run,
    {"gears": 1, "parameters": ["yoke.preload", "pinion.runout"]},
    {"slopes": slopes_table},
)
