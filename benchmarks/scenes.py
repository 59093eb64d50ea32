"""The paper's Figures 16, 17 and 18 redrawn from the model, and what it did not show.

    python studies/paper_figures.py [results/scenes]

Free pinion torque lock to lock, load test, runout; contact pattern, losses, orders, hysteresis, rack push,
yoke impact; the map of efficiency ratios that tells what a load test says. Prints the numbers of
results/README.md.
All runs are of the default gear by the default fidelity and take seconds.
"""

import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

import rps_exudyn as rps
from rps_exudyn.analysis.efficiency import LoadTest
from rps_exudyn.charts import style
from rps_exudyn.charts.contact_pattern import pattern_figure
from rps_exudyn.charts.losses import losses_figure
from rps_exudyn.charts.scene import draw
from rps_exudyn.charts.several import torques_figure
from rps_exudyn.charts.spectrum import spectrum_figure
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.result import Result
from rps_exudyn.solvers.closed_form import load_test

GEAR = SteeringGear()
RUNOUT = GEAR.replace({"pinion.runout": "40 um"})
STOPPED = RUNOUT.replace({"yoke.clearance": "20 um"})
HEAVY = 33.0  # weight with which the default gear has the paper's ratio [kg]
MASSES = np.linspace(2, 40, 39)  # [kg]
SCALES = np.linspace(0.01, 1.4, 46)  # of what makes the free torque: preload, bush, bearings
TABLES = {
    "free-pinion-torque": (
        "torque_mean_forward",
        "torque_mean_backward",
        "torque_on_centre_variation",
        "torque_off_centre_variation",
        "torque_tooth_order",
        "rack_roll_range",
        "transmission_error_peak_to_peak",
    ),
    "load-test": (
        "torque_forward",
        "torque_reverse",
        "free_torque",
        "efficiency_forward",
        "efficiency_reverse",
        "efficiency_forward_net",
        "efficiency_reverse_net",
        "efficiency_ratio",
    ),
    "rack-push": ("push_force_mean", "push_force_peak_to_peak"),
    "reversal": ("hysteresis_area", "torque_jump", "reversal_angle", "lost_motion"),
    "yoke-impact": (
        "impacts",
        "impact_peak_force",
        "impact_impulse",
        "impact_duration",
        "impact_speed",
        "impact_contact_share",
    ),
}


def main(folder: Path) -> None:
    """Compute, draw, print."""
    folder.mkdir(parents=True, exist_ok=True)
    for scene, names in TABLES.items():
        result = done(scene, GEAR, path="lock-to-lock")
        draw(result, folder / f"{scene.replace('-', '_')}.png")
        tell(scene, result, names)
    heavy = done("load-test", GEAR, load_mass=HEAVY)
    tell(f"load-test, {HEAVY:g} kg", heavy, TABLES["load-test"])
    two_turns = {
        "runout 0": done("free-pinion-torque", GEAR, turns=2, start_angle=-2 * np.pi),
        "40 µm": done("free-pinion-torque", RUNOUT, turns=2, start_angle=-2 * np.pi),
        "40 µm, yoke clearance 20 µm": done("free-pinion-torque", STOPPED, turns=2, start_angle=-2 * np.pi),
    }
    for name, result in two_turns.items():
        tell(name, result, ("torque_mean", "torque_peak_to_peak", "torque_first_order", "torque_tooth_order"))
    free = {name: two_turns[name] for name in ("runout 0", "40 µm")}
    style.save(torques_figure(free, "Runout of the pinion: free pinion torque"), folder / "runout.png")
    style.save(torques_figure(two_turns, "The same with a yoke that stops"), folder / "runout_stopped.png")
    style.save(spectrum_figure(free), folder / "spectrum.png")
    style.save(losses_figure(free["40 µm"]), folder / "losses.png")
    style.save(pattern_figure(free["runout 0"]), folder / "contact_pattern.png")
    style.save(efficiency_map(), folder / "efficiency_ratio.png")


def done(scene: str, gear: SteeringGear, **test: object) -> Result:
    """The result, which must be ok."""
    result = rps.run(scene, gear, **test)
    if result.status != "ok":
        raise SystemExit(f"{scene}: {result.status}, {result.message}")
    return result


def tell(title: str, result: Result, names: tuple[str, ...]) -> None:
    """One line for each figure, and the remark of the run."""
    print(f"{title}: {result.message or 'no remark'}; {result.counters['solver_cpu']:.2g} s in the solver")
    for name in names:
        print(f"    {name} {SUMMARY[name].show(result.summary[name])}")


def efficiency_map() -> Figure:
    """Ratio of reverse to forward efficiency by the closed form, over free torque and weight.

    The free torque is changed by the yoke's preload and the drag of bush and bearings, all in proportion.
    """
    gears = [scaled(float(scale)) for scale in SCALES]
    tests = [[load_test(gear, float(mass)) for gear in gears] for mass in MASSES]
    free = np.array([test.free_torque for test in tests[0]])
    ratio = np.array([[test.efficiency_ratio for test in row] for row in tests])
    with mpl.rc_context({"font.size": 10}):
        figure = Figure(figsize=(8, 4.6), layout="constrained")
        axes = figure.subplots()
    levels = [-10, 0, 0.3, 0.6, 0.8, 0.9, 0.95, 1.001]
    shown = axes.contourf(free, MASSES, ratio, levels=levels, cmap="RdYlGn", norm=_even(levels), extend="min")
    lines = axes.contour(free, MASSES, ratio, levels=[0, 0.9], colors="black", linewidths=[1, 1.8])
    axes.clabel(lines, fmt={0: "self-locking below", 0.9: "0.9, the paper's"}, fontsize=9)
    test = load_test(GEAR)
    axes.plot(test.free_torque, GEAR.test.load_mass, "o", color="white")
    axes.annotate(
        f"default gear, {GEAR.test.load_mass:g} kg: {test.efficiency_ratio:.2f}",
        (test.free_torque, GEAR.test.load_mass),
        xytext=(6, -12),
        textcoords="offset points",
        fontsize=9,
        color="white",
    )
    axes.set_xlabel("free pinion torque [N m]")
    axes.set_ylabel("weight [kg]")
    axes.set_xlim(free[0], free[-1])
    figure.colorbar(shown, ax=axes, label="reverse over forward efficiency", ticks=levels[1:-1])
    style.title(figure, "What a load test says depends on the weight: ratio of reverse to forward efficiency")
    tell_limits(tests)
    return figure


def scaled(share: float) -> SteeringGear:
    """The default gear with a share of all that makes its free torque."""
    return GEAR.replace(
        {
            "yoke.preload": share * GEAR.yoke.preload,
            "bush.drag": share * GEAR.bush.drag,
            "bearing.friction_torque": share * GEAR.bearing.friction_torque,
        }
    )


def tell_limits(tests: list[list[LoadTest]]) -> None:
    """The largest free torque for which 10 kg give the paper's ratio, and the least weight for others."""
    free = np.array([test.free_torque for test in tests[0]])
    row = next(each for each, mass in zip(tests, MASSES, strict=True) if mass >= 10)
    ratio = np.array([test.efficiency_ratio for test in row])
    print(f"10 kg: ratio 0.9 at a free torque of {np.interp(-0.9, -ratio, free):.3f} N m")
    for torque in (0.3, 0.5, 0.635):
        at = [np.interp(torque, free, [test.efficiency_ratio for test in each]) for each in tests]
        print(
            f"free torque {torque} N m: ratio 0.9 from {np.interp(0.9, at, MASSES):.1f} kg, "
            f"self-locking below {np.interp(0.0, at, MASSES):.1f} kg"
        )


def _even(levels: list[float]) -> mpl.colors.BoundaryNorm:
    return mpl.colors.BoundaryNorm(levels, 256)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "results/scenes"))
