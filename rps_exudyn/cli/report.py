"""The command `report`: one HTML page about studies and results."""

from pathlib import Path

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import Flag
from rps_exudyn.cli.output import DONE


def report(*paths: Path, out: Path | None = None, contact: Flag = False) -> int:
    """Write one HTML page about what commands wrote: results, bands, studies, checks, fits, gears.

    Args:
        paths: folders that `study` wrote, also half-finished ones, HDF5 files that `run` wrote, JSON files of
            `run --band`, check, fit and validate, and gear files.
        out: page (.html); without it report.html in the study's folder, or a page beside the only file.
        contact: add loads of the lines of contact, shares of the teeth and contact pattern to each result.
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
