"""The command `show`: the summary of a result, and its picture."""

from pathlib import Path

from rps_exudyn.base.files import PICTURES, check_writable
from rps_exudyn.cli.options import Flag, Json
from rps_exudyn.cli.output import DONE, present


def show(file: Path, /, *, plot: Path | None = None, from_zero: Flag = False, json: Json = False) -> int:
    """Print the summary of a result; draw it with --plot.

    Args:
        file: HDF5 file that `run` wrote.
        plot: Picture (.png, .svg, .pdf) of the result.
        from_zero: Begin the torque and force axes of the picture at zero.
    """
    from rps_exudyn.analysis.measured import compared_with_own
    from rps_exudyn.pages.report.result_sheet import sheet_of
    from rps_exudyn.study.case_blocks import load

    if plot:
        check_writable(plot, PICTURES)
    result = load(file)
    if plot:
        result.plot(plot, from_zero=from_zero)
    present(sheet_of(result, compared_with_own(result)), [plot] if plot else [], json=json)
    return DONE
