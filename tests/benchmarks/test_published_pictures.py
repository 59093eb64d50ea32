"""Pictures that benchmarks draw from published data: no data outside the axes, no text over text or cut."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

import benchmarks
from benchmarks import (
    efficiency_map,
    measured_bow,
    rack_bow,
    rack_deflection,
    rattle_map,
    stick_slip,
    tooth_compliance,
)
from benchmarks.accuracy_speed import chart, law_and_scaling, level_points, overview
from benchmarks.accuracy_speed.measurement import load_measurement
from benchmarks.peers import chart as peers
from benchmarks.peers.side_by_side import from_data
from benchmarks.stability.chart import draw_limits, draw_maps
from benchmarks.topic import RESULTS
from picture_album import Album, figure_functions
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.gear import SteeringGear


def data(name: str) -> Any:
    return json.loads((RESULTS / name).read_text(encoding="utf-8"))


def arrays(content: Mapping[str, Any]) -> dict[str, np.ndarray]:
    return {name: np.array(values) for name, values in content.items()}


def deflected() -> Figure:
    found = data("flexible_rack/deflection.json")
    line = np.array([found["station"], found["deflection"]])
    return rack_deflection.picture(SteeringGear(), line, found["force"])


def efficiency() -> Figure:
    masses = efficiency_map.MASSES[::4]
    return efficiency_map.efficiency_map(efficiency_map.efficiency_tests(masses), masses)


def laws() -> Figure:
    found = data("accuracy_speed/limits.json")
    angle, torques = np.array(found["angle"]), arrays(found["torques"])
    return chart.law_band_figure(angle, torques, law_and_scaling.DEFAULT, law_and_scaling.BANDS)


def scaling() -> Figure:
    found = data("accuracy_speed/limits.json")["scaling"]
    return chart.scaling_figure({name: (np.array(x), np.array(y)) for name, (x, y) in found.items()})


def fronts() -> Figure:
    measured = load_measurement(RESULTS / "accuracy_speed" / "free-pinion-torque.h5")
    uncertain = data("accuracy_speed/overview.json")["uncertainties"]
    return overview.overview_figure([point for point in measured.points if point.ok], uncertain)


def levels() -> Figure:
    return level_points.levels_figure(data("accuracy_speed/levels.json")["points"])


def compared() -> Figure:
    found = data("peers/peers.json")
    return peers.work_precision_figure(from_data(found["rows"]), found["reference"]["uncertainty_percent"])


PICTURES: dict[str, Callable[[], Figure]] = {
    "levels": levels,
    "stick-slip map": lambda: stick_slip.map_picture(data("stick_slip/stick_slip.json")),
    "stick-slip methods": lambda: stick_slip.method_picture(data("stick_slip/stick_slip.json")["methods"]),
    "rattle": lambda: rattle_map.picture(data("flexible_rack/rattle.json")["cases"]),
    "bow": lambda: rack_bow.picture(data("flexible_rack/bow.json")["cases"]),
    "deflected": deflected,
    "fit with a bow": lambda: measured_bow.picture(data("fit/fit_bow.json")["cases"]),
    "efficiency": efficiency,
    "laws": laws,
    "scaling": scaling,
    "overview": fronts,
    "other programs": compared,
} | {
    path.stem: lambda path=path: chart.work_precision_figure(  # type: ignore[misc]
        load_measurement(path), level_points.whole_runs(path.parent, path.stem)
    )
    for path in sorted((RESULTS / "accuracy_speed").glob("*.h5"))
}

FILES: dict[str, Callable[[Path], None]] = {
    "limits of steps": lambda out: draw_limits(data("stability/explicit.json")["limits"], out),
    "yields of teeth": lambda out: tooth_compliance.draw(
        data("tooth_compliance/elements.json")["course"], out
    ),
} | {
    path.stem: lambda out, path=path: draw_maps(json.loads(path.read_text())["maps"], out)  # type: ignore[misc]
    for path in sorted((RESULTS / "stability").glob("*.json"))
    if "maps" in json.loads(path.read_text(encoding="utf-8"))
}


@pytest.fixture(scope="module")
def album(tmp_path_factory: pytest.TempPathFactory) -> Album:
    album, out = Album(), tmp_path_factory.mktemp("pictures") / "a.png"
    for title, figure in PICTURES.items():
        with album.looking(title):
            style.save(figure(), out)
    for title, draw in FILES.items():
        with album.looking(title):
            draw(out)
    return album


def test_no_published_picture_has_data_outside_its_axes_or_texts_that_overlap(album: Album) -> None:
    assert all(len(page) == 1 for page in album.pages.values())
    assert album.faults() == []


def test_every_picture_of_a_benchmark_was_looked_at(album: Album) -> None:
    looked_at = {name for page in album.pages.values() for drawn in page for name in drawn.functions}
    elsewhere = {name for name in figure_functions(benchmarks) if name.startswith("benchmarks.charts.")}
    assert figure_functions(benchmarks) - looked_at == elsewhere  # which smoke/test_pictures.py draws
