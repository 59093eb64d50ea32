"""A row of validation: the content of its folder. Adding a row is adding a folder with a row.toml.

title = "Nissan Note: rotation torque on centre"
kind = "validation"              # or "comparison" (another program), "verification" (exact, or a standard)
source = "workshop manual"
note = "..."                     # what a reader needs to judge it

[data]
quantity = "torque_on_centre"    # of a scene's summary or the geometry; a calculation has unit = "N/m"
low = "0.7 N*m"                  # low and high; or value and uncertainty (standard); or most; or least
high = "1.2 N*m"

[procedure]
scene = "free-pinion-torque"     # or geometry = true, or calculation = "..." with [procedure.arguments]
fidelity = "quasi-static"
inputs = "unknown"               # a band; without it one run
samples = 64
set = { "test.turns" = 1 }

[criterion]
agreement = "10 %"               # |E| over |D| up to which both agree
not_comparable = "..."           # why S and D do not measure the same, if so
calibrates = "..."               # what of the inputs was centred by this row, if so: then it judges nothing
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

from rps_exudyn.assessment.validation.calculations import CALCULATIONS
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import shown, to_si
from rps_exudyn.inference.uncertainty.input_sets import SETS
from rps_exudyn.parameters.declaration import read_toml
from rps_exudyn.results.quantities import GEOMETRY, SUMMARY, Quantity
from rps_exudyn.scenes import SCENE_NAMES

FILE = "row.toml"
SHIPPED = Path(__file__).parent / "rows"
Kind = Literal["validation", "comparison", "verification"]
KINDS: tuple[str, ...] = get_args(Kind)
KEYS = {
    "": ("title", "kind", "source", "note", "data", "procedure", "criterion"),
    "data": ("quantity", "unit", "value", "uncertainty", "low", "high", "most", "least"),
    "procedure": ("scene", "geometry", "calculation", "arguments", "fidelity", "inputs", "samples", "set"),
    "criterion": ("agreement", "not_comparable", "calibrates"),
}
FORMS = (("value", "uncertainty"), ("low", "high"), ("most",), ("least",))
SAMPLES = 32  # of a band, where none are given


@dataclass(frozen=True)
class Data:
    """What was measured, stated or derived elsewhere; SI."""

    quantity: str
    value: float  # middle of a range, or the limit
    uncertainty: float  # standard; that of a range is its width / sqrt(12)
    ends: tuple[float, float] | None  # of a range
    side: int  # of a limit: +1 at most, -1 at least; 0: no limit
    shown_as: Quantity


@dataclass(frozen=True)
class Procedure:
    """How the package makes the same number: by a scene, geometry or calculation; none for a row that cannot
    be compared."""

    scene: str = ""
    geometry: bool = False
    calculation: str = ""
    arguments: Mapping[str, Any] = field(default_factory=dict)
    fidelity: str = "quasi-static"
    inputs: str = ""
    samples: int = SAMPLES
    settings: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class ValidationRow:
    """One row."""

    name: str
    title: str
    kind: str
    source: str
    note: str
    data: Data
    procedure: Procedure
    agreement: float  # fraction of |D|
    not_comparable: str
    calibrates: str


def read_rows(folder: Path) -> list[ValidationRow]:
    """Return the rows of all folders that hold a row.toml, by their names.

    Raises:
        InputError: no such folder, no row in it, or rows that cannot be read (all of them at once).
    """
    files = sorted(folder.glob(f"*/{FILE}"))
    if not files:
        raise InputError(f"{folder} holds no row; a row is a folder with a file {FILE}.")
    rows, problems = [], []
    for file in files:
        try:
            rows.append(read_row(file))
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    return rows


def read_row(file: Path) -> ValidationRow:
    """Return the row in a file.

    Raises:
        InputError: what is wrong with it: file, key, and what is allowed.
    """
    reader, content = _Reader(file), read_toml(file)
    tables = {name: reader.table(content, name) for name in KEYS if name}
    for name, table in {"": content, **tables}.items():
        for key in table.keys() - set(KEYS[name]):
            reader.wrong(f"{name}.{key}".lstrip("."), f"is no key; there are {', '.join(KEYS[name])}")
    kind = reader.one_of(content, "kind", KINDS)
    runs = "procedure" in content or not tables["criterion"].get("not_comparable")
    procedure = reader.procedure(tables["procedure"]) if runs else Procedure()
    data = reader.data(tables["data"], procedure)
    row = ValidationRow(
        name=file.parent.name,
        title=reader.text(content, "title"),
        kind=kind,
        source=reader.text(content, "source"),
        note=content.get("note", ""),
        data=data,
        procedure=procedure,
        agreement=reader.number(tables["criterion"], "criterion.agreement", ""),
        not_comparable=tables["criterion"].get("not_comparable", ""),
        calibrates=tables["criterion"].get("calibrates", ""),
    )
    if reader.problems:
        raise InputError(reader.problems)
    return row


class _Reader:
    """Reads values of one row and gathers what is wrong with them."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.problems: list[str] = []

    def wrong(self, where: str, sentence: str) -> None:
        self.problems.append(f"{self.file}: {where} {sentence}.")

    def table(self, content: Mapping[str, Any], name: str) -> Mapping[str, Any]:
        table = content.get(name, {})
        if isinstance(table, Mapping):
            return table
        self.wrong(name, f"is {shown(table)}; it must be a table")
        return {}

    def text(self, table: Mapping[str, Any], key: str) -> str:
        value = table.get(key, "")
        if isinstance(value, str) and value.strip():
            return value
        self.wrong(key, f"is {shown(value)}; it must be text")
        return ""

    def one_of(self, table: Mapping[str, Any], key: str, allowed: tuple[str, ...]) -> str:
        value = table.get(key, "")
        if value in allowed:
            return str(value)
        self.wrong(key, f"is {shown(value)}; it must be one of {', '.join(allowed)}")
        return allowed[0]

    def number(self, table: Mapping[str, Any], key: str, unit: str) -> float:
        name = key.rpartition(".")[2]
        if name not in table:
            self.wrong(key, "is missing")
            return 0.0
        try:
            return to_si(table[name], unit)
        except ValueError as error:
            self.wrong(key, str(error))
            return 0.0

    def procedure(self, table: Mapping[str, Any]) -> Procedure:
        ways = [way for way in ("scene", "geometry", "calculation") if way in table]
        if len(ways) != 1:
            self.wrong("procedure", "needs one of scene, geometry and calculation")
        allowed = {"scene": SCENE_NAMES, "calculation": tuple(CALCULATIONS), "inputs": tuple(SETS)}
        scene, calculation, inputs = (
            self.one_of(table, key, names) if key in table else "" for key, names in allowed.items()
        )
        samples = table.get("samples", SAMPLES)
        if type(samples) is not int or samples < 8:
            self.wrong("procedure.samples", f"is {shown(samples)}; it must be a whole number of at least 8")
        geometry, fidelity = bool(table.get("geometry")), table.get("fidelity", "quasi-static")
        arguments, settings = self.table(table, "arguments"), self.table(table, "set")
        return Procedure(scene, geometry, calculation, arguments, fidelity, inputs, samples, settings)

    def data(self, table: Mapping[str, Any], procedure: Procedure) -> Data:
        name = self.text(table, "quantity")
        known = GEOMETRY if procedure.geometry else SUMMARY
        unit = table.get("unit", "")
        own = procedure.calculation or procedure == Procedure()
        quantity = known.get(name) or (Quantity(unit, unit, name) if own else None)
        if quantity is None:
            self.wrong("data.quantity", f"is {shown(name)}, which no result has")
            quantity = Quantity("", "", name)
        form = next((keys for keys in FORMS if set(keys) <= table.keys()), None)
        if form is None or any(key in table for keys in FORMS if keys != form for key in keys):
            self.wrong("data", "needs value and uncertainty, or low and high, or most, or least")
            return Data(name, 1.0, 0.0, None, 0, quantity)
        first, *rest = (self.number(table, f"data.{key}", quantity.unit) for key in form)
        if form == ("low", "high"):
            if not first < rest[0]:
                self.wrong("data.low", "must be below high")
            width = rest[0] - first
            return Data(name, first + width / 2, width / 12**0.5, (first, rest[0]), 0, quantity)
        if form[0] != "value":
            return Data(name, first, 0.0, None, 1 if form[0] == "most" else -1, quantity)
        if rest[0] < 0:
            self.wrong("data.uncertainty", "must be at least 0")
        return Data(name, first, rest[0], None, 0, quantity)
