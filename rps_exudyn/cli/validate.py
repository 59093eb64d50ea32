"""The command `validate`: rows of data from outside against this package, on one page."""

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable, write_json
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import All, Flag, Jobs, Json
from rps_exudyn.cli.output import (
    DONE,
    QUIET_ALONE,
    command_line,
    naming,
    print_files,
    print_json,
    printing,
    put,
    put_table,
)

if TYPE_CHECKING:
    from rps_exudyn.assessment.validation.compared_rows import ComparedRow

DATA, PICTURE = ".json", ".png"  # beside the page


def validate(
    rows: Path | None = None,
    /,
    *,
    only: tuple[str, ...] = (),
    out: Path | None = None,
    jobs: Jobs = None,
    every: All = False,
    quiet: Flag = False,
    json: Json = False,
) -> int:
    """Compare the package with manuals, standards, other programs and closed forms.

    Args:
        rows: Folder of rows, each a folder with a row.toml; default: the rows of the package.
        only: Name of a row; only named rows are run; may be repeated.
        out: Page (.html), with data (.json) and picture (.png) beside it; default: validation.html.
        quiet: Print only errors.
    """
    if quiet and (every or json):
        raise InputError(QUIET_ALONE)
    from rps_exudyn.assessment.validation.compared_rows import compare_rows
    from rps_exudyn.assessment.validation.row import SHIPPED, read_rows
    from rps_exudyn.assessment.validation.validation_page import validation_article, validation_figure
    from rps_exudyn.cli.printed import print_sheet
    from rps_exudyn.pages.charts.style import save
    from rps_exudyn.pages.report.sheet_file import KEY, sheet_as_dict
    from rps_exudyn.pages.report.write_report import write_pages
    from rps_exudyn.results.provenance import provenance
    from rps_exudyn.simulate.cases.run_cases import checked_jobs

    found = read_rows(rows or SHIPPED)
    if unknown := set(only) - {row.name for row in found}:
        known = ", ".join(row.name for row in found)
        raise InputError(f"there is no row {', '.join(sorted(unknown))}; there are {known}.")
    out = check_writable(out or Path("validation.html"), (".html",))
    chosen = [row for row in found if not only or row.name in only]
    with printing(quiet), shown_progress() as show:

        def report(done: int, of: int) -> None:
            show(f"procedure {done} of {of}", done / of)

        comparisons = compare_rows(chosen, report, checked_jobs(jobs))
    content = {"origin": provenance(), "rows": [each.as_dict() for each in comparisons]}
    article = validation_article(comparisons, command_line())
    files: list[Path] = []
    with printing(quiet), naming(files):
        write_json(out.with_suffix(DATA), content | {KEY: sheet_as_dict(article)})
        files.append(out.with_suffix(DATA))
        write_pages([article], out)
        files.append(out)
        save(validation_figure(comparisons), out.with_suffix(PICTURE))
        files.append(out.with_suffix(PICTURE))
        if json:
            print_json(content | {"files": [str(file) for file in files]})
        elif every:
            _print(comparisons, files)
        else:
            print_sheet(article.sheet, files, "every row")
    return DONE


def _print(comparisons: "list[ComparedRow]", files: list[Path]) -> None:
    from rps_exudyn.assessment.validation.validation_page import COLUMNS, row_cells

    put_table(COLUMNS, [tuple(row_cells(each)) for each in comparisons])
    counts = Counter(each.verdict.value for each in comparisons)
    put(", ".join(f"{count} {verdict}" for verdict, count in counts.items()) + ".", "bold")
    print_files(files)
