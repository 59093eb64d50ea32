"""Charts as SVG inside a page: text remains text, and identifiers are unique among the pictures."""

import hashlib
import io
import re
import warnings

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.text import Text as Words

from rps_exudyn.report.blocks import Picture

_NO_METADATA = {"Creator": None, "Date": None, "Format": None, "Type": None}


def picture(figure: Figure, caption: str) -> Picture:
    """The figure as a part of a page; the same figure gives the same text."""
    for words in figure.findobj(Words):
        words.set_parse_math(False)  # a dollar in a name is a dollar
    text = io.StringIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "report"}), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # glyphs that the font of the layout lacks: the browser has others
        figure.savefig(text, format="svg", metadata=_NO_METADATA)
    return Picture(_for_a_page(text.getvalue()), caption, figure.get_size_inches()[0])


def _for_a_page(svg: str) -> str:
    """The svg element alone, as wide as its place, with only the ids to which it refers itself."""
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>\s*|<style.*?</style>\s*", "", svg, flags=re.S)
    svg = re.sub(r'^(<svg\b[^>]*?) width="[^"]*"', r"\1", svg)
    svg = re.sub(r'^(<svg\b[^>]*?) height="[^"]*"', r"\1", svg)
    svg = re.sub(r' (?:x|y|d)="[^"]*"', _to_hundredths, svg)
    used = set(re.findall(r'(?:href="#|url\(#)([^")]+)', svg))
    mark = hashlib.sha256(svg.encode(errors="replace")).hexdigest()[:8]  # no other picture's
    svg = re.sub(r'(href="#|url\(#)', rf"\g<1>{mark}", svg)
    return re.sub(r' id="([^"]*)"', lambda found: f' id="{mark}{found[1]}"' if found[1] in used else "", svg)


def _to_hundredths(coordinates: re.Match[str]) -> str:
    """Round to hundredths of a point (1/72 inch): more digits are invisible and double the page's size."""
    return re.sub(r"(\.\d\d)\d+", r"\1", coordinates[0])
