"""The free pinion torque over the yoke's preload: a sweep in a loop, printed and drawn.

    python preload_sweep.py [PICTURE.png]

studies/preload.toml does the same in parallel, keeps every case and goes on where it was stopped.
"""

import sys

import numpy as np

import rps_exudyn as rps

gear = rps.SteeringGear()  # the paper's; SteeringGear.from_toml("my_gear.toml") reads another
preloads = np.linspace(100, 600, 6)  # [N]; bare numbers are SI, "300 N" works as well
torques = []
for preload in preloads:
    result = rps.run("free-pinion-torque", gear.replace({"yoke.preload": preload}), fidelity="quasi-static")
    if result.status != "ok":  # a failed simulation is a result too: its message says what happened
        raise SystemExit(f"{preload:g} N: {result.message}")
    torques.append(result.summary["torque_mean"])
    print(f"{preload:5.0f} N  {result.summary['torque_mean']:.4f} N m")

slope, constant = np.polyfit(preloads, torques, 1)
print(f"each newton adds {1e3 * slope:.3f} N mm to {1e3 * constant:.1f} N mm of bush and bearings")

if len(sys.argv) > 1:
    from matplotlib.figure import Figure

    figure = Figure(layout="constrained")
    axes = figure.subplots()
    axes.plot(preloads, torques, "o-")
    axes.set_xlabel("preload of the yoke [N]")
    axes.set_ylabel("mean free pinion torque [N m]")
    figure.savefig(sys.argv[1])
