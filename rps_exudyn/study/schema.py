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
VALUE: Schema = {"type": ["number", "string"]}
CORRELATIONS: Schema = {
    "type": "object",
    "additionalProperties": {"anyOf": [{"type": "number", "minimum": -1, "maximum": 1}, {"enum": [AS_ONE]}]},
    "description": 'correlation of the normal scores of two inputs, "A, B" = 0.5',
}


def gear_schema() -> Schema:
    """Schema of a gear file: every parameter with its meaning, default, limits in SI, and choices."""
    samples = {"type": "object", "description": "samples of a fit's posterior, of inputs that vary together"}
    return headed(
        "Gear of rps-exudyn", tables_in(SteeringGear) | {"correlation": CORRELATIONS, "posterior": samples}
    )


def study_schema() -> Schema:
    """Schema of a study file: its keys, and the parameters that it sets or varies."""
    settings = tables_in(Setup)
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
        "set": closed(settings, "parameters of all cases"),
        "axis": {"type": "array", "items": _axis(paths, settings), "description": "what is varied"},
        "design": {"enum": list(DESIGNS), "default": "grid"},
        "correlation": CORRELATIONS,
        "samples": whole_number(1, MOST_SAMPLES, "points of a sampled design"),
        "seed": whole_number(0, 2**32 - 1, "seed of a sampled design"),
        "inputs": {"enum": list(SETS), "description": "inputs of the design uncertain"},
        "time_limit": _quantity("elapsed time of one case", 0),
        "keep": closed(
            {
                "signals": {
                    "anyOf": [{"enum": ["all", "none"]}, {"type": "array", "items": {"enum": list(SIGNALS)}}]
                },
                "samples": whole_number(2, 10**9, "samples of each signal"),
                "blocks": {"type": "boolean", "description": "many cases in one file"},
            },
            "what is stored of each case",
        ),
    }
    return headed("Study of rps-exudyn", keys)


def headed(title: str, properties: Mapping[str, Schema]) -> Schema:
    """A file of these keys and no others."""
    return {"$schema": "http://json-schema.org/draft-07/schema#", "title": title, **closed(properties)}


def closed(properties: Mapping[str, Schema], meaning: str = "") -> Schema:
    """A table of these keys and no others."""
    described = {"description": meaning} if meaning else {}
    return {"type": "object", **described, "properties": properties, "additionalProperties": False}


def tables_in(table: type[Table]) -> dict[str, Schema]:
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
        return closed(shown, (inner.__doc__ or "").partition("\n")[0])

    tables = {name: field.annotation for name, field in table.model_fields.items()}
    return {name: schema_of(inner) for name, inner in tables.items() if isinstance(inner, type)}


def _axis(paths: list[str], settings: Mapping[str, Schema]) -> Schema:
    path, value = {"enum": paths}, VALUE
    ends = list_of(value, 3, 3, "[first, last, number]")
    many = list_of(value, 1, MOST_ON_AN_AXIS)
    same = {"$ref": "#/properties/axis/items/properties/values"}
    along = {name: with_leaves(table, same) for name, table in settings.items()}
    keys: dict[str, Schema] = {
        "name": {"type": "string", "description": "name of the axis; without it the path"},
        "path": path | {"description": "the parameter varied"},
        "paths": {"type": "array", "minItems": 1, "items": path, "description": "parameters of one value"},
        "unit": {"type": "string", "description": "unit of the plain numbers; without it SI"},
        "along": closed(along, "parameters that move along, with one value for each of the axis"),
        **{shape: many if shape == "values" else ends for shape in SHAPES},
        **{kind: list_of(value, 2, 2, each.numbers) for kind, each in KINDS.items()},
    }
    one_of = [{"required": [key]} for key in (*SHAPES, *DISTRIBUTIONS)]
    return closed(keys) | {
        "allOf": [{"oneOf": [{"required": ["path"]}, {"required": ["paths"]}]}, {"oneOf": one_of}]
    }


def with_leaves(table: Schema, values: Schema) -> Schema:
    """The same tables, with other values in them."""
    inner = table["properties"].items()
    return closed({key: with_leaves(each, values) if "properties" in each else values for key, each in inner})


def list_of(items: Schema | list[Schema], least: int, most: int, meaning: str = "") -> Schema:
    """A list of so many items."""
    described = {"description": meaning} if meaning else {}
    return {"type": "array", "minItems": least, "maxItems": most, "items": items, **described}


def whole_number(least: int, most: int, meaning: str) -> Schema:
    """A whole number between two ends."""
    return {"type": "integer", "minimum": least, "maximum": most, "description": meaning}


def _quantity(meaning: str, more_than: float) -> Schema:
    number = {"type": "number", "exclusiveMinimum": more_than}
    return {"anyOf": [number, {"type": "string", "pattern": QUANTITY}], "description": meaning}
