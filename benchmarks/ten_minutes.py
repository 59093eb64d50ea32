"""The ten-minute test: what a newcomer types, from the clone to the animation, each command with its time.

Commands run as processes of their own in an empty folder. "Compiled" are commands after others have compiled
what they need; "first" is one with an empty cache of kernels.
"""

import os
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.topic import ROOT, Topic, load_data, markdown, save_data

DATA = "ten_minutes.json"
LIMIT = 5.0  # of a compiled command [s]
FIRST = "run"
COMMANDS = (
    "init .",
    "run",
    'run --gear gears/paper.toml --set yoke.preload="400 N" --out own.h5',
    "run --fidelity quasi-static --out fast.h5",
    "study preload.toml",
    "report preload",
    "report own.h5",
    "animate own.h5 --out own.html",
    "run --measured measured.csv --out compared.h5",
    "fit examples/measured/made_up_free.csv --out fitted.toml",
    "check",
)
PAGES = {  # command -> the page that it writes
    "report preload": "preload/report.html",
    "report own.h5": "own.html",
    "animate own.h5 --out own.html": "own.html",
}


def run(
    folder: Path, commands: Sequence[str] = COMMANDS, repeats: int = 2, first: bool = True, clone: bool = True
) -> None:
    """Do all steps in an empty folder; keep the least times of some repeats."""
    steps: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as temporary:
        place = Path(temporary)
        if clone:
            copy = ["git", "clone", "-q", "--depth", "1", ROOT.as_uri(), str(place / "clone")]
            steps.append(timed("git clone", copy, place, {}))
        if first:
            cache = {"NUMBA_CACHE_DIR": str(place / "cache")}
            steps.append(timed(f"rps-exudyn {FIRST}, compiling", command(FIRST), place, cache))
        for line in commands:
            if "--measured" in line:
                write_measured(place / "measured.csv")
            tries = []
            for _ in range(repeats):
                if line.startswith("study"):
                    shutil.rmtree(place / "preload", ignore_errors=True)  # what is there is not done again
                tries.append(timed(f"rps-exudyn {line}", command(line), place, {}))
            step = {**tries[0], **{name: min(each[name] for each in tries) for name in ("cpu", "wall")}}
            print(step, flush=True)
            if line in PAGES:
                step["kilobytes"] = (place / PAGES[line]).stat().st_size / 1e3
            steps.append(step)
    save_data(folder / DATA, {"steps": steps})


def command(line: str) -> list[str]:
    """The process of a command of this checkout."""
    return [sys.executable, "-m", "rps_exudyn", *shlex.split(line)]


def timed(name: str, process: list[str], place: Path, environment: dict[str, str]) -> dict[str, Any]:
    """Run a process; return its name with CPU time of it and its children and elapsed time [s].

    Raises:
        subprocess.CalledProcessError: it failed.
    """
    settings = surroundings() | environment
    before, began = children(), perf_counter()
    done = subprocess.run(process, cwd=place, env=settings, capture_output=True)
    allowed = (0, 1) if name.endswith(" check") else (0,)  # 1: some limit is not kept
    if done.returncode not in allowed:
        raise subprocess.CalledProcessError(done.returncode, process, done.stdout, done.stderr)
    return {"command": name, "cpu": children() - before, "wall": perf_counter() - began}


def surroundings() -> dict[str, str]:
    """Environment of a command of this checkout, whose bytecode is kept as that of an installed package."""
    settings = {**os.environ, "PYTHONPATH": str(ROOT)}
    settings.pop("PYTHONDONTWRITEBYTECODE", None)
    return settings


def children() -> float:
    """CPU time of all processes that this one has started and seen ending [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def write_measured(path: Path) -> None:
    """Write a made-up curve that stands for a measured one: what is timed does not depend on it."""
    angle = np.linspace(0, 360, 361)
    torque = 0.62 + 0.015 * np.sin(np.radians(6 * angle))
    rows = "\n".join(f"{a:.1f};{t:.4f}" for a, t in zip(angle, torque, strict=True))
    path.write_text(f"pinion_angle [deg]; pinion_torque [N m]\n{rows}\n", encoding="utf-8")


def steps_table(folder: Path) -> str:
    """Every step with its times."""
    data = load_data(folder / DATA)
    rows = [
        [
            f"`{step['command']}`",
            f"{step['cpu']:.1f}",
            f"{step['kilobytes']:.0f}" if "kilobytes" in step else "",
        ]
        for step in data["steps"]
    ]
    return markdown(["step", "CPU time s", "page kB"], rows)


TOPIC = Topic(
    "what a newcomer types, each command with its time",
    "3 min",
    "first_use",
    run,
    {"commands": ("init .",), "repeats": 1, "first": False, "clone": False},
    {"ten_minutes": steps_table},
)
