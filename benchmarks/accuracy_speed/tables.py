"""Tables about speed and accuracy, from the files of measured points: models, facets."""

from collections.abc import Collection, Iterable
from pathlib import Path

from benchmarks.accuracy_speed.measurement import Point, load_measurement
from benchmarks.topic import Columns, digits, markdown, table_of

TORQUE = "free-pinion-torque"
LIMITS = "limits.json"
DEFAULT_STRIPS = "strips 4"
MODELS = {
    "general_contact": ("spheres 10", "spheres 27", "spheres 54"),
    "bush": ("segments 25, step_angle 1 °",),
    **dict.fromkeys(
        ("flank_line", "quasi_static_line", "flank_teeth", "quasi_static_teeth"),
        (f"step_angle 1 °, {DEFAULT_STRIPS}",),
    ),
    "flank_bending": ("rack.modes 8, step_angle 1 °",),
    "flank_stribeck": ("step_angle 1 °",),
    "flank_bristles": ("step_angle 1 °",),
    "loop": ("step_angle 5 °",),
    "closed_form": ("",),
}
"""Study -> beginnings of the labels that stand for the package's models."""


def of_torque(folder: Path, *studies: str) -> list[Point]:
    """Points of the free pinion torque that these studies planned."""
    points = load_measurement(folder / f"{TORQUE}.h5").points
    return [point for point in points if point.study in studies]


def models_table(folder: Path) -> str:
    """Return what each kind of model costs per revolution, and how far its torque is from the reference."""
    columns: Columns = {
        "family": lambda point: point.family,
        "settings": lambda point: point.label,
        "CPU s": lambda point: digits(point.cost),
        "error %": lambda point: f"{point.error:.2g}" if point.ok else point.status,
    }
    points = [point for point in of_torque(folder, *MODELS) if point.label.startswith(MODELS[point.study])]
    return table_of(sorted(points, key=lambda point: list(MODELS).index(point.study)), columns)


def cheapest(points: Iterable[Point], families: Collection[str], error: float) -> Point | None:
    """The cheapest point of these families that keeps an error [%]."""
    keeps = [point for point in points if point.ok and point.family in families and point.error <= error]
    return min(keeps, key=lambda point: point.cost, default=None)


def facets_table(folder: Path) -> str:
    """Return what flat facets of the pinion do to the torque: the coarsest and the finest of each kind."""
    kinds = [of_torque(folder, study) for study in ("shaping", "chord")]
    rows = [
        (point.family, point.label, f"{point.error:.2g} %", f"{point.bias:+.2g} %")
        for points in kinds
        for point in points[:: max(len(points) - 1, 1)]
    ]
    return markdown(("family", "facets, material left over", "torque, RMS", "mean"), rows)


TABLES = {"models": models_table, "facets": facets_table}
