"""The command `validate`: rows of data from outside against this package, on one page."""

from pathlib import Path

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import HEAD_ALONE, Jobs, Printing
from rps_exudyn.cli.output import DONE, command_line, naming, present, printing

DATA, PICTURE = ".json", ".png"  # beside the page


def validate(
    rows: Path | None = None,
    /,
    *,
    only: tuple[str, ...] = (),
    out: Path | None = None,
    jobs: Jobs = None,
    shown: Printing = HEAD_ALONE,
) -> int:
    """Compare the package with manuals, standards, other programs and closed forms.

    Args:
        rows: Folder of rows, each a folder with a row.toml; default: the rows of the package.
        only: Name of a row; only named rows are run; may be repeated.
        out: Page (.html), with data (.json) and picture (.png) beside it; default: validation.html.
    """
    shown.check()
    from rps_exudyn.assessment.validation.compared_rows import compare_rows
    from rps_exudyn.assessment.validation.row import SHIPPED, read_rows
    from rps_exudyn.assessment.validation.validation_page import validation_figure, validation_page
    from rps_exudyn.pages.charts.style import save
    from rps_exudyn.pages.report.sheet_file import write_sheet
    from rps_exudyn.simulate.cases.run_cases import checked_jobs

    found = read_rows(rows or SHIPPED)
    if unknown := set(only) - {row.name for row in found}:
        known = ", ".join(row.name for row in found)
        raise InputError(f"there is no row {', '.join(sorted(unknown))}; there are {known}.")
    out = check_writable(out or Path("validation.html"), (".html",))
    chosen = [row for row in found if not only or row.name in only]
    with printing(shown.quiet), shown_progress() as show:

        def report(done: int, of: int) -> None:
            show(f"procedure {done} of {of}", done / of)

        comparisons = compare_rows(chosen, report, checked_jobs(jobs))
    sheet = validation_page(comparisons, command_line())
    files: list[Path] = []
    with printing(shown.quiet), naming(files):
        for path in (out.with_suffix(DATA), out):
            write_sheet(sheet, path)
            files.append(path)
        save(validation_figure(comparisons), out.with_suffix(PICTURE))
        files.append(out.with_suffix(PICTURE))
        present(sheet, files, every=shown.every, json=shown.json)
    return DONE
