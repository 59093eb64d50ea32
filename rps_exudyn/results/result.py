"""What a simulation leaves: a `Result`, and the HDF5 file that holds it.

Every group, dataset and attribute of the file is described in docs/hdf5-format.md; names and units come
from `quantities`. The file is plain HDF5 with dimension scales, so that other tools read it, for instance
xarray: `xarray.open_dataset(path)`.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from pkgutil import resolve_name
from textwrap import shorten
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from rps_exudyn.base.errors import InputError, check_kind
from rps_exudyn.base.files import printable, read_json_tables, replacing, with_checksum
from rps_exudyn.base.hdf5 import file_image, opened, write_dataset
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import of_this_version
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.parameters.retired import STORED
from rps_exudyn.results import provenance as origin
from rps_exudyn.results.outcome import Status, codes_of
from rps_exudyn.results.quantities import GROUPS, SIGNALS, SUMMARY

if TYPE_CHECKING:
    from xarray import Dataset

MOST_NUMBERS = 6  # of the summary that a printed result shows
DRAWING = "rps_exudyn.pages.charts.scene_figures:draw"  # looked up when drawn: charts stand above results

FILETYPE = "rps_exudyn-result"
VERSION = (1, 5)
"""Major: old readers must refuse the file. Minor: something was added that they may leave unread."""


TABLES = ("summary", "counters", "geometry")  # of numbers
TEXTS = (
    *("scene", "status", "message", "codes", "parameters", "fidelity", "solver", "findings"),
    *origin.FIELDS,
)
"""Root attributes that are text."""
LATER_TEXTS = ("codes", "findings")  # which files of the first versions lack
MEASURED_GROUP = "measured"  # of a result's file
MEASURED_SIGNALS = ("pinion_angle", "pinion_torque")


@dataclass(frozen=True, eq=False)
class MeasuredTorque:
    """A measured curve in SI units, in the order of its file."""

    name: str
    signals: dict[str, np.ndarray]  # pinion_angle [rad], pinion_torque [N m], shape (n,); or of a rack push
    assumed: tuple[str, ...] = ()  # what the reading of the file took for granted
    beside: dict[str, np.ndarray] = field(default_factory=dict)  # clock [s], speed [rad/s], line; (n,)
    left_out: tuple[str, ...] = ()  # those of `assumed` about rows of the file that are no part of it

    def write(self, file: h5py.File) -> None:
        """Write name, angle and torque as a group of a result's file."""
        group = file.create_group(MEASURED_GROUP)
        group.attrs["name"] = self.name
        for name in MEASURED_SIGNALS:
            write_dataset(group, name, np.asarray(self.signals[name], dtype=float), SIGNALS[name].attributes)

    @classmethod
    def read(cls, file: h5py.File) -> "MeasuredTorque | None":
        """The curve in a result's file; None of a file without one.

        Raises:
            ValueError: the group is there and holds no curve.
        """
        if MEASURED_GROUP not in file:
            return None
        name = file[MEASURED_GROUP].attrs["name"]
        signals = {each: file[MEASURED_GROUP][each][()] for each in MEASURED_SIGNALS}
        angle, torque = signals.values()
        if not isinstance(name, str) or angle.ndim != 1 or angle.shape != torque.shape or angle.size < 2:
            raise ValueError(f"{MEASURED_GROUP} holds no curve")
        if not all(values.dtype.kind == "f" and np.isfinite(values).all() for values in signals.values()):
            raise ValueError(f"{MEASURED_GROUP} holds no numbers")
        return cls(name, signals)


@dataclass(frozen=True, eq=False, kw_only=True)
class Result:
    """One simulation: what was asked, how it ended, what came out. All values are SI.

        result = rps.run("free-pinion-torque")
        result["pinion_torque"], result.summary["torque_mean"]
        result.plot("torque.png")

    Use the numbers only if `status` is `Status.OK`. Their names are those of `quantities`.

    Attributes:
        scene: what the test rig did.
        gear: every parameter of the gear and its test.
        fidelity: what was modelled how, choice by choice; "name" is their description in words.
        solver: every setting of the solver.
        findings: what solver and choice of the model report beside the numbers, see docs/hdf5-format.md.
        status: how it ended.
        message: why, if the status is not OK; else remarks.
        codes: what the message is about, by the names of `outcome.Code`.
        signals: name -> values over the time, shape (time,).
        summary: name -> number.
        errors: name -> half width of the number's error bar, its numerical error, in the same unit; nan where
            it is unknown. Numbers without one follow from formulas or settings.
        counters: name -> what the solver had to do.
        geometry: name -> number of the geometry report.
        cpu_s: CPU time of the simulation [s].
        wall_s: elapsed time of the simulation [s].
        provenance: versions, commit, date and machine.
        measured: a measured torque to compare with, drawn over the simulated one.

    Examples:
        >>> result = rps.run("free-pinion-torque", fidelity="quasi-static", turns=0.1)
        >>> result["pinion_torque"].shape == result["pinion_angle"].shape
        True
    """

    scene: str
    gear: SteeringGear
    fidelity: dict[str, Any]
    solver: dict[str, Any]
    findings: dict[str, Any] = field(default_factory=dict)
    status: Status
    message: str = ""
    codes: tuple[str, ...] = ()
    signals: Mapping[str, np.ndarray] = field(default_factory=dict)
    summary: Mapping[str, float] = field(default_factory=dict)
    errors: Mapping[str, float] = field(default_factory=dict)
    counters: Mapping[str, int | float] = field(default_factory=dict)
    geometry: Mapping[str, float] = field(default_factory=dict)
    cpu_s: float
    wall_s: float
    provenance: dict[str, str] = field(default_factory=origin.provenance)
    measured: MeasuredTorque | None = None

    def __post_init__(self) -> None:
        for group, known in GROUPS.items():
            if unknown := set(getattr(self, group)) - set(known):
                raise ValueError(f"quantities.py declares no {group} named {', '.join(sorted(unknown))}")
        if unknown := self.errors.keys() - SUMMARY.keys():
            raise ValueError(f"quantities.py declares no summary named {', '.join(sorted(unknown))}")
        shapes = {np.shape(values) for values in self.signals.values()}
        if self.signals and ("time" not in self.signals or len(shapes) > 1 or len(shapes.pop()) != 1):
            raise ValueError("signals must be one-dimensional, of one length, and hold the time")

    def __getitem__(self, signal: str) -> np.ndarray:
        """Return the signal of that name, shape (time,).

        Raises:
            KeyError: the result has no signal of that name.
        """
        try:
            return self.signals[signal]
        except KeyError:
            has = ", ".join(self.signals) or "none"
            raise KeyError(f"{signal} is no signal of this result; it has {has}") from None

    def __repr__(self) -> str:
        lines = [f"<Result: {self._heading()}", *(f"  {line}" for line in self._facts())]
        return "\n".join(lines) + ">"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{name}</td><td>{SUMMARY[name].show(value)}</td><td>{SUMMARY[name].long_name}</td></tr>"
            for name, value in self.summary.items()
        )
        message = f"<p>{escape(self.message)}</p>" if self.message else ""
        return f"<p><b>{escape(self._heading())}</b></p>{message}<table>{rows}</table>"

    def _heading(self) -> str:
        return f"{self.scene} · fidelity {self.fidelity.get('name', '')} · status {self.status}"

    def _facts(self) -> Iterator[str]:
        """A few lines about it: message, first numbers, size."""
        if self.message:
            yield shorten(self.message, 200, placeholder=" ...")
        first = list(self.summary.items())[:MOST_NUMBERS]
        more = len(self.summary) - len(first)
        numbers = [f"{name} {SUMMARY[name].show(value)}" for name, value in first]
        if numbers:
            yield ", ".join(numbers) + (f", {more} more in .summary" if more else "")
        if self.signals:
            time = self.signals["time"]
            yield f"{len(self.signals)} signals at {time.size} instants over {float(np.ptp(time)):.4g} s"
        yield f"{self.cpu_s:.3g} s of CPU time"

    def plot(self, path: str | Path | None = None, measured: Any = None, *, from_zero: bool = False) -> Any:
        """Draw the scene's picture; return the matplotlib Figure, saved to `path` (.png, .svg, .pdf).

        Args:
            path: file of the picture.
            measured: a measured torque of `rps.read_measured_torque`, drawn over it instead of the result's
                own one.
            from_zero: torques and forces are drawn from zero on.

        Raises:
            InputError: the result has no signals, or the file cannot be written.
        """
        if not self.signals:
            raise InputError(f"The result has no signals to draw: {self.status}, {self.message}.")
        check_kind("measured", measured, MeasuredTorque | None, "a curve of read_measured_torque")
        draw = resolve_name(DRAWING)
        return draw(self, path, measured, from_zero=from_zero)

    def to_xarray(self) -> "Dataset":
        """Return the signals as an xarray Dataset over the time, with units, definitions and the summary."""
        from xarray import Dataset

        variables = {
            name: ("time", values, SIGNALS[name].attributes) for name, values in self.signals.items()
        }
        about = {"scene": self.scene, "status": self.status.value, "message": self.message}
        errors = {f"{name}_error": error for name, error in self.errors.items()}
        return Dataset(variables, attrs={**about, **self.summary, **errors})

    def save(self, path: str | Path) -> None:
        """Write the HDF5 file; an existing file is replaced only by a complete one.

        Raises:
            InputError: the file cannot be written.
        """
        with replacing(path) as partial:
            partial.write_bytes(with_checksum(content_of(self)))


def failed(
    scene: str,
    gear: SteeringGear,
    fidelity: Fidelity,
    status: Status,
    message: str,
    cpu_s: float = 0.0,
    wall_s: float = 0.0,
) -> Result:
    """Return a simulation that came to nothing as a result all the same; times in seconds."""
    return Result(
        scene=scene,
        gear=gear,
        fidelity=fidelity.model_dump(),
        solver={},
        status=status,
        message=message,
        cpu_s=cpu_s,
        wall_s=wall_s,
    )


def read_result(path: str | Path) -> Result:
    """Read the result in an HDF5 file of its own; `study.case_blocks.load` reads cases in blocks, too.

    Raises:
        InputError: no such file, not a result of this package, damaged, or of a newer format.
    """
    with opened(path, FILETYPE, "result", VERSION) as file:
        about = {name: _text(file, name) for name in TEXTS if name in file.attrs or name not in LATER_TEXTS}
        return result_of(
            about | {name: float(file.attrs[name]) for name in ("cpu_s", "wall_s")},
            str(path),
            signals={name: _numbers(dataset, 1) for name, dataset in _known(file, "signals")},
            errors={
                name: _error(dataset) for name, dataset in _known(file, "summary") if "error" in dataset.attrs
            },
            measured=MeasuredTorque.read(file),
            **{
                group: {name: _numbers(dataset, 0).item() for name, dataset in _known(file, group)}
                for group in TABLES
            },
        )


# --- writing -----------------------------------------------------------------------------------


def content_of(result: Result) -> bytes:
    """Return the bytes of the result's HDF5 file, without a checksum."""
    return file_image(lambda file: _write(result, file))


def _write(result: Result, file: h5py.File) -> None:
    file.attrs.update(attributes_of(result))
    for group in GROUPS:
        file.create_group(group)
    for name, values in result.signals.items():
        write_dataset(file["signals"], name, np.asarray(values, dtype=float), SIGNALS[name].attributes)
    if result.signals:
        time = file["signals/time"]
        time.make_scale("time")
        for dataset in (each for each in file["signals"].values() if each != time):
            dataset.dims[0].attach_scale(time)
    for group in TABLES:
        for name, value in getattr(result, group).items():
            number = value if group == "counters" else float(value)
            write_dataset(file[group], name, number, GROUPS[group][name].attributes)
    for name in result.errors.keys() & result.summary.keys():
        file["summary"][name].attrs["error"] = float(result.errors[name])
    if result.measured is not None:
        result.measured.write(file)


def attributes_of(result: Result) -> dict[str, Any]:
    """Return the root attributes of the result's file."""
    return {
        "filetype": FILETYPE,
        "version": np.array(VERSION),
        "scene": result.scene,
        "status": result.status.value,
        "message": result.message,
        "codes": " ".join(result.codes),
        "parameters": result.gear.model_dump_json(),
        "fidelity": json.dumps(result.fidelity, default=_plain),
        "solver": json.dumps(result.solver, default=_plain),
        "findings": json.dumps(result.findings, default=_plain),
        "cpu_s": float(result.cpu_s),
        "wall_s": float(result.wall_s),
        **result.provenance,
    }


def _plain(value: Any) -> Any:
    """Return what JSON cannot hold: arrays become lists, everything else its text."""
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else str(value)


# Findings that files of version 1.0 hold among the solver's settings
_FINDINGS = ("residual", "rescues", "angles", "periods_alike", "tries", "accuracy", "refused")


# --- reading -----------------------------------------------------------------------------------


def result_of(about: Mapping[str, Any], where: str, **parts: Any) -> Result:
    """Return the result with these root attributes, signals and tables; `where` stands for it in messages.

    Raises:
        InputError: its parameters are wrong.
        ValueError: an attribute is damaged.
    """
    tables = {
        name: read_json_tables(about.get(name, "{}") if name in LATER_TEXTS else about[name], name)
        for name in ("fidelity", "solver", "findings", "parameters")
    }
    fidelity, solver, findings, gear = tables.values()
    if not isinstance(fidelity.get("name"), str):
        raise ValueError("fidelity has no name")
    gear, message = of_this_version(gear, fidelity, about["message"])
    return Result(
        scene=about["scene"],
        gear=SteeringGear.from_tables(gear, where=where, context=STORED),
        fidelity=fidelity,
        solver={name: value for name, value in solver.items() if name not in _FINDINGS},
        findings=findings | {name: value for name, value in solver.items() if name in _FINDINGS},
        status=Status(about["status"]),
        message=message,
        codes=codes_of(about["message"], about.get("codes")),
        cpu_s=about["cpu_s"],
        wall_s=about["wall_s"],
        provenance={name: about[name] for name in origin.FIELDS},
        **parts,
    )


def _text(file: h5py.File, name: str) -> str:
    text = file.attrs[name]
    if not isinstance(text, str):
        raise ValueError(f"{name} is no text")
    return printable(text)


def _numbers(dataset: Any, dimensions: int) -> np.ndarray:
    """The dataset's numbers, if they are that: one value (0), or one per time (1)."""
    if not isinstance(dataset, h5py.Dataset) or dataset.dtype.kind not in "iuf":
        raise ValueError(f"{dataset.name} holds no numbers")
    if dataset.shape is None or len(dataset.shape) != dimensions:
        raise ValueError(f"{dataset.name} is {'no row of numbers' if dimensions else 'not one number'}")
    return np.asarray(dataset[()])


def _error(dataset: h5py.Dataset) -> float:
    """The half width of a number's error bar."""
    error = dataset.attrs["error"]
    if np.ndim(error) or np.asarray(error).dtype.kind != "f" or error < 0:
        raise ValueError(f"the error of {dataset.name} is no number of at least 0")
    return float(error)


def _known(file: h5py.File, group: str) -> Iterator[tuple[str, h5py.Dataset]]:
    """Datasets in the order of their declaration; what a newer minor version added is left unread."""
    for name in GROUPS[group]:
        if name in file[group]:
            yield name, file[group][name]
