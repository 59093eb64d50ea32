"""A scene: one thing that the test rig does, and its facts for the rest of the package."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.run_options import RunOptions
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.scenes.steady_test import SteadyTest


def always_promised(gear: SteeringGear) -> str:
    """Return no reason against a promise of accuracy."""
    return ""


def turns_of_test(gear: SteeringGear) -> float:
    """Return the revolutions that the test records one way."""
    return gear.test.turns


@dataclass(frozen=True, kw_only=True)
class Scene:
    """One thing that the test rig does.

    Attributes:
        name: its name in commands and files.
        title: its name over tables and charts.
        run: simulates it; raises InputError for a test or a model that the scene cannot have.
        signal: name of the signal whose error counts.
        figure: name of the number in the summary that must be right.
        chart: its picture is drawn by the function CHART_figure(result, measured) of `charts.scene`.
        steady: whether everything slides at a constant speed.
        needs_inertia: whether equilibria cannot show it.
        at_rest: whether nothing moves: its instants are loads one after the other.
        swings: whether it steers to and fro and records whole cycles.
        at_test_speed: whether the rig moves at `test.speed`.
        test: its maneuvers and metrics, where many gears can be followed together.
        revolutions: how often the pinion turns in a run one way; None where it does not turn.
        short_path: `test.path` of a run over a few tooth pitches.
        promised_as: name of the scene whose table of accuracy holds; "" if it is its own.
        unpromised: why no accuracy can be promised of a test; "" if one can.
    """

    name: str
    title: str
    run: Callable[[SteeringGear, Fidelity, RunOptions], SceneRun]
    signal: str
    figure: str
    chart: str
    steady: bool = False
    needs_inertia: bool = False
    at_rest: bool = False
    swings: bool = False
    at_test_speed: bool = True
    test: SteadyTest | None = None
    revolutions: Callable[[SteeringGear], float] | None = turns_of_test
    short_path: str = "one-way"
    promised_as: str = ""
    unpromised: Callable[[SteeringGear], str] = always_promised

    @property
    def unit_of_cost(self) -> str:
        """Return what the CPU time of a run is counted by: "revolution", or "run" where the pinion is
        held."""
        return "revolution" if self.revolutions else "run"


def swept_revolutions(gear: SteeringGear) -> float:
    """Return the revolutions that a reversal sweeps, to and fro."""
    return 4 * gear.test.amplitude * gear.test.cycles / (2 * np.pi)
