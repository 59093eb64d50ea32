"""Small studies, and a stand-in for simulation in worker processes, for tests of the runner."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from rps_exudyn.simulate.cases.task import Answer, Task, answer_to

GRID = """
scene = "free-pinion-torque"
fidelity = "quasi-static"
time_limit = "20 s"
[[axis]]
path = "yoke.preload"
unit = "N"
values = [{preloads}]
"""

TWO = """
title = "Much travel per turn at little torque"
fidelity = "closed-form"
errors = "none"
designs = 24
population = 12
confirm = [1, 0]
[variables]
yoke.preload = ["200 N", "400 N"]
rack.tooth_angle = ["0 deg", "15 deg"]
[objectives.torque_mean]
[objectives.gain]
goal = "most"
"""
"""An optimisation of two objectives and two variables, in a second."""

TOLERANCES = """
fidelity = "closed-form"
errors = "none"
samples = 64
confirm = [64, 0]
[tolerances.yoke.preload]
coarse = ["300 N +- 60 N", 0]
fine = ["300 N +- 15 N", 3]
[constraints.torque_mean]
most = "0.7 N*m"
"""
"""A choice of tolerances, in a second."""

STAND_IN = '''
import os, signal, time
import numpy as np
from dataclasses import replace

from rps_exudyn.scenes import free_pinion_torque
from rps_exudyn.results.outcome import Outcome, Status
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.simulate import run_plan


def scene(gear, fidelity, options):
    """What becomes of a case depends on its preload [N]."""
    preload = round(gear.yoke.preload)
    if gear.test.turns < 0.1:  # warm_up
        return SceneRun(Outcome(Status.OK, settings={"name": "none"}))
    if preload == 901:
        os.kill(os.getpid(), signal.SIGSEGV)
    if preload == 902:
        time.sleep(1000)
    if preload == 903:
        raise RuntimeError("on purpose")
    if preload == 904:
        return SceneRun(Outcome(Status.DIVERGED, "on purpose", settings={"name": "none"}))
    if preload == 905:
        os._exit(7)
    if preload > 910:
        time.sleep(float(os.environ.get("STAND_IN_SECONDS", 0)))
    angle = np.linspace(0, 6.28, 101)
    signals = {"time": angle, "pinion_angle": angle, "pinion_torque": preload * np.cos(angle)}
    return SceneRun(Outcome(Status.OK, settings={"name": "none"}), signals, {"torque_mean": preload / 500})


free_pinion_torque.SCENE = replace(free_pinion_torque.SCENE, run=scene, test=None)
class Levels:  # which made-up signals do not have
    def __init__(self, own, *arguments): self.run = lambda level: own.run(*arguments)
    with_bars = property(lambda self: self.run)
run_plan.Levels = Levels
'''
"""A sitecustomize.py, which Python imports when it starts: workers then simulate nothing."""


@dataclass(frozen=True)
class Here:
    """An executor: does tasks one after the other in this process."""

    time_limit: float = float("inf")
    workers: int = 1
    group_seconds: float = 2.0

    def run(self, tasks: Iterator[Task]) -> Iterator[tuple[Task, Answer]]:
        for task in tasks:
            yield task, answer_to(task, self.time_limit)


def write_stand_in(folder: Path) -> Path:
    """The folder to be put on PYTHONPATH."""
    (folder / "sitecustomize.py").write_text(STAND_IN)
    return folder


def write_grid(file: Path, *preloads: float) -> Path:
    """A study over these preloads [N]."""
    file.write_text(GRID.format(preloads=", ".join(map(str, preloads))))
    return file
