"""Work and precision of many models of one scene: what was planned, what was measured, and their file.

Each point is kept as soon as it is measured, failed ones too; a planned point without measurement is missing.
"""

import json
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from benchmarks.accuracy_speed.variants import variant_of
from rps_exudyn.analysis.curve import Curve
from rps_exudyn.base.files import replacing
from rps_exudyn.base.hdf5 import opened
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.scenes.scene_run import SceneRun
from verification.runs import SceneReference, revolutions, run_scene
from verification.work_precision import Reference

FILETYPE = "rps_exudyn-work-precision"
VERSION = (1, 1)

REPEATS = 15
ENOUGH_TIME = 1.5  # CPU seconds spent on repeating one point

FAMILIES = {
    "general contact": "spheres on triangles in Exudyn",
    "flank": "analytic flank contact in Exudyn",
    "flank, bush chain": "the same with the bush as a chain",
    "quasi-static": "the same contact in equilibrium",
    "flank, line": "flank contact by the default law, compared with its own reference",
    "quasi-static, line": "that in equilibrium",
    "flank, teeth": "teeth that bend together, likewise",
    "quasi-static, teeth": "that in equilibrium",
    "flank, bending rack": "the default law and a rack that bends, likewise",
    "quasi-static, bending rack": "that in equilibrium",
    "flank, supported pinion": "the default law and a pinion on bearings, likewise",
    "quasi-static, supported pinion": "that in equilibrium",
    "flank, Stribeck": "the default law and friction that falls with speed, likewise",
    "quasi-static, Stribeck": "that in equilibrium",
    "flank, bristles": "the default law and friction with a state, likewise",
    "quasi-static, bristles": "that in equilibrium",
    "flank, four bristles": "that with four elements, likewise",
    "quasi-static, four bristles": "that in equilibrium",
    "loop over gears, line": "equilibria by the default law of many gears computed together, of each",
    "spheres at rest": "equilibrium, contact of the spheres",
    "shaped pinion": "spheres at rest on flanks as they are cut, compared with those on the analytic flank",
    "meshed pinion": "spheres at rest on triangles, likewise",
    "explicit": "flank contact, Exudyn's explicit solvers",
    "closed form": "formulas",
}
"""Models that are drawn and compared together -> what they are."""

PRESET_FAMILIES = {
    "full": "general contact",
    "flank": "flank",
    "quasi-static": "quasi-static",
    "closed-form": "closed form",
}


def family_of(gear: SteeringGear, fidelity: Fidelity) -> str:
    """The family of a model of a gear, one of `FAMILIES`."""
    return ", ".join(filter(None, (_kind_of(fidelity), variant_of(gear, fidelity))))


def _kind_of(fidelity: Fidelity) -> str:
    if fidelity.solver == "closed-form":
        return "closed form"
    if fidelity.solver == "equilibrium":
        return "spheres at rest" if fidelity.mesh == "general-contact" else "quasi-static"
    if fidelity.mesh == "general-contact":
        return "general contact"
    return "flank, bush chain" if fidelity.bush == "chain" else "flank"


@dataclass(frozen=True)
class Point:
    """One measured model of a scene. Errors in % of the mean, lift in m; nan where there is none."""

    study: str  # file in which it was planned
    label: str
    family: str
    settings: str  # JSON of its fidelity
    status: str
    message: str
    cost: float  # CPU seconds of the solver per revolution, the least of several
    repeats: int
    steps: float = np.nan  # counters per revolution
    newton_iterations: float = np.nan
    jacobians: float = np.nan
    force_evaluations: float = np.nan
    rms: float = np.nan
    rms_linear: float = np.nan
    bias: float = np.nan
    peak_to_peak: float = np.nan
    tooth_order: float = np.nan
    first_order: float = np.nan
    lift: float = np.nan

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


@dataclass(frozen=True)
class Order:
    """Exponent p of error ~ size^p over measured points; nan where too few of them are above the floor."""

    family: str
    knob: str  # what is made smaller
    error: str  # which error falls with it
    observed: float
    expected: float
    points: int  # that were fitted
    why: str  # this is expected


@dataclass
class Measurement:
    """All points of one scene."""

    scene: str
    reference: Reference
    points: list[Point] = field(default_factory=list)
    planned: list[tuple[str, str]] = field(default_factory=list)  # study and label of each point
    origin: dict[str, str] = field(default_factory=dict)
    orders: list[Order] = field(default_factory=list)  # of convergence, fitted

    @property
    def missing(self) -> list[tuple[str, str]]:
        """Study and label of the points that were planned and not measured."""
        measured = {(point.study, point.label) for point in self.points}
        return [name for name in self.planned if name not in measured]

    def of_family(self, family: str) -> list[Point]:
        """Measured points of a family."""
        return [point for point in self.points if point.family == family]

    def save(self, path: str | Path) -> None:
        """Write the file, whole or not at all.

        Raises:
            InputError: the file cannot be written.
        """
        with replacing(path) as partial, h5py.File(partial, "w") as file:
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
    turned = plan.revolutions
    numbers: dict[str, float] = {name: count / turned for name, count in best.outcome.counters.items()}
    if best.ok:
        errors, lift = reference.errors_of(best.signals, plan.fidelity)
        numbers |= {name: value for name, value in asdict(errors).items() if value is not None}
        numbers |= {"lift": lift} if lift is not None else {}
    return Point(
        study=plan.study,
        label=plan.label,
        family=plan.family,
        settings=json.dumps(plan.fidelity.model_dump()),
        status=str(best.outcome.status),
        message=best.outcome.message if not best.ok else "",
        cost=best.outcome.cpu_s / turned,
        repeats=len(runs),
        **{name: numbers[name] for name in NUMBERS if name in numbers},
    )


TEXTS = [each.name for each in fields(Point) if each.type is str]
NUMBERS = [each.name for each in fields(Point) if each.name not in (*TEXTS, "cost", "repeats")]


def load_measurement(path: str | Path) -> Measurement:
    """Read what `Measurement.save` wrote.

    Raises:
        InputError: no such file, or one of something else.
    """
    with opened(path, FILETYPE, "work-precision study", VERSION) as file:
        reference = Reference(
            Curve(file["reference/time"][()], file["reference/values"][()]),
            float(file["reference"].attrs["uncertainty"]),
            json.loads(file["reference"].attrs["differences"]),
        )
        columns: dict[str, Any] = {}
        for each in fields(Point):
            column = file["points"][each.name]
            columns[each.name] = column.asstr()[()].tolist() if each.type is str else column[()].tolist()
        rows: Iterable[tuple[Any, ...]] = zip(*columns.values(), strict=True)
        return Measurement(
            scene=str(file.attrs["scene"]),
            reference=reference,
            points=[Point(**dict(zip(columns, row, strict=True))) for row in rows],
            planned=[(study, label) for study, label in json.loads(file.attrs["planned"])],
            origin=json.loads(file.attrs["origin"]),
            orders=[Order(**row) for row in json.loads(file.attrs.get("orders", "[]"))],
        )


def _write(measurement: Measurement, file: h5py.File) -> None:
    file.attrs.update(
        filetype=FILETYPE,
        version=VERSION,
        scene=measurement.scene,
        planned=json.dumps(measurement.planned),
        origin=json.dumps(measurement.origin),
        orders=json.dumps([asdict(each) for each in measurement.orders]),
    )
    reference = file.create_group("reference")
    curve = measurement.reference.curve
    packed: Any = {"compression": "gzip", "shuffle": True}
    reference.create_dataset("time", data=curve.time, **packed)
    reference.create_dataset("values", data=curve.values, dtype=np.float32, **packed)
    reference.attrs["uncertainty"] = measurement.reference.uncertainty
    reference.attrs["differences"] = json.dumps(measurement.reference.differences)
    points = file.create_group("points")
    for each in fields(Point):
        column = [getattr(point, each.name) for point in measurement.points]
        if each.type is str:
            letters = [text.encode() for text in column]
            size = max(map(len, letters), default=0) or 1
            points.create_dataset(each.name, data=letters, dtype=h5py.string_dtype(length=size), **packed)
        else:
            points[each.name] = np.array(column, dtype=int if each.type is int else float)
