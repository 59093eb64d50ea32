"""What a scene hands back, and the checks that all scenes share."""

from dataclasses import dataclass, field

import numpy as np

from rps_exudyn.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
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

        Raises:
            InputError: the test leaves the rack's travel.
        """
        test = gear.test
        angle = 2 * np.pi * test.turns
        check_travel(gear, test.start_angle, test.start_angle + test.direction * angle)
        steps = int(np.ceil(angle / step_angle * (1 - 1e-12)))
        step = angle / steps
        lead = int(np.ceil(RUN_IN / step))
        first = test.start_angle - test.direction * lead * step
        return cls(first, test.direction * step, lead, steps, step / test.speed)

    @property
    def angles(self) -> np.ndarray:
        """From the start of the run-in to the end of the record."""
        return self.first + self.step * np.arange(self.lead + self.steps + 1)


def without_equilibrium(angle: float, residual: float) -> SceneRun:
    """The run that could not start."""
    message = f"no equilibrium at {np.degrees(angle):.4g} deg: {residual:.3g} N remain unbalanced; "
    message += "yoke.preload may be more than teeth of mesh.stiffness can carry"
    return SceneRun(Outcome(Status.NO_CONVERGENCE, message))


def check_travel(gear: SteeringGear, first: float, last: float) -> None:
    """The rack must stay within its travel between two pinion angles [rad].

    Raises:
        InputError: it would not.
    """
    pair, half = GearPair.of(gear), gear.rack.travel / 2
    farthest = max(abs(first), abs(last))
    if pair.gain * farthest > half * (1 + 1e-9):
        raise InputError(
            f"test.turns and test.start_angle lead to a pinion angle of {np.degrees(farthest):.6g} deg; "
            f"rack.travel = {gear.rack.travel * 1e3:g} mm allows {np.degrees(half / pair.gain):.6g} deg "
            "either way."
        )
