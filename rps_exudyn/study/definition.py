"""A study: its axes and cases, its definition (a study file), and its description (study.json of its folder).

study.json is plain JSON in SI units. It names every case by its hash: the folder can be read without the
study file and without computing anything.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, TypeAdapter, ValidationError

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import content_of, read_json_tables
from rps_exudyn.base.hdf5 import check_version
from rps_exudyn.parameters.gear import Setup
from rps_exudyn.results.block import AxisColumns, Keep
from rps_exudyn.results.quantities import Quantity
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.contact_law import LAW_OF_SERIES, resolve_contact_law
from rps_exudyn.simulate.by_accuracy import AccuracyGoal

FILETYPE = "rps_exudyn-study"
VERSION = (1, 2)
"""Major: old readers must refuse the folder. Minor: something was added that they may leave unread."""

GRID_DESIGN = "grid"
UNCERTAIN_DESIGN = "uncertain"
SAMPLED_DESIGNS = ("latin-hypercube", "sobol", "random", "morris", "saltelli", UNCERTAIN_DESIGN)
DESIGNS = (GRID_DESIGN, *SAMPLED_DESIGNS)

Value = float | int | str


@dataclass(frozen=True)
class Axis:
    """Parameters that are varied together, under one name.

    All `paths` take the axis' value; `along` are further paths with values of their own, one for each value
    of a grid's axis. Values are SI (or a choice's word).
    """

    name: str
    paths: tuple[str, ...]
    unit: str  # in which a reader expects the values; "" for plain numbers and words
    values: tuple[Value, ...] | None  # of a grid; None for a sampled design
    kind: str  # "grid" or "sampled"
    along: Mapping[str, tuple[Value, ...]] = field(default_factory=dict)
    distribution: Mapping[str, Any] = field(
        default_factory=dict
    )  # of a sampled axis: "kind", "numbers" in SI

    def settings(self, value: Value) -> dict[str, Value]:
        """Path -> value of every parameter of the axis, where it takes this value."""
        moved = {path: values[self.values.index(value)] for path, values in self.along.items() if self.values}
        return dict.fromkeys(self.paths, value) | moved


def settings_of(axes: tuple[Axis, ...], values: Mapping[str, Value]) -> dict[str, Value]:
    """Path -> value of every parameter of the axes, whose `values` are given by name."""
    return {path: value for axis in axes for path, value in axis.settings(values[axis.name]).items()}


@dataclass(frozen=True)
class Case:
    """One point of the design. `hash` names its file; `values` are axis name -> SI value (or word)."""

    hash: Annotated[str, Field(pattern="^[0-9a-f]{16}$")]  # no path, which could lead out of the folder
    values: Mapping[str, Value]


def axis_quantity(axis: Axis) -> Quantity:
    """Unit, display unit and meaning of the parameters that an axis varies."""
    declared = Setup.declared_at(axis.paths[0])[0] if axis.paths else None
    unit = declared.unit.si if declared and declared.unit else ""
    display = axis.unit or (declared.unit.display if declared and declared.unit else "")
    meaning = declared.meaning if declared else ""
    others = [*axis.paths[1:], *axis.along]
    return Quantity(unit, display, f"{meaning}; with it {', '.join(others)}" if others else meaning)


def axis_values(axis: Axis, cases: Iterable[Case]) -> np.ndarray:
    """The axis' value in each case: numbers in SI, or words."""
    values = [case.values[axis.name] for case in cases]
    if any(isinstance(value, str) for value in values):
        return np.array([str(value) for value in values], dtype=np.str_)
    return np.array(values, dtype=float)


@dataclass(frozen=True)
class Description:
    """A study: what is simulated, what is varied, and every case; in SI units.

    `base` holds the parameters that differ from the defaults in all cases, by their paths. `cases` are in the
    order of the design: a grid's last axis changes fastest. They name a hash twice where a sampled design
    visits a point again.
    """

    name: str
    scene: str
    fidelity: Mapping[str, Any]
    base: Mapping[str, Any]
    axes: tuple[Axis, ...]
    design: str
    seed: int | None
    cases: tuple[Case, ...]
    signals: Keep
    time_limit: float  # of one case [s]
    provenance: Mapping[str, Any]
    title: str = ""  # as in the study file
    correlation: Mapping[str, float] = field(default_factory=dict)  # "axis, axis" -> that of their scores

    @property
    def hashes(self) -> dict[str, Case]:
        """Hash -> case, each once, in the order of the design."""
        return {case.hash: case for case in self.cases}

    def axis_columns(self, hashes: Iterable[str]) -> AxisColumns:
        """Values and meaning of each axis in the cases of these hashes."""
        known = self.hashes
        cases = [known[name] for name in hashes]
        return {axis.name: (axis_values(axis, cases), axis_quantity(axis)) for axis in self.axes}

    def settings(self, case: Case) -> dict[str, Value]:
        """Path -> value of every parameter in which the case differs from the study's base."""
        return settings_of(self.axes, case.values)

    def to_json(self) -> str:
        """The text of study.json: the checksum of all other lines first, and one line per case."""
        content = asdict(self) | {"filetype": FILETYPE, "version": list(VERSION)}
        cases = ",\n".join(json.dumps(case) for case in content.pop("cases"))
        head = json.dumps(content, indent=1)
        text = f'{head[:-2]},\n "cases": [\n{cases}\n ]\n}}\n'
        return "{\n" + _checksum_line(text) + text.removeprefix("{\n")

    @classmethod
    def read(cls, path: Path) -> "Description":
        """The description in a study.json.

        Raises:
            InputError: no such file, not a study, damaged, or of another format version.
        """
        try:
            text = content_of(path).decode("utf-8")
            content = read_json_tables(text, "its text")
        except InputError as error:
            raise InputError(f"{path.parent} is no study's folder: {error}") from None
        except ValueError as error:
            raise InputError(f"{path} is damaged: {error}.") from None
        if content.get("filetype") != FILETYPE:
            raise InputError(f"{path} is not the description of a study of rps-exudyn.")
        version = content.get("version")
        if not _fits(text, content):
            raise InputError(f"{path} is damaged, or was edited: its checksum does not fit.")
        check_version(version if isinstance(version, list) else [], path, VERSION)
        try:
            return TypeAdapter(cls).validate_python(content)
        except ValidationError as error:
            problem = error.errors()[0]
            place = ".".join(map(str, problem["loc"]))
            raise InputError(f"{path} is damaged: {place}: {problem['msg']}.") from None


def _checksum_line(text: str) -> str:
    """The line of study.json that is made of all others."""
    return f' "sha256": "{hashlib.sha256(text.encode()).hexdigest()}",\n'


def _fits(text: str, content: Mapping[str, Any]) -> bool:
    """Return whether a study.json fits its checksum; version 1.0 had none."""
    if "sha256" not in content:
        return content.get("version") not in ([1, 1], list(VERSION))
    opening, line, rest = (*text.split("\n", 2), "", "")[:3]
    return f"{line}\n" == _checksum_line(f"{opening}\n{rest}")


# --- A study as its file defines it: a base of gear and fidelity, and axes that vary it

FIDELITY = "fidelity."


@dataclass(frozen=True)
class Study:
    """The content of a study file. `tables` and `settings` make the base that the axes vary."""

    file: Path
    title: str
    scene: str
    tables: Mapping[str, Any]
    settings: Mapping[str, Any]
    axes: tuple[Axis, ...]
    design: str
    samples: int
    seed: int
    time_limit: float  # [s]
    keep: Keep
    accuracy_goal: AccuracyGoal | None = None  # to which each case climbs the ladder; None: one run with bars
    blocks: bool | None = None  # whether cases are kept in blocks; None: if they are many
    correlation: Mapping[str, float] = field(default_factory=dict)  # "axis, axis" -> that of their scores

    @property
    def name(self) -> str:
        """The file's name without its suffix."""
        return self.file.stem

    @cached_property
    def base(self) -> Setup:
        """Gear and fidelity that the axes vary, with one contact law unless cases differ in law or model."""
        base = Setup.from_tables(self.tables, self.settings, where=str(self.file))
        paths = [path for axis in self.axes for path in (*axis.paths, *axis.along)]
        if any(path == "mesh.law" or path.startswith(FIDELITY) for path in paths):
            return base
        needed = LAW_OF_SERIES if self.design == UNCERTAIN_DESIGN else scene_named(self.scene).law
        return resolve_contact_law(base, base.fidelity, needed, paths)

    def setup(self, settings: Mapping[str, Any]) -> Setup:
        """Return the base with these settings (path -> value)."""
        return self.base.replace(settings, where=str(self.file))

    def toy(self) -> "Study":
        """The same study at the smallest size: two values of each axis, or four samples."""
        axes = []
        for axis in self.axes:
            along = {path: values[:2] for path, values in axis.along.items()}
            axes.append(axis if axis.values is None else replace(axis, values=axis.values[:2], along=along))
        return replace(self, axes=tuple(axes), samples=min(self.samples, 4))
