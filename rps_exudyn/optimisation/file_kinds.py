"""Kinds of TOML files that users write, with the JSON schema of each: gears, studies, files of `optimise`."""

from collections.abc import Mapping
from functools import cache
from typing import Any

from rps_exudyn.assessment.requirements.judging import BY_GEOMETRY
from rps_exudyn.inference.uncertainty.input_sets import SETS
from rps_exudyn.optimisation import definition, tolerances
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.requirements import REQUIRED
from rps_exudyn.scenes import SCENE_NAMES
from rps_exudyn.study.schema import (
    VALUE,
    Schema,
    closed,
    gear_schema,
    headed,
    list_of,
    study_schema,
    tables_in,
    whole_number,
    with_leaves,
)


def optimisation_schema() -> Schema:
    """Schema of a file of `optimise`: variables and objectives, or tolerances; and what both have."""
    study, gear = study_schema()["properties"], tables_in(SteeringGear)
    cost: Schema = {"type": "number", "minimum": 0, "description": "cost of the class"}
    one_class = list_of([{"type": "string"}, cost], 2, 2, "[scatter, cost]")
    classes: Schema = {"type": "object", "additionalProperties": one_class, "description": "class -> scatter"}
    paths = {each.path: each.unit for each in SteeringGear.declared()}
    numbers: Schema = {"enum": [path for path, unit in paths.items() if unit]}
    share: Schema = VALUE | {"description": 'such as "90 %"'}
    number: dict[str, Schema] = {
        "metric": {"enum": [*SUMMARY, *REQUIRED, *paths], "description": "metric, requirement or parameter"},
        "scene": {"enum": list(SCENE_NAMES)},
        "set": {"$ref": "#/properties/set"},
    }
    goal: dict[str, Schema] = {"goal": {"enum": ["least", "most"], "default": "least"}, "quantile": share}
    ends: dict[str, Schema] = {"least": VALUE, "most": VALUE, "share": share}
    sizes = {**tolerances.SIZES, **definition.SIZES}
    gears = whole_number(0, definition.MOST_CONFIRMED, "fresh gears")
    names: Schema = {"enum": list(REQUIRED)}
    leaves = {"ends": list_of(VALUE, 2, 2, "[least, most]"), "classes": classes}

    def varied(leaf: str, meaning: str) -> Schema:
        same: Schema = {"$ref": f"#/definitions/{leaf}"}
        return closed({name: with_leaves(each, same) for name, each in gear.items()}, meaning)

    keys: dict[str, Schema] = {
        **{name: study[name] for name in definition.OF_STUDIES},
        "errors": {"enum": [*SETS, definition.NONE], "description": "of each gear's series"},
        "samples": whole_number(*sizes["samples"][1:], "gears with errors of a design, or for all classes"),
        "designs": whole_number(*sizes["designs"][1:], "that the search may try"),
        "population": whole_number(*sizes["population"][1:], "designs of a generation"),
        "confirm": list_of(gears, 2, 2, "fresh gears by the search's model, and by each of the others"),
        "limits": {"type": "string", "description": "file of limits, as of check"},
        "requirements": {"anyOf": [{"enum": ["all"]}, names, {"type": "array", "items": names}]},
        "variables": varied("ends", "what is varied between its bounds"),
        "keep": closed(dict.fromkeys(BY_GEOMETRY, numbers)),
        "objectives": {"type": "object", "additionalProperties": closed(number | goal)},
        "constraints": {"type": "object", "additionalProperties": closed(number | ends)},
        "tolerances": varied("classes", "classes of each parameter's scatter"),
        "share": share,
    }
    kinds = {"variables": definition.KEYS, "tolerances": tolerances.KEYS}
    return headed("Optimisation or tolerances of rps-exudyn", keys) | {
        "definitions": leaves,
        "oneOf": [{"required": ["variables", "objectives"]}, {"required": ["tolerances"]}],
        "dependencies": {key: {"propertyNames": {"enum": [*allowed]}} for key, allowed in kinds.items()},
    }


SCHEMAS = {"gear": gear_schema, "study": study_schema, "optimise": optimisation_schema}
"""Kind of file -> its schema."""


def kind_of(content: Mapping[str, Any]) -> str:
    """Return the kind of a file: the first one whose keys are all that it has.

    Raises:
        StopIteration: there is none.
    """
    return next(kind for kind, known in _keys().items() if content.keys() <= known)


@cache
def _keys() -> dict[str, set[str]]:
    return {kind: set(make()["properties"]) for kind, make in SCHEMAS.items()}
