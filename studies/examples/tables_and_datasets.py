"""Many gears at once, as a table of pandas and as a Dataset of xarray.

    python tables_and_datasets.py

For thousands of cases, or long ones, write a study file instead: `rps-exudyn study` runs them in parallel,
keeps them, and `rps.study_frame` and `rps.open_study` read its folder.
"""

import itertools

import pandas as pd

import rps_exudyn as rps

preloads, frictions = (200.0, 300.0, 400.0), (0.05, 0.1)  # [N], coefficient of the teeth
points = list(itertools.product(preloads, frictions))
found = rps.batch(
    "free-pinion-torque",
    rps.SteeringGear(),
    {"yoke.preload": [p for p, _ in points], "mesh.friction": [f for _, f in points]},
)

table = pd.DataFrame(points, columns=["preload", "friction"])
table["status"] = [str(status) for status in found.statuses]
table["torque"] = found.summary["torque_mean"]  # [N m]; nan where a gear did not end ok
table["ripple"] = found.summary["torque_peak_to_peak"]
print(table)

data = table.set_index(["preload", "friction"])[["torque", "ripple"]].to_xarray()
data.torque.attrs["units"] = "N m"
slope = data.torque.polyfit("preload", 1).polyfit_coefficients.sel(degree=1)
for friction in data.friction.values:
    print(
        f"friction {friction:g}: {1e3 * float(slope.sel(friction=friction)):.3f} N mm per newton of preload"
    )
