"""The ten-minute test: what a newcomer does, from the clone to a notebook, each step's time and silence.

Each step is a process of its own in a terminal and an empty folder. "Compiled" are steps after others have
compiled what they need; "first" is one with an empty cache of kernels.
"""

import json
import os
import pty
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from resource import RUSAGE_CHILDREN
from time import monotonic
from typing import Any
from urllib.request import Request, urlopen

import numpy as np

from benchmarks.published import cpu_time_of
from benchmarks.topic import ROOT, Columns, Topic, rows_table, save_data

DATA = "ten_minutes.json"
FIRST = "run"
EXPLORE = "explore --no-browser"
COMMANDS = (
    "init .",
    "run",
    'run --gear gears/paper.toml --set yoke.preload="400 N" --out own.h5',
    "study preload.toml",
    "report preload",
    "report own.h5",
    "animate own.h5 --out own.html",
    "run --measured measured.csv --out compared.h5",
    "fit examples/measured/made_up_free.csv --out fitted.toml --report fitted.html",
    "run --band --out band.h5",
    "check --out check.html",
    EXPLORE,
    "report band.band.json --out band.html",
)
NOTEBOOK = "examples/first_steps.ipynb"
CELLS = """
import json, sys
names = {}
for cell in json.load(open(sys.argv[1], encoding="utf-8"))["cells"]:
    if cell["cell_type"] == "code":
        exec("".join(cell["source"]), names)
        print("cell done", flush=True)
"""
SERVER = re.compile(r"server: (http\S+)")
MOVES: tuple[dict[str, float], ...] = ({}, {"yoke.preload": 400})  # states of the explorer's sliders
PAGES = {  # command -> the page that it writes
    "report preload": "preload/report.html",
    "report own.h5": "own.html",
    "fit examples/measured/made_up_free.csv --out fitted.toml --report fitted.html": "fitted.html",
    "check --out check.html": "check.html",
    "report band.band.json --out band.html": "band.html",
    "animate own.h5 --out own.html": "own.html",
}


def run(folder: Path, commands: Sequence[str] = COMMANDS, repeats: int = 2, beside: bool = True) -> None:
    """Do these steps in an empty folder, and those beside commands; keep the least times of some repeats."""
    steps: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as temporary:
        place = Path(temporary)
        write_measured(place / "measured.csv")
        named = [(f"rps-exudyn {line}", command(line)) for line in commands]
        if beside:
            copy = ["git", "clone", "-q", "--depth", "1", ROOT.as_uri(), str(place / "clone")]
            steps.append(timed("git clone", copy, place, {}))
            cache = {"RPS_EXUDYN_CACHE": str(place / "cache")}
            steps.append(timed(f"rps-exudyn {FIRST}, preparing", command(FIRST), place, cache))
            named.append((f"the cells of {NOTEBOOK}", [sys.executable, "-c", CELLS, NOTEBOOK]))
        for name, process in named:
            line, tries = name.removeprefix("rps-exudyn "), []
            for _ in range(repeats):
                if line.startswith("study"):
                    shutil.rmtree(place / "preload", ignore_errors=True)  # what is there is not done again
                tries.append(timed(name, process, place, {}, explore if line == EXPLORE else None))
            step = tries[0] | {each: min(found[each] for found in tries) for each in ("cpu", "silence")}
            print(step, flush=True)
            if line in PAGES:
                step["kilobytes"] = (place / PAGES[line]).stat().st_size / 1e3
            steps.append(step)
    save_data(folder / DATA, {"steps": steps})


def command(line: str) -> list[str]:
    """The process of a command of this checkout."""
    return [sys.executable, "-m", "rps_exudyn", *shlex.split(line)]


Use = Callable[[str], bool]
"""Called with all that a process has printed so far; returns whether it is to be interrupted."""


def timed(
    name: str, process: list[str], place: Path, environment: dict[str, str], use: Use | None = None
) -> dict[str, Any]:
    """Run a process in a terminal; return its name with CPU time of it and its children, and the longest time
    without output [s].

    Raises:
        subprocess.CalledProcessError: it failed.
    """
    settings = surroundings() | environment
    before, last, silences = cpu_time_of(RUSAGE_CHILDREN), monotonic(), [0.0]
    terminal, end = pty.openpty()
    with subprocess.Popen(process, cwd=place, env=settings, stdin=end, stdout=end, stderr=end) as running:
        os.close(end)
        printed = ""
        with suppress(OSError):  # how the end of a terminal is read
            while found := os.read(terminal, 65536):
                silences.append(monotonic() - last)
                printed += found.decode(errors="replace")
                if use and use(printed):
                    use = None
                    running.send_signal(signal.SIGINT)
                last = monotonic()
        os.close(terminal)
        status = running.wait()
    silences.append(monotonic() - last)
    allowed = (0, 1) if " check" in name else (0,)  # 1: some limit is not kept
    if status not in allowed:
        raise subprocess.CalledProcessError(status, process, printed)
    return {"command": name, "cpu": cpu_time_of(RUSAGE_CHILDREN) - before, "silence": max(silences)}


def explore(printed: str) -> bool:
    """Once the server's address is printed, ask for all that its page asks for at first and after a slider
    has moved."""
    if (address := SERVER.search(printed)) is None:
        return False
    for number, state in enumerate(MOVES):
        for path in ("sliders", "curve", "picture"):
            content = json.dumps({"state": state, "number": number}).encode()
            asked = Request(address[1] + path, content, {"Content-Type": "application/json"})
            with urlopen(asked) as answer:
                assert "problems" not in json.load(answer)
    return True


def surroundings() -> dict[str, str]:
    """Environment of a command of this checkout, whose bytecode is kept as that of an installed package."""
    settings = {**os.environ, "PYTHONPATH": str(ROOT), "TERM": "xterm"}
    settings.pop("PYTHONDONTWRITEBYTECODE", None)
    return settings


def write_measured(path: Path) -> None:
    """Write a made-up curve that stands for a measured one: what is timed does not depend on it."""
    angle = np.linspace(0, 360, 361)
    torque = 0.62 + 0.015 * np.sin(np.radians(6 * angle))
    rows = "\n".join(f"{a:.1f};{t:.4f}" for a, t in zip(angle, torque, strict=True))
    path.write_text(f"pinion_angle [deg]; pinion_torque [N m]\n{rows}\n", encoding="utf-8")


OUTPUTS = re.compile(r" --(out|report) \S+")
"""What the table leaves out of a command."""
STEPS: Columns = {
    "step": lambda step: f"`{OUTPUTS.sub('', step['command'].removeprefix('rps-exudyn '))}`",
    "CPU time s": "{cpu:.1f}",
    "longest silence s": "{silence:.1f}",
}
TOPIC = Topic(
    "3 min",
    "first_use",
    run,
    {"commands": ("init .",), "repeats": 1, "beside": False},
    {"ten_minutes": rows_table(DATA, "steps", STEPS)},
)
