"""Choices and parameters of earlier versions: what replaces them, and how results made by them are read.

They are not run again.
"""

from collections.abc import Callable, Mapping
from functools import wraps
from operator import attrgetter
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import ValidationInfo, ValidatorFunctionWrapHandler

if TYPE_CHECKING:
    from rps_exudyn.parameters.gear import SteeringGear

Fields = TypeVar("Fields")

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


def context_of(settings: Mapping[str, object]) -> dict[str, bool] | None:
    """Return the context in which a stored gear is changed: its own retired choices are read."""
    return None if any(choice_instead(*each) for each in settings.items()) else STORED


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


# --- former names in Python


def with_former_names(**former: str) -> Callable[[type[Fields]], type[Fields]]:
    """Return a decorator of a dataclass whose fields have former names too, former -> present."""

    def decorate(kind: type[Fields]) -> type[Fields]:
        begin = kind.__init__

        @wraps(begin)
        def accept(self: Fields, *values: Any, **named: Any) -> None:
            for old in former.keys() & named.keys():
                named[former[old]] = named.pop(old)
            begin(self, *values, **named)

        for old, new in former.items():
            setattr(kind, old, property(attrgetter(new)))
        kind.__init__ = accept  # type: ignore[assignment]
        return kind

    return decorate


# --- what stored results mean

RETIRED_CODES = {
    "friction-zone": "the friction zone is too wide for the result",
    "steps-too-coarse": "the steps are too long for the result",
    "rolling-too-coarse": "the steps are too long for the rack's rolling",
    "steps-not-confirmed": "the run in shorter steps failed",
    "strips-not-confirmed": "the run with finer strips failed",
    "rack-not-settled": "the rack has not settled in roll",
    "start-matters": "the result depends on where the motion began",
    "swing-not-settled": "the swing does not become periodic",
    "few-stations": "metrics are omitted: too few stations on a line of contact",
    "edges-loaded": "too much work is lost at the tooth edges",
}
"""Codes that results of version 1.0 may have -> their meaning."""


def has_lines(law: str) -> bool:
    """Return whether a contact law has loads per length of line: `area` has pressures alone."""
    return law != "area"


def with_lines(gear: "SteeringGear") -> "SteeringGear":
    """Return a gear by law line where its own contact law has no lines."""
    return gear if has_lines(gear.mesh.contact_law) else gear.replace({"mesh.law": "line"})


def contact_law_of(mesh: str, law: str) -> str | None:
    """Return the contact law of a model of the mesh, whose gear has a law; None of one without contact."""
    if mesh.startswith("ratio"):
        return None
    return "area" if mesh == "flank-generators" else law
