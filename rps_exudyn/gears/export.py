"""Export of the parts, assembled in the housing frame, to 3-D files; the assembly for pictures."""

from pathlib import Path

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import replacing
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.polyhedron import Solid
from rps_exudyn.gears.solids import CHORD_ERROR, bush_segment_solid, gear_solids
from rps_exudyn.gears.step_file import step_text
from rps_exudyn.parameters.gear import SteeringGear


def rack_position(pair: GearPair, angle: float) -> np.ndarray:
    """Origin of the rack frame [m], shape (3,), with the rack pressed into the mesh of rigid teeth.

    A gear centre displaced by c (runout, axis offset) takes the rack along by the d in X and Y that keeps
    both flanks touching, n . d = n . c: d_X = u . c / cos beta_r, d_Y = c_Y. Exact without angle error.
    """
    centre = pair.pinion_origin + pair.pinion_frame @ turned(angle) @ pair.eccentricity
    along = pair.cross_trace @ centre / np.cos(pair.beta_r)
    return np.array([pair.travel_at(angle) + along, pair.bar_axis_height + centre[1], 0.0])


def turned(angle: float) -> np.ndarray:
    """Rotation of the pinion frame by the pinion angle, which is -angle about k; shape (3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])


def assembled(gear: SteeringGear, angle: float = 0.0, chord_error: float = CHORD_ERROR) -> dict[str, Solid]:
    """All parts at one pinion angle [rad], the bush in one piece; vertices in the housing frame."""
    pair = GearPair.of(gear)
    solids = gear_solids(gear, chord_error)
    del solids["bush_segment"]
    solids["bush"] = bush_segment_solid(gear.replace({"bush.segments": 1}), chord_error)
    rack = rack_position(pair, angle)
    behind = np.array([0, rack[1], 0])
    bush = np.array([gear.bush.distance + gear.bush.length / 2, pair.bar_axis_height, 0])
    upright = np.eye(3)
    places = {
        "pinion": (pair.pinion_frame @ turned(angle), pair.pinion_origin),
        "rack": (upright, rack),
        "plunger": (upright, behind),
        "yokenut": (upright, np.array([0, pair.bar_axis_height, 0])),
        "bush": (upright, bush),
    }
    return {
        name: Solid(solid.vertices @ places[name][0].T + places[name][1], solid.faces, solid.density)
        for name, solid in solids.items()
    }


# --- The assembled gear, or a part of it, for other programs


def export_solids(
    gear: SteeringGear, path: str | Path, part: str | None = None, chord_error: float = CHORD_ERROR
) -> None:
    """Write all parts at pinion angle 0, or one of them, in the housing frame.

    GLB keeps the parts apart by name and is in metres, as its standard asks; STL is one mesh in
    millimetres, the unit its readers assume; both hold single precision. STEP has plane faces and
    millimetres.

    Raises:
        InputError: no such part, or the file cannot be written.
    """
    import trimesh  # loads in half a second, which pictures of a motion are spared

    solids = assembled(gear, chord_error=chord_error)
    if part is not None and part not in solids:
        raise InputError(f"{part} is no part of the gear; these are {', '.join(solids)}.")
    solids = {name: solid for name, solid in solids.items() if part in (None, name)}
    parts = {
        name: trimesh.Trimesh(solid.vertices, solid.faces, process=False) for name, solid in solids.items()
    }
    with replacing(path) as partial:
        if partial.suffix.lower() == ".step":
            meshes = {name: (each.vertices, each.faces) for name, each in solids.items()}
            partial.write_text(step_text(part or "gear", meshes), encoding="ascii")
        elif partial.suffix.lower() == ".glb":
            partial.write_bytes(trimesh.Scene(parts).export(file_type="glb"))
        else:
            joined = trimesh.util.concatenate(list(parts.values()))
            joined.apply_transform(np.diag([1e3, 1e3, 1e3, 1]))
            partial.write_bytes(joined.export(file_type="stl"))
