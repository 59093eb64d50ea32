"""The reduced gear beside the dynamics `flank`, on random gears: loops, dead bands, wheel angle; its speed.

Gears are drawn from the ranges of passenger cars (`verification.population`), half of them with errors.
Each is steered to and fro at the pinion, and at the wheel by a torque against tyres. The FMU steps its pinion
under a torque and a load that change all the time.
"""

import ctypes
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np

from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.base.errors import InputError
from rps_exudyn.fmu.export_fmu import LONGEST_STEP, compiled, reduced_of, sources_of
from rps_exudyn.fmu.gear_data import header
from rps_exudyn.fmu.model_error import model_error
from rps_exudyn.fmu.variables import parameters_of
from rps_exudyn.parameters.gear import SteeringGear
from verification.population import admissible_gears

SEED = 67
DATA = "reduced_gear.json"
LOAD = 2000.0  # of the table that is timed [N]
SHOWN = {
    "hysteresis_area": "loop area, pinion",
    "torque_jump": "jump of the torque at a reversal",
    "feel_area": "loop area, wheel",
    "angle_dead_band": "dead band of the angle",
    "torque_dead_band": "dead band of the torque",
    "steering_gradient": "gradient",
    "wheel_angle_rms": "angle of the wheel over the time, RMS",
}


def run(folder: Path, gears: int = 20, seconds: float = 10.0) -> None:
    """Compare so many gears, and time a table and an FMU."""
    drawn = admissible_gears(np.random.default_rng(SEED))
    errors: list[dict[str, float]] = []
    refused: list[str] = []
    while len(errors) < gears and len(refused) < 3 * gears:
        try:
            errors.append(model_error(next(drawn)))
        except InputError as error:
            refused.append(str(error))
        print(len(errors), errors[-1] if errors else "", refused[-1] if refused else "", flush=True)
        save_data(folder / DATA, {"errors": errors, "refused": refused})
    save_data(folder / DATA, {"errors": errors, "refused": refused, "speed": speed(seconds)})


def speed(seconds: float) -> dict[str, float]:
    """Return CPU times: of the default gear's table, and of the FMU's C code over the gear's time."""
    gear = SteeringGear()
    begun = process_time()
    reduced = reduced_of(gear.replace({"mesh.law": "line"}), LOAD)
    table = process_time() - begun
    sources = sources_of(3)
    sources["gear_data.h"] = header(gear, reduced, parameters_of(gear, LONGEST_STEP).values(), "")
    sources["turning.c"] = TURNING
    binary = compiled(sources, ["reduced_gear.c", "turning.c"])
    if binary is None:
        return {"table_s": table}
    with TemporaryDirectory() as place:
        Path(place, "gear.so").write_bytes(binary)
        library = ctypes.CDLL(str(Path(place, "gear.so")))
        steps = round(seconds / LONGEST_STEP)
        times = []
        for _ in range(3):
            begun = process_time()
            library.turning(ctypes.c_int(steps), ctypes.c_double(LONGEST_STEP))
            times.append(process_time() - begun)
    return {"table_s": table, "step_ns": 1e9 * min(times) / steps, "real_time_factor": min(times) / seconds}


TURNING = """
#include "reduced_gear.h"
#include <math.h>
void turning(int steps, double h) {
    Gear g;
    gear_reset(&g);
    gear_start(&g);
    for (int k = 0; k < steps; k++) {
        g.in[TORQUE_IN] = 5 * sin(3 * k * h);
        g.in[FORCE_IN] = 800 * sin(3 * k * h - 0.1);
        gear_step(&g, h);
    }
}
"""


def errors_table(folder: Path) -> str:
    """Metric -> median and worst error over the gears."""
    found: list[dict[str, Any]] = load_data(folder / DATA)["errors"]
    rows = []
    for name, text in SHOWN.items():
        sizes = [100 * abs(each[name]) for each in found if name in each]
        if sizes:
            rows.append((text, len(sizes), f"{np.median(sizes):.2g} %", f"{max(sizes):.2g} %"))
    return markdown(("reduced against `flank`", "gears", "median error", "worst"), rows)


def speed_table(folder: Path) -> str:
    """What the table and a step of the FMU take."""
    found = load_data(folder / DATA).get("speed", {})
    rows = [("table of the default gear", f"{found['table_s']:.2g} s")] if "table_s" in found else []
    if "step_ns" in found:
        rows.append((f"step of {1e3 * LONGEST_STEP:g} ms", f"{found['step_ns']:.0f} ns"))
        rows.append(("CPU time over the gear's time", f"{found['real_time_factor']:.1g}"))
    return markdown(("CPU time", ""), rows)


TOPIC = Topic(
    "6 min",
    "reduced_gear",
    run,
    {"gears": 1, "seconds": 0.01},
    {"reduced_errors": errors_table, "reduced_speed": speed_table},
)
