"""The ten-minute test: what a newcomer types, from the clone to the animation, each command with its time.

Commands run as processes of their own in an empty folder, in a terminal, whose longest silence is measured.
"Compiled" are commands after others have compiled what they need; "first" is one with an empty cache of
kernels. The explorer is asked for one curve and ended; a notebook's cells run one after the other, without
Jupyter.
"""

import json
import os
import pty
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import Any
from urllib.request import Request, urlopen

import numpy as np

from benchmarks.topic import ROOT, Topic, load_data, markdown, save_data

DATA = "ten_minutes.json"
FIRST = "run"
TIMES = ("cpu", "wall", "silent")
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
    "run --band --measured measured.csv --out band.h5",
    "fit examples/measured/made_up_free.csv --out fitted.toml",
    "check",
    "explore --no-browser",
    "first_steps.ipynb",
)
ALL_CELLS = """
import json, sys
from pathlib import Path
cells = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))["cells"]
exec("\\n".join("".join(each["source"]) for each in cells if each["cell_type"] == "code"))
"""
ADDRESS = re.compile(r"server: (http\S+)")
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
                name = line if line.endswith(".ipynb") else f"rps-exudyn {line}"
                tries.append(timed(name, command(line), place, {}))
            step = {**tries[0], **{name: min(each[name] for each in tries) for name in TIMES}}
            print(step, flush=True)
            if line in PAGES:
                step["kilobytes"] = (place / PAGES[line]).stat().st_size / 1e3
            steps.append(step)
    save_data(folder / DATA, {"steps": steps})


def command(line: str) -> list[str]:
    """The process of a command of this checkout, or of a notebook."""
    if line.endswith(".ipynb"):
        return [sys.executable, "-c", ALL_CELLS, f"examples/{line}"]
    return [sys.executable, "-m", "rps_exudyn", *shlex.split(line)]


def timed(name: str, process: list[str], place: Path, environment: dict[str, str]) -> dict[str, Any]:
    """Run a process in a terminal; return its name with CPU time of it and its children, elapsed time, and
    the longest time without output [s].

    Raises:
        subprocess.CalledProcessError: it failed.
    """
    settings = surroundings() | environment
    before, began = children(), perf_counter()
    terminal, its_end = pty.openpty()
    started = subprocess.Popen(
        process, cwd=place, env=settings, stdin=subprocess.DEVNULL, stdout=its_end, stderr=its_end
    )
    os.close(its_end)
    said, silent, last = "", 0.0, began
    while True:
        part = _said(terminal)
        now = perf_counter()
        silent, last = max(silent, now - last), now
        if not part:
            break
        already, said = ADDRESS.search(said), said + part
        if (found := ADDRESS.search(said)) and not already:
            _ask_for_curve(found[1])
            started.send_signal(signal.SIGINT)
    os.close(terminal)
    allowed = (0, 1) if name.endswith(" check") else (0,)  # 1: some limit is not kept
    if started.wait() not in allowed:
        raise subprocess.CalledProcessError(started.returncode, process, said)
    return {"command": name, "cpu": children() - before, "wall": perf_counter() - began, "silent": silent}


def _said(terminal: int) -> str:
    """What a process writes next; nothing once all of them have ended."""
    try:
        return os.read(terminal, 65536).decode(errors="replace")
    except OSError:  # Linux's end of a terminal
        return ""


def _ask_for_curve(address: str) -> None:
    """Move a slider of the explorer's page."""
    state = json.dumps({"state": {"yoke.preload": 400}}).encode()
    with urlopen(Request(f"{address}curve", state, {"Content-Type": "application/json"})) as reply:
        assert "curves" in json.load(reply)


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
            f"{step['wall']:.1f}",
            f"{step['silent']:.1f}" if "silent" in step else "",
            f"{step['kilobytes']:.0f}" if "kilobytes" in step else "",
        ]
        for step in data["steps"]
    ]
    return markdown(["step", "CPU time s", "elapsed s", "longest silence s", "page kB"], rows)


TOPIC = Topic(
    "what a newcomer types, each command with its time",
    "3 min",
    "first_use",
    run,
    {"commands": ("init .",), "repeats": 1, "first": False, "clone": False},
    {"ten_minutes": steps_table},
)
