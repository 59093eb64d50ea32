"""Make the made-up curves beside this script: what the model shows, with noise. NOT MEASURED.

    python make_made_up.py [FOLDER]

The gear has 340 N of preload, 20 um of runout at 70 degrees and friction coefficients of 0.09 and 0.11; the
files hold its free torque to and fro, as a bench with semicolons and decimal commas writes it, and the torque
without the yoke, with points. Then

    rps-exudyn fit made_up_free.csv yoke-out=made_up_yoke_out.csv --report fit.html

measured.csv is the file that `rps-exudyn init` writes for a curve of your own: rows of the default gear with
that runout, as an example of the format.
"""

import sys
from pathlib import Path

import numpy as np

import rps_exudyn as rps
from rps_exudyn.gears.gear_pair import GearPair

NOISE = 0.02  # of the mean torque, new at each point
GEAR = {
    "yoke.preload": "340 N",
    "mesh.friction": 0.09,
    "yoke.friction": 0.11,
    "pinion.runout": "20 um",
    "pinion.runout_angle": "70 deg",
    "test.path": "there-and-back",
    "test.start_angle": "-180 deg",
}
EXAMPLE = {path: value for path, value in GEAR.items() if path.startswith(("test.", "pinion.runout"))}

folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
random = np.random.default_rng(1)
gear = rps.SteeringGear().replace(GEAR)
result = rps.run("free-pinion-torque", gear, fidelity="quasi-static")
if result.status != "ok":
    raise SystemExit(result.message)
angle, torque = np.degrees(result["pinion_angle"]), result["pinion_torque"]
torque = torque + NOISE * np.abs(torque).mean() * random.standard_normal(torque.size)
rows = [f"{a:.2f};{100 * t:.2f}".replace(".", ",") for a, t in zip(angle, torque, strict=True)]
head = ["NICHT GEMESSEN: aus dem Modell mit Rauschen (made up, not measured)", "Winkel [°];Drehmoment [N cm]"]
(folder / "made_up_free.csv").write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")

without = gear.bush.drag * GearPair.of(gear).gain + gear.bearing.friction_torque
sense = np.sign(torque)
torque = without * (sense + NOISE * random.standard_normal(sense.size))
rows = [f"{a:.2f},{1e3 * t:.2f}" for a, t in zip(angle, torque, strict=True)]
head = ["# MADE UP, NOT MEASURED: the model without its yoke, with noise", "angle [deg],torque [N mm]"]
(folder / "made_up_yoke_out.csv").write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")

TEMPLATE = """\
# EXAMPLE, MADE UP, NOT MEASURED: computed for gears/paper.toml with 20 um of runout, and 2 % of noise.
# Replace all rows by those of your own pinion, turned freely, in one direction or both; two columns are read.
# rps-exudyn run --gear gears/paper.toml --measured measured.csv   draws the curve with the simulated one
# rps-exudyn fit --gear gears/paper.toml measured.csv              estimates what the curve tells of the gear
pinion_angle [deg]; pinion_torque [N m]; remark
"""
result = rps.run("free-pinion-torque", rps.SteeringGear().replace(EXAMPLE), fidelity="quasi-static")
tens = np.isclose(np.degrees(result["pinion_angle"]) % 10, [[0], [10]]).any(axis=0)
angle, torque = np.degrees(result["pinion_angle"])[tens], result["pinion_torque"][tens]
random = np.random.default_rng(2)
torque = torque + NOISE * np.abs(torque).mean() * random.standard_normal(torque.size)
rows = [f"{a + 0.0:.0f}; {t:.3f}; made up" for a, t in zip(angle, torque, strict=True)]
(folder / "measured.csv").write_text(TEMPLATE + "\n".join(rows) + "\n", encoding="utf-8")
