"""The table behind `--accuracy`: the error of each setting on random gears.

Every gear gets a reference of its own, on which three methods must agree: equilibria with the contact
integrated over generators, with fine strips, and dynamics; of an impact an explicit method and Exudyn's.
Gears that do not run, and those whose methods differ by more than `LARGEST_UNCERTAINTY`, are left out.
The error of a setting on a gear is its RMS, the larger of joining by lines and smoothly, plus the methods'
difference; it promises 1.25 times the worst of all gears, twice the worst of few. A setting that fails on
more than one gear in ten is not offered.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from benchmarks.topic import Topic, markdown
from rps_exudyn.base.atomic import replacing, write_json
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.provenance import provenance
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.maneuver import whole_periods
from rps_exudyn.simulate.by_accuracy import TABLE, Setting
from rps_exudyn.verification.population import random_gears
from rps_exudyn.verification.references import (
    Method,
    as_run,
    by_generators,
    by_strips,
    explicitly,
    finer,
    moving,
    reference_of,
    slowly,
)
from rps_exudyn.verification.runs import SceneReference, revolutions, run_scene

SEED = 2024  # other gears than those the promise is tested on
MARGIN = 1.25
WIDE_MARGIN, FEW = 2.0, 12  # where fewer gears had a reference
LARGEST_UNCERTAINTY = {"reversal": 0.1, "yoke-impact": 0.25}
"""Of a gear's reference [%]; of other scenes 0.05."""

GEARS = {"free-pinion-torque": 60, "reversal": 24, "yoke-impact": 12}
"""Random gears of a scene; 30 of the others."""

MOST_FAILURES = 0.1
RAW = "promise_errors.json"
FINE: dict[str, float] = {"strip_stations": 6, "strip_points": 3}

Choice = tuple[str, int | None, dict[str, float]]
"""Preset, angles per pitch, other settings."""

AT_REST: list[Choice] = [("quasi-static", n, {}) for n in (6, 8, 10, 12, 16, 20, 24, 36, 48)]
AT_REST += [("quasi-static", n, FINE) for n in (36, 48, 72, 96)]
IN_MOTION: list[Choice] = [("flank", n, {}) for n in (8, 12, 16, 24, 36, 60)]
IN_MOTION += [("flank", n, FINE) for n in (60, 120)]
STEADY = AT_REST + IN_MOTION
TURNING_BACK: list[Choice] = [("quasi-static", n, {}) for n in (60, 180, 360, 720)]
TURNING_BACK += [("flank", n, {}) for n in (60, 180, 360, 720)]
IMPACTS: list[Choice] = [("flank", None, {"tolerance": each}) for each in (1e-2, 1e-3, 1e-4, 1e-5)]
IMPACTS += [("flank", None, {"tolerance": 1e-5, **FINE})]
SETTINGS: dict[str, list[Choice]] = {
    "free-pinion-torque": STEADY,
    "load-test": STEADY,
    "rack-push": STEADY,
    "reversal": TURNING_BACK,
    "yoke-impact": IMPACTS,
}
SLIDING = {
    "generators": as_run(by_generators(320, "0.5 deg")),
    "strips": as_run(by_strips("0.25 deg")),
    "dynamics": as_run(moving("0.5 deg", 1e-5)),
}
METHODS = {
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


def run(
    folder: Path,
    settings: Mapping[str, Sequence[Choice]] = MappingProxyType(SETTINGS),
    methods: Mapping[str, Mapping[str, Method]] = MappingProxyType(METHODS),
    gears: int | None = None,
    table: Path = TABLE,
) -> None:
    """Measure the settings of these scenes on random gears; a run goes on with what the folder has.

    `table` is the file that is written; a relative path is one in the folder.
    """
    keep = folder / RAW
    raw: dict[str, Any] = json.loads(keep.read_text()) if keep.exists() else {}
    for scene, choices in settings.items():
        drawn = random_gears(SEED, gears or GEARS.get(scene, 30))
        population = [gear.replace({"mesh.law": "area"}) for gear in drawn]  # which all methods know
        rows = raw.setdefault(scene, [])
        for gear in population[len(rows) :]:
            rows.append(errors_on(scene, gear, choices, methods[scene]))
            print(scene, len(rows), rows[-1].get("refused", "measured"), flush=True)
            with replacing(keep) as partial:
                partial.write_text(json.dumps(raw))
        publish(scene, choices, rows, population, folder / table)


def errors_on(
    scene: str, gear: SteeringGear, choices: Sequence[Choice], methods: Mapping[str, Method]
) -> dict[str, Any]:
    """Errors and costs of all settings on one gear, or why it has none."""
    gear = for_scene(scene, gear)
    try:
        reference = reference_of(scene, gear, methods)
    except (ArithmeticError, InputError) as error:
        return {"refused": str(error)}
    uncertainty = reference.headline.uncertainty
    if uncertainty > LARGEST_UNCERTAINTY.get(scene, 0.05):
        return {"refused": f"the reference is known to {uncertainty:.3f} % only", "uncertainty": uncertainty}
    return {
        "uncertainty": uncertainty,
        "errors": [error_and_cost(reference, gear, *setting) for setting in choices],
    }


def for_scene(scene: str, gear: SteeringGear) -> SteeringGear:
    """The gear for a scene: of a load test one tooth pitch with a weight that loads both flanks."""
    if scene != "load-test":
        return gear
    return gear.replace({"test.turns": 1 / gear.pinion.teeth, "test.load_mass": gear.yoke.preload / 40})


def error_and_cost(
    reference: SceneReference, gear: SteeringGear, preset: str, angles: int | None, settings: dict[str, float]
) -> tuple[float, float] | None:
    """Error [%] and CPU time per revolution [s] of a setting; None where the run fails."""
    fidelity = Setting(preset, angles, settings, 0, 0, 0, 0, 0).for_gear(gear)
    runs = [run_scene(reference.scene, gear, fidelity) for _ in range(3 if preset == "quasi-static" else 1)]
    if not runs[0].ok:
        return None
    errors, _ = reference.errors_of(runs[0].signals, fidelity)
    # of alike teeth one pitch is followed, be it for a pitch or for a whole turn
    steady = scene_named(reference.scene).steady
    stands_for_turn = (
        steady and preset == "quasi-static" and whole_periods(gear, 2 * np.pi) == gear.pinion.teeth
    )
    turned = revolutions(reference.scene, gear) / (gear.test.turns if stands_for_turn else 1.0)
    return errors.either_way, min(run.outcome.cpu_s for run in runs) / turned


def publish(
    scene: str, choices: Sequence[Choice], rows: list[dict[str, Any]], gears: list[SteeringGear], path: Path
) -> None:
    """Write this scene's part of the table; other scenes stay unmodified."""
    alike = [whole_periods(gear, 2 * np.pi) == gear.pinion.teeth for gear in gears]
    scenes = json.loads(path.read_text())["scenes"] if path.exists() else {}
    if any("errors" in row for row in rows):
        scenes[scene] = scene_rows(choices, rows, alike)
    scenes = {name: scenes[name] for name in SETTINGS if name in scenes}
    made = {"origin": provenance(), "seed": SEED, "scenes": scenes}
    write_json(path, made)


def scene_rows(choices: Sequence[Choice], rows: list[dict[str, Any]], alike: list[bool]) -> dict[str, Any]:
    """Floor, count of gears, settings; `alike`: whether all teeth of each gear are alike."""
    measured = [(row, teeth) for row, teeth in zip(rows, alike, strict=False) if "errors" in row]
    margin = MARGIN if len(measured) >= FEW else WIDE_MARGIN
    uncertainties = np.array([row["uncertainty"] for row, _ in measured])
    settings = []
    for at, (preset, angles, changes) in enumerate(choices):
        found = [row["errors"][at] for row, _ in measured]
        succeeded = np.array([one is not None for one in found])
        if not succeeded.any() or 1 - succeeded.mean() > MOST_FAILURES:
            continue
        errors = np.array([one[0] for one in found if one]) + uncertainties[succeeded]
        costs = {
            kind: np.median(
                [one[1] for one, (_, teeth) in zip(found, measured, strict=True) if one and teeth == kind]
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
                "failed": float(f"{1 - succeeded.mean():.3g}"),
            }
        )
    floor = float(f"{margin * uncertainties.max():.2g}")
    return {
        "floor": floor,
        "gears": len(measured),
        "tried": len(rows),
        "margin": margin,
        "settings": settings,
    }


def promises_table(folder: Path) -> str:
    """Gears, floor and the strictest promise of each scene, from the folder's table or the package's."""
    own, rows = folder / TABLE.name, []
    for scene, each in json.loads((own if own.exists() else TABLE).read_text())["scenes"].items():
        strictest = min(setting["promised"] for setting in each["settings"])
        rows.append((scene, each["gears"], each["tried"], f"{each['floor']:g} %", f"{strictest:g} %"))
    return markdown(("scene", "gears measured", "random gears", "floor", "strictest promise"), rows)


TOPIC = Topic(
    "the table behind --accuracy: errors of settings on random gears",
    "2 h",
    "accuracy_speed",
    run,
    {
        "settings": {"free-pinion-torque": AT_REST[:2]},
        "methods": {"free-pinion-torque": {name: SLIDING[name] for name in ("generators", "strips")}},
        "gears": 2,
        "table": Path(TABLE.name),
    },
    {"promises": promises_table},
)
