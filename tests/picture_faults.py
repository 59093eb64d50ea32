"""What is wrong with a picture as it is drawn: data outside the axes, text over text, text that is cut.

    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    faults(canvas)  # ["pinion torque [N m]: Line2D 'measured' reaches 30 pixels beyond the axes", ...]

Everything is compared in pixels.
"""

from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import Collection, PathCollection, QuadMesh
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from rps_exudyn.pages.charts.style import NAME

TOLERANCE = 1.0  # [pixels]; a line of 1 point is 1.4 pixels wide at 100 pixels to an inch
TOUCHING = 0.12  # of the size of letters, by which the frames of lines of text may overlap
HALF_BLANK = 0.1  # of the size of letters, that is free beside a text
WIDEST = 9.5  # [in]; on a page, 7 inches wide, letters of 10 points are then 7 points high
SMALLEST = 0.2  # of the figure's area, that all its axes together have at least
BRACKETS = (("(", ")"), ("[", "]"), ("{", "}"))


def faults(canvas: FigureCanvasAgg, zooms: Mapping[int, str] | None = None) -> list[str]:
    """Return one sentence for each fault of a figure.

    Args:
        canvas: on which the figure was drawn.
        zooms: number of axes, from 0 on -> why they show a part of their data.
    """
    figure = canvas.figure
    found = [*_texts_over_texts(figure, canvas), *_texts_cut(figure, canvas), *_too_small(figure)]
    for number, axes in enumerate(figure.axes):
        if not (zooms and number in zooms):
            found += _data_outside(axes)
    return list(dict.fromkeys(found))


# --- texts -------------------------------------------------------------------------------------


def _texts(figure: Figure) -> list[Text]:
    """Every text that is drawn: of ticks only those within the view."""
    hidden = {text for axes in figure.axes for text in _hidden(axes)}
    return [
        text
        for text in figure.findobj(Text)
        if text.get_text().strip() and text.get_visible() and text not in hidden
    ]


def _hidden(axes: Axes) -> Iterator[Text]:
    """The texts of axes that are not drawn: of invisible axes all, of ticks those beyond the view."""
    if not axes.get_visible():
        yield from axes.findobj(Text)
    for axis in (axes.xaxis, axes.yaxis):
        if not axes.axison or not axis.get_visible():
            yield from axis.findobj(Text)
            continue
        low, high = sorted(axis.get_transform().transform(axis.get_view_interval()))
        margin = 1e-6 * (high - low)
        for tick in [*axis.get_major_ticks(), *axis.get_minor_ticks()]:
            if not low - margin <= axis.get_transform().transform(tick.get_loc()) <= high + margin:
                yield from (tick.label1, tick.label2)


def _texts_over_texts(figure: Figure, canvas: FigureCanvasAgg) -> Iterator[str]:
    boxes = [(text, _inner(text, canvas)) for text in _texts(figure)]
    for (one, its), (other, others) in combinations(boxes, 2):
        if its.overlaps(others):
            yield f"{_quoted(one)} and {_quoted(other)} lie over each other"


def _inner(text: Text, canvas: FigureCanvasAgg) -> Bbox:
    """The text's frame, without what lines leave above and below letters, and with half a blank beside it."""
    box, size = (
        text.get_window_extent(canvas.get_renderer()),
        float(text.get_fontsize()) * canvas.figure.dpi / 72,
    )
    above, beside = TOUCHING * size, HALF_BLANK * size
    if text.get_rotation() % 180 == 90:
        above, beside = -beside, -above
    middle = (box.y0 + box.y1) / 2
    low, high = min(box.y0 + above, middle), max(box.y1 - above, middle)
    return Bbox.from_extents(box.x0 - beside, low, box.x1 + beside, high)


def _texts_cut(figure: Figure, canvas: FigureCanvasAgg) -> Iterator[str]:
    for text in _texts(figure):
        box = text.get_window_extent(canvas.get_renderer())
        frame = figure.bbox
        clip = text.get_clip_box() if text.get_clip_on() else None
        if clip is not None:
            frame = Bbox.intersection(frame, clip) or frame
        over = max(frame.x0 - box.x0, box.x1 - frame.x1, frame.y0 - box.y0, box.y1 - frame.y1)
        if over > TOLERANCE:
            yield f"{_quoted(text)} is cut by {over:.0f} pixels"
        for opening, closing in BRACKETS:
            if text.get_text().count(opening) != text.get_text().count(closing):
                yield f"{_quoted(text)} is cut within {opening}{closing}"


def _quoted(text: Text) -> str:
    return repr(text.get_text() if len(text.get_text()) < 60 else f"{text.get_text()[:55]}...")


# --- data --------------------------------------------------------------------------------------


def _data_outside(axes: Axes) -> Iterator[str]:
    """Artists of which the axes cut a part off."""
    if not axes.get_visible():
        return
    for artist in axes.get_children():
        if not (artist.get_visible() and artist.get_clip_on()) or artist in _frame(axes):
            continue
        points = _points(artist)
        points = points[np.isfinite(points).all(axis=1)]
        if not points.size:
            continue
        low, high = points.min(axis=0), points.max(axis=0)
        box = axes.bbox
        over = max(*(box.min - low), *(high - box.max))
        if over > TOLERANCE:
            yield f"{_name(axes)}: {_kind(artist)} reaches {over:.0f} pixels beyond the axes"


def _frame(axes: Axes) -> tuple[Artist, ...]:
    return (axes.patch, *axes.spines.values())


def _points(artist: Artist) -> np.ndarray:
    """The points of an artist that belong to the data, in pixels, shape (n, 2)."""
    points: Any = np.empty((0, 2))
    if isinstance(artist, Line2D):
        points = artist.get_xydata()
    elif isinstance(artist, QuadMesh):
        points = np.asarray(artist.get_coordinates()).reshape(-1, 2)
    elif isinstance(artist, Collection) and _is_scattered(artist):
        return np.asarray(artist.get_offset_transform().transform(np.ma.filled(artist.get_offsets(), np.nan)))
    elif isinstance(artist, Collection):
        points = np.concatenate([points, *(np.asarray(path.vertices) for path in artist.get_paths())])
    elif isinstance(artist, Patch):
        points = artist.get_path().vertices
    elif isinstance(artist, AxesImage):
        left, right, bottom, top = artist.get_extent()
        points = np.array([[left, bottom], [right, top]])
        return np.asarray(artist.get_transform().transform(points))
    return np.asarray(artist.get_transform().transform(points)) if len(points) else np.empty((0, 2))


def _is_scattered(artist: Collection) -> bool:
    """Whether the data are where copies of its paths stand, as of dots, and not the paths themselves."""
    return len(np.ma.atleast_2d(artist.get_offsets())) > 0 and isinstance(artist, PathCollection)


def _kind(artist: Artist) -> str:
    label = str(artist.get_label())
    named = "" if label.startswith("_") or not label else f" {label!r}"
    return f"{type(artist).__name__}{named}"


def _name(axes: Axes) -> str:
    return " ".join((axes.get_ylabel() or axes.get_title(loc="left") or axes.get_xlabel() or "axes").split())


def _too_small(figure: Figure) -> Iterator[str]:
    width = figure.get_size_inches()[0]
    if width > WIDEST:
        yield f"the figure is {width:.3g} inches wide: on a page its letters are too small to be read"
    areas = [axes.bbox.width * axes.bbox.height for axes in figure.axes]
    share = sum(areas) / (figure.bbox.width * figure.bbox.height)
    if share < SMALLEST:
        yield f"all axes together have {100 * share:.0f} % of the figure's area"


def names_of(axes: Axes) -> list[str]:
    """Return the names beside the curves, from above, each in one line."""
    found = [each for each in axes.texts if each.get_gid() == NAME]
    found.sort(key=lambda each: -float(each.xy[1]))  # type: ignore[attr-defined]
    return [each.get_text().replace("\n", " ") for each in found]
