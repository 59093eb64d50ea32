"""From articles to one HTML page without fonts or requests; the only script that it lets run is page.js."""

import base64
import hashlib
from collections.abc import Sequence
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from rps_exudyn.report.blocks import Article

_FOLDER = Path(__file__).parent


def page(title: str, articles: Sequence[Article]) -> str:
    """The page as HTML; all text is escaped except the SVG of pictures, which this package draws."""
    environment = Environment(
        loader=FileSystemLoader(_FOLDER),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    css = (_FOLDER / "page.css").read_text(encoding="utf-8")
    script = (_FOLDER / "page.js").read_text(encoding="utf-8")
    digest = hashlib.sha256(script.encode()).digest()
    return environment.get_template("page.html").render(
        title=title,
        articles=articles,
        css=css,
        script=script,
        script_hash=f"sha256-{base64.b64encode(digest).decode()}",
    )
