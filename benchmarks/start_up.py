"""Start of the commands: CPU time with compiled kernels, of the first run, and of the libraries alone.

Each command is a process of its own in an empty folder. Other work on the machine makes CPU times up to three
times as long; the libraries' own import, measured in turn with the commands, shows by how much.
"""

import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from benchmarks.ten_minutes import command, timed
from benchmarks.topic import Topic, load_data, markdown, save_data

DATA = "start_up.json"
LIBRARIES = "the libraries that `run` needs, imported"
IMPORTED = "import numpy, llvmlite.binding, h5py, exudyn, pydantic, cyclopts, matplotlib.figure"
QUICK = ("--help", "describe", "describe yoke.preload")
COMMANDS = (*QUICK, "run --fidelity closed-form", "run --fidelity quasi-static", "run")
WANTED = dict.fromkeys(QUICK, 0.3) | {"run": 0.9}  # CPU time [s]
FIRST = {"run": 10.0}


def run(
    folder: Path, commands: Sequence[str] = COMMANDS, repeats: int = 10, first: Sequence[str] = tuple(FIRST)
) -> None:
    """Measure every command some times in turn, and the first run with an empty cache of kernels."""
    least: dict[str, dict[str, float]] = {}
    with tempfile.TemporaryDirectory() as temporary:
        place = Path(temporary)
        for line in commands:
            timed(line, command(line), place, {})  # prepares what is missing
        for _ in range(repeats):
            tries = {line: timed(line, command(line), place, {}) for line in commands}
            tries[LIBRARIES] = timed(LIBRARIES, [sys.executable, "-c", IMPORTED], place, {})
            for line, one in tries.items():
                least[line] = {"cpu": min(one["cpu"], least.get(line, one)["cpu"])}
        for line in first:
            cache = {"RPS_EXUDYN_CACHE": str(place / f"cache {line}")}
            least[f"first {line}"] = {"cpu": timed(line, command(line), place, cache)["cpu"]}
    print(least, flush=True)
    save_data(folder / DATA, {"commands": least, "repeats": repeats})


def table(folder: Path) -> str:
    """Times of all commands."""
    commands = load_data(folder / DATA)["commands"]
    wanted = WANTED | {f"first {line}": limit for line, limit in FIRST.items()}
    rows = [(_named(line), f"{each['cpu']:.2f}", wanted.get(line, "")) for line, each in commands.items()]
    return markdown(("command", "CPU time [s]", "aim [s]"), rows)


def _named(line: str) -> str:
    name = f"`rps-exudyn {line.removeprefix('first ')}`"
    return line if line == LIBRARIES else f"{name}, preparing" if line.startswith("first ") else name


TOY = {"commands": QUICK[:2], "repeats": 1, "first": ()}
TOPIC = Topic("3 min", "first_use", run, TOY, {"start_up": table})
