"""How a simulation ended. A failed one is a value with a remedy, not an exception."""

from enum import StrEnum


class Status(StrEnum):
    """Outcome of one simulation; only `OK` results may be used."""

    remedy: str

    def __new__(cls, value: str, remedy: str) -> "Status":
        member = str.__new__(cls, value)
        member._value_ = value
        member.remedy = remedy
        return member

    OK = "ok", "Nothing to do."
    DIVERGED = (
        "diverged",
        "Use a smaller step, or more contact damping (mesh.damping); check the stiffnesses.",
    )
    NO_CONVERGENCE = (
        "no-convergence",
        "Use a smaller step or another solver, or a larger friction regularization.",
    )
    CONTACT_LOST = (
        "contact-lost",
        "The teeth separated: raise yoke.preload, or check yoke.clearance and the load.",
    )
    TIMEOUT = "timeout", "Allow more time, or take a cheaper fidelity or fewer turns."
    CRASHED = "crashed", "The solver's process ended: see the message; run the case alone to reproduce it."
    INVALID = (
        "invalid",
        "The run ended but failed the check that the message names: do not use its numbers; refine the step "
        "or the contact.",
    )
