"""Gears with a bow and an angle error fitted to made-up curves over their travel: errors, coverage, cost.

No measurement stands behind these numbers: the curves are those of the model for a gear of each seed, with
white noise of 2 %, in steps that are not the fit's. Preload and friction of all of them are 17 to 25 % off
what the fit expects; bow, angle error and runout are drawn with the deviations of its priors, or less.
"""

from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib.figure import Figure

from benchmarks.topic import Topic, begun, load_data, markdown, save_data
from rps_exudyn.inference.fitting.bench_tests import measurement_of
from rps_exudyn.inference.fitting.fit import fit
from rps_exudyn.inference.fitting.unknowns import SHAPE_PARAMETERS, USUAL
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.judged_row import Verdict
from verification.made_up_curves import FREE, TRUE, WHITE, measured_curve, true_curve, with_noise

DATA, PICTURE = "fit_bow.json", "fit_bow.png"
ANGLE_ERROR, BOW, RUNOUT, OFFSET = np.radians(0.05), 70e-6, 14e-6, np.radians(2.0)  # standard deviations
WHOLE = 3.8  # turns


def run(
    folder: Path, seeds: int = 24, turns: float = WHOLE, free: tuple[str, ...] = SHAPE_PARAMETERS
) -> None:
    """Fit a gear of each seed; keep and draw the errors. A run that was stopped goes on where it was."""
    cases = kept(folder / DATA, seeds, turns)
    for seed in range(len(cases), seeds):
        cases.append(case(seed, turns, free))
        print(seed, cases[-1]["simulations"], round(cases[-1]["cpu_s"], 1), flush=True)
        save_data(folder / DATA, {"turns": turns, "cases": cases})
    style.save(picture(cases), folder / PICTURE)


def kept(file: Path, seeds: int, turns: float) -> list[dict[str, Any]]:
    """The cases of a run that was stopped; none where the last one came to its end."""
    before = begun(file)
    cases: list[dict[str, Any]] = before.get("cases", [])
    return cases if before.get("turns") == turns and len(cases) < seeds else []


def gear_of(random: np.random.Generator) -> SteeringGear:
    """A gear with an angle error, a bow in any direction, and a runout."""
    settings: dict[str, object] = {**TRUE, "installation.angle_error": ANGLE_ERROR * random.standard_normal()}
    for path, sd in (("rack.bow", BOW), ("pinion.runout", RUNOUT)):
        cos, sin = (sd * random.standard_normal(2)).tolist()
        settings |= {path: float(np.hypot(cos, sin)), f"{path}_angle": float(np.arctan2(sin, cos))}
    return SteeringGear().replace(settings)


def curve_of(gear: SteeringGear, turns: float, random: np.random.Generator) -> Any:
    """Its free torque to and fro over these turns about the middle, with noise and an offset of the angle."""
    curve = with_noise(true_curve(gear.replace({"test.turns": turns}), FREE), WHITE, random)
    curve["pinion_angle"] = curve["pinion_angle"] + OFFSET * random.standard_normal()
    return measured_curve(curve, FREE)


def case(seed: int, turns: float, free: tuple[str, ...]) -> dict[str, Any]:
    """Fit one gear, without another law, whose difference would widen the intervals; return what is kept."""
    random = np.random.default_rng(1000 + seed)
    gear = gear_of(random)
    if "rack.bow" not in free:
        gear = gear.replace({"rack.bow": 0.0})
    found = fit(measurement_of([curve_of(gear, turns, random)]), free=(*USUAL, *free), other_law=False)
    estimates = {
        each.path: {
            "true": gear.value_at(each.path),
            "value": each.value,
            "interval": list(each.interval),
            "verdict": str(each.verdict),
        }
        for each in found.estimates
        if each.path in SHAPE_PARAMETERS or each.path.startswith(("pinion.runout", "rack.bow"))
    }
    kept = {name: getattr(found, name) for name in ("converged", "simulations", "cpu_s")}
    return {"estimates": estimates, "seed": seed, **kept}


def missed(path: str, estimate: dict[str, Any]) -> float:
    """Difference of the estimate from the true value; of angles the shorter way round."""
    difference = float(estimate["value"] - estimate["true"])
    return (difference + np.pi) % (2 * np.pi) - np.pi if path.endswith("_angle") else difference


def holds(path: str, estimate: dict[str, Any]) -> bool:
    """Return whether what is printed holds the true value: an interval, or a largest size."""
    low, high = estimate["interval"]
    true = estimate["value"] - missed(path, estimate)
    if estimate["verdict"] == Verdict.MAYBE_ZERO:
        return bool(abs(true) <= max(abs(low), abs(high)))
    return bool(low <= true <= high)


SHOWN = {
    "installation.angle_error": ("deg", 180 / np.pi),
    "rack.bow": ("µm", 1e6),
    "rack.bow_angle": ("deg", 180 / np.pi),
    "pinion.runout": ("µm", 1e6),
    "pinion.runout_angle": ("deg", 180 / np.pi),
}
PRINTED = (Verdict.NOT_ZERO, Verdict.MAYBE_ZERO)  # with an interval or a largest size; others have none


def table(folder: Path) -> str:
    """Errors and coverage of each parameter, of the fits that converged: others print no interval."""
    cases, rows = [each for each in load_data(folder / DATA)["cases"] if each["converged"]], []
    for path, (unit, size) in SHOWN.items():
        own = [each["estimates"][path] for each in cases if path in each["estimates"]]
        printed = [each for each in own if each["verdict"] in PRINTED]
        if not printed:
            continue
        error = size * np.array([missed(path, each) for each in printed])
        half = size * np.median([(each["interval"][1] - each["interval"][0]) / 2 for each in printed])
        held = f"{sum(holds(path, each) for each in printed)} of {len(printed)}"
        numbers = np.median(np.abs(error)), np.abs(error).max(), half
        rows.append([f"`{path}` [{unit}]", *(f"{each:.2g}" for each in numbers), held])
    head = ("parameter", "median error", "largest", "median half interval", "interval holds")
    return markdown(head, rows)


def picture(cases: list[dict[str, Any]]) -> Figure:
    """Fitted over true angle error and bow of the fits that converged, with the 95 % intervals that are
    printed; hollow where none is."""
    cases = [each for each in cases if each["converged"]]
    shown = [path for path in SHAPE_PARAMETERS if path in cases[0]["estimates"]]
    figure, axes = style.panels([3.0] * len(shown), width=6.0, common_abscissa=False)
    for panel, path in zip(axes, shown, strict=True):
        unit, size = SHOWN[path]
        own = [each["estimates"][path] for each in cases if path in each["estimates"]]
        true = size * np.array([each["true"] for each in own])
        for printed in (True, False):
            some = [each for each in own if (each["verdict"] in PRINTED) == printed]
            at, value = (size * np.array([each[name] for each in some]) for name in ("true", "value"))
            ends = size * np.array([each["interval"] for each in some]).reshape(-1, 2).T
            bars = np.abs(ends - value) if printed else None
            fill: Literal["full", "none"] = "full" if printed else "none"
            colour = style.COLOURS["torque"]
            panel.errorbar(at, value, bars, fmt=".", fillstyle=fill, linewidth=0.8, color=colour)
        panel.plot([true.min(), true.max()], [true.min(), true.max()], **style.REFERENCE_LINE)
        panel.set_ylabel(f"fitted {path} [{unit}]")
        panel.set_xlabel(f"true [{unit}]")
    style.title(figure, "Bow and angle error of made-up gears, fitted; hollow: no interval")
    return figure


TOPIC = Topic(
    "20 min",
    "fit",
    run,
    {"seeds": 1, "turns": 1.0, "free": ("installation.angle_error",)},
    {"fit_bow": table},
)
