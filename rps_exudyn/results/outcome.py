"""How a simulation ended. A failed one is a value with a remedy, not an exception."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, NamedTuple, Self


class MeaningEnum(StrEnum):
    """Words, each with its `meaning`; without one it is the word itself."""

    meaning: str

    def __new__(cls, word: str, meaning: str = "") -> Self:
        """Make a member of "word", "meaning"."""
        member = str.__new__(cls, word)
        member._value_, member.meaning = word, meaning or word
        return member


class Status(MeaningEnum):
    """Outcome of one simulation; only `OK` results may be used.

    Examples:
        >>> rps.run("free-pinion-torque", fidelity="closed-form").status is rps.Status.OK
        True
    """

    OK = "ok", "Nothing to do."
    DIVERGED = (
        "diverged",
        "Use a smaller step or more contact damping (mesh.damping), and check the stiffnesses.",
    )
    NO_CONVERGENCE = (
        "no-convergence",
        "Use a smaller step, another solver, or a wider friction regularization.",
    )
    CONTACT_LOST = (
        "contact-lost",
        "The rack left the mesh: raise yoke.preload, or check yoke.clearance and the load.",
    )
    TIMEOUT = "timeout", "Allow more time, or use a cheaper fidelity or fewer turns."
    CRASHED = "crashed", "The solver's process ended: run this case by itself to see the cause."
    INVALID = "invalid", "The run ended but failed the check that the message names."

    @property
    def remedy(self) -> str:
        """One sentence: what to change."""
        return self.meaning


class Code(MeaningEnum):
    """What a message is about, for programs: sentences are for readers, and may change.

    A failed run has the code of its cause; one that ended ok those of its remarks.
    """

    NOT_FINITE = "not-finite", "a value is not a finite number"
    OUT_OF_BOUNDS = "out-of-bounds", "a coordinate or a rate left all bounds"
    NO_STEP = "no-step", "no time step converged"
    STEPS_USED_UP = "steps-used-up", "the run took far more time steps than planned"
    FORCE_FAILED = "force-failed", "a function of the model ended with an error"
    NO_EQUILIBRIUM = "no-equilibrium", "no equilibrium was found"
    GEAR_JUMPS = "gear-jumps", "the gear jumps where equilibria end"
    NO_RESISTANCE = "no-resistance", "the gear has no stiffness against a force"
    INTERRUPTED = "interrupted", "the run was stopped before its end"
    REFUSED = "refused", "a check of the plan failed, nothing was run"
    RACK_OUT_OF_MESH = "rack-out-of-mesh", "the rack left the mesh"
    TEETH_UNLOADED = "teeth-unloaded", "the teeth carry no load"
    BEYOND_LAW = "beyond-law", "the contact left the range of its law"
    BEYOND_TABLE = "beyond-table", "the load on the rack is outside the table of the reduced gear"
    BEYOND_FORMULAS = "beyond-formulas", "the gear is outside the range of the closed form"
    TURN_TOO_FAST = "turn-too-fast", "equilibria leave out inertia, which matters in this turn"
    CONTACT_DISAGREES = "contact-disagrees", "two evaluations of the contact forces differ"
    FEW_SPHERES = "few-spheres", "too few spheres touch"
    SPHERES_OUT_OF_PLACE = (
        "spheres-out-of-place",
        "the rack is not at the place for which the spheres were made",
    )
    SPHERES_AT_NUT = "spheres-at-nut", "general contact has no means of a yoke at its nut"
    WORK_MISSING = "work-missing", "the work balance does not close"
    FLANK_LIFTED = "flank-lifted", "flanks of one side carry no load during part of the record"
    YOKE_STOPPED = "yoke-stopped", "the yoke touched its nut"
    CLEARANCE_CLOSED = "clearance-closed", "the yoke touches its nut from the start"
    TEETH_OVERLOADED = "teeth-overloaded", "the contact pressure is above that of case-hardened steel"
    PEAKS_UNRESOLVED = "peaks-unresolved", "the error of the peak to peak is unknown: a vibration grows"
    BARS_SHORT = "bars-short", "fewer metrics than elsewhere lie within their error bars"
    METRIC_NOT_CONFIRMED = "metric-not-confirmed", "the errors of some metrics are unknown"
    RACK_RIGID = "rack-rigid", "the model leaves out the bending of the rack, which matters here"
    NO_EFFICIENCY = "no-efficiency", "an efficiency is not between 0 and 1"
    OTHER_LAW = "other-law", "the closed form uses another contact law"
    HELD_BY_FRICTION = "held-by-friction", "friction holds the gear against the torque"
    FRICTION_NEVER_FALLS = "friction-never-falls", "no friction falls with speed: sliding is steady"
    NOT_HIT = "not-hit", "the yokenut is not hit up to the largest force"
    THRESHOLD_RESOLUTION = "threshold-resolution", "the threshold is known to one cycle of the growing force"
    CAP_PRESSES = "cap-presses", "the yoke's cap still presses the plunger"
    OTHER_SETTINGS = "other-settings", "the run used safer settings than those asked for"
    ACCURACY_NOT_REACHED = "accuracy-not-reached", "the error bar is wider than the accuracy asked for"
    PRESET_LEFT = "preset-left", "a cheaper preset failed, or could not reach the accuracy"


class Remark(NamedTuple):
    """A sentence about a run, without a full stop, and what it is about."""

    code: Code
    text: str


def joined_text(remarks: Iterable[Remark]) -> str:
    """Return the sentences of remarks as one message."""
    return "; ".join(remark.text for remark in remarks)


def sentences(message: str) -> list[str]:
    """Return the sentences of a message that `joined_text` joined."""
    return [text for text in message.split("; ") if text]


def each_once(codes: Iterable[str]) -> tuple[str, ...]:
    """Return codes in their order without those that come again."""
    return tuple(dict.fromkeys(str(code) for code in codes))


def codes_of(message: str, stored: str | None) -> tuple[str, ...]:
    """Return the codes that a file holds beside a message; in files of versions before 1.4, which hold none,
    those of contacts that open or close, by the words of these versions."""
    if stored is not None:
        return tuple(stored.split())
    words = {"carry nothing": Code.FLANK_LIFTED, "is used up": Code.YOKE_STOPPED}
    return each_once(code for text, code in words.items() if text in message)


_NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def alike(status: Status, codes: tuple[str, ...], message: str) -> tuple[str, ...]:
    """Return what outcomes of one kind have in common: status and codes, or without codes the words."""
    return (status, *codes) if codes else (status, "", _NUMBER.sub("#", message))


@dataclass
class Outcome:
    """End of a run, its cost (CPU time in seconds, counts by name) and what the solver reports."""

    status: Status
    message: str = ""
    codes: tuple[str, ...] = ()  # of the message, see `Code`
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
        super().__init__()
        self.recorded = recorded
