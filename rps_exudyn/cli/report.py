"""The command `report`: one HTML page about studies and results."""

from pathlib import Path

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import Flag
from rps_exudyn.cli.output import DONE


def report(*paths: Path, out: Path | None = None, contact: Flag = False) -> int:
    """Write one HTML page about results, bands, studies, checks, fits and gears.

    Args:
        paths: Folders that `study` wrote (also unfinished ones) or `optimise`, HDF5 files that `run` wrote,
            JSON files of `run --band`, `check`, `fit` and `validate`, and gear files.
        out: Page (.html); default: report.html in the study's folder, or a page beside a single file.
        contact: Add to each result the loads on the lines of contact, load sharing and contact pattern.
    """
    from rps_exudyn.pages.report.write_report import SUFFIXES, default_name, write_report

    if not paths:
        raise InputError("report needs at least one study's folder or result's file.")
    out = check_writable(out or default_name(paths), SUFFIXES)
    with shown_progress() as show:

        def drawn(done: int, of: int) -> None:
            show(f"drawing sheet {done + 1} of {of}", done / of)

        write_report(paths, out, contact, drawn)
    print(f"written: {out}")
    return DONE
