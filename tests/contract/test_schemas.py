"""JSON schemas of gear and study files: what the package reads they allow, and wrong keys they refuse."""

import json
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from rps_exudyn.optimisation import definition, tolerances
from rps_exudyn.optimisation.file_kinds import SCHEMAS, kind_of
from rps_exudyn.parameters.gear import Setup, SteeringGear
from rps_exudyn.study.axis_tables import AXIS_KEYS
from rps_exudyn.study.schema import study_schema
from rps_exudyn.study.study_file import KEYS
from shell import Command, refusal_of

SHIPPED = sorted((Path(__file__).parents[2] / "studies").rglob("*.toml"))
AXIS = {"path": "yoke.preload", "values": [100, "200 N"]}
SEARCHED = {"variables": {"yoke": {"preload": ["200 N", 400]}}, "objectives": {"torque_mean": {}}}
SHAPE_TWICE = AXIS | {"linspace": [1, 2, 3]}


@cache
def validator(kind: str) -> Any:
    """Return the validator by the schema of a kind of file."""
    made, schema = pytest.importorskip("jsonschema").Draft7Validator, SCHEMAS[kind]()
    made.check_schema(schema)
    return made(schema)


def problems(kind: str, content: dict[str, Any]) -> list[str]:
    """Return what is wrong by the schema of a kind of file."""
    return [error.message for error in validator(kind).iter_errors(content)]


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.name)
def test_shipped_file_fits_its_schema_and_a_wrong_key_does_not(path: Path) -> None:
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    kind = kind_of(content)
    assert (kind == "gear") == (path.parent.name == "gears")
    assert problems(kind, content) == []
    assert problems(kind, content | {"tabel": {}})


@pytest.mark.parametrize("item", list(SteeringGear.declared()), ids=lambda item: item.path)
def test_default_of_each_parameter_is_allowed(item: Any) -> None:
    """In SI and as a reader writes it; words where the parameter is a number are not."""

    def content(value: Any) -> dict[str, Any]:
        for name in reversed(item.path.split(".")):
            value = {name: value}
        return dict(value)

    for value in (item.field.default, SteeringGear().value_at(item.path)):
        assert problems("gear", content(value)) == []
    shown = item.show(SteeringGear().value_at(item.path)) if item.unit else item.field.default
    assert problems("gear", content(shown)) == []
    if item.unit:
        assert problems("gear", content("much"))


@pytest.mark.parametrize(
    ("kind", "content", "right"),
    [
        ("gear", {"yoke": {"preload": "0,3 kN"}}, True),
        ("gear", {"yoke": {"preload": "300 N +- 30 N"}}, True),
        ("gear", {"yoke": {"preload": "uniform(200 N, 400 N)"}}, True),
        ("gear", {"conditions": {"temperature": "−30 °C"}}, True),
        ("gear", {"pinion": {"pitch_errors": [0, "2 um", 1e-6, 0, 0, 0]}}, True),
        ("gear", {"mesh": {"line_stiffness": "from the gear"}}, True),
        ("gear", {"yoke": {"prelaod": "300 N"}}, False),
        ("gear", {"mesh": {"law": "lines"}}, False),
        ("gear", {"pinion": {"teeth": 2}}, False),
        ("gear", {"pinion": {"teeth": "six"}}, False),
        ("gear", {"mesh": {"friction": 1.5}}, False),
        ("gear", {"fidelity": {"bush": "chain"}}, False),
        ("study", {"set": {"fidelity": {"bush": "chain"}}, "axis": [AXIS]}, True),
        ("study", {"axis": [AXIS | {"along": {"mesh": {"friction": [0.1, 0.2]}}}]}, True),
        ("study", {"set": {"fidelity": {"based_on": "full"}}}, False),
        ("study", {"scene": "free-torque"}, False),
        ("study", {"axis": [{"path": "yoke.prelaod", "values": [1]}]}, False),
        ("study", {"axis": [{"path": "yoke.preload"}]}, False),
        ("study", {"axis": [SHAPE_TWICE]}, False),
        ("study", {"keep": {"signals": ["torque"]}}, False),
        ("optimise", SEARCHED, True),
        ("optimise", SEARCHED | {"keep": {"gain": "pinion.normal_module"}, "requirements": "all"}, True),
        ("optimise", SEARCHED | {"objectives": {"torque_mean": {"goal": "many"}}}, False),
        ("optimise", {"variables": {"yoke": {"preload": ["200 N"]}}, "objectives": {}}, False),
        ("optimise", {"objectives": {"torque_mean": {}}}, False),
        ("optimise", SEARCHED | {"share": "95 %"}, False),
        (
            "optimise",
            {"tolerances": {"yoke": {"preload": {"fine": ["300 N +- 9 N", 1]}}}, "share": 0.9},
            True,
        ),
        ("optimise", {"tolerances": {"yoke": {"preload": {"fine": ["300 N +- 9 N"]}}}}, False),
        ("optimise", {"tolerances": {}, "designs": 8}, False),
    ],
)
def test_schema_allows_what_the_package_reads(kind: str, content: dict[str, Any], right: bool) -> None:
    assert (problems(kind, content) == []) == right


def test_schema_of_studies_has_every_key_and_path() -> None:
    keys = study_schema()["properties"]
    axis = keys["axis"]["items"]["properties"]
    assert set(keys) == set(KEYS)
    assert set(axis) == set(AXIS_KEYS)
    declared = [item.path for item in Setup.declared() if item.path != "fidelity.based_on"]
    assert axis["path"]["enum"] == declared
    assert set(SCHEMAS["optimise"]()["properties"]) == {*definition.KEYS, *tolerances.KEYS}


def test_init_writes_files_that_name_their_schema(command: Command) -> None:
    assert command(["init", "mine"]).status == 0
    written = sorted(Path("mine").rglob("*.toml"))
    assert len(written) == len(SHIPPED)
    for path in written:
        text = path.read_text(encoding="utf-8")
        mark, place = text.split("\n")[0].split()
        kind = kind_of(tomllib.loads(text))
        named = json.loads((path.parent / place).read_text(encoding="utf-8"))
        assert (mark, named) == ("#:schema", SCHEMAS[kind]())


def test_command_prints_or_writes_a_schema(command: Command) -> None:
    assert json.loads(command(["schema", "study"]).out) == study_schema()
    assert command(["schema", "--out", "g.json"]).out == "written: g.json\n"
    assert json.loads(Path("g.json").read_text(encoding="utf-8")) == SCHEMAS["gear"]()
    assert "must end in .json" in refusal_of(command(["schema", "--out", "g.toml"]))
