"""JSON schemas of gear files and study files, made from the declarations: editors complete and check by them.

A file names its schema in its first line, `#:schema gear.schema.json`, relative to the file. Taplo, which
editors use for TOML, reads draft 7.
"""

from collections.abc import Mapping
from typing import Any

from rps_exudyn.inference.uncertainty.input_sets import SETS
from rps_exudyn.inference.uncertainty.joint import AS_ONE
from rps_exudyn.parameters.declaration import QUANTITY, Table
from rps_exudyn.parameters.distribution import KINDS
from rps_exudyn.parameters.fidelity import PRESETS
from rps_exudyn.parameters.gear import Setup, SteeringGear
from rps_exudyn.results.quantities import SIGNALS, SUMMARY
from rps_exudyn.scenes import SCENE_NAMES
from rps_exudyn.study.axis_tables import DISTRIBUTIONS, MOST_ON_AN_AXIS, SHAPES
from rps_exudyn.study.definition import DESIGNS
from rps_exudyn.study.study_file import MOST_SAMPLES

Schema = dict[str, Any]
BARRED = [name for name, each in SUMMARY.items() if each.simulated]
CORRELATIONS: Schema = {
    "type": "object",
    "additionalProperties": {"anyOf": [{"type": "number", "minimum": -1, "maximum": 1}, {"enum": [AS_ONE]}]},
    "description": 'correlation of the normal scores of two inputs, "A, B" = 0.5',
}


def gear_schema() -> Schema:
    """Schema of a gear file: every parameter with its meaning, default, limits in SI, and choices."""
    samples = {"type": "object", "description": "samples of a fit's posterior, of inputs that vary together"}
    return _headed(
        "Gear of rps-exudyn", _tables(SteeringGear) | {"correlation": CORRELATIONS, "posterior": samples}
    )


def study_schema() -> Schema:
    """Schema of a study file: its keys, and the parameters that it sets or varies."""
    settings = _tables(Setup)
    for name in ("name", "based_on"):  # which name what was chosen
        settings["fidelity"]["properties"].pop(name, None)
    paths = [item.path for item in Setup.declared() if item.path != "fidelity.based_on"]
    keys: dict[str, Schema] = {
        "title": {"type": "string", "description": "heading of the report"},
        "scene": {"enum": list(SCENE_NAMES)},
        "gear": {"type": "string", "description": "gear file, beside or below this one"},
        "fidelity": {"enum": list(PRESETS), "description": "model preset", "default": "flank"},
        "accuracy": {"type": "string", "description": 'largest error, for instance "1 %": each case climbs'},
        "metrics": {"type": "array", "items": {"enum": BARRED}, "description": "whose error it is"},
        "set": _closed(settings, "parameters of all cases"),
        "axis": {"type": "array", "items": _axis(paths, settings), "description": "what is varied"},
        "design": {"enum": list(DESIGNS), "default": "grid"},
        "correlation": CORRELATIONS,
        "samples": _whole(1, MOST_SAMPLES, "points of a sampled design"),
        "seed": _whole(0, 2**32 - 1, "seed of a sampled design"),
        "inputs": {"enum": list(SETS), "description": "inputs of the design uncertain"},
        "time_limit": _quantity("elapsed time of one case", 0),
        "keep": _closed(
            {
                "signals": {
                    "anyOf": [{"enum": ["all", "none"]}, {"type": "array", "items": {"enum": list(SIGNALS)}}]
                },
                "samples": _whole(2, 10**9, "samples of each signal"),
                "blocks": {"type": "boolean", "description": "many cases in one file"},
            },
            "what is stored of each case",
        ),
    }
    return _headed("Study of rps-exudyn", keys)


SCHEMAS = {"gear": gear_schema, "study": study_schema}
"""Kind of file -> its schema."""


def _headed(title: str, properties: Mapping[str, Schema]) -> Schema:
    return {"$schema": "http://json-schema.org/draft-07/schema#", "title": title, **_closed(properties)}


def _closed(properties: Mapping[str, Schema], meaning: str = "") -> Schema:
    """A table of these keys and no others."""
    described = {"description": meaning} if meaning else {}
    return {"type": "object", **described, "properties": properties, "additionalProperties": False}


def _tables(table: type[Table]) -> dict[str, Schema]:
    """Name -> schema of the tables within one, as pydantic makes them of the declarations."""
    made = table.model_json_schema()["$defs"]

    def schema_of(inner: type[Table]) -> Schema:
        shown = {}
        for name, each in made[inner.__name__]["properties"].items():
            field = inner.model_fields[name].annotation
            if isinstance(field, type) and issubclass(field, Table):
                shown[name] = schema_of(field)
            else:
                shown[name] = {key: value for key, value in each.items() if key not in ("title", "source")}
        return _closed(shown, (inner.__doc__ or "").partition("\n")[0])

    tables = {name: field.annotation for name, field in table.model_fields.items()}
    return {name: schema_of(inner) for name, inner in tables.items() if isinstance(inner, type)}


def _axis(paths: list[str], settings: Mapping[str, Schema]) -> Schema:
    path, value = {"enum": paths}, {"type": ["number", "string"]}
    ends = {
        "type": "array",
        "minItems": 3,
        "maxItems": 3,
        "items": value,
        "description": "[first, last, number]",
    }
    many = {"type": "array", "minItems": 1, "maxItems": MOST_ON_AN_AXIS, "items": value}
    same = {"$ref": "#/properties/axis/items/properties/values"}
    along = {name: _along(table, same) for name, table in settings.items()}
    keys: dict[str, Schema] = {
        "name": {"type": "string", "description": "name of the axis; without it the path"},
        "path": path | {"description": "the parameter varied"},
        "paths": {"type": "array", "minItems": 1, "items": path, "description": "parameters of one value"},
        "unit": {"type": "string", "description": "unit of the plain numbers; without it SI"},
        "along": _closed(along, "parameters that move along, with one value for each of the axis"),
        **{shape: many if shape == "values" else ends for shape in SHAPES},
        **{
            kind: {"type": "array", "minItems": 2, "maxItems": 2, "items": value, "description": each.numbers}
            for kind, each in KINDS.items()
        },
    }
    one_of = [{"required": [key]} for key in (*SHAPES, *DISTRIBUTIONS)]
    return _closed(keys) | {
        "allOf": [{"oneOf": [{"required": ["path"]}, {"required": ["paths"]}]}, {"oneOf": one_of}]
    }


def _along(table: Schema, values: Schema) -> Schema:
    inner = table["properties"].items()
    return _closed({key: _along(each, values) if "properties" in each else values for key, each in inner})


def _whole(least: int, most: int, meaning: str) -> Schema:
    return {"type": "integer", "minimum": least, "maximum": most, "description": meaning}


def _quantity(meaning: str, more_than: float) -> Schema:
    number = {"type": "number", "exclusiveMinimum": more_than}
    return {"anyOf": [number, {"type": "string", "pattern": QUANTITY}], "description": meaning}
