"""The command `validate`: rows of data from outside against this package, on one page."""

from collections import Counter
from pathlib import Path

from rps_exudyn.base.atomic import check_writable, replacing, write_json
from rps_exudyn.base.errors import InputError
from rps_exudyn.cli.kept import naming
from rps_exudyn.cli.printed import print_json
from rps_exudyn.cli.progress import shown_progress
from rps_exudyn.cli.text_table import put, put_table
from rps_exudyn.results.provenance import provenance
from rps_exudyn.simulate.cases.run_cases import checked_jobs
from rps_exudyn.validation.comparison import Comparison, compare_rows
from rps_exudyn.validation.page import COLUMNS, row_cells, validation_figure, validation_page
from rps_exudyn.validation.row import SHIPPED, read_rows

DATA, PICTURE = ".json", ".png"  # beside the page


def do_validate(
    folder: Path | None, only: tuple[str, ...], out: Path, as_json: bool, jobs: int | None = None
) -> None:
    """Run the rows, write page, data and picture, and print the table.

    Raises:
        InputError: rows that cannot be read, no such row, or files that cannot be written.
    """
    from rps_exudyn.charts.style import save

    rows = read_rows(folder or SHIPPED)
    if unknown := set(only) - {row.name for row in rows}:
        known = ", ".join(row.name for row in rows)
        raise InputError(f"there is no row {', '.join(sorted(unknown))}; there are {known}.")
    check_writable(out, (".html",))
    chosen = [row for row in rows if not only or row.name in only]
    with shown_progress() as show:

        def report(done: int, of: int) -> None:
            show(f"procedure {done} of {of}", done / of)

        comparisons = compare_rows(chosen, report, checked_jobs(jobs))
    content = {"origin": provenance(), "rows": [each.as_dict() for each in comparisons]}
    files: list[Path] = []
    with naming(files):
        write_json(out.with_suffix(DATA), content)
        files.append(out.with_suffix(DATA))
        with replacing(out) as partial:
            partial.write_text(validation_page(comparisons), encoding="utf-8")
        files.append(out)
        save(validation_figure(comparisons), out.with_suffix(PICTURE))
        files.append(out.with_suffix(PICTURE))
        if as_json:
            print_json(content | {"files": [str(file) for file in files]})
        else:
            _print(comparisons, files)


def _print(comparisons: list[Comparison], files: list[Path]) -> None:
    put_table(COLUMNS, [tuple(row_cells(each)) for each in comparisons])
    counts = Counter(each.verdict.value for each in comparisons)
    put(", ".join(f"{count} {verdict}" for verdict, count in counts.items()) + ".", "bold")
    for file in files:
        put(f"written: {file}")
