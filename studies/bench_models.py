"""What each model of the gear costs per revolution, and how far its torque is from the converged one.

    python studies/bench_models.py [results/models]

Prints the tables of results/README.md, draws the torque of general contact over that of the flank contact,
and both with the kinematic ratio. Cost is CPU time of one thread in the solver, the least of several
repeats, compilation and setting up apart; general contact is timed over one tooth pitch and counted `teeth`
times. The error is the RMS of the torque over one tooth pitch in % of its mean, the bias its mean. The
reference is the equilibrium at 0.1 degree steps; how far slow dynamics at 0.1 degrees lies from it says how
far to trust it.
"""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

import rps_exudyn as rps
from rps_exudyn.charts import style
from rps_exudyn.charts.several import torques_figure
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

GEAR = SteeringGear()
PITCH = 1 / GEAR.pinion.teeth

CASES = {
    "general contact 54 x 36 spheres, 0.3 deg": ("full", {"profile_samples": 54, "axial_samples": 36}),
    "general contact 27 x 18 spheres, 0.1 deg": ("full", {"step_angle": "0.1 deg"}),
    "general contact 27 x 18 spheres, 0.3 deg": ("full", {}),
    "general contact 14 x 10 spheres, 0.3 deg": ("full", {"profile_samples": 14, "axial_samples": 10}),
    "general contact 10 x 8 spheres, 0.3 deg": ("full", {"profile_samples": 10, "axial_samples": 8}),
    "flank, bush of 25 segments, 1 deg": ("flank", {"bush": "chain"}),
    "flank, 0.3 deg": ("flank", {"step_angle": "0.3 deg"}),
    "flank, 1 deg": ("flank", {}),
    "flank, 3 deg": ("flank", {"step_angle": "3 deg"}),
    "flank, 6 deg": ("flank", {"step_angle": "6 deg"}),
    "quasi-static, 1 deg": ("quasi-static", {}),
    "quasi-static, 2.5 deg": ("quasi-static", {"step_angle": "2.5 deg"}),
    "quasi-static, 5 deg": ("quasi-static", {"step_angle": "5 deg"}),
    "quasi-static, 15 deg": ("quasi-static", {"step_angle": "15 deg"}),
    "closed form": ("closed-form", {}),
    "ratio": ("flank", {"mesh": "ratio"}),
    "ratio with the closed form's loss": ("flank", {"mesh": "ratio-with-loss"}),
}


@dataclass(frozen=True)
class Row:
    """One model: seconds per revolution, RMS error and bias in % of the mean torque, counters."""

    name: str
    cost: float
    error: float
    bias: float
    result: Result


def measured(name: str, reference: CubicSpline) -> Row:
    """One case, timed and held against the reference."""
    preset, changes = CASES[name]
    fidelity = Fidelity.preset(preset).replace(changes)
    slow = fidelity.mesh == "general-contact"
    turns, repeats = (PITCH, 1) if slow else (1.0, 20)
    results = [rps.run("free-pinion-torque", GEAR, fidelity=fidelity, turns=turns) for _ in range(repeats)]
    result = min(results, key=lambda each: each.counters["solver_cpu"])
    angle = np.linspace(0, 2 * np.pi * PITCH, 721)
    curve = CubicSpline(result["pinion_angle"], result["pinion_torque"])
    difference = curve(angle) - reference(angle)
    mean = np.trapezoid(reference(angle), angle) / angle[-1]
    return Row(
        name,
        result.counters["solver_cpu"] / turns,
        100 * float(np.sqrt(np.mean(difference**2))) / mean,
        100 * float(np.mean(difference)) / mean,
        result,
    )


def reference() -> tuple[CubicSpline, float, float]:
    """Torque over the angle, and RMS and bias of slow dynamics against it in %."""
    fine = {"step_angle": "0.1 deg", "tolerance": 1e-7}
    still, moving = (
        rps.run("free-pinion-torque", GEAR, fidelity=Fidelity.preset(preset).replace(fine), turns=PITCH)
        for preset in ("quasi-static", "flank")
    )
    curve = CubicSpline(still["pinion_angle"], still["pinion_torque"])
    difference = moving["pinion_torque"] - curve(moving["pinion_angle"])
    percent = 100 / still.summary["torque_mean"]
    return curve, percent * float(np.std(difference)), percent * float(np.mean(difference))


def draw(rows: list[Row], path: Path) -> None:
    """General contact at three resolutions and the flank contact, and the differences from the flank's."""
    figure, (upper, lower) = style.panels([3.4, 2.2])
    quantity = SIGNALS["pinion_torque"]
    flank = next(row.result for row in rows if row.name == "flank, 0.3 deg")
    curve = CubicSpline(flank["pinion_angle"], flank["pinion_torque"])
    for samples, colour in (("14 x 10", "failure"), ("27 x 18", "other"), ("54 x 36", "lift")):
        result = next(row.result for row in rows if f"{samples} spheres, 0.3 deg" in row.name)
        degrees = SIGNALS["pinion_angle"].displayed(result["pinion_angle"])
        torque = result["pinion_torque"]
        style.line(upper, degrees, torque, quantity, "pinion torque", colour, f"{samples} spheres")
        off = torque - curve(result["pinion_angle"])
        style.line(lower, degrees, off, quantity, "difference", colour)
    angle = np.linspace(0, 2 * np.pi * PITCH, 400)
    degrees = SIGNALS["pinion_angle"].displayed(angle)
    style.line(upper, degrees, curve(angle), quantity, "pinion torque", "torque", "flank contact")
    style.legend_above(upper)
    style.angle_axis(lower)
    style.title(figure, "General contact converges to the flank contact", "")
    style.save(figure, path)


MODELS = {
    "general contact": "general contact 27 x 18 spheres, 0.3 deg",
    "flank contact": "flank, 1 deg",
    "ratio with loss": "ratio with the closed form's loss",
    "ratio": "ratio",
}
"""Name in the picture -> case."""


def draw_models(rows: list[Row], path: Path) -> None:
    """One model of each kind over a tooth pitch, from zero on: what each of them misses."""
    results = {row.name: row.result for row in rows}
    shown = {name: over_a_pitch(results[case]) for name, case in MODELS.items()}
    figure = torques_figure(shown, "What a model of the teeth misses: the ripple, or half of the torque")
    figure.axes[0].set_ylim(0, None)
    style.save(figure, path)


def over_a_pitch(result: Result) -> Result:
    """The first tooth pitch of a record."""
    kept = result["pinion_angle"] <= 2 * np.pi * PITCH * (1 + 1e-9)
    return replace(result, signals={name: values[kept] for name, values in result.signals.items()})


def main(folder: Path) -> None:
    """Measure, print, draw."""
    curve, spread, bias = reference()
    print(
        f"reference: equilibrium at 0.1 deg; slow dynamics differ by {spread:.4f} % RMS, {bias:+.4f} % bias\n"
    )
    for name in CASES:  # compile everything first
        if CASES[name][0] != "full":
            measured(name, curve)
    rps.run("free-pinion-torque", GEAR, fidelity="full", turns=0.005)
    rows = [measured(name, curve) for name in CASES]
    print("| model | CPU s per revolution | error RMS % | bias % | steps | Newton iterations | Jacobians |")
    print("|---|---|---|---|---|---|---|")
    for row in rows:
        counts = (row.result.counters.get(name, "") for name in ("steps", "newton_iterations", "jacobians"))
        print(
            f"| {row.name} | {row.cost:.4g} | {row.error:.3g} | {row.bias:+.3g} | "
            + " | ".join(f"{count:g}" if count != "" else "" for count in counts)
            + " |"
        )
    folder.mkdir(parents=True, exist_ok=True)
    draw(rows, folder / "general_contact_and_flank.png")
    draw_models(rows, folder / "models.png")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "results/models"))
