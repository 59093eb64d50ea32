"""From paths of studies and results to one HTML file."""

from collections.abc import Callable, Sequence
from pathlib import Path

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import PICTURES, replacing
from rps_exudyn.pages.report.html import Article, page
from rps_exudyn.pages.report.result_page import contact_section, gear_article, result_article, side_by_side
from rps_exudyn.pages.report.sheet_file import read_sheet, with_gear
from rps_exudyn.pages.report.study_page import study_article
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import Result
from rps_exudyn.study.case_blocks import beside, load
from rps_exudyn.study.store import Store

SUFFIXES = (".html", ".htm")
OTHERS = (
    *SUFFIXES,
    ".csv",
    ".gif",
    ".mp4",
    ".glb",
    ".stl",
)  # written by commands, without a page of their own


def write_report(
    paths: Sequence[str | Path],
    out: str | Path,
    contact: bool = False,
    on_progress: Callable[[int, int], None] = lambda done, of: None,
) -> None:
    """Write the page about studies (folders), results (.h5), sheets (.json) and gears (.toml).

    Args:
        paths: folders and files.
        out: the page.
        contact: adds loads and pattern of the contact to each result.
        on_progress: called with the number of paths that are drawn, and of all.

    Raises:
        InputError: a path that is neither, damaged, or of another format; or `out` cannot be written.
    """
    write_pages(_articles([Path(path) for path in paths], contact, on_progress), out)


def write_pages(articles: Sequence[Article], out: str | Path) -> None:
    """Write the page of these articles.

    Raises:
        InputError: `out` cannot be written.
    """
    text = page(" · ".join(article.title for article in articles), articles)
    with replacing(out) as partial:
        partial.write_text(text, encoding="utf-8", errors="replace")


def default_name(paths: Sequence[Path]) -> Path:
    """The default path of the report: in a study's folder, beside a result, or in the current folder."""
    if len(paths) > 1:
        return Path("report.html")
    (path,) = paths
    if path.name == "study.json":
        path = path.parent
    return path / "report.html" if path.is_dir() else beside(path, f"{path.stem}.html")


def _articles(paths: Sequence[Path], contact: bool, on_progress: Callable[[int, int], None]) -> list[Article]:
    """The articles; all paths are opened before anything is drawn, so that all mistakes are reported."""
    problems: list[str] = []
    opened: dict[Path, Store | Result | Article] = {}
    for path in paths:
        try:
            opened[path] = _opened(path)
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    results = {path: content for path, content in opened.items() if isinstance(content, Result)}
    articles = [side_by_side(results)] if len(results) > 1 else []
    for done, (path, content) in enumerate(opened.items()):
        on_progress(done, len(opened))
        if isinstance(content, Store):
            content = study_article(content)
        elif isinstance(content, Result):
            article = result_article(content, path, [contact_section(content)] if contact else [])
            content = with_gear(article, content.gear, content)
        articles.append(content)
    return articles


def _opened(path: Path) -> Store | Result | Article:
    """What a command has written.

    Raises:
        InputError: nothing of which there is a page.
    """
    if path.is_dir() or path.name == "study.json":
        return Store.open(path if path.is_dir() else path.parent)
    match path.suffix.lower():
        case ".json":
            return read_sheet(path)
        case ".toml":
            gear = SteeringGear.from_toml(path)
            return with_gear(gear_article(gear, path), gear)
        case suffix if suffix in PICTURES or suffix in OTHERS:
            raise InputError(
                f"{path} is a {suffix} file; report takes folders of studies, results (.h5), sheets (.json) "
                "and gears (.toml)."
            )
    return load(path)
