"""An own gear: data from a drawing, what follows from them, whether it can be built, and what it does.

    python own_gear.py [GEAR.toml]

With a file's name the gear is read from there; `rps-exudyn init` writes one to begin with.
"""

import sys

import rps_exudyn as rps

if len(sys.argv) > 1:
    gear = rps.SteeringGear.from_toml(sys.argv[1])
else:  # text with a unit, or bare SI numbers; what is not given keeps its default or follows from the others
    gear = rps.SteeringGear().replace(
        {
            "pinion.teeth": 7,
            "pinion.normal_module": "2 mm",
            "pinion.helix_angle": "22 deg",
            "rack.bar_diameter": "26 mm",
            "bush.inner_diameter": "27 mm",
            "bush.outer_diameter": "32 mm",
            "yoke.preload": "350 N",
        }
    )
print(gear)

try:  # a gear that cannot exist is refused in one sentence for each problem
    gear.replace({"yoke.plunger_diameter": "15 mm"})
except rps.InputError as error:
    print(f"refused: {error}")

result = rps.run("free-pinion-torque", gear, fidelity="quasi-static")
if result.status != rps.Status.OK:
    raise SystemExit(f"{result.status}: {result.message} {result.status.remedy}")
names = ("rack_gain", "torque_mean", "torque_peak_to_peak")
travel, mean, ripple = (result.summary[name] for name in names)
print(f"travel {1e3 * travel:.2f} mm per turn, mean torque {mean:.4f} N m, varies by {ripple:.4f} N m")
