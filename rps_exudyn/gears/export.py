"""The assembled gear as STL or GLB, for other programs."""

from pathlib import Path

import numpy as np
import trimesh

from rps_exudyn.base.atomic import replacing
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.assembly import assembled
from rps_exudyn.gears.solids import CHORD_ERROR
from rps_exudyn.parameters.gear import SteeringGear

FORMATS = (".stl", ".glb")


def export_solids(gear: SteeringGear, path: str | Path, chord_error: float = CHORD_ERROR) -> None:
    """Write all parts at pinion angle 0, housing frame.

    GLB keeps the parts apart by name and is in metres, as its standard asks; STL is one mesh in
    millimetres, the unit its readers assume. Both formats hold single precision.

    Raises:
        InputError: another suffix, or the file cannot be written.
    """
    kind = Path(path).suffix.lower()
    if kind not in FORMATS:
        raise InputError(f"{path} is no geometry file; its suffix must be {' or '.join(FORMATS)}.")
    parts = {
        name: trimesh.Trimesh(solid.vertices, solid.faces, process=False)
        for name, solid in assembled(gear, chord_error=chord_error).items()
    }
    with replacing(path) as partial:
        if kind == ".glb":
            partial.write_bytes(trimesh.Scene(parts).export(file_type="glb"))
        else:
            joined = trimesh.util.concatenate(list(parts.values()))
            joined.apply_transform(np.diag([1e3, 1e3, 1e3, 1]))
            partial.write_bytes(joined.export(file_type="stl"))
