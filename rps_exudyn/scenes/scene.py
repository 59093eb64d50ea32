"""A scene: one thing that the test rig does, with all that other files ask about it; options of its runs."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rps_exudyn.analysis.curve import Curve
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.parameters.retired import with_former_names
from rps_exudyn.results.outcome import Outcome, Remark
from rps_exudyn.scenes.checks.after_run import validated
from rps_exudyn.scenes.checks.rules import Motion
from rps_exudyn.scenes.contact_law import ContactLaw
from rps_exudyn.scenes.maneuver import Maneuver, StepLimits, swing_maneuver
from rps_exudyn.scenes.scene_run import SceneRun, Signals


@dataclass(frozen=True)
class RunOptions:
    """Options that every run has and a study of stability replaces."""

    # gives a finished run its outcome, with the arguments of `checks.after_run.validated`
    check: Callable[..., Outcome] = validated
    # steps that a maneuver gets, however large the fidelity's step
    least_steps: StepLimits = field(default_factory=StepLimits)
    level: int = 1  # of the ladder (`scenes.ladder`)
    bars: bool = True  # whether a second level gives the metrics their error bars

    @property
    def halvings(self) -> int:
        """Return how often the steps of every maneuver are halved, whatever chose them; -1 doubles them."""
        return self.level - 1

    def finer(self, count: int) -> int:
        """Return a number, given for the steps of level 1, for those of these options."""
        return int(np.ceil(count * 2.0**self.halvings))


DEFAULT_OPTIONS = RunOptions()
WITHOUT_BARS = RunOptions(bars=False)


@dataclass(frozen=True)
class SteadyRecord:
    """Records of a steady test; signals of many gears are (n, t) over the same instants, numbers (n,)."""

    gear: SteeringGear  # what all gears have in common; what differs stands beside it
    signals: Signals  # of the maneuvers recorded, joined
    beside: Signals  # of the maneuver that is not recorded; {} if there is none
    gain: Any  # rack travel per radian, of a variable ratio by the pinion's angle [m]
    load: Any  # that pulls at the rack's end [N]


@dataclass(frozen=True)
class SteadyTest:
    """The steady maneuvers of a scene, and the metrics of their record."""

    # (gear, step angle, least steps) -> those recorded, and one beside them or None; raises InputError if
    # they leave the rack's teeth
    maneuvers: Callable[[SteeringGear, float, StepLimits], tuple[list[Maneuver], Maneuver | None]]
    metrics: Callable[[SteadyRecord], dict[str, Any]]  # the summary of a record; of many gears arrays
    curve: tuple[str, ...]  # signals that show the drive's torque or force alone
    # on that summary, a list for each gear
    remarks: Callable[[SteadyRecord], list[list[Remark]]] = lambda record: [
        [] for _ in range(np.size(record.load))
    ]
    # metrics of a gear beside, without its record
    formulas: Callable[[SteeringGear], dict[str, float]] | None = None


@with_former_names(figure="main_metric")
@dataclass(frozen=True, kw_only=True)
class Scene:
    """One thing that the test rig does.

    Attributes:
        name: its name in commands and files.
        title: its name over tables and charts.
        run: simulates it; raises InputError for a test or a model that the scene cannot have.
        signal: name of the signal whose error counts.
        main_metric: name of the number in the summary that must be right; `figure` is its former name.
        chart: its picture is drawn by the function CHART_figure(result, measured) of `charts.scene_figures`.
        steady: whether everything slides at a constant speed.
        needs_inertia: whether equilibria cannot show it.
        at_rest: whether nothing moves: its instants are loads one after the other.
        swings: whether it steers to and fro and records whole cycles.
        has_impacts: whether its signals are pulses, which shift in time from level to level.
        at_test_speed: whether the rig moves at `test.speed`.
        test: its maneuvers and metrics, where many gears can be computed together.
        revolutions: how often the pinion turns in a run one way, by default as in the test; None where it
            does not turn.
        law: contact law that its metrics need, where the gear's is by-scene (`contact_law`).

    Examples:
        >>> from rps_exudyn.scenes import scene_named
        >>> scene_named("reversal").swings
        True
    """

    name: str
    title: str
    run: Callable[[SteeringGear, Fidelity, RunOptions], SceneRun]
    signal: str
    main_metric: str
    chart: str
    steady: bool = False
    needs_inertia: bool = False
    at_rest: bool = False
    swings: bool = False
    has_impacts: bool = False
    at_test_speed: bool = True
    test: SteadyTest | None = None
    revolutions: Callable[[SteeringGear], float] | None = lambda gear: gear.test.turns
    law: ContactLaw = "line"

    @property
    def motion(self) -> Motion:
        """Return the kind of its motion, on which the limits of a plan depend."""
        if self.at_rest:
            return "at rest"
        return "steady" if self.steady else "unsteady"

    def curve(
        self, signals: Mapping[str, np.ndarray], gear: SteeringGear, fidelity: Fidelity, name: str = ""
    ) -> Curve:
        """Return a signal over the time of the rig's motion, by default the scene's own."""
        start = 0.0
        if self.swings:  # recording begins at another phase with every step
            maneuver = swing_maneuver(gear, fidelity.step_angle)
            start = maneuver.lead * maneuver.time_step
        return Curve(start + signals["time"], signals[name or self.signal])


def swept_revolutions(gear: SteeringGear) -> float:
    """Return the revolutions that a reversal sweeps, to and fro."""
    return 4 * gear.test.amplitude * gear.test.cycles / (2 * np.pi)
