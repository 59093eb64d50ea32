"""Spheres of general contact over their number: errors of mean and shape of the torque, at rest.

Equilibria of the default gear over a tooth pitch, against those of the flank contact by the same law: what
is seen is the error of the spheres. Rows that touch in step add up to ripple, so their number matters.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

import rps_exudyn as rps
from benchmarks.topic import Topic, digits, load_data, markdown, save_data
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear

GRIDS = (14, 10), (19, 13), (27, 15), (27, 16), (27, 17), (27, 18), (27, 22), (38, 23), (38, 26), (54, 36)
DATA = "sphere_grids.json"
AT_REST = Fidelity.preset("quasi-static")


def run(folder: Path, grids: Sequence[tuple[int, int]] = GRIDS) -> None:
    """Compare all grids."""
    save_data(folder / DATA, {"rows": errors_of(grids)})


def errors_of(grids: Sequence[tuple[int, int]]) -> list[dict[str, object]]:
    """Mean and shape error of each grid [%]."""
    gear = SteeringGear()
    gear = gear.replace({"test.turns": 1 / gear.pinion.teeth})
    fine = AT_REST.replace({"strip_stations": 8, "strip_points": 4})
    reference = rps.run("free-pinion-torque", gear, fidelity=fine)
    torque, angles = reference["pinion_torque"], reference["pinion_angle"]
    rows: list[dict[str, object]] = []
    for profile, axial in grids:
        grid = {"mesh": "general-contact", "profile_samples": profile, "axial_samples": axial}
        run = rps.run("free-pinion-torque", gear, fidelity=AT_REST.replace(grid))
        found = np.interp(angles, run["pinion_angle"], run["pinion_torque"])  # rough ones halve their steps
        mean = 100 * float(found.mean() / torque.mean() - 1)
        shape = 100 * float(np.std(found - torque) / torque.mean())
        rows.append({"profile": profile, "axial": axial, "mean": mean, "shape": shape})
    return rows


def grids_table(folder: Path) -> str:
    """Errors of each grid."""
    lines = [
        (f"{row['profile']} x {row['axial']}", digits(row["mean"]), digits(row["shape"]))
        for row in load_data(folder / DATA)["rows"]
    ]
    return markdown(("spheres on a flank", "mean %", "shape %"), lines)


TOPIC = Topic(
    "general contact at rest: errors of mean and shape over the number of spheres",
    "1 min",
    "contact_laws",
    run,
    {"grids": ((27, 16),)},
    {"sphere_grids": grids_table},
)
