"""How a scene is carried out beyond what gear and fidelity say: for studies of what goes wrong without it."""

from collections.abc import Callable
from dataclasses import dataclass, field

from rps_exudyn.checks.after_run import validated
from rps_exudyn.results.outcome import Outcome
from rps_exudyn.scenes.maneuver import StepLimits


@dataclass(frozen=True)
class RunOptions:
    """Options that every run has and a study of stability replaces.

    Attributes:
        check: gives a finished run its outcome, with the arguments of `checks.after_run.validated`.
        least_steps: steps that a maneuver gets, however large the fidelity's step.
    """

    check: Callable[..., Outcome] = validated
    least_steps: StepLimits = field(default_factory=StepLimits)


DEFAULT = RunOptions()
