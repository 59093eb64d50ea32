"""The command `collect`: one table of all cases of a study."""

from pathlib import Path

from rps_exudyn.base.files import check_writable
from rps_exudyn.cli.output import DONE, present, say
from rps_exudyn.cli.study import SHOWN_SKIPPED, group_lines
from rps_exudyn.results.sheet import Sheet, Text


def collect(folder: Path, /, *, out: Path | None = None) -> int:
    """Write one table of all cases of a study: varied parameters, status, metrics.

    Args:
        folder: Folder that `study` wrote.
        out: Table (.h5, .csv, .parquet, .mat), or netCDF over the axes (.nc); default: table.h5
            in the folder.
    """
    from rps_exudyn.study.case_progress import groups
    from rps_exudyn.study.collected import SUFFIXES, write_table
    from rps_exudyn.study.store import Store
    from rps_exudyn.study.table import CaseTable

    store = Store.open(folder)
    out = check_writable(out or folder / "table.h5", SUFFIXES)
    table = CaseTable.of(store)
    for _, sentence in table.skipped[:SHOWN_SKIPPED]:
        say(f"left out: {sentence}")
    if (count := len(table.skipped)) > SHOWN_SKIPPED:
        say(f"{count} files are left out, these among them; the command study repeats their cases.")
    write_table(table, out)
    present(Sheet(text=[Text(f"written: {out}"), *group_lines(groups(table.ended()))]))
    return DONE
