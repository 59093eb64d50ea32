"""What a study's folder says about itself: study.json as a frozen `Description`.

The file is plain JSON with everything in SI; it names every case by its hash, so that the folder can be
understood without the study file and without computing anything.
"""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.results.case_file import Keep

FILETYPE = "rps_exudyn-study"
VERSION = (1, 0)
"""Major: old readers must refuse the folder. Minor: something was added that they may leave unread."""

GRID_DESIGN = "grid"
SAMPLED_DESIGNS = ("latin-hypercube", "sobol", "random", "morris", "saltelli")
DESIGNS = (GRID_DESIGN, *SAMPLED_DESIGNS)

Value = float | int | str


@dataclass(frozen=True)
class Axis:
    """What is varied together, under one name.

    All `paths` take the axis' value; `along` are further paths with values of their own, one per value of a
    grid's axis. Values are SI (or a choice's word).
    """

    name: str
    paths: tuple[str, ...]
    unit: str  # in which a reader expects the values; "" for plain numbers and words
    values: tuple[Value, ...] | None  # of a grid; None for a sampled design
    kind: str  # "grid" or "sampled"
    along: Mapping[str, tuple[Value, ...]] = field(default_factory=dict)
    distribution: Mapping[str, Any] = field(
        default_factory=dict
    )  # of a sampled axis: kind and its numbers, SI

    def settings(self, value: Value) -> dict[str, Value]:
        """Path -> value of all that moves with the axis."""
        moved = {path: values[self.values.index(value)] for path, values in self.along.items() if self.values}
        return dict.fromkeys(self.paths, value) | moved


@dataclass(frozen=True)
class Case:
    """One point of the design. `hash` names its file; `values` are axis name -> SI value (or word)."""

    hash: str
    values: Mapping[str, Value]


@dataclass(frozen=True)
class Description:
    """A study: what is simulated, what is varied, and every case. Values are SI.

    `base` holds the parameters that differ from the defaults in all cases, by their paths. `cases` are in the
    order of the design (a grid's last axis changes fastest) and may name the same hash twice, where a
    sampled design visits a point again.
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
    title: str = ""  # in the words of its author

    @property
    def hashes(self) -> dict[str, Case]:
        """Hash -> case, each once, in the order of the design."""
        return {case.hash: case for case in self.cases}

    def settings(self, case: Case) -> dict[str, Value]:
        """Path -> value of everything in which the case differs from the study's base."""
        return {
            path: value for axis in self.axes for path, value in axis.settings(case.values[axis.name]).items()
        }

    def to_json(self) -> str:
        """The text of study.json: one line per case."""
        told = asdict(self) | {"filetype": FILETYPE, "version": list(VERSION)}
        cases = ",\n".join(json.dumps(case) for case in told.pop("cases"))
        head = json.dumps(told, indent=1)
        return f'{head[:-2]},\n "cases": [\n{cases}\n ]\n}}\n'

    @classmethod
    def read(cls, path: Path) -> "Description":
        """From a study.json.

        Raises:
            InputError: no such file, not a study, damaged, or of a newer format.
        """
        try:
            told = json.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            raise InputError(
                f"{path.parent} is no study's folder: {error.strerror or error}: {path.name}."
            ) from None
        except (ValueError, RecursionError) as error:
            raise InputError(f"{path} is damaged: {error}.") from None
        if not isinstance(told, dict) or told.get("filetype") != FILETYPE:
            raise InputError(f"{path} is not the description of a study of rps-exudyn.")
        version = told.get("version")
        if not isinstance(version, list) or version[:1] != [VERSION[0]]:
            raise InputError(
                f"{path} has format version {version}, and this rps-exudyn reads {VERSION[0]}.x; "
                "use the rps-exudyn that wrote it, or a newer one."
            )
        try:
            return _from_json(told)
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise InputError(f"{path} is damaged: {type(error).__name__} {error}.") from None


def _from_json(told: dict[str, Any]) -> Description:
    cases = tuple(Case(_name_of_file(case["hash"]), dict(case["values"])) for case in told["cases"])
    keep = told["signals"]
    names = keep["signals"]
    return Description(
        name=str(told["name"]),
        scene=str(told["scene"]),
        fidelity=dict(told["fidelity"]),
        base=dict(told["base"]),
        axes=tuple(_axis(axis) for axis in told["axes"]),
        design=str(told["design"]),
        seed=told["seed"],
        cases=cases,
        signals=Keep(None if names is None else tuple(names), keep["samples"]),
        time_limit=float(told["time_limit"]),
        provenance=dict(told["provenance"]),
        title=str(told.get("title", "")),
    )


def _axis(told: dict[str, Any]) -> Axis:
    values = told["values"]
    return Axis(
        name=str(told["name"]),
        paths=tuple(told["paths"]),
        unit=str(told["unit"]),
        values=None if values is None else tuple(values),
        kind=str(told["kind"]),
        along={path: tuple(along) for path, along in told.get("along", {}).items()},
        distribution=dict(told.get("distribution", {})),
    )


def _name_of_file(text: Any) -> str:
    """A hash becomes a file's name: nothing else may pass, or a study could point outside its folder."""
    if not isinstance(text, str) or len(text) != 16 or not set(text) <= set("0123456789abcdef"):
        raise ValueError(f"{text!r} is no hash of a case")
    return text
