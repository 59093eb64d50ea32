"""The picture of a result, chosen by its scene."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from matplotlib.figure import Figure

from rps_exudyn.charts import style
from rps_exudyn.charts.torque import torque_figure
from rps_exudyn.results.measured_torque import MeasuredTorque
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import is_scene, scene_named

FORCES = ("[N m]", "[N]")  # units in which zero means something

Draw = Callable[[Result, MeasuredTorque | None], Figure]


def figure_of(scene: str) -> Draw:
    """The function that draws results of a scene; for an unknown one, the torque over the angle."""
    if not is_scene(scene):
        return torque_figure
    chart = scene_named(scene).chart
    draw: Draw = getattr(import_module(f"rps_exudyn.charts.{chart}"), f"{chart}_figure")
    return draw


def scene_figure(
    result: Result, measured: MeasuredTorque | None = None, *, from_zero: bool = False
) -> Figure:
    """The picture of a result that has signals; ordinates of torque and force begin at zero, or say that they
    do not. `measured` is drawn over it, by default the measured torque that the result keeps."""
    figure = figure_of(result.scene)(result, result.measured if measured is None else measured)
    for axes in figure.axes:
        if axes.get_ylabel().endswith(FORCES):
            if from_zero:
                style.from_zero(axes)
            style.tell_where_it_begins(axes)
    return figure


def draw(
    result: Result,
    path: str | Path | None = None,
    measured: MeasuredTorque | None = None,
    *,
    from_zero: bool = False,
) -> Figure:
    """Draw as `scene_figure`, and save it to `path`.

    Raises:
        InputError: the file cannot be written.
    """
    figure = scene_figure(result, measured, from_zero=from_zero)
    if path is not None:
        style.save(figure, path)
    return figure
