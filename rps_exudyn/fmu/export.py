"""A gear as a file for other programs, by the file's suffix."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable
from rps_exudyn.fmu.export_fmu import ExportedFmu, export_fmu
from rps_exudyn.gears.export import export_solids
from rps_exudyn.parameters.gear import SteeringGear, check_gear, surfaces_of


class Writer(NamedTuple):
    """What writes files of a suffix: a function (gear, path, options), and the names of its options."""

    function: Callable[..., ExportedFmu | tuple[str, ...]]
    options: tuple[str, ...]


MESH = Writer(export_solids, ("part", "chord_error"))
WRITERS = {".stl": MESH, ".glb": MESH, ".step": MESH, ".fmu": Writer(export_fmu, ("load", "fmi"))}
"""Suffix -> what writes such files."""


def export(gear: SteeringGear, path: str | Path, **options: Any) -> ExportedFmu | tuple[str, ...]:
    """Write a gear as a file: its parts as .stl, .glb or .step, or an FMU of the reduced gear as .fmu.

    Args:
        gear: the gear.
        path: file to write; its suffix chooses the format.
        options: of a mesh, `part` writes one part alone, such as "pinion", and `chord_error` is that of the
            mesh [m]; of an FMU, `load` is the largest on the rack [N] and `fmi` the version, 3 or 2.

    Returns:
        Of an FMU, its errors against `flank`; of parts, sentences on what the file does not have.

    Raises:
        InputError: another suffix, an option that it does not have, a part that does not exist, a gear with
            surfaces, or a file that cannot be written.

    Examples:
        >>> rps.export(rps.SteeringGear(), "pinion.stl", part="pinion")
        ()
        >>> rps.export(rps.SteeringGear(), "gear.fmu").errors["hysteresis_area"] < 0.01
        True
    """
    check_gear(gear)
    if given := surfaces_of(gear):
        raise InputError(
            f"{given[0]} is given, but files are written of the gear's parameters: leave it out."
        )
    suffix = check_writable(path, tuple(WRITERS)).suffix.lower()
    writer = WRITERS[suffix]
    if unknown := sorted(set(options) - set(writer.options)):
        known = " and ".join(writer.options)
        raise InputError(f"{unknown[0]} is no option of {suffix} files; these have {known}.")
    return writer.function(gear, path, **options)
