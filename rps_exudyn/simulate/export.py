"""A gear as a file for other programs, by the file's suffix."""

from importlib import import_module
from pathlib import Path
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable
from rps_exudyn.parameters.gear import SteeringGear, check_gear, surfaces_of

WRITERS = dict.fromkeys((".stl", ".glb", ".step"), "rps_exudyn.gears.export:export_solids")
"""Suffix -> function (gear, path, options) that writes such files."""


def export(gear: SteeringGear, path: str | Path, **options: Any) -> None:
    """Write a gear as a file: its parts as .stl, .glb or .step.

    Args:
        gear: the gear.
        path: file to write; its suffix chooses the format.
        options: `part` writes one part alone, such as "pinion"; `chord_error` is that of the mesh [m].

    Raises:
        InputError: another suffix, a part that does not exist, or a file that cannot be written.

    Examples:
        >>> rps.export(rps.SteeringGear(), "pinion.stl", part="pinion")
    """
    check_gear(gear)
    if given := surfaces_of(gear):
        raise InputError(
            f"{given[0]} is given, but files are written of the gear's parameters: leave it out."
        )
    module, function = WRITERS[check_writable(path, tuple(WRITERS)).suffix.lower()].split(":")
    getattr(import_module(module), function)(gear, path, **options)
