"""Charts as SVG inside a page: text remains text, and identifiers are unique among the pictures.

Curves keep a number, and the picture holds where its axes stand: page.js reads values from the paths.
"""

import hashlib
import io
import json
import re
import warnings
from collections.abc import Callable, Mapping
from dataclasses import replace
from html import escape
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text as Words

from rps_exudyn.results.page_blocks import Picture

_NO_METADATA = {"Creator": None, "Date": None, "Format": None, "Type": None}
POINTS_PER_INCH = 72  # units of matplotlib's SVG
CURVE = "curve-"
WIDTHS = {"wide-only": 9.5, "narrow": 5.2}  # of curves on wide and narrow screens [in]


def picture(figure: Figure, caption: str, links: Mapping[str, tuple[str, str]] | None = None) -> Picture:
    """The figure as a part of a page; the same figure gives the same text.

    `links` are label of a curve -> id that the curve gets, id of the row to which it leads.
    """
    for ground in (figure.patch, *(axes.patch for axes in figure.axes)):
        ground.set_alpha(0.0)  # the page's own, light or dark
    for words in figure.findobj(Words):
        words.set_parse_math(False)  # a dollar in a name is a dollar
    curves = {axes: curves_of(axes) for axes in figure.axes}
    numbered = [line for lines in curves.values() for line in lines]
    for number, line in enumerate(numbered):
        line.set_gid(f"{CURVE}{number}")
    text = io.StringIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "report"}), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # glyphs that the font of the layout lacks: the browser has others
        figure.savefig(text, format="svg", metadata=_NO_METADATA)
    ids = {}
    if links:
        ids = {number: links[str(line.get_label())][0] for number, line in enumerate(numbered)}
    places = [
        axes_of(axes, figure.get_size_inches(), {numbered.index(line): line for line in lines}, links or {})
        for axes, lines in curves.items()
        if lines
    ]
    svg, width = _for_a_page(text.getvalue(), ids), figure.get_size_inches()[0]
    return Picture(svg, caption, width, axes=json.dumps(places) if places else "")


def at_widths(draw: Callable[[float], Figure | None], caption: str) -> list[Picture]:
    """What `draw` makes of a width [in], for wide and narrow screens; nothing where it makes no picture."""
    figures = {place: draw(width) for place, width in WIDTHS.items()}
    return [replace(picture(each, caption), place=place) for place, each in figures.items() if each]


def curves_of(axes: Axes) -> list[Line2D]:
    """Lines over the axes' data: no dots, no lines of reference across the axes."""
    return [
        line
        for line in axes.lines
        if line.get_transform() == axes.transData
        and line.get_linestyle() not in ("None", "none", "", " ")
        and np.size(line.get_xdata()) > 2
    ]


def axes_of(
    axes: Axes, size: np.ndarray, curves: Mapping[int, Line2D], links: Mapping[str, tuple[str, str]]
) -> dict[str, Any]:
    """Place of drawn axes in units of the SVG, their scales, names and units, and the curves by number.

    `size` is the figure's [in].
    """
    width, height = (POINTS_PER_INCH * size).tolist()
    place = axes.get_position()
    box = place.x0 * width, (1 - place.y1) * height, place.x1 * width, (1 - place.y0) * height
    labels = {number: str(line.get_label()) for number, line in curves.items()}
    name, unit = name_and_unit(axes.get_ylabel())
    along, unit_along = name_and_unit(axes.get_xlabel())
    return {
        "box": [round(float(each), 2) for each in box],
        "x": [float(each) for each in axes.get_xlim()],
        "y": [float(each) for each in axes.get_ylim()],
        "log": [axes.get_xscale() == "log", axes.get_yscale() == "log"],
        "along": {"name": along, "unit": unit_along},
        "across": {"name": name or axes.get_title(loc="left"), "unit": unit},
        "curves": [
            {"number": number, "label": "" if label.startswith("_") else label}
            | ({"to": links[label][1]} if label in links else {})
            for number, label in labels.items()
        ],
    }


def name_and_unit(label: str) -> tuple[str, str]:
    """Split the label of an axis, for instance "pinion angle [deg]"."""
    found = re.fullmatch(r"(.*?)\s*\[(.+)\]", label.replace("\n", " "))
    return (found[1], found[2]) if found else (label, "")


def _for_a_page(svg: str, ids: Mapping[int, str]) -> str:
    """The svg element alone, as wide as its place, with only the ids to which it refers itself and `ids` of
    curves by their number."""
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>\s*|<style.*?</style>\s*", "", svg, flags=re.S)
    svg = re.sub(r'^(<svg\b[^>]*?) width="[^"]*" height="[^"]*"', r"\1", svg)
    # To hundredths of a point: more digits are invisible and double the page's size
    svg = re.sub(r' (?:x|y|d)="[^"]*"', lambda found: re.sub(r"(\.\d\d)\d+", r"\1", found[0]), svg)
    used = set(re.findall(r'(?:href="#|url\(#)([^")]+)', svg))
    mark = hashlib.sha256(svg.encode(errors="replace")).hexdigest()[:8]  # no other picture's
    svg = re.sub(r'(href="#|url\(#)', rf"\g<1>{mark}", svg)

    def kept(found: re.Match[str]) -> str:
        if found[1] in used:
            return f' id="{mark}{found[1]}"'
        if not found[1].startswith(CURVE):
            return ""
        number = int(found[1].removeprefix(CURVE))
        own = f' id="{escape(ids[number])}"' if number in ids else ""
        return f' data-curve="{number}"{own}'

    return re.sub(r' id="([^"]*)"', kept, svg)
