"""Tables about speed and accuracy, from the files of measured points: models, fronts, references, orders."""

from collections.abc import Collection, Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from benchmarks.accuracy_speed.chart import shown_time
from benchmarks.accuracy_speed.measurement import Measurement, Point, load_measurement
from benchmarks.topic import Columns, digits, load_data, markdown, table_of
from rps_exudyn.scenes import SCENE_NAMES

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


def measured(folder: Path) -> Iterator[Measurement]:
    """Every scene's measurement, as far as there is one."""
    for scene in SCENE_NAMES:
        file = folder / f"{scene}.h5"
        if file.exists():
            yield load_measurement(file)


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


def scenes_table(folder: Path) -> str:
    """Return how well each scene's reference is known, and what 1 % and 0.1 % cost."""
    rows = []
    for each in measured(folder):
        cells = []
        for error in (1.0, 0.1):
            found = [_cheapest_of(each.points, kind, error) for kind in ("quasi-static", "flank")]
            cells.append(" / ".join("-" if best is None else shown_time(best.cost) for best in found))
        rows.append((each.scene, f"{each.uncertainty:.2g} %", *cells))
    return markdown(("scene", "reference known to", "1 % by quasi-static / flank", "0.1 %"), rows)


def _cheapest_of(points: Sequence[Point], kind: str, error: float) -> Point | None:
    """The cheapest point by the default contact law, or by the other where the scene was measured with that
    alone."""
    by_default = f"{kind}, line"
    family = by_default if any(point.family == by_default for point in points) else kind
    return cheapest(points, (family,), error)


def laws_table(folder: Path) -> str:
    """Mean torque and ripple by every law."""
    content = load_data(folder / LIMITS)
    torques = {name: np.array(values) for name, values in content["torques"].items()}
    default = torques[content["default"]].mean()
    columns: Columns = {
        "law": lambda row: row[0],
        "mean N mm": lambda row: f"{1e3 * row[1].mean():.1f}",
        "against the default %": lambda row: f"{100 * (row[1].mean() / default - 1):+.2f}",
        "peak to peak N mm": lambda row: f"{1e3 * np.ptp(row[1]):.1f}",
    }
    return table_of(torques.items(), columns)


def facets_table(folder: Path) -> str:
    """Return what flat facets of the pinion do to the torque: the coarsest and the finest of each kind."""
    kinds = [of_torque(folder, study) for study in ("shaping", "chord")]
    rows = [
        (point.family, point.label, f"{point.error:.2g} %", f"{point.bias:+.2g} %")
        for points in kinds
        for point in points[:: max(len(points) - 1, 1)]
    ]
    return markdown(("family", "facets, material left over", "torque, RMS", "mean"), rows)


TABLES = {"models": models_table, "accuracy_scenes": scenes_table, "facets": facets_table}
