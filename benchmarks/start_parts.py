"""Where the CPU time of `rps-exudyn run` goes with compiled kernels: libraries, own modules, work.

A process loads and does what the command does, part by part in the command's order; a part's time is the
least of some processes. What a part loads for itself is not counted again in the next.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks.ten_minutes import surroundings
from benchmarks.topic import Topic, load_data, markdown, save_data

DATA = "start_parts.json"
PARTS = {
    "Python itself": "",
    "the command line, with cyclopts": "import rps_exudyn.cli.main as c; c.prepare_process()",
    "numpy": "import numpy",
    "the parameters, with pydantic": (
        "from rps_exudyn.parameters.gear import SteeringGear; gear = SteeringGear()"
    ),
    "h5py": "import h5py",
    "numba": "import numba",
    "Exudyn": "import exudyn",
    "the package's modules, with 200 kernels declared": (
        "from rps_exudyn.simulate.run import simulate; import rps_exudyn.scenes.run_maneuver;"
        "import rps_exudyn.multibody.model, rps_exudyn.multibody.solve, rps_exudyn.multibody.recorder"
    ),
    "masses of pinion and rack": (
        "from rps_exudyn.gears import masses; masses.rack_masses(gear); masses.pinion_inertia(gear)"
    ),
    "compiled kernels loaded, and the simulation": "result = simulate('free-pinion-torque', gear)",
    "the same simulation once more": "simulate('free-pinion-torque', gear)",
    "the HDF5 file": "result.save('result.h5')",
    "matplotlib": ("import matplotlib.figure, rps_exudyn.pages.charts.scene_figures"),
    "the picture": "rps_exudyn.pages.charts.scene_figures.draw(result, 'result.png')",
}
NOT_IN_RUN = ("the same simulation once more",)
PROBE = """
import json, time
found, names, before = {}, {"__name__": "__main__"}, 0.0
for part, code in json.loads(PARTS).items():
    exec(code, names)
    now = time.process_time()
    found[part], before = now - before, now
print(json.dumps(found))
"""


LEAST_SHARE = 0.08  # of the whole, of a part that the table shows


def run(folder: Path, repeats: int = 5) -> None:
    """Measure all parts some times; the first process compiles what is missing."""
    probe = f"PARTS = {json.dumps(PARTS)!r}\n{PROBE}"
    with tempfile.TemporaryDirectory() as place:
        tries = [_measured(probe, place) for _ in range(repeats + 1)][1:]
    least = {part: min(each[part] for each in tries) for part in PARTS}
    print(least, flush=True)
    save_data(folder / DATA, {"parts": least, "repeats": repeats})


def _measured(probe: str, place: str) -> dict[str, float]:
    """CPU time of each part in one process [s]."""
    process = [sys.executable, "-c", probe]
    done = subprocess.run(process, cwd=place, env=surroundings(), capture_output=True, text=True, check=True)
    found: dict[str, float] = json.loads(done.stdout)
    return found


def table(folder: Path) -> str:
    """CPU time and share of the largest parts."""
    parts = load_data(folder / DATA)["parts"]
    whole = sum(time for part, time in parts.items() if part not in NOT_IN_RUN)
    rows = [
        (part, f"{time:.3f}", "" if part in NOT_IN_RUN else f"{100 * time / whole:.0f}")
        for part, time in sorted(parts.items(), key=lambda each: -each[1])
        if time > LEAST_SHARE * whole
    ]
    rows.append(("all", f"{whole:.2f}", "100"))
    return markdown(("part of `rps-exudyn run`", "CPU time [s]", "share %"), rows)


TOPIC = Topic(
    "where the CPU time of `run` goes with compiled kernels",
    "20 s",
    "first_use",
    run,
    {"repeats": 1},
    {"start_parts": table},
)
