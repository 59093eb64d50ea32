"""The scene as a folder that others can run: geometry, parameters, reference curve, measure."""

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from benchmarks.peers import scene, score
from benchmarks.peers.reference import ANGLES, COARSE, FINE, at_angles, reference
from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.base.files import replacing
from rps_exudyn.gears.export import assembled
from verification.references import Method

PARAMETERS, CURVE, SCORE = "parameters.json", score.REFERENCE, "score.py"
CHORD_ERRORS = {"pinion": 8e-6, "rack": 4e-5}
"""Of the published solids [m], which are small so. The rack's flanks are planes, and exact in any mesh."""


def run(folder: Path, methods: Mapping[str, Method] = FINE) -> None:
    """Write the folder's files."""
    found = reference(methods)
    torque = at_angles(found)
    save_data(
        folder / PARAMETERS,
        {
            "scene": scene_parameters(),
            "gear": scene.GEAR.model_dump(include={"basic_rack", "pinion", "rack", "installation", "mesh"}),
            "changed_from_default": {**scene.SETTINGS, "mesh.law": scene.GEAR.mesh.law},
            "reference": {
                "mean": float(np.mean(torque[:-1])),
                "peak_to_peak": float(np.ptp(torque)),
                "uncertainty_percent": found.uncertainty,
                "differences_percent": found.differences,
            },
        },
    )
    uncertainty = found.uncertainty / 100 * float(np.mean(torque))
    rows = ["pinion angle deg,pinion torque N m,uncertainty N m"]
    rows += [f"{a:g},{t:.7f},{uncertainty:.1e}" for a, t in zip(ANGLES, torque, strict=True)]
    with replacing(folder / CURVE) as partial:
        partial.write_text("\n".join(rows) + "\n", encoding="utf-8")
    write_geometry(folder)
    shutil.copyfile(score.__file__, folder / SCORE)


def scene_parameters() -> dict[str, Any]:
    """Return what a program needs beside the geometry [SI]."""
    return {
        "preload": scene.PRELOAD,
        "friction": scene.FRICTION,
        "pressure_per_depth": scene.STIFFNESS,
        "pinion_speed": scene.SPEED,
        "rack_mass": scene.RACK_MASS,
        "rack_freedoms": ["X", "Y"],
        "pinion_axis": scene.PAIR.pinion_frame[:, 2].tolist(),
        "pinion_turns_about_its_axis": -1,
        "rack_travel_per_radian": scene.PAIR.gain,
        "bar_axis_height": scene.PAIR.bar_axis_height,
        "rack_pressed_in_by": scene.APPROACH,
        "base_radius": scene.PAIR.base_radius,
        "base_helix_angle": scene.PAIR.beta_b,
        "normal_base_pitch": scene.PAIR.normal_base_pitch,
    }


def write_geometry(folder: Path) -> None:
    """Write pinion and rack at pinion angle 0, housing frame [mm]."""
    for name, chord_error in CHORD_ERRORS.items():
        solid = assembled(scene.GEAR, chord_error=chord_error)[name]
        mesh = trimesh.Trimesh(1e3 * solid.vertices, solid.faces, process=False)
        with replacing(folder / f"{name}.stl") as partial:
            partial.write_bytes(mesh.export(file_type="stl"))


def reference_table(folder: Path) -> str:
    """Mean and variation of the reference, and how far its methods differ."""
    found = load_data(folder / PARAMETERS)["reference"]
    rows = [
        ("mean", f"{found['mean']:.5f} N m"),
        ("peak to peak", f"{found['peak_to_peak']:.5f} N m"),
        *((f"{pair}, RMS", f"{off:.2g} %") for pair, off in found["differences_percent"].items()),
    ]
    return markdown(("reference", ""), rows)


TOPIC = Topic("20 s", "peers/benchmark", run, {"methods": COARSE}, {"peer_reference": reference_table})
