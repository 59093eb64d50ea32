"""The table behind `--accuracy`: the error of each setting on random gears under random tests.

Gears have passenger-car proportions and the default contact law; speed, direction, start, path, turns, loads,
amplitude, pulses, gravity and travel come from the wide ranges. Every gear gets a reference of its own, on
which methods must agree (`promise_scenes`); for a quantity in which they differ by more than allowed it is
left out. The error of a setting on a gear is that of the quantity, plus the methods' difference; it promises
1.5 times the worst of all gears, twice the worst of few. A setting that fails too often is not offered.

Contact laws `area` and `teeth` are measured on the first of these gears: how many times the angles of the
table they need for what the table promises.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from benchmarks.accuracy_speed.promise_scenes import SCENES, STEADY, Measured, Setting
from benchmarks.topic import Topic, begun
from rps_exudyn.base.files import write_json
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.provenance import provenance
from rps_exudyn.scenes.maneuver import whole_periods
from rps_exudyn.simulate.by_accuracy import TABLE, beyond_in_run, beyond_promise
from verification.limited import cpu_limit
from verification.runs import revolutions, run_scene
from verification.scene_truth import truth_of
from verification.wide_tests import gears_under_tests

SEED = 2024  # other gears than those the promise is tested on
MARGIN = 1.5
WIDE_MARGIN, FEW = 2.0, 12  # where fewer gears had a reference
RAW = "promise_errors.json"  # of a run that was stopped
LAW_SCENE, LAW_GEARS = "free-pinion-torque", 24
FACTORS = (1.0, 1.5, 2.0, 4.0)


def run(
    folder: Path,
    scenes: Mapping[str, Measured] = MappingProxyType(SCENES),
    gears: int | None = None,
    table: Path = TABLE,
    laws: Sequence[str] = ("teeth",),
) -> None:
    """Measure the settings of these scenes on random gears; a run goes on with what the folder has.

    `table` is the file that is written; a relative path is one in the folder.
    """
    keep = folder / RAW
    raw: dict[str, Any] = begun(keep)
    for scene, measured in scenes.items():
        population = gears_under_tests(SEED, scene, gears or measured.gears)
        for law in ("line", *(laws if scene == LAW_SCENE else ())):
            rows = raw.setdefault(scene if law == "line" else law, [])
            drawn = population if law == "line" else population[: min(len(population), LAW_GEARS)]
            for gear in drawn[len(rows) :]:
                rows.append(within_limit(scene, gear.replace({"mesh.law": law}), measured))
                costed = sum("cost" in row for row in rows)
                if law == "line" and "errors" in rows[-1] and costed < measured.costed:
                    rows[-1]["cost"] = costs_on(scene, gear, measured)
                print(law, scene, len(rows), rows[-1].get("refused", "measured"), flush=True)
                write_json(keep, raw)
        publish(scene, measured, raw, population, folder / table)
    keep.unlink()


def within_limit(scene: str, gear: SteeringGear, measured: Measured) -> dict[str, Any]:
    """Errors of all settings on one gear, or why it has none: it may take too long."""
    try:
        with cpu_limit(measured.longest):
            return errors_on(scene, gear, measured)
    except ArithmeticError as error:
        return {"refused": str(error)}


def errors_on(scene: str, gear: SteeringGear, measured: Measured) -> dict[str, Any]:
    """Errors of all settings on one gear.

    Raises:
        ArithmeticError: it has none.
    """
    allowed = measured.allowed(scene)
    truth = truth_of(scene, gear, measured.methods, tuple(allowed), allowed)
    if truth.failed and measured.all_methods:
        raise ArithmeticError("; ".join(f"{name}: {why}" for name, why in truth.failed.items()))
    signals = next(iter(truth.runs.values()))[0].signals
    if beyond := beyond_promise(gear) or beyond_in_run(scene, signals):
        raise ArithmeticError(beyond.removeprefix("; "))
    found = []
    for setting in measured.settings:
        fidelity = fidelity_of(setting, gear)
        tried = run_scene(scene, gear, fidelity)
        found.append(truth.errors_of(tried, fidelity) if tried.ok else None)
    return {"uncertainty": truth.uncertainty, "errors": found}


def costs_on(scene: str, gear: SteeringGear, measured: Measured) -> list[float | None]:
    """CPU time of all settings on one gear under the default test [s per revolution]; None of failed runs."""
    default = SteeringGear()
    test = {f"test.{name}": value for name, value in default.test.model_dump().items()}
    usual = gear.replace({**test, "rack.travel": default.rack.travel})
    runs = [run_scene(scene, usual, fidelity_of(each, usual)) for each in measured.settings]
    return [run.outcome.cpu_s / revolutions(scene, usual) if run.ok else None for run in runs]


def fidelity_of(setting: Setting, gear: SteeringGear) -> Fidelity:
    """Return the model of a setting on a gear, by the table's own angles."""
    preset, angles, changes = setting
    step = {"step_angle": 2 * np.pi / gear.pinion.teeth / angles} if angles else {}
    return Fidelity.preset(preset).replace({**step, **changes})


def publish(
    scene: str, measured: Measured, raw: dict[str, Any], gears: list[SteeringGear], path: Path
) -> None:
    """Write this scene's part of the table; other scenes stay unmodified."""
    before, rows = begun(path), raw[scene]
    scenes, laws = before.get("scenes", {}), before.get("laws", {})
    alike = [whole_periods(gear, 2 * np.pi) == gear.pinion.teeth for gear in gears]
    tables = [
        {"quantity": quantity, **table}
        for quantity, uncertain in measured.allowed(scene).items()
        if (table := rows_of(quantity, uncertain, measured, rows, alike))["settings"]
    ]
    if tables:
        scenes[scene] = {"tried": len(rows), "quantities": tables}
    if scene == LAW_SCENE and tables:
        laws = {"line": 1.0} | {law: factor_of(raw[law], tables[0]) for law in ("teeth",) if law in raw}
    scenes = {name: scenes[name] for name in SCENES if name in scenes}
    write_json(path, {"origin": provenance(), "seed": SEED, "laws": laws, "scenes": scenes})


def rows_of(
    quantity: str, uncertain: float, measured: Measured, rows: list[dict[str, Any]], alike: list[bool]
) -> dict[str, Any]:
    """Floor, count of gears, settings; `alike`: whether all teeth of each gear are alike."""
    known = [
        (row, teeth)
        for row, teeth in zip(rows, alike, strict=False)
        if "errors" in row and row["uncertainty"][quantity] <= uncertain
    ]
    margin = MARGIN if len(known) >= FEW else WIDE_MARGIN
    doubts = np.array([row["uncertainty"][quantity] for row, _ in known])
    settings = []
    for at, setting in enumerate(measured.settings if known else ()):
        found = [row["errors"][at] for row, _ in known]
        succeeded = np.array([one is not None and np.isfinite(one[quantity]) for one in found])
        if not succeeded.any() or 1 - succeeded.mean() > measured.most_failures:
            continue
        errors = doubts[succeeded] + [found[i][quantity] for i in np.flatnonzero(succeeded)]
        (preset, angles, changes), (cost, cost_of_turn) = setting, cost_of(at, known)
        numbers = {"promised": margin * errors.max(), "median": np.median(errors), "cost": cost}
        numbers |= {"cost_of_turn": cost_of_turn, "failed": 1 - succeeded.mean()}
        rounded = {name: float(f"{number:.3g}") for name, number in numbers.items()}
        settings.append({"preset": preset, "angles_per_pitch": angles, "settings": changes, **rounded})
    floor = float(f"{margin * doubts.max(initial=0.0):.2g}")
    return {"floor": floor, "gears": len(known), "margin": margin, "settings": settings}


def cost_of(at: int, known: Sequence[tuple[dict[str, Any], bool]]) -> tuple[float, float]:
    """Median cost of a setting on gears whose teeth are all alike, and on the others; the one where the other
    is missing."""
    costs = [(row["cost"][at], teeth) for row, teeth in known if row.get("cost") and row["cost"][at]]
    kinds = [[cost for cost, teeth in costs if teeth == kind] for kind in (True, False)]
    alike, other = (float(np.median(kind or [cost for cost, _ in costs])) for kind in kinds)
    return alike, other


def factor_of(rows: list[dict[str, Any]], table: dict[str, Any]) -> float:
    """Return how many times the angles of the table a contact law needs, so that each of its gears keeps what
    the setting with so many fewer angles promises of equilibria."""
    quantity, limit = table["quantity"], SCENES[LAW_SCENE].uncertain
    worst: dict[tuple[int, str], float] = {}
    for at, (preset, angles, changes) in enumerate(STEADY):
        errors = [
            row["errors"][at][quantity]
            for row in rows
            if "errors" in row and row["uncertainty"][quantity] <= limit and row["errors"][at]
        ]
        if preset == "quasi-static" and angles and errors:
            worst[angles, str(changes)] = max(errors)
    promised = {
        (row["angles_per_pitch"], str(row["settings"])): row["promised"]
        for row in table["settings"]
        if row["preset"] == "quasi-static"
    }
    for factor in FACTORS:
        denser = {(n, kind): (round(factor * n), kind) for n, kind in promised}
        compared = [(worst[denser[key]], promised[key]) for key in promised if denser[key] in worst]
        if compared and all(error <= promise for error, promise in compared):
            return factor
    return FACTORS[-1]


TWO = {name: SCENES[LAW_SCENE].methods[name] for name in ("equilibria", "dynamics")}
TOPIC = Topic(
    "40 min",
    "accuracy_speed",
    run,
    {"scenes": {LAW_SCENE: Measured(STEADY[:2], TWO)}, "gears": 2, "laws": (), "table": Path(TABLE.name)},
)
