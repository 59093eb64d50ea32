"""How a simulation ended. A failed one is a value with a remedy, not an exception.

ok                 reached its end and passed every check: the numbers may be used
diverged           left all bounds
no-convergence     found no equilibrium, or no step that converges
contact-lost       the rack left the mesh, or the teeth carry no load
timeout, crashed   was ended by its time limit, or its process ended by itself
invalid            reached its end and failed the check that the message names, or was refused before
"""

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any


class Status(StrEnum):
    """Outcome of one simulation; only `OK` results may be used."""

    OK = "ok"
    DIVERGED = "diverged"
    NO_CONVERGENCE = "no-convergence"
    CONTACT_LOST = "contact-lost"
    TIMEOUT = "timeout"
    CRASHED = "crashed"
    INVALID = "invalid"

    @property
    def remedy(self) -> str:
        """One sentence: what to change."""
        return _REMEDIES[self]


_REMEDIES = {
    Status.OK: "Nothing to do.",
    Status.DIVERGED: "Use a smaller step or more contact damping (mesh.damping), and check the stiffnesses.",
    Status.NO_CONVERGENCE: "Use a smaller step, another solver, or a wider friction regularization.",
    Status.CONTACT_LOST: "The rack left the mesh: raise yoke.preload, or check yoke.clearance and the load.",
    Status.TIMEOUT: "Allow more time, or take a cheaper fidelity or fewer turns.",
    Status.CRASHED: "The solver's process ended: run this case alone to see why.",
    Status.INVALID: "The run ended but failed the check that the message names: refine step or contact.",
}


@dataclass
class Outcome:
    """End of a run, its cost (CPU time in seconds, counts by name) and what the solver reports."""

    status: Status
    message: str = ""
    time_reached: float = 0.0
    cpu_s: float = 0.0
    counters: dict[str, int] = field(default_factory=dict)
    settings: dict[str, Any] = field(default_factory=dict)  # of the solver
    findings: dict[str, Any] = field(default_factory=dict)  # what it found out about itself


class Interrupted(KeyboardInterrupt):
    """Raised where Ctrl-C ends a run: carries what was recorded until then.

    Attributes:
        recorded: the part of the run, a `SceneRun` where the maneuver is made, a `Result` above that.
    """

    def __init__(self, recorded: Any) -> None:
        super().__init__("interrupted")
        self.recorded = recorded
