"""The checker of pictures finds each kind of fault, and none in a picture without."""

from collections.abc import Callable

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from picture_album import Album
from picture_faults import faults
from rps_exudyn.pages.charts.style import signed_decades

X = np.linspace(0, 1, 11)


def drawn(draw: Callable[[Axes], object], zooms: dict[int, str] | None = None) -> list[str]:
    figure = Figure(figsize=(4, 3), layout="constrained")
    axes = figure.subplots()
    axes.plot(X, X, label="curve")
    axes.set(xlabel="angle [deg]", ylabel="torque [N m]", title="A picture (of a line)")
    draw(axes)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return faults(canvas, zooms)


@pytest.mark.parametrize(
    "draw",
    [
        lambda axes: None,
        lambda axes: axes.scatter(X, X**2),
        lambda axes: axes.axvspan(0.2, 0.4),
        lambda axes: axes.axhline(0.5),
        lambda axes: axes.plot(X, np.where(X > 0.5, np.nan, X)),
        lambda axes: axes.plot([], [], label="only in the legend"),
        lambda axes: axes.legend(loc="lower right", bbox_to_anchor=(1, 1)),
        lambda axes: axes.errorbar(X, X, 0.1),
        lambda axes: axes.set(xscale="log", xlim=(0.05, 2)) and axes.lines[0].set_data(X[1:], X[1:]),
        lambda axes: axes.plot(0.5, 1.2, "o", transform=axes.transAxes, clip_on=False),
        lambda axes: axes.figure.colorbar(
            axes.contourf(X, X, np.outer(X, X), levels=[0.2, 0.5], extend="both"), ax=axes
        ),
    ],
)
def test_pictures_without_a_fault_have_none(draw: Callable[[Axes], object]) -> None:
    assert drawn(draw) == []


@pytest.mark.parametrize(
    ("draw", "found"),
    [
        (lambda axes: axes.set_ylim(0, 0.9), "torque [N m]: Line2D 'curve' reaches"),
        (lambda axes: axes.set_xlim(0.1, 1), "torque [N m]: Line2D 'curve' reaches"),
        (lambda axes: (axes.set_ylim(0, 1), axes.scatter(X, 2 * X)), "PathCollection reaches"),
        (lambda axes: (axes.set_ylim(0, 1), axes.fill_between(X, X, 2 * X)), "reaches"),
        (lambda axes: (axes.set_ylim(0, 1), axes.bar(X, 2 * X, 0.01)), "Rectangle reaches"),
        (lambda axes: (axes.set_ylim(0, 1), axes.errorbar(X, X, 0.5)), "LineCollection reaches"),
        (lambda axes: (axes.set_ylim(0, 1), axes.vlines(X, 0, 2 * X)), "LineCollection reaches"),
        (lambda axes: (axes.set_ylim(0, 1), axes.axhline(1.5)), "Line2D reaches"),
        (lambda axes: (axes.set_ylim(0, 1), axes.axhspan(0.5, 1.5)), "Rectangle reaches"),
        (lambda axes: (axes.set_xlim(0, 1), axes.pcolormesh(2 * X, X, np.outer(X, X))), "QuadMesh reaches"),
        (lambda axes: (axes.set_xlim(0, 1), axes.imshow(np.eye(9), aspect="auto")), "AxesImage reaches"),
        (lambda axes: axes.text(0.5, 1.02, "over", transform=axes.transAxes), "lie over each other"),
        (lambda axes: axes.set_xticks([0.5, 0.52], ["0.50", "0.52"]), "lie over each other"),
        (lambda axes: axes.set_xticks([0.5, 0.59], ["0.50", "0.59"]), "lie over each other"),
        (lambda axes: axes.figure.text(0.9, 0.5, "beyond the edge of the figure"), "is cut by"),
        (lambda axes: axes.text(0.9, 0.5, "beyond the edge of the axes", clip_on=True), "is cut by"),
        (lambda axes: axes.set_title("A picture (of a"), "is cut within ()"),
        (lambda axes: axes.set_position((0.4, 0.4, 0.2, 0.2)), "of the figure's area"),
        (lambda axes: axes.figure.set_size_inches(12, 4), "12 inches wide"),
    ],
)
def test_each_kind_of_fault_is_found(draw: Callable[[Axes], object], found: str) -> None:
    assert any(found in sentence for sentence in drawn(draw)), drawn(draw)


def test_a_zoom_is_declared() -> None:
    assert drawn(lambda axes: axes.set_ylim(0, 0.9), {0: "the lower part alone"}) == []
    assert drawn(lambda axes: axes.set_ylim(0, 0.9), {1: "another one"}) != []


def test_an_album_knows_who_drew_what() -> None:
    def a_figure(top: float) -> Figure:
        figure = Figure()
        figure.subplots().plot(X, X)
        figure.axes[0].set_ylim(0, top)
        return figure

    album = Album()
    for top in (1.1, 0.5):
        with album.looking("twice"):
            a_figure(top).savefig("/dev/null", format="png")
    (good, bad) = album.pages["twice"]
    assert (len(good.faults), len(bad.faults)) == (0, 1)
    assert any(name.endswith("a_figure") for name in good.functions)
    assert album.faults()[0].startswith("twice: axes: Line2D reaches")


@pytest.mark.parametrize("largest", [1e-3, 0.9, 1.0, 9.0, 30.0, 999.0, 1e5, 3e18, 1e200])
@pytest.mark.parametrize("width", [1.5, 3.0, 9.0])
def test_ticks_of_signed_decades_have_room(largest: float, width: float) -> None:
    """Of any range of values on axes of any width."""
    figure = Figure(figsize=(width, 3), layout="constrained")
    axes = figure.subplots()
    axes.plot([-largest, 0.1 * largest], [0, 1])
    signed_decades(axes, 1.0)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    assert not any("over each other" in fault for fault in faults(canvas))
    assert 0 in axes.get_xticks()
