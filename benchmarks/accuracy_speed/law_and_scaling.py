"""What limits accuracy besides numerics, and how cost grows: the contact law's band, cost against size.

    python studies/accuracy_limits.py [--out results/accuracy_speed]

Draws contact_law.png and scaling.png, prints their numbers, keeps them in limits.json and writes report.html
anew. Spheres and segments are read from what studies/accuracy_speed.py measured of the free pinion torque.
"""

import argparse
from pathlib import Path
from time import process_time

import numpy as np
from scipy.interpolate import CubicSpline

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.verification.accuracy_page import write_accuracy_report
from rps_exudyn.verification.law_and_scaling import Limits
from rps_exudyn.verification.measurement import Measurement, Point, load_measurement
from rps_exudyn.verification.runs import run_scene
from rps_exudyn.verification.work_precision_chart import draw_law_band, draw_scaling

GEAR = SteeringGear()
PITCH = 1 / GEAR.pinion.teeth
DEFAULT = "pressure per depth, 2e13 N/m^3 (default)"
LAWS = {
    DEFAULT: {},
    "the same, 5e12 N/m^3": {"mesh.stiffness": 5e12},
    "the same, 1e14 N/m^3": {"mesh.stiffness": 1e14},
    "load per length, 14 N/mm/um": {"mesh.law": "line"},
    "the same, 10 N/mm/um": {"mesh.law": "line", "mesh.line_stiffness": 10e9},
    "the same, 20 N/mm/um": {"mesh.law": "line", "mesh.line_stiffness": 20e9},
}
ZONES = (0.02, 0.1, 0.5, 1.0)
"""Friction zone over the smallest sliding speed."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[1] / "results" / "accuracy_speed")
    folder = parser.parse_args().out
    angle = np.linspace(0, 2 * np.pi * PITCH, 61)
    torques = {name: torque(angle, settings) for name, settings in LAWS.items()}
    mean = torques[DEFAULT].mean()
    zones = [(zone, 100 * (torque(angle, {}, {"zone_ratio": zone}).mean() / mean - 1)) for zone in ZONES]
    limits = Limits(angle, torques, DEFAULT, zones, scaling(folder))
    draw_law_band(angle, torques, DEFAULT, folder / "contact_law.png")
    draw_scaling(limits.scaling, folder / "scaling.png")
    limits.save(folder)
    tell(limits)
    write_accuracy_report(folder, folder / "report.html")


def tell(limits: Limits) -> None:
    """The tables of results/README.md."""
    sure = limits.torques[DEFAULT]
    print("| contact law | mean N mm | against the default % | peak to peak N mm |\n|---|---|---|---|")
    for name, found in limits.torques.items():
        off = 100 * (found.mean() / sure.mean() - 1)
        print(f"| {name} | {1e3 * found.mean():.1f} | {off:+.2f} | {1e3 * np.ptp(found):.1f} |")
    for zone, off in limits.zones:
        print(f"friction zone {zone:g} of the smallest sliding speed: {off:+.4f} %")
    print("\n| size | from | to | CPU s | exponent |\n|---|---|---|---|---|")
    for (name, (size, cost)), power in zip(limits.scaling.items(), limits.exponents, strict=True):
        told = f"{size[0]:g} | {size[-1]:g} | {cost[0]:.3g} to {cost[-1]:.3g}"
        print(f"| {name} | {told} | {power:.2f} |")


def torque(angle: np.ndarray, gear: dict[str, object], model: dict[str, object] | None = None) -> np.ndarray:
    """In equilibrium, over one tooth pitch."""
    chosen = GEAR.replace({**gear, "test.turns": PITCH})
    run = run_scene("free-pinion-torque", chosen, Fidelity.preset("quasi-static").replace(model or {}))
    assert run.ok, run.outcome.message
    return CubicSpline(run.signals["pinion_angle"], run.signals["pinion_torque"])(angle)


def scaling(folder: Path) -> "Series":
    """Of what the study measured, as far as it is there, and of turns and cases."""
    file = folder / "free-pinion-torque.h5"
    return {**(from_study(load_measurement(file)) if file.exists() else {}), **turns(), **cases()}


Series = dict[str, tuple[np.ndarray, np.ndarray]]


def from_study(measurement: Measurement) -> Series:
    """Per revolution: spheres of general contact, segments of the bush."""

    def series(study: str, label: str, size: str) -> tuple[np.ndarray, np.ndarray]:
        points = [p for p in measurement.points if p.ok and p.study == study and label in p.label]
        return sizes(points, size), np.array([point.cost for point in points])

    def sizes(points: list[Point], size: str) -> np.ndarray:
        if size == "spheres":
            return np.array(
                [p.fidelity.profile_samples * p.fidelity.axial_samples for p in points], dtype=float
            )
        return np.array([float(p.label.split()[1].strip(",")) for p in points])

    found = {
        "spheres of a flank, general contact": series("general_contact", "", "spheres"),
        "segments of the bush, flank contact": series("bush", "step_angle 1 ", "segments"),
    }
    return {name: one for name, one in found.items() if one[0].size > 2}


def turns() -> Series:
    """Turns of a gear with runout, so that none stands for another."""
    found: Series = {}
    counts = np.array([0.25, 0.5, 0.95, 1.9])  # no whole turns, of which one would stand for all
    for preset in ("quasi-static", "flank"):
        costs = [solver_cost(preset, {"test.turns": each, "pinion.runout": 1e-5}) for each in counts]
        found[f"turns, {preset}"] = (counts, np.array(costs))
    return found


def solver_cost(preset: str, settings: dict[str, object]) -> float:
    fidelity, gear = Fidelity.preset(preset), GEAR.replace(settings)
    return min(run_scene("free-pinion-torque", gear, fidelity).outcome.cpu_s for _ in range(5))


def cases() -> Series:
    """Whole cases one after the other, with all that is set up for each."""
    counts = np.array([1, 3, 10, 30])
    costs = []
    for count in counts:
        start = process_time()
        for number in range(count):
            gear = GEAR.replace({"yoke.preload": 300.0 + number})
            run_scene("free-pinion-torque", gear, Fidelity.preset("quasi-static"))
        costs.append(process_time() - start)
    return {"cases, quasi-static, all told": (counts.astype(float), np.array(costs))}


if __name__ == "__main__":
    main()
