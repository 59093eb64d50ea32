"""One look for all charts: sizes, colours by meaning, axes with units, and how a picture is saved."""

import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.ticker import Locator, MaxNLocator, StrMethodFormatter
from PIL import Image

from rps_exudyn.base.files import PICTURES, check_writable, replacing
from rps_exudyn.base.units import mm
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import SIGNALS, Quantity
from rps_exudyn.results.result import Result
from rps_exudyn.results.rounding import rounded_metric
from rps_exudyn.scenes import is_scene, scene_named

PART_COLOURS = {
    "mesh": "#E69F00",
    "seat": "#0072B2",
    "bush": "#009E73",
    "bearing": "#CC79A7",
    "column": "#56B4E9",
    "rack": "#AEB6BF",
}
"""Part where work is lost -> its colour in every picture and page (Okabe and Ito's; the rack's is grey)."""

COLOURS = {
    "torque": "#1B1F24",
    "other": "#0072B2",
    "lift": "#59616B",
    "roll": "#59616B",
    "reference": "#747D88",
    "failure": "#B84A00",
    "forward": "#1B1F24",
    "backward": "#454D57",
    "measured": "#59616B",
    **PART_COLOURS,
}
"""Colours by meaning: ink is the simulation, vermilion a limit that is not kept, the others are parts'."""

DASHES = {"backward": (0, (4, 1.5))}
"""Colour of a direction -> its dashes, which survive grey print."""

SEVERAL = ("#1B1F24", "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9")
"""Colours of curves that only the legend distinguishes."""

_LOOK: Any = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.formatter.useoffset": False,
    "grid.color": "#e4e4e4",
    "lines.linewidth": 1.4,
}

NAME_COLOURS = {
    "mesh": ("#8A5F00", "#F0B434"),
    "seat": ("#00629A", "#67B5E8"),
    "bush": ("#00744F", "#35C79D"),
    "bearing": ("#9C3F73", "#E3A3C5"),
}
"""Part -> the colours of its name on a light and on a dark ground."""
TEXT_COLOURS = {PART_COLOURS[part]: light for part, (light, _) in NAME_COLOURS.items()}
"""Colour of a curve -> the darker one of its name."""

THEME = {
    "page": ("#fff", "#14171B"),
    "ink": (COLOURS["torque"], "#ECEEF1"),
    "faint": (COLOURS["lift"], "#A4ACB6"),
    "line": ("#E3E6EA", "#2B3138"),
    "accent": NAME_COLOURS["seat"],
    "failure": (COLOURS["failure"], "#FF8A3C"),
    "soft": ("#f4f5f6", "#1d2228"),
    "alarm": ("#fbf1ea", "#2c211a"),
    "series": ("#8B939D", COLOURS["reference"]),
    **{part: (colour, colour) for part, colour in PART_COLOURS.items()},
    **{f"{part}-text": colours for part, colours in NAME_COLOURS.items()},
}
"""Name of a colour in style sheets -> it on a light and on a dark screen."""

REFERENCE_LINE: Any = {"color": COLOURS["reference"], "linewidth": 1, "linestyle": "--", "zorder": 1}

NUMBERS, LABEL_LINE = 0.7, 0.17  # widths at an ordinate, of its numbers and of a line of its label [in]
ABSCISSA, GAP, EDGE = 0.46, 0.1, 0.06  # below a panel with a label, around others, of the picture [in]
LETTERS = 12.5  # of a headline in an inch
LINE_HEIGHT = 0.2  # of a sentence over the axes [in]
POINTS = 72  # to an inch
FAILURE = "failure"  # mark of the text about it
NAME, NAME_SIZE, NAME_LETTERS = "name", 9, 20  # mark and size of a curve's name, letters of its lines
NAME_LINE, NAME_GAP = 0.16, 0.35  # height of a line of it [in], and its distance to the next in lines
NAMES_FROM = 6.0  # narrower pictures have no room for names beside curves [in]
LETTER, LEGEND_MARK = 0.075, 0.6  # width of a letter, and of a line with its gaps, in legends [in]
TICK_LETTER = 0.11  # width of a letter of a number on an axis, with its part of the gap beside it [in]

ROOM_FOR_NOTE = 0.1  # below the data, of the ordinate
NOT_ZERO = "axis does not begin at 0"

DPI = 150  # pixels to an inch in pictures of pixels
COMPRESSION = 1  # of pixels, of 9: a third of the default's time for a tenth more bytes

BAND: Any = {"color": COLOURS["reference"], "alpha": 0.15, "linewidth": 0, "zorder": 0}


def theme() -> str:
    """The beginning of the style sheets of report and explorer: their colours, as variables."""
    light, dark = (" ".join(f"--{name}: {each[k]};" for name, each in THEME.items()) for k in (0, 1))
    at_night = f"@media screen and (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}"
    return f":root {{ color-scheme: light dark; {light} }}\n{at_night}\n"


def panels(
    heights: list[float], width: float = 8.0, *, common_abscissa: bool = True
) -> tuple[Figure, list[Axes]]:
    """A figure of panels one below the other, by default with a common abscissa, and their axes; sizes in
    inches."""
    with mpl.rc_context(_LOOK):
        figure = Figure(figsize=(width, sum(heights)), layout="constrained")
        rows = figure.subplots(len(heights), sharex=common_abscissa, squeeze=False, height_ratios=heights)
    figure.align_ylabels(rows)
    return figure, list(rows[:, 0])


def line(
    axes: Axes,
    x: np.ndarray,
    y: np.ndarray,
    quantity: Quantity,
    name: str,
    colour: str,
    label: str | None = None,
) -> None:
    """Draw one signal over x (display unit), shape (n,) both; y is SI and drawn in its display unit.

    `name` is for the axis, `label` for the legend.
    """
    look: Any = {"linestyle": DASHES.get(colour, "-"), "linewidth": _LOOK["lines.linewidth"]}
    axes.plot(x, quantity.displayed(y), label=label, color=COLOURS[colour], **look)
    axes.set_ylabel(quantity.axis_label(name))


def thinned(count: int, most: int) -> slice:
    """Which of so many points are drawn: every n-th, at most about `most`."""
    return slice(None, None, max(1, -(-count // most)))


def name_curves(axes: Axes) -> None:
    """Write the name of each curve and band beside its right end; above the axes where they are too many or
    the picture is narrow."""
    figure = axes.figure.get_figure(root=True)
    _remove_names(axes)
    handles, labels = axes.get_legend_handles_labels()
    named = [textwrap.wrap(label, NAME_LETTERS, break_on_hyphens=False) for label in labels]
    line = NAME_LINE / (axes.get_position().height * figure.bbox_inches.height)  # of the axes' height
    heights = np.array([line * (len(lines) + NAME_GAP) for lines in named])
    if not labels or figure.bbox_inches.width < NAMES_FROM or heights.sum() > 1:
        legend_above(axes)
        return
    ends = np.array([_end_of(axes, handle) for handle in handles])
    order = np.argsort(-ends, kind="stable")
    beside: Any = {"xycoords": "axes fraction", "xytext": (6, 0), "textcoords": "offset points"}
    beside |= {"va": "center", "fontsize": NAME_SIZE, "annotation_clip": False}
    for k, place in zip(order, _spread(ends[order], heights[order]), strict=True):
        drawn = handles[k].get_color() if hasattr(handles[k], "get_color") else COLOURS["reference"]
        colour = to_hex(drawn).upper()
        colour = TEXT_COLOURS.get(colour, colour)
        text = axes.annotate("\n".join(named[k]), (1, place), color=colour, **beside)
        text.set_gid(NAME)
        text.set_parse_math(False)


def _remove_names(axes: Axes) -> None:
    for text in [each for each in axes.texts if each.get_gid() == NAME]:
        text.remove()
    if (legend := axes.get_legend()) is not None:
        legend.remove()


def _end_of(axes: Axes, handle: Any) -> float:
    """Height of a curve's or band's right end, over the axes' height."""
    points = np.empty((0, 2))
    transform = handle.get_transform() if hasattr(handle, "get_transform") else axes.transData
    if hasattr(handle, "get_xydata"):
        points = handle.get_xydata()
    elif hasattr(handle, "get_offsets") and len(handle.get_offsets()) > 1:
        transform, points = axes.transData, np.asarray(handle.get_offsets())
    elif hasattr(handle, "get_paths") and handle.get_paths():
        points = handle.get_paths()[0].vertices
    elif hasattr(handle, "get_path"):
        points = handle.get_path().vertices
    points = transform.transform(points)
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        return 0.0
    last = points[points[:, 0] > points[:, 0].max() - 1.0]
    middle = (0.0, (last[:, 1].min() + last[:, 1].max()) / 2)
    return float(np.clip(axes.transAxes.inverted().transform(middle)[1], 0.0, 1.0))


def _spread(places: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """Middles of texts of these heights that do not overlap, near falling places, all from 0 to 1."""
    found, top, bottom = places.copy(), 1.0, 0.0
    for k, half in enumerate(heights / 2):
        found[k] = min(found[k], top - half)
        top = found[k] - half
    for k, half in reversed(list(enumerate(heights / 2))):
        found[k] = max(found[k], bottom + half)
        bottom = found[k] + half
    return found


def legend_above(axes: Axes) -> None:
    """Put the legend over the axes, where it hides no curve, in as many columns as have room; none without
    labels."""
    _remove_names(axes)
    if labels := axes.get_legend_handles_labels()[1]:
        width = axes.figure.get_figure(root=True).bbox_inches.width
        longest = max(len(label) for label in labels)
        columns = max(1, min(4, int(width / (LEGEND_MARK + LETTER * longest))))
        look: Any = {"borderpad": 0, "frameon": False}
        legend = axes.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=columns, **look)
        for text in legend.get_texts():
            text.set_parse_math(False)  # a dollar in a name is a dollar


def angle_axis(axes: Axes) -> None:
    """Make the pinion angle [deg] the common abscissa, with ticks that suit turns and teeth."""
    axes.set_xlabel(SIGNALS["pinion_angle"].axis_label("pinion angle"))
    low, high = axes.dataLim.intervalx
    steps = [1, 1.8, 3.6, 9, 10] if high - low > 400 else [1, 1.5, 3, 6, 10]
    axes.xaxis.set_major_locator(MaxNLocator(nbins=9, steps=steps))
    for each in axes.get_shared_x_axes().get_siblings(axes):
        each.margins(x=0)


class _SignedDecades(Locator):
    """Ticks at 0 and at powers of ten of both signs: as many as have room for their labels."""

    def __init__(self, linear: float) -> None:
        self.linear = linear

    def __call__(self) -> Any:
        view, transform = np.array(self.axis.get_view_interval()), self.axis.get_transform()  # type: ignore[union-attr]
        box = self.axis.axes.bbox  # type: ignore[union-attr]
        pixels = box.width / np.ptp(transform.transform(view))
        letter = TICK_LETTER * self.axis.get_figure(root=True).dpi  # type: ignore[union-attr]
        largest = max(self.linear, np.abs(view).max())
        kept = [0.0]
        for power in 10.0 ** np.arange(np.log10(self.linear), np.log10(largest) + 1e-9):
            apart = pixels * float(np.diff(transform.transform(np.array([kept[-1], power])))[0])
            if apart >= letter * (len(f"-{power:g}") + len(f"-{kept[-1]:g}")) / 2:
                kept.append(power)
        return np.array([*(-each for each in reversed(kept[1:])), *kept])


def signed_decades(axes: Axes, linear: float) -> None:
    """Make the abscissa logarithmic in both directions, and linear up to `linear`, a power of ten."""
    axes.set_xscale("symlog", linthresh=linear, linscale=0.5)
    axes.xaxis.set_major_locator(_SignedDecades(linear))
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))


def name_directions(axes: Axes, named: dict[str, str]) -> None:
    """Label the first curve of each direction; `named` is colour -> its name in the legend."""
    for colour, name in named.items():
        curves = [curve for curve in axes.lines if curve.get_color() == COLOURS[colour]]
        if curves:
            curves[0].set_label(name)
    name_curves(axes)


def abscissa(axes: Axes, label: str) -> None:
    """Label another common abscissa than the angle, for instance "time [ms]", and limit it to the data."""
    axes.set_xlabel(label)
    low, high = axes.dataLim.intervalx
    if np.isfinite([low, high]).all() and low < high:
        axes.set_xlim(low, high)


def title(figure: Figure, headline: str, failure: str = "") -> None:
    """Write what the picture shows and, in the colour of failure, why not to trust it.

    The failure stands above the legend of the first axes, and the figure grows by its lines.
    """
    width = round(LETTERS * figure.get_size_inches()[0])
    lines = [_wrapped(line, width) for line in headline.split("\n")]
    figure.suptitle("\n".join(lines), x=0.01, ha="left", fontsize=11).set_parse_math(False)
    if failure:
        said = textwrap.wrap(failure, width=width)
        axes = figure.axes[0]
        look: Any = {"loc": "left", "fontsize": 10, "color": COLOURS["failure"]}
        text = axes.set_title("\n".join(said), pad=6 + POINTS * _height_of_legend(axes), **look)
        text.set_gid(FAILURE)
        text.set_parse_math(False)
        _heighten(figure, LINE_HEIGHT * len(said))


def fix_margins(figure: Figure) -> None:
    """Place the panels with margins for their texts, in a fraction of the time of matplotlib's own layouts,
    which measure every text and every number twice."""
    renderer, (width, height) = FigureCanvasAgg(figure).get_renderer(), figure.get_size_inches()
    figure.set_layout_engine(None)
    top, lines, beside, rooms = height - EDGE, 1, 0.2, []
    for text in figure.texts:
        text.set_y(top / height)
        top -= LINE_HEIGHT * (text.get_text().count("\n") + 1)
    for axes in figure.axes:
        lines = max(lines, axes.get_ylabel().count("\n") + 1)
        names = [each.get_window_extent(renderer).width for each in axes.texts if each.get_gid() == NAME]
        beside = max(beside, max(names, default=0.0) / figure.dpi + 6 / POINTS + EDGE)
        title = axes.get_title(loc="left")
        over = GAP + _height_of_legend(axes) + LINE_HEIGHT * (title.count("\n") + 1) * bool(title)
        rooms.append((over, ABSCISSA if axes.get_xlabel() else GAP))
    left, free = NUMBERS + LABEL_LINE * lines, top - float(np.sum(rooms))
    shares = [axes.get_position().height for axes in figure.axes]
    for axes, (above, below), share in zip(figure.axes, rooms, shares, strict=True):
        tall = free * share / sum(shares)
        top -= above + tall
        axes.set_position((left / width, top / height, 1 - (left + beside) / width, tall / height))
        for failure in axes.findobj(lambda each: each.get_gid() == FAILURE):
            failure.set(x=(EDGE - left) / (width - left - beside))  # below the headline
        top -= below


def footnote(figure: Figure, sentences: Sequence[str]) -> None:
    """Write sentences below everything, in the colour of failure; the figure grows by their lines."""
    width = round(LETTERS * figure.get_size_inches()[0])
    said = [line for sentence in sentences for line in textwrap.wrap(sentence, width=width)]
    text = figure.supxlabel("\n".join(said), x=0.01, ha="left", fontsize=9, color=COLOURS["failure"])
    text.set_parse_math(False)
    _heighten(figure, LINE_HEIGHT * len(said))


def _heighten(figure: Figure, by: float) -> None:
    figure.set_figheight(figure.get_figheight() + by)


def _height_of_legend(axes: Axes) -> float:
    """Height of the legend over the axes [in]; 0 without one."""
    legend, figure = axes.get_legend(), axes.figure.get_figure(root=True)
    if legend is None:
        return 0.0
    return float(legend.get_window_extent(FigureCanvasAgg(figure).get_renderer()).height / figure.dpi)


def _wrapped(headline: str, width: int) -> str:
    """The headline in lines of so many letters, broken between its parts, and within longer ones."""
    parts = [part if len(part) > width else part.replace(" ", "\xa0") for part in headline.split(" · ")]
    broken = textwrap.fill("\xa0· ".join(parts), width=width, break_on_hyphens=False)
    return broken.replace("\xa0", " ").replace(" ·\n", "\n")


def widen(axes: Axes, least: float) -> None:
    """Widen the ordinate to at least this span (display unit): rounding must not look like a signal."""
    low, high = axes.get_ylim()
    if high - low < least:
        middle = (low + high) / 2
        axes.set_ylim(middle - least / 2, middle + least / 2)


def from_zero(axes: Axes) -> None:
    """Let the ordinate begin, or end, at zero."""
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, 0.0), max(high, 0.0))


def tell_where_it_begins(axes: Axes) -> None:
    """Mark at the ordinate's foot, below all data, that it does not begin at zero, if so."""
    low, high = axes.get_ylim()
    if low > 0 or high < 0:
        room = ROOM_FOR_NOTE * (high - low)
        axes.set_ylim(low - room if high < 0 else max(low - room, low / 2), high)
        at = axes.transAxes
        axes.text(0.005, 0.015, NOT_ZERO, transform=at, fontsize=10, color=COLOURS["reference"])


def save(figure: Figure, path: str | Path) -> None:
    """Write the picture in the format of the path's suffix.

    Raises:
        InputError: the file cannot be written, or has another suffix.
    """
    check_writable(path, PICTURES)
    with replacing(path) as partial:
        if partial.suffix == ".png":
            _save_pixels(figure, partial)
        else:
            figure.savefig(partial, dpi=DPI)


def _save_pixels(figure: Figure, path: Path) -> None:
    """Draw once, and keep no transparency: matplotlib's own `savefig` draws a figure with a layout twice, for
    the same pixels."""
    dpi, canvas = figure.dpi, figure.canvas
    figure.set_dpi(DPI)
    try:
        drawn = FigureCanvasAgg(figure)
        drawn.draw()
        pixels = Image.fromarray(np.asarray(drawn.buffer_rgba())[..., :3])
        pixels.save(path, "PNG", compress_level=COMPRESSION, dpi=(DPI, DPI))
    finally:
        figure.set_dpi(dpi)
        figure.set_canvas(canvas)


# --- Headline of a result's picture: scene and its figures, the gear, and its failure in words


def head(figure: Figure, result: Result, subject: str, figures: Mapping[str, str]) -> None:
    """Write the headline; `figures` are names -> labels of the summary, as far as it has them."""
    known = {name: label for name, label in figures.items() if name in result.summary}
    parts = [subject, *(f"{label} {rounded_metric(result, name)}" for name, label in known.items())]
    failure = "" if result.status is Status.OK else f"{result.status}: {result.message}"
    title(figure, f"{' · '.join(parts)}\n{about(result)}", failure)


def scene_of(result: Result) -> str:
    """The scene's name in words, for instance "Load test"."""
    return result.scene.replace("-", " ").capitalize()


def about(result: Result) -> str:
    """What was simulated in one line: gear, preload, speed where there is one, fidelity."""
    gear = result.gear
    size = f"{gear.pinion.teeth} teeth, module {mm(gear.pinion.normal_module)}"
    parts = [size, f"preload {gear.yoke.preload:g} N"]
    if not is_scene(result.scene) or scene_named(result.scene).at_test_speed:
        parts.append(next(item for item in SteeringGear.declared_at("test.speed")).show(gear.test.speed))
    return " · ".join([*parts, f"fidelity {result.fidelity['name']}"])
