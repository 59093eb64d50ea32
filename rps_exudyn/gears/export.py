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

NOT_IN_SOLIDS = ("deviation", "pitch_errors", "bow", "back_parallelism")  # parameters of the rack


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
    solids = gear_solids(gear, chord_error)
    del solids["bush_segment"]
    solids["bush"] = bush_segment_solid(in_one_piece(gear), chord_error)
    frames = places(gear, angle)
    return {
        name: Solid(solid.vertices @ frames[name][0].T + frames[name][1], solid.faces, solid.density)
        for name, solid in solids.items()
    }


def in_one_piece(gear: SteeringGear) -> SteeringGear:
    """Return the gear with an undivided bush."""
    return gear.replace({"bush.segments": 1})


def places(gear: SteeringGear, angle: float = 0.0) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Directions (3, 3) and origin [m] in the housing frame of each part's frame at a pinion angle [rad]."""
    pair = GearPair.of(gear)
    rack = rack_position(pair, angle)
    upright = np.eye(3)
    return {
        "pinion": (pair.pinion_frame @ turned(angle), pair.pinion_origin),
        "rack": (upright, rack),
        "plunger": (upright, np.array([0, rack[1], 0])),
        "yokenut": (upright, np.array([0, pair.bar_axis_height, 0])),
        "bush": (
            upright,
            np.array([gear.bush.distance + gear.bush.length / 2, pair.bar_axis_height, 0]),
        ),
    }


# --- The assembled gear, or a part of it, for other programs


def export_solids(
    gear: SteeringGear, path: str | Path, part: str | None = None, chord_error: float = CHORD_ERROR
) -> tuple[str, ...]:
    """Write all parts at pinion angle 0, or one of them, in the housing frame.

    GLB keeps the parts apart by name and is in metres, as its standard asks; STL is one mesh in
    millimetres, the unit its readers assume; both hold single precision. STEP has millimetres, and true
    faces with the extra `cad`, else plane ones.

    Returns:
        Sentences on what the file does not have.

    Raises:
        InputError: no such part, or the file cannot be written.
    """
    frames = places(gear)
    if part is not None and part not in frames:
        raise InputError(f"{part} is no part of the gear; these are {', '.join(frames)}.")
    names = [name for name in frames if part in (None, name)]
    missing = [f"rack.{name}" for name in NOT_IN_SOLIDS if getattr(gear.rack, name)]
    remarks = [f"{', '.join(missing)}: not part of the file."] if missing and "rack" in names else []
    with replacing(path) as partial:
        suffix = partial.suffix.lower()
        if suffix == ".step":
            try:
                partial.write_bytes(_true_step(gear, names))
                return tuple(remarks)
            except NoTrueFacesError as error:
                remarks.append(f"The faces are plane, one for each triangle: {error}.")
        solids = assembled(gear, chord_error=chord_error)
        meshes = {name: (solids[name].vertices, solids[name].faces) for name in names}
        if suffix == ".step":
            partial.write_text(step_text(part or "gear", meshes), encoding="ascii")
            return tuple(remarks)
        import trimesh  # loads in half a second, which pictures of a motion are spared

        parts = {name: trimesh.Trimesh(*mesh, process=False) for name, mesh in meshes.items()}
        if suffix == ".glb":
            partial.write_bytes(trimesh.Scene(parts).export(file_type="glb"))
        else:
            joined = trimesh.util.concatenate(list(parts.values()))
            joined.apply_transform(np.diag([1e3, 1e3, 1e3, 1]))
            partial.write_bytes(joined.export(file_type="stl"))
    return tuple(remarks)


class NoTrueFacesError(Exception):
    """Why a gear has no solids with true faces."""


def _true_step(gear: SteeringGear, names: list[str]) -> bytes:
    """A file with true faces."""
    try:
        from rps_exudyn.gears import brep, brep_parts
    except ImportError:
        raise NoTrueFacesError('curved ones need pip install "rps-exudyn[cad]"') from None
    frames, solids = places(gear), {}
    for name in names:
        try:
            solids[name] = brep.placed(brep_parts.PARTS[name](in_one_piece(gear)), *frames[name])
        except (brep.NotSolidError, brep.Standard_Failure) as error:
            reason = error if isinstance(error, brep.NotSolidError) else "fails in OpenCASCADE"
            raise NoTrueFacesError(f"the {name} {reason}") from None
    return brep.step_bytes(solids)
