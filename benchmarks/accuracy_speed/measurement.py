"""Work and precision of many models of one scene: what was planned, what was measured, and their file.

Each point is kept as soon as it is measured, failed ones too; a planned point without measurement is missing.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from rps_exudyn.base.files import replacing
from rps_exudyn.base.hdf5 import opened
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.scenes.scene_run import SceneRun
from verification.runs import SceneReference, revolutions, run_scene
from verification.variants import variant_of

FILETYPE = "rps_exudyn-work-precision"
VERSION = (2, 0)

REPEATS = 15
ENOUGH_TIME = 1.5  # CPU seconds spent on repeating one point

PRESET_FAMILIES = {
    "full": "general contact",
    "flank": "flank",
    "quasi-static": "quasi-static",
    "reduced": "reduced, line",
    "closed-form": "closed form",
}


def family_of(gear: SteeringGear, fidelity: Fidelity) -> str:
    """The family of a model of a gear: what is drawn and compared together."""
    return ", ".join(filter(None, (_kind_of(fidelity), variant_of(gear, fidelity))))


def _kind_of(fidelity: Fidelity) -> str:
    if fidelity.solver == "closed-form":
        return "closed form"
    if fidelity.solver == "reduced":
        return "reduced"
    if fidelity.solver == "equilibrium":
        return "spheres at rest" if fidelity.mesh == "general-contact" else "quasi-static"
    if fidelity.mesh == "general-contact":
        return "general contact"
    return "flank, bush chain" if fidelity.bush == "chain" else "flank"


@dataclass(frozen=True)
class Point:
    """One measured model of a scene. Errors in % of the mean; nan where there is none."""

    study: str  # file in which it was planned
    label: str
    family: str
    settings: str  # JSON of its fidelity
    status: str
    message: str
    cost: float  # CPU seconds of the solver per revolution, the least of several
    repeats: int
    rms: float = np.nan
    rms_linear: float = np.nan
    bias: float = np.nan

    @property
    def fidelity(self) -> Fidelity:
        """The measured model."""
        return Fidelity.model_validate(json.loads(self.settings))

    @property
    def ok(self) -> bool:
        """Return whether the run ended well."""
        return self.status == Status.OK

    @property
    def error(self) -> float:
        """Larger RMS of both interpolations [%]."""
        return max(self.rms, self.rms_linear)


@dataclass
class Measurement:
    """All points of one scene."""

    scene: str
    uncertainty: float  # of the reference [%]
    differences: dict[str, float] = field(default_factory=dict)  # of its methods, pair by pair [%]
    points: list[Point] = field(default_factory=list)
    planned: list[tuple[str, str]] = field(default_factory=list)  # study and label of each point
    origin: dict[str, str] = field(default_factory=dict)

    @property
    def missing(self) -> list[tuple[str, str]]:
        """Study and label of the points that were planned and not measured."""
        measured = {(point.study, point.label) for point in self.points}
        return [name for name in self.planned if name not in measured]

    def save(self, path: str | Path) -> None:
        """Write the file, whole or not at all.

        Raises:
            InputError: the file cannot be written.
        """
        with replacing(path) as partial, h5py.File(partial, "w", libver="latest") as file:
            _write(self, file)


@dataclass(frozen=True)
class PlannedPoint:
    """A point to be measured."""

    study: str
    label: str
    family: str
    fidelity: Fidelity
    revolutions: float  # of the pinion that a run makes
    run: Callable[[], SceneRun]

    @classmethod
    def of_scene(
        cls, study: str, label: str, scene: str, gear: SteeringGear, fidelity: Fidelity
    ) -> "PlannedPoint":
        """Plan a run of the package."""
        turned = revolutions(scene, gear)
        family = family_of(gear, fidelity)
        return cls(study, label, family, fidelity, turned, lambda: run_scene(scene, gear, fidelity))


def measure_point(plan: PlannedPoint, reference: SceneReference, repeats: int = REPEATS) -> Point:
    """Run it until its least cost is known well enough, and compare it with the reference."""
    runs: list[SceneRun] = []
    spent = 0.0
    while not runs or (len(runs) < repeats and spent < ENOUGH_TIME):
        runs.append(plan.run())
        spent += runs[-1].outcome.cpu_s
    best = min(runs, key=lambda run: run.outcome.cpu_s)
    found = reference.errors_of(best.signals, plan.fidelity)[0] if best.ok else None
    return Point(
        study=plan.study,
        label=plan.label,
        family=plan.family,
        settings=json.dumps(plan.fidelity.model_dump()),
        status=str(best.outcome.status),
        message=best.outcome.message if not best.ok else "",
        cost=best.outcome.cpu_s / plan.revolutions,
        repeats=len(runs),
        **({name: getattr(found, name) for name in ERRORS} if found else {}),
    )


ERRORS = ("rms", "rms_linear", "bias")
PLANNED = "study", "label"


def load_measurement(path: str | Path) -> Measurement:
    """Read what `Measurement.save` wrote.

    Raises:
        InputError: no such file, or one of something else.
    """
    with opened(path, FILETYPE, "work-precision study", VERSION) as file:
        columns = [_column(file["points"][each.name]) for each in fields(Point)]
        planned = [_column(file["planned"][name]) for name in PLANNED]
        return Measurement(
            scene=str(file.attrs["scene"]),
            uncertainty=float(file.attrs["uncertainty"]),
            differences=json.loads(file.attrs["differences"]),
            points=[Point(*row) for row in zip(*columns, strict=True)],
            planned=list(zip(*planned, strict=True)),
            origin=json.loads(file.attrs["origin"]),
        )


def _write(measurement: Measurement, file: h5py.File) -> None:
    file.attrs.update(
        filetype=FILETYPE,
        version=VERSION,
        scene=measurement.scene,
        uncertainty=measurement.uncertainty,
        differences=json.dumps(measurement.differences),
        origin=json.dumps(measurement.origin),
    )
    _write_columns(file.create_group("planned"), PLANNED, measurement.planned)
    names = [each.name for each in fields(Point)]
    rows = [[getattr(point, name) for name in names] for point in measurement.points]
    _write_columns(file.create_group("points"), names, rows)


def _write_columns(group: h5py.Group, names: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
    """Write each column in one chunk, which takes the fewest bytes."""
    for name, column in zip(names, zip(*rows, strict=True) if rows else [()] * len(names), strict=True):
        values = np.array([each.encode() if isinstance(each, str) else each for each in column])
        packed: Any = {"compression": 9, "shuffle": True, "chunks": values.shape} if rows else {}
        group.create_dataset(name, data=values, **packed)


def _column(stored: h5py.Dataset) -> list[Any]:
    return [each.decode() if isinstance(each, bytes) else each for each in stored[()].tolist()]
