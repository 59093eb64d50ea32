"""The command `export`: a gear as a file for other programs."""

from pathlib import Path

from rps_exudyn.base.files import check_writable
from rps_exudyn.cli.options import PAPER_GEAR, Flag, GearOptions, Json
from rps_exudyn.cli.output import DONE, present
from rps_exudyn.results.sheet import Grid, Sheet, Text


def export(
    path: Path,
    /,
    *,
    gear: GearOptions = PAPER_GEAR,
    part: str | None = None,
    force: Flag = False,
    load: float | None = None,
    fmi: int | None = None,
    json: Json = False,
) -> int:
    """Write a gear for other programs: its parts as a mesh (.stl, .glb, .step), or an FMU (.fmu).

    Args:
        path: File to write.
        part: Mesh: the part that is written alone, for instance pinion; default: all, assembled.
        force: Build the gear even if it is undercut.
        load: FMU: largest load on the rack, either way [N]; default: ten times the preload.
        fmi: FMU: version of FMI, 3 (co-simulation and model exchange, default) or 2 (co-simulation).
    """
    from rps_exudyn.fmu.export import WRITERS
    from rps_exudyn.fmu.export import export as write
    from rps_exudyn.gears.geometry_report import check_gear

    check_writable(path, tuple(WRITERS))
    chosen = gear.load()
    check_gear(chosen, force)
    given = {"part": part, "load": load, "fmi": fmi}
    done = write(chosen, path, **{name: value for name, value in given.items() if value is not None})
    if isinstance(done, tuple):
        present(Sheet(text=[Text(each) for each in done], data=lambda: {"remarks": done}), [path], json=json)
        return DONE
    rows = [(name, f"{100 * error:+.2f} %") for name, error in done.errors.items()]
    binary = done.platform or "none, because no C compiler was found; importers compile the sources"
    text = [Grid(("metric", "error against flank"), rows), Text(f"binary inside: {binary}")]
    data = {"errors": done.errors, "platform": done.platform}
    present(Sheet(text=text, data=lambda: data), [path], json=json)
    return DONE
