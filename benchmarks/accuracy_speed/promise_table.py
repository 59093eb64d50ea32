"""The table behind `--accuracy`: what each setting's error is on random gears. Goes on where it was stopped.

    python studies/accuracy_choice.py [--scene NAME ...] [--gears 30] [--out rps_exudyn/accuracy/table.json]

Every gear gets a reference of its own, on which three methods must agree: equilibria with the contact
integrated over generators, with fine strips, and dynamics; of an impact an explicit method and Exudyn's.
Gears that do not run, and those whose methods differ by more than `LARGEST_DOUBT`, are told and left out.
The error of a setting on a gear is its RMS, the larger of joining by lines and smoothly, plus what the
methods do not agree about; it promises 1.25 times the worst of all gears, of few gears twice. A setting that
fails on more than one gear in ten is not offered.
"""

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from rps_exudyn.base.atomic import replacing
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.provenance import provenance
from rps_exudyn.scenes.maneuver import whole_periods
from rps_exudyn.simulate.by_accuracy import TABLE, Setting
from rps_exudyn.verification.population import random_gears
from rps_exudyn.verification.references import (
    as_run,
    by_generators,
    by_strips,
    explicitly,
    finer,
    moving,
    slowly,
    truth_of,
)
from rps_exudyn.verification.runs import Truth, revolutions, run_scene

SEED = 2024  # other gears than those the promise is tested on
MARGIN = 1.25
WIDE_MARGIN, FEW = 2.0, 12  # where fewer gears were judged
LARGEST_DOUBT = {"reversal": 0.1, "yoke-impact": 0.25}
"""Of a gear's reference [%]; of other scenes 0.05."""

GEARS = {"free-pinion-torque": 60, "reversal": 24, "yoke-impact": 12}
"""Tried; of other scenes 30."""

MOST_FAILURES = 0.1
FINE: dict[str, float] = {"strip_stations": 6, "strip_points": 3}

Tried = tuple[str, int | None, dict[str, float]]
AT_REST: list[Tried] = [("quasi-static", n, {}) for n in (6, 8, 10, 12, 16, 20, 24, 36, 48)]
AT_REST += [("quasi-static", n, FINE) for n in (36, 48, 72, 96)]
IN_MOTION: list[Tried] = [("flank", n, {}) for n in (8, 12, 16, 24, 36, 60)]
IN_MOTION += [("flank", n, FINE) for n in (60, 120)]
STEADY = AT_REST + IN_MOTION
TURNING_BACK: list[Tried] = [("quasi-static", n, {}) for n in (60, 180, 360, 720)]
TURNING_BACK += [("flank", n, {}) for n in (60, 180, 360, 720)]
IMPACTS: list[Tried] = [("flank", None, {"tolerance": each}) for each in (1e-2, 1e-3, 1e-4, 1e-5)]
IMPACTS += [("flank", None, {"tolerance": 1e-5, **FINE})]
SETTINGS: dict[str, list[Tried]] = {
    "free-pinion-torque": STEADY,
    "load-test": STEADY,
    "rack-push": STEADY,
    "reversal": TURNING_BACK,
    "yoke-impact": IMPACTS,
}
"""Preset, angles per pitch, and what else."""

SLIDING = {
    "generators": as_run(by_generators(320, "0.5 deg")),
    "strips": as_run(by_strips("0.25 deg")),
    "dynamics": as_run(moving("0.5 deg", 1e-5)),
}
WITNESSES = {
    "free-pinion-torque": SLIDING,
    "load-test": SLIDING,
    "rack-push": SLIDING,
    "reversal": {
        "generators": slowly(by_generators(160, "0.05 deg")),
        "strips": slowly(by_strips("0.05 deg")),
        "dynamics": as_run(moving("0.05 deg", 1e-5)),
    },
    "yoke-impact": {"Runge-Kutta": explicitly(2e-6), "a quarter of the step": finer(4)},
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", action="append", choices=list(SETTINGS))
    parser.add_argument("--gears", type=int, help="to be tried")
    parser.add_argument("--out", type=Path, default=TABLE)
    parser.add_argument("--keep", type=Path, default=Path("accuracy_choice.json"), help="raw errors, kept")
    asked = parser.parse_args()
    raw: dict[str, Any] = json.loads(asked.keep.read_text()) if asked.keep.exists() else {}
    for scene in asked.scene or SETTINGS:
        gears = random_gears(SEED, asked.gears or GEARS.get(scene, 30))
        rows = raw.setdefault(scene, [])
        for index, gear in enumerate(gears):
            if index < len(rows):
                continue
            rows.append(run_and_check(scene, gear))
            print(
                scene,
                index,
                rows[-1].get("refused") or f"uncertainty {rows[-1]['uncertainty']:.4f}",
                flush=True,
            )
            with replacing(asked.keep) as partial:
                partial.write_text(json.dumps(raw))
        publish(scene, rows, gears, asked.out)


def run_and_check(scene: str, gear: SteeringGear) -> dict[str, Any]:
    """Errors and costs of all settings on one gear, or why it has none."""
    gear = for_scene(scene, gear)
    try:
        truth = truth_of(scene, gear, WITNESSES[scene])
    except (ArithmeticError, InputError) as error:
        return {"refused": str(error)}
    uncertainty = truth.judged.uncertainty
    if uncertainty > LARGEST_DOUBT.get(scene, 0.05):
        return {"refused": f"the reference is known to {uncertainty:.3f} % only", "uncertainty": uncertainty}
    return {
        "uncertainty": uncertainty,
        "errors": [error_and_cost(truth, gear, *setting) for setting in SETTINGS[scene]],
    }


def for_scene(scene: str, gear: SteeringGear) -> SteeringGear:
    """One turn; the load test with a weight that loads both flanks."""
    if scene != "load-test":
        return gear
    return gear.replace({"test.turns": 1 / gear.pinion.teeth, "test.load_mass": gear.yoke.preload / 40})


def error_and_cost(
    truth: Truth, gear: SteeringGear, preset: str, angles: int | None, settings: dict[str, float]
) -> tuple[float, float] | None:
    """[%] and CPU seconds per revolution; None where the run fails."""
    fidelity = Setting(preset, angles, settings, 0, 0, 0, 0, 0).for_gear(gear)
    runs = [run_scene(truth.scene, gear, fidelity) for _ in range(3 if preset == "quasi-static" else 1)]
    if not runs[0].ok:
        return None
    errors, _ = truth.errors_of(runs[0].signals, fidelity)
    # of alike teeth one pitch is followed, be it for a pitch or for a whole turn
    steady = SETTINGS[truth.scene] is STEADY
    stands_for_turn = (
        steady and preset == "quasi-static" and whole_periods(gear, 2 * np.pi) == gear.pinion.teeth
    )
    turned = revolutions(truth.scene, gear) / (gear.test.turns if stands_for_turn else 1.0)
    return errors.either_way, min(run.outcome.cpu_s for run in runs) / turned


def publish(scene: str, rows: list[dict[str, Any]], gears: list[SteeringGear], path: Path) -> None:
    """The table with this scene from all that was tried; other scenes stay as they are."""
    alike = [whole_periods(gear, 2 * np.pi) == gear.pinion.teeth for gear in gears]
    scenes = json.loads(path.read_text())["scenes"] if path.exists() else {}
    if any("errors" in row for row in rows):
        scenes[scene] = scene_rows(SETTINGS[scene], rows, alike)
    scenes = {name: scenes[name] for name in SETTINGS if name in scenes}
    made = {"origin": provenance(), "seed": SEED, "scenes": scenes}
    with replacing(path) as partial:
        partial.write_text(json.dumps(made, indent=1) + "\n")


def scene_rows(tried: list[Tried], rows: list[dict[str, Any]], alike: list[bool]) -> dict[str, Any]:
    """Floor, count of gears, settings; `alike` tells of each gear whether its teeth are."""
    judged = [(row, same) for row, same in zip(rows, alike, strict=False) if "errors" in row]
    margin = MARGIN if len(judged) >= FEW else WIDE_MARGIN
    uncertainties = np.array([row["uncertainty"] for row, _ in judged])
    settings = []
    for at, (preset, angles, changes) in enumerate(tried):
        found = [row["errors"][at] for row, _ in judged]
        there = np.array([one is not None for one in found])
        if not there.any() or 1 - there.mean() > MOST_FAILURES:
            continue
        errors = np.array([one[0] for one in found if one]) + uncertainties[there]
        costs = {
            kind: np.median(
                [one[1] for one, (_, same) in zip(found, judged, strict=True) if one and same == kind]
            )
            for kind in (True, False)
        }
        settings.append(
            {
                "preset": preset,
                "angles_per_pitch": angles,
                "settings": changes,
                "promised": float(f"{margin * errors.max():.3g}"),
                "median": float(f"{np.median(errors):.3g}"),
                "cost": float(f"{costs[True]:.3g}"),
                "cost_of_turn": float(f"{costs[False]:.3g}"),
                "failed": float(f"{1 - there.mean():.3g}"),
            }
        )
    floor = float(f"{margin * uncertainties.max():.2g}")
    return {"floor": floor, "gears": len(judged), "tried": len(rows), "margin": margin, "settings": settings}


if __name__ == "__main__":
    main()
