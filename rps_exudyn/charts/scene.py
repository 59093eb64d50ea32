"""The picture that suits a result: its scene's own."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from matplotlib.figure import Figure

from rps_exudyn.analysis.measured import MeasuredTorque
from rps_exudyn.charts import style
from rps_exudyn.charts.torque import torque_figure
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import SCENE_NAMES, scene_named

Draw = Callable[[Result, MeasuredTorque | None], Figure]


def figure_of(scene: str) -> Draw:
    """Return the function that draws results of a scene; of an unknown one, the torque over the angle."""
    if scene not in SCENE_NAMES:
        return torque_figure
    chart = scene_named(scene).chart
    draw: Draw = getattr(import_module(f"rps_exudyn.charts.{chart}"), f"{chart}_figure")
    return draw


def draw(result: Result, path: str | Path, measured: MeasuredTorque | None = None) -> None:
    """Save the picture of a result that has signals, a measured torque over it if there is one.

    Raises:
        InputError: the file cannot be written.
    """
    style.save(figure_of(result.scene)(result, measured), path)
