"""What a gear would show in each test of a bench: simulated by equilibria, and by formula.

A curve of free turning is simulated over a turn in both directions, and repeated; of the other tests the mean
of each direction is predicted, from a turn, or from a tooth pitch where the runout is too small to matter.
Under a weight that lifts a flank now and then over the turn, 20 um change the friction by 0.4 %, and so the
preload that is fitted. Without its yoke, without its rack, or with rollers for its pinion, what is left of a
gear are formulas of drag, bearing and plunger friction.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from rps_exudyn.analysis.measured import TURN
from rps_exudyn.analysis.torque import mean
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.inference.fitting.bench_tests import BenchTest
from rps_exudyn.inference.fitting.unknowns import BY_LOAD, LARGEST, LOAD_OF_NUISANCE, WITHOUT_YOKE
from rps_exudyn.parameters.fidelity import FOR_MEANS, MEAN_STEP, Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.ladder import gear_at, model_at
from rps_exudyn.scenes.maneuver import steady_maneuver
from rps_exudyn.scenes.rack_on_rollers import SCENE as RACK_ON_ROLLERS
from rps_exudyn.scenes.rack_on_rollers import on_rollers
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.scene import RunOptions
from rps_exudyn.simulate.cases.run_cases import CaseRunner
from rps_exudyn.simulate.cases.task import Task
from rps_exudyn.solvers.closed_form import GRAVITY, mean_state, pushing_force
from rps_exudyn.solvers.prescribed_motion import DrivenBody
from rps_exudyn.solvers.temperature_and_wear import tested_gear

SEEN = 4e-6  # of a runout, that changes means by a percent of what 20 um do [m]


class NoPredictionError(Exception):
    """Raised where the simulation of a gear fails; its text is the cause."""


@dataclass(frozen=True)
class CurveBlock:
    """A part of the predicted values: forward and backward values of one test, one after the other."""

    test: BenchTest
    grid: np.ndarray  # pinion angles of either direction [rad], shape (n,); one angle stands for a mean
    repeats: bool  # with the turn

    @property
    def size(self) -> int:
        return 2 * self.grid.size

    def at(self, values: np.ndarray, direction: int, angle: np.ndarray) -> np.ndarray:
        """Values (m, ...) of this block at pinion angles (n,): shape (n, ...)."""
        half = values[: self.grid.size] if direction > 0 else values[self.grid.size :]
        if self.grid.size == 1:
            return np.broadcast_to(half[0], (angle.size, *half.shape[1:])).copy()
        place = (angle - self.grid[0]) % TURN + self.grid[0] if self.repeats else angle
        where = np.clip((place - self.grid[0]) / (self.grid[1] - self.grid[0]), 0, self.grid.size - 1 - 1e-9)
        low = where.astype(int)
        part = (where - low).reshape(-1, *([1] * (values.ndim - 1)))
        return (1 - part) * half[low] + part * half[low + 1]

    def means(self, values: np.ndarray) -> np.ndarray:
        """Means towards +X and -X of values (m, ...): shape (2, ...)."""
        half = self.grid.size
        weights = np.ones(half)
        if half > 1:
            weights[[0, -1]] = 0.5
        weights = weights / weights.sum()
        return np.array([np.tensordot(weights, part, axes=1) for part in (values[:half], values[half:])])


@dataclass
class Prediction:
    """Predicts the values of all tests, and counts what it took."""

    blocks: Sequence[CurveBlock]
    fidelity: Fidelity = FOR_MEANS
    level: int = 1  # of the ladder
    simulations: int = 0  # of all tests together
    runner: CaseRunner = field(default_factory=CaseRunner)

    @classmethod
    def of(cls, tests: Sequence[BenchTest], whole: tuple[float, float] | None = None) -> "Prediction":
        """The prediction of tests; `whole` is the range of angles where the curve does not repeat [rad]."""
        low, high = whole or (-np.pi, np.pi)
        turn = np.linspace(low, high, round((high - low) / MEAN_STEP) + 1)
        grids = [(turn, whole is None) if test.of_kind.by_angle else (np.zeros(1), True) for test in tests]
        return cls([CurveBlock(test, *grid) for test, grid in zip(tests, grids, strict=True)])

    def part(self, number: int, values: np.ndarray) -> np.ndarray:
        """The values (m, ...) of one block out of those of all."""
        begin = sum(block.size for block in self.blocks[:number])
        return values[begin : begin + self.blocks[number].size]

    def simulated(self, gear: SteeringGear, nuisances: Mapping[str, float] | None = None) -> np.ndarray:
        """Values of all blocks, shape (m,), with the nuisances' logarithms by their names.

        Raises:
            NoPredictionError: there is no equilibrium, or no such gear.
        """
        self.simulations += 1
        in_tests = [(block, gear_in(block.test, gear, nuisances)) for block in self.blocks]
        tasks = [
            Task(partial(pass_values, block, in_test, self.fidelity, sense, self.level))
            for block, in_test in in_tests
            for sense in (1, -1)
        ]
        answers = dict(self.runner.run(tasks))
        try:
            return np.concatenate([answers[task].returned() for task in tasks])
        except InputError as error:
            raise NoPredictionError(" ".join(error.problems)) from None

    def numerical(self, gear: SteeringGear, nuisances: Mapping[str, float], values: np.ndarray) -> np.ndarray:
        """Numerical error of values (m,) of this level: their change from the level below, as a standard
        uncertainty (a bar is twice the change).

        Raises:
            NoPredictionError: the level below has no equilibrium.
        """
        self.simulations += 1
        return values - replace(self, level=self.level - 1).simulated(gear, nuisances)

    def by_formula(self, gear: SteeringGear) -> np.ndarray:
        """Means of all tests by the closed form, on the same grids, shape (m,)."""
        means = [np.repeat(formula_means(gear, block.test), block.grid.size) for block in self.blocks]
        return np.concatenate(means)


def pass_values(
    block: CurveBlock, gear: SteeringGear, fidelity: Fidelity, sense: int, level: int = 1
) -> np.ndarray:
    """Return the values of one direction of a block at a level of the ladder: along its grid, or their mean,
    shape (n,).

    Raises:
        InputError: no such gear, or a test that it does not allow.
        NoPredictionError: there is no equilibrium.
    """
    test, gear = block.test, tested_gear(gear)
    if test.kind in ("yoke-out", "bearing", RACK_ON_ROLLERS.name):
        return np.array([formula_means(gear, test)[0 if sense > 0 else 1]])
    gear, fidelity, options = gear_at(level, gear), model_at(level, fidelity), RunOptions(level=level)
    if test.of_kind.by_angle:
        first, last = (float(angle) for angle in block.grid[[0, -1]][::sense])
        run = run_maneuver(gear, fidelity, steady_maneuver(gear, "pinion", first, last, MEAN_STEP), options)
        if not run.ok:
            raise NoPredictionError(run.outcome.message)
        angle, torque = run.signals["pinion_angle"], run.signals["pinion_torque"]
        return np.interp(block.grid, angle[::sense], torque[::sense])
    true = gear.replace(
        dict.fromkeys(("pinion.pitch_error", "rack.bow"), 0.0)
        | dict.fromkeys(("pinion.pitch_errors", "rack.pitch_errors"), "none")
    )
    half, step = sense * TURN / 2, 2 * MEAN_STEP
    if gear.pinion.runout < SEEN:
        true, half, step = true.replace({"pinion.runout": 0.0}), half / gear.pinion.teeth, MEAN_STEP
    body: DrivenBody = "rack" if test.pushed else "pinion"
    maneuver = steady_maneuver(true, body, -half, half, step).under(test.load)
    run = run_maneuver(true, fidelity, maneuver, options)
    if not run.ok:
        raise NoPredictionError(f"{test.title}: {run.outcome.message}")
    signal = "rack_force" if body == "rack" else "pinion_torque"
    return np.array([mean(run.signals["pinion_angle"], run.signals[signal])])


def gear_in(test: BenchTest, gear: SteeringGear, nuisances: Mapping[str, float] | None) -> SteeringGear:
    """Return the gear as it is in a test: with friction that changes under a weight, and another drag without
    yoke."""
    changed = {}
    if nuisances and test.of_kind.weighted and (change := nuisances.get(BY_LOAD, 0.0)):
        power = change * abs(test.load) / (LOAD_OF_NUISANCE * GRAVITY)
        factor = np.exp(np.clip(power, -LARGEST, LARGEST))
        frictions = ("mesh.friction", "yoke.friction")
        changed = {path: min(1.0, gear.value_at(path) * factor) for path in frictions}
    if nuisances and test.kind == "yoke-out" and (change := nuisances.get(WITHOUT_YOKE, 0.0)):
        changed = {"bush.drag": gear.bush.drag * float(np.exp(np.clip(change, -LARGEST, LARGEST)))}
    return gear.replace(changed) if changed else gear


def formula_means(gear: SteeringGear, test: BenchTest) -> tuple[float, float]:
    """Return the mean values towards +X and -X by the closed form, of the gear in operation."""
    gear = tested_gear(gear)
    if test.kind == "bearing":
        return gear.bearing.friction_torque, -gear.bearing.friction_torque
    if test.kind == "yoke-out":
        torque = float(GearPair.of(gear).gain) * gear.bush.drag + gear.bearing.friction_torque
        return torque, -torque
    if test.kind == RACK_ON_ROLLERS.name:
        gear = on_rollers(gear)
    if test.pushed:
        return pushing_force(gear, +1), pushing_force(gear, -1)
    return mean_state(gear, +1, test.load).torque, mean_state(gear, -1, test.load).torque
