"""Ordinary gears over a turn by equilibria: how many of them are lost.

The default gear with preload, friction, drag, spring and manufacturing errors drawn evenly from the ranges
of passenger cars (`verification.population`), each gear simulated on its own in steps of 1 degree. Lost is a
gear without an equilibrium at some angle.
"""

from collections import Counter
from pathlib import Path
from time import process_time

import numpy as np

import rps_exudyn as rps
from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.parameters.gear import SteeringGear
from verification.population import ERRORS, RANGES

SEED = 8
OF_PINION = ("normal_module", "pressure_angle", "helix_angle", "face_width")
GEOMETRY = ("rack.tooth_angle", *(f"pinion.{name}" for name in OF_PINION))
DRAWN = {path: span for path, span in sorted({**RANGES, **ERRORS}.items()) if path not in GEOMETRY}
TOGETHER = 100  # gears handed over at a time
DATA = "ordinary_gears.json"


def run(folder: Path, gears: int = 10_000) -> None:
    """Simulate so many gears and count how they end; keep the values of those that do not end well."""
    rng, counts, cpu = np.random.default_rng(SEED), Counter[str](), 0.0
    odd: list[dict[str, object]] = []
    for begin in range(0, gears, TOGETHER):
        count = min(TOGETHER, gears - begin)
        table = {path: rng.uniform(low, high, count) for path, (low, high) in DRAWN.items()}
        start = process_time()
        made = rps.batch("free-pinion-torque", SteeringGear(), table)
        cpu += process_time() - start
        counts.update(status.value for status in made.statuses)
        for i, result in enumerate(made.results):
            if result is not None and result.status is not rps.Status.OK:
                values = {path: float(column[i]) for path, column in table.items()}
                odd.append({"status": result.status.value, "message": result.message, **values})
        save_data(
            folder / DATA, {"gears": begin + count, "cpu_s": cpu, "counts": dict(counts), "not_ok": odd}
        )


def counts_table(folder: Path) -> str:
    """How the gears ended."""
    found = load_data(folder / DATA)
    lost = found["counts"].get("no-convergence", 0)
    rows = [("gears", found["gears"]), *sorted(found["counts"].items()), ("**lost**", f"**{lost}**")]
    rows.append(("CPU time of a gear", f"{1e3 * found['cpu_s'] / found['gears']:.0f} ms"))
    return markdown(("ordinary gears over a turn", "number"), rows)


TOPIC = Topic("16 min", "stability", run, {"gears": 3}, {"ordinary_gears": counts_table})
