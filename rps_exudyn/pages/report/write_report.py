"""From paths of studies and results to one HTML file."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import PICTURES
from rps_exudyn.pages.report.html import write_page
from rps_exudyn.pages.report.result_page import contact_section, gear_page, result_page, side_by_side
from rps_exudyn.pages.report.sheet_file import FOLDER_SHEET, read_sheet
from rps_exudyn.pages.report.study_page import study_page
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import Result
from rps_exudyn.results.sheet import Sheet
from rps_exudyn.study.case_blocks import beside, load
from rps_exudyn.study.store import Store

SUFFIXES = (".html", ".htm")
OTHERS = (*SUFFIXES, ".csv", ".gif", ".mp4", ".glb", ".stl")  # written by commands, without a page


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
    problems: list[str] = []
    opened: dict[Path, Store | Result | Sheet] = {}
    for path in map(Path, paths):  # all of them before anything is drawn, so that all mistakes are reported
        try:
            opened[path] = _opened(path)
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    write_page(_sheets(opened, contact, on_progress), out)


def _sheets(
    opened: Mapping[Path, Store | Result | Sheet], contact: bool, on_progress: Callable[[int, int], None]
) -> Iterator[Sheet]:
    results = {path: content for path, content in opened.items() if isinstance(content, Result)}
    if len(results) > 1:
        yield side_by_side(results)
    for done, (path, content) in enumerate(opened.items()):
        on_progress(done, len(opened))
        if isinstance(content, Store):
            yield study_page(content)
        elif isinstance(content, Result):
            yield result_page(content, path, [contact_section(content)] if contact else [])
        else:
            yield content


def default_name(paths: Sequence[Path]) -> Path:
    """The default path of the report: in a study's folder, beside a result, or in the current folder."""
    if len(paths) > 1:
        return Path("report.html")
    (path,) = paths
    if path.name == "study.json":
        path = path.parent
    return path / "report.html" if path.is_dir() else beside(path, f"{path.stem}.html")


def _opened(path: Path) -> Store | Result | Sheet:
    """What a command has written.

    Raises:
        InputError: nothing of which there is a page.
    """
    if path.is_dir() or path.name == "study.json":
        folder = path if path.is_dir() else path.parent
        sheet = folder / FOLDER_SHEET
        return read_sheet(sheet) if sheet.exists() else Store.open(folder)
    match path.suffix.lower():
        case ".json":
            return read_sheet(path)
        case ".toml":
            return gear_page(SteeringGear.from_toml(path), path)
        case suffix if suffix in PICTURES or suffix in OTHERS:
            raise InputError(
                f"{path} is a {suffix} file; report takes folders of studies, results (.h5), sheets (.json) "
                "and gears (.toml)."
            )
    return load(path)
