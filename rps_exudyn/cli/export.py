"""The command `export`: a gear as a file for other programs."""

from pathlib import Path

from rps_exudyn.base.files import check_writable
from rps_exudyn.cli.options import PAPER_GEAR, Flag, GearOptions, Json
from rps_exudyn.cli.output import DONE, present


def export(
    path: Path,
    /,
    *,
    gear: GearOptions = PAPER_GEAR,
    part: str | None = None,
    force: Flag = False,
    json: Json = False,
) -> int:
    """Write a gear for other programs: its parts as a mesh (.stl, .glb, .step).

    Args:
        path: File to write.
        part: The part that is written alone, for instance pinion; default: all, assembled.
        force: Build the gear even if it is undercut.
    """
    from rps_exudyn.gears.geometry_report import check_gear
    from rps_exudyn.results.sheet import Sheet
    from rps_exudyn.simulate.export import WRITERS
    from rps_exudyn.simulate.export import export as write

    check_writable(path, tuple(WRITERS))
    chosen = gear.load()
    check_gear(chosen, force)
    write(chosen, path, **({} if part is None else {"part": part}))
    present(Sheet(), [path], json=json)
    return DONE
