"""The command `export`: a gear as a file for other programs."""

from pathlib import Path

from rps_exudyn.base.files import check_writable
from rps_exudyn.cli.options import PAPER_GEAR, GearOptions, Json
from rps_exudyn.cli.output import DONE, present


def export(
    path: Path, *, gear: GearOptions = PAPER_GEAR, load: float | None = None, fmi: int = 3, json: Json = False
) -> int:
    """Write a gear as a file for other programs: by its suffix an FMU (.fmu).

    Args:
        path: File to write.
        load: FMU: largest load on the rack, either way [N]; by default ten times the preload.
        fmi: FMU: version of FMI, 3 (co-simulation and model exchange) or 2 (co-simulation).
    """
    from rps_exudyn.fmu.export_fmu import SUFFIXES
    from rps_exudyn.results.sheet import Grid, Sheet, Text

    suffix = check_writable(path, tuple(SUFFIXES)).suffix.lower()
    done = SUFFIXES[suffix](gear.load(), path, load=load, fmi=fmi)
    rows = [(name, f"{100 * error:+.2f} %") for name, error in done.errors.items()]
    binary = done.platform or "none, because no C compiler was found; importers compile the sources"
    text = [Grid(("metric", "error against flank"), rows), Text(f"binary inside: {binary}")]
    data = {"errors": done.errors, "platform": done.platform}
    present(Sheet(text=text, data=lambda: data), [path], json=json)
    return DONE
