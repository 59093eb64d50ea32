"""The table of kernels that works compile, from which a command says how many are still to be compiled.

Each work is a process of its own with an empty cache. Its kernels are counted as numba reports them; the time
of a kernel is the least of all works, without the kernels that it calls.
"""

import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from benchmarks.topic import ROOT, Topic
from rps_exudyn.base.atomic import write_json
from rps_exudyn.base.kernel_table import TABLE, KernelTable
from rps_exudyn.parameters.fidelity import PRESETS
from rps_exudyn.scenes import SCENE_NAMES

TYRES = ("--set", "test.tyre_stiffness=200 N/mm")  # without which that scene is refused
NEEDS = {"steering-torque": TYRES}
RESULT, STUDY, ROWS = "result.h5", "study.toml", 70
LOOPED = f"""scene = "free-pinion-torque"
fidelity = "quasi-static"
[keep]
signals = "none"
[[axis]]
path = "yoke.preload"
unit = "N"
linspace = [200, 400, {ROWS}]
"""

SCENES = {
    f"{scene} {preset}": ("run", scene, "--fidelity", preset, *NEEDS.get(scene, ()))
    for scene in SCENE_NAMES
    for preset in PRESETS
    if preset != "closed-form"  # compiles nothing
}
BESIDE = (  # preset, and what is chosen beside it
    ("flank", "bush", "chain"),
    ("flank", "bush", "rigid"),
    ("flank", "mesh", "ratio"),
    ("flank", "mesh", "ratio-with-loss"),
    ("flank", "mesh", "general-contact"),
    ("flank", "yoke", "force"),
    ("flank", "rack", "flexible"),
    ("quasi-static", "mesh", "ratio-with-loss"),
    ("quasi-static", "mesh", "general-contact"),
    ("quasi-static", "yoke", "force"),
    ("quasi-static", "rack", "flexible"),
    ("full", "bush", "condensed"),
    ("full", "mesh", "flank"),
)
MODELS = {
    f"{SCENE_NAMES[0]} {preset} with {part} {choice}": ("run", "--fidelity", preset, f"--{part}", choice)
    for preset, part, choice in BESIDE
}
OF_GEAR = ("mesh.law=teeth", "mesh.friction_law=bristle")
GEARS = {  # not asked for by these names, but recognised by their kernels
    f"{setting} {preset}": ("run", "--fidelity", preset, "--set", setting)
    for setting in OF_GEAR
    for preset in ("flank", "quasi-static")
}
COMMANDS = {
    "check": ("check",),
    "validate": ("validate",),
    "animate": ("animate", RESULT),
    "contact": ("report", RESULT, "--contact"),
    "loop": ("study", STUDY, "--jobs", "1"),
}
WORKS: Mapping[str, Sequence[str]] = MappingProxyType(SCENES | MODELS | GEARS | COMMANDS)


def run(folder: Path, works: Mapping[str, Sequence[str]] = WORKS, table: Path = TABLE) -> None:
    """Record the works and write the table; a relative `table` is one in the folder."""
    seconds: dict[str, float] = {}
    found: dict[str, Counter[str]] = {}
    with tempfile.TemporaryDirectory() as temporary:
        place = Path(temporary)
        (place / STUDY).write_text(LOOPED)
        recorded(place, ("run", "--fidelity", "quasi-static", "--out", RESULT))
        for name, arguments in works.items():
            steps = recorded(place, arguments)
            for kernel, took in steps:
                seconds[kernel] = min(took, seconds.get(kernel, took))
            if steps:
                found[name] = Counter(kernel for kernel, _ in steps)
            print(f"{name}: {len(steps)} kernels in {sum(took for _, took in steps):.1f} s", flush=True)
    write_json(folder / table, KernelTable.of(seconds, found).as_dict())


def recorded(place: Path, arguments: Sequence[str]) -> list[tuple[str, float]]:
    """Return the kernels that a command compiles with an empty cache, and the time of each [s]."""
    with tempfile.TemporaryDirectory() as cache:
        steps = Path(cache) / "steps.json"
        environment = {**os.environ, "XDG_CACHE_HOME": cache, "PYTHONPATH": str(ROOT)}
        environment.pop("NUMBA_CACHE_DIR", None)
        call = [sys.executable, "-P", "-m", __spec__.name, str(steps), *arguments]
        subprocess.run(call, cwd=place, env=environment, capture_output=True, check=False)
        return [(kernel, took) for kernel, took in json.loads(steps.read_text())]


def record(file: Path, arguments: Sequence[str]) -> None:
    """Run a command in this process and write what it compiled."""
    from rps_exudyn.base.compiling import Step, listening
    from rps_exudyn.cli.commands import main

    steps: list[tuple[str, float]] = []

    def listen(step: Step) -> None:
        if step.what == "done":
            steps.append((step.name, step.seconds))

    try:
        with listening(listen):
            main(arguments)
    finally:
        file.write_text(json.dumps(steps))


TOPIC = Topic(
    "kernels that each work compiles, for the total of the progress bar",
    "25 min",
    "first_use",
    run,
    {"works": {"animate": COMMANDS["animate"]}, "table": Path("kernel_table.json")},
)

if __name__ == "__main__":
    record(Path(sys.argv[1]), sys.argv[2:])
