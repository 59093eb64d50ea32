"""What a scene hands back, and the checks that all scenes share."""

from dataclasses import dataclass, field

import numpy as np

from rps_exudyn.errors import InputError
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.outcome import Status
from rps_exudyn.parameters import SteeringGear
from rps_exudyn.solve import Outcome


@dataclass(frozen=True)
class SceneRun:
    """Outcome, and what was recorded until then."""

    outcome: Outcome
    signals: dict[str, np.ndarray] = field(default_factory=dict)
    summary: dict[str, float] = field(default_factory=dict)


RUN_IN = np.deg2rad(0.5)  # pinion angle turned before the record starts, at least


@dataclass(frozen=True)
class Turning:
    """The rotation that a rig prescribes, in even steps; angles [rad] count from the centre position."""

    first: float  # where the solver starts: `lead` steps before the record
    step: float  # signed
    lead: int
    steps: int
    time_step: float  # [s]

    @classmethod
    def of(cls, gear: SteeringGear, step_angle: float) -> "Turning":
        """The test's rotation in steps of at most `step_angle` [rad].

        A rotation over whole periods of the gear gets the same steps in each of them.

        Raises:
            InputError: the test leaves the rack's travel.
        """
        test = gear.test
        angle = 2 * np.pi * test.turns
        check_travel(gear, test.start_angle, test.start_angle + test.direction * angle)
        piece = angle / (whole_periods(gear) or 1)
        step = piece / int(np.ceil(piece / step_angle * (1 - 1e-12)))
        lead = int(np.ceil(RUN_IN / step))
        first = test.start_angle - test.direction * lead * step
        return cls(first, test.direction * step, lead, round(angle / step), step / test.speed)

    @property
    def angles(self) -> np.ndarray:
        """From the start of the run-in to the end of the record."""
        return self.first + self.step * np.arange(self.lead + self.steps + 1)


def whole_periods(gear: SteeringGear) -> int | None:
    """How many periods of the gear its test turns through; None if not a whole number.

    Every tooth is alike, so that the curve repeats with the tooth pitch; errors that single out a tooth
    or a direction of the pinion make it repeat with the turn.
    """
    alike = gear.pinion.runout == 0 and gear.pinion.pitch_error == 0
    periods = gear.test.turns * (gear.pinion.teeth if alike else 1)
    return round(periods) if periods > 0.5 and abs(periods - round(periods)) < 1e-9 * periods else None


def without_equilibrium(angle: float, residual: float) -> SceneRun:
    """The run that could not start."""
    message = f"no equilibrium was found at {np.degrees(angle):.4g} deg, {residual:.3g} N remain unbalanced"
    return SceneRun(Outcome(Status.NO_CONVERGENCE, message))


def check_travel(gear: SteeringGear, first: float, last: float) -> None:
    """The pinion must stay on the rack's teeth between two pinion angles [rad].

    Raises:
        InputError: it would not.
    """
    bar = RackBar.of(gear)
    allowed = bar.largest_displacement / bar.pair.gain
    farthest = max(abs(first), abs(last))
    if farthest > allowed:
        raise InputError(
            f"test.turns and test.start_angle lead to a pinion angle of {np.degrees(farthest):.6g} deg; "
            f"the teeth for rack.travel = {gear.rack.travel * 1e3:g} mm allow "
            f"{np.degrees(allowed):.6g} deg either way."
        )
