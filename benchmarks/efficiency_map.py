"""What a load test says depends on the weight: the ratio of efficiencies over weight and free torque."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from benchmarks.topic import Topic
from rps_exudyn.analysis.efficiency import LoadTest
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.closed_form import load_test

GEAR = SteeringGear()
MASSES = np.linspace(2, 40, 39)  # [kg]
SCALES = np.linspace(0.01, 1.4, 46)  # of what makes the free torque: preload, bush, bearings


def run(folder: Path, masses: np.ndarray = MASSES) -> None:
    """Draw the map over these weights [kg]."""
    style.save(efficiency_map(efficiency_tests(masses), masses), folder / "efficiency_ratio.png")


def efficiency_tests(masses: np.ndarray) -> list[list[LoadTest]]:
    """Load tests by the closed form, [weight][free torque].

    The free torque is changed by the yoke's preload and the drag of bush and bearings, all in proportion.
    """
    gears = [scaled(float(scale)) for scale in SCALES]
    return [[load_test(gear, float(mass)) for gear in gears] for mass in masses]


def scaled(fraction: float) -> SteeringGear:
    """The default gear with a fraction of all that makes its free torque."""
    parts = ("yoke.preload", "bush.drag", "bearing.friction_torque")
    return GEAR.replace({path: fraction * GEAR.value_at(path) for path in parts})


def efficiency_map(tests: list[list[LoadTest]], masses: np.ndarray) -> Figure:
    """Ratio of reverse to forward efficiency over free torque and weight."""
    free = np.array([test.free_torque for test in tests[0]])
    ratio = np.array([[test.efficiency_ratio for test in row] for row in tests])
    with mpl.rc_context({"font.size": 10}):
        figure = Figure(figsize=(8, 4.6), layout="constrained")
        axes = figure.subplots()
    levels = [-10, 0, 0.3, 0.6, 0.8, 0.9, 0.95, 1.001]
    even = mpl.colors.BoundaryNorm(levels, 256)
    shown = axes.contourf(free, masses, ratio, levels=levels, cmap="RdYlGn", norm=even, extend="min")
    lines = axes.contour(free, masses, ratio, levels=[0, 0.9], colors="black", linewidths=[1, 1.8])
    axes.clabel(lines, fmt={0: "self-locking below", 0.9: "0.9, the paper's"}, fontsize=9)
    test = load_test(GEAR)
    default = test.free_torque, GEAR.test.load_mass
    axes.plot(*default, "o", color="white")
    label = f"default gear, {GEAR.test.load_mass:g} kg: {test.efficiency_ratio:.2f}"
    axes.annotate(label, default, (6, -12), textcoords="offset points", fontsize=9, color="white")
    axes.set_xlabel("free pinion torque [N m]")
    axes.set_ylabel("weight [kg]")
    axes.set_xlim(free[0], free[-1])
    figure.colorbar(shown, ax=axes, label="reverse over forward efficiency", ticks=levels[1:-1])
    style.title(figure, "What a load test says depends on the weight: ratio of reverse to forward efficiency")
    return figure


TOPIC = Topic("10 s", "scenes", run, {"masses": MASSES[::8]})
