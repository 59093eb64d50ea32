"""Choices and parameters of earlier versions, with what replaces them.

Results made by them remain readable; they are not run again.
"""

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationInfo, ValidatorFunctionWrapHandler

CHOICES: dict[str, dict[str, str]] = {
    "fidelity.mesh": {
        "flank-generators": "flank integrates the same contact",
        "ratio": "choose flank, with mesh.friction = 0 for teeth without losses",
        "ratio-with-loss": "choose flank, or the preset closed-form for the loss by formula",
    },
    "mesh.law": {"area": "choose line, whose torque is within 1 % of finite elements instead of 1 to 5 %"},
    "fidelity.bush": {"adams-chain": "chain has the beam's stiffness whatever the number of segments"},
}
"""Path -> value -> what replaces it."""

PARAMETERS = {
    "fidelity.yoke": "the plunger is always a body, and fidelity.solver = equilibrium leaves out its inertia",
    "fidelity.generators": "fidelity.strip_stations and fidelity.strip_points integrate the contact",
    "fidelity.torque_tolerance": "accuracy, of a run and of a study, keeps an error; also --level",
}
"""Path -> what replaces it."""
USELESS = {"fidelity.yoke": "body"}
"""Path -> value that changes nothing."""


def gone(tables: Mapping[str, Any], table: str) -> list[str]:
    """Return a sentence for each parameter of a stored table that had an effect and has gone."""
    known = {path: tables.get(path.removeprefix(f"{table}.")) for path in PARAMETERS}
    return [
        f"{path} was {value} and has gone: {PARAMETERS[path]}."
        for path, value in known.items()
        if value and value != USELESS.get(path)
    ]


STORED = {"stored": True}
"""Context in which retired choices are read."""


def read_choice(value: Any, read: ValidatorFunctionWrapHandler, info: ValidationInfo) -> Any:
    """Validate a choice of which earlier versions had more; those are read in the context `STORED`."""
    stored = info.context == STORED and choice_instead(str(info.field_name), value)
    return value if stored else read(value)


def choice_instead(path: str, value: object) -> str | None:
    """Return what replaces a value at a path, or at the end of one."""
    found = (values.get(str(value)) for known, values in CHOICES.items() if _ends_in(known, path))
    return next(found, None)


def parameter_instead(path: str) -> str | None:
    """Return what replaces a parameter at a path, or at the end of one."""
    return next((instead for known, instead in PARAMETERS.items() if _ends_in(known, path)), None)


def _ends_in(known: str, path: str) -> bool:
    return f".{known}".endswith(f".{path}")
