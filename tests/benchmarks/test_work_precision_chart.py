"""The charts of work and precision: from a whole study, and from one that was stopped."""

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.accuracy_speed.chart import (
    law_band_figure,
    scaling_figure,
    unfinished,
    work_precision_figure,
)
from benchmarks.accuracy_speed.measurement import Measurement, Point, load_measurement
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.law_error import MEASURED


def point(label: str, cost: float, rms: float, status: str = "ok") -> Point:
    settings = json.dumps(Fidelity.preset("quasi-static").model_dump())
    numbers = {"rms": rms, "rms_linear": rms} if status == "ok" else {}
    return Point("quasi_static", label, "quasi-static", settings, status, "", cost, 3, **numbers)


@pytest.fixture
def stopped() -> Measurement:
    points = [point("fine", 2e-3, 0.01), point("coarse", 1e-3, 0.5), point("wild", 1e-3, np.nan, "diverged")]
    planned = [("quasi_static", each) for each in ("fine", "coarse", "wild", "finer")] + [("flank", "one")]
    return Measurement("free-pinion-torque", 0.001, {"a - b": 0.001}, points, planned, {"date": "today"})


def test_a_stopped_study_is_drawn_and_says_what_is_missing(stopped: Measurement, tmp_path: Path) -> None:
    sentence = "unfinished: 2 of 5 points are missing (1 of quasi_static, 1 of flank)"
    assert unfinished(stopped) == sentence
    axes = work_precision_figure(stopped).axes[0]
    assert axes.get_title(loc="left") == sentence
    labels = axes.get_legend_handles_labels()[1]
    assert {"quasi-static", "failed", "default of a preset"} <= set(labels)
    style.save(work_precision_figure(stopped), tmp_path / "chart.png")
    assert (tmp_path / "chart.png").stat().st_size > 10_000


def test_an_empty_study_is_drawn(stopped: Measurement, tmp_path: Path) -> None:
    stopped.points.clear()
    style.save(work_precision_figure(stopped), tmp_path / "chart.png")
    assert "5 of 5 points are missing" in unfinished(stopped)


def test_what_was_measured_is_kept(stopped: Measurement, tmp_path: Path) -> None:
    stopped.save(tmp_path / "a.h5")
    again = load_measurement(tmp_path / "a.h5")
    assert [str(each) for each in again.points] == [str(each) for each in stopped.points]
    assert (again.planned, again.missing, again.origin) == (stopped.planned, stopped.missing, stopped.origin)
    assert (again.uncertainty, again.differences) == (stopped.uncertainty, stopped.differences)


def test_scaling_and_band(tmp_path: Path) -> None:
    size = np.array([1.0, 2, 4])
    style.save(scaling_figure({"turns": (size, 0.1 * size)}), tmp_path / "scaling.png")
    angle = np.linspace(0, 1, 30)
    torques = {"a": 1 + angle, "b": 1.1 + angle}
    style.save(law_band_figure(angle, torques, "a", {"b": MEASURED["line"]}), tmp_path / "law.png")
    assert all((tmp_path / name).stat().st_size > 10_000 for name in ("scaling.png", "law.png"))
