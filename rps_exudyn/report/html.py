"""Articles -> one HTML page that needs nothing else: no script, no font, no request."""

from collections.abc import Sequence
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from rps_exudyn.report.blocks import Article

_FOLDER = Path(__file__).parent


def page(title: str, articles: Sequence[Article]) -> str:
    """The page; all text is escaped, only pictures (drawn by this package) stand as they are."""
    environment = Environment(
        loader=FileSystemLoader(_FOLDER),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    css = (_FOLDER / "page.css").read_text(encoding="utf-8")
    return environment.get_template("page.html").render(title=title, articles=articles, css=css)
