"""Whether `--accuracy` keeps its promise on gears and tests drawn from the widest ranges.

Each gear and test of a scene is drawn over every declared parameter, speed, amplitude, load, start, gravity
and travel among them, in its own contact law. What `--accuracy` returns is compared with a curve of its own
seat, beginning, periods and steps (`verification.plan_reference.curve`). Gears of which the command itself
says that it promises nothing, and runs that do not end ok, are counted apart.
"""

import csv
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.topic import Topic, markdown
from rps_exudyn.analysis.curve import Curve, difference
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.scenes.headline import curve_of
from rps_exudyn.simulate.by_accuracy import beyond_promise, beyond_swings
from rps_exudyn.simulate.run import simulate
from rps_exudyn.verification.plan_reference import NotFoundError, curve
from rps_exudyn.verification.sampler import random_gear
from rps_exudyn.verification.stability import ScenePlan

SEED = 20261123
WANTED = {
    "free-pinion-torque": (1.0, 0.1),
    "load-test": (1.0, 0.1),
    "rack-push": (1.0, 0.1),
    "reversal": (1.0,),
}
MEASURED = 20  # gears of a scene that are within the promise's scope and have a reference
MOST_TRIED = 60
DATA = "promises_kept.csv"
COLUMNS = ("scene", "number", "wanted", "verdict", "error", "cpu_ms", "model", "said")


def run(
    folder: Path, measured: int = MEASURED, tried: int = MOST_TRIED, scenes: tuple[str, ...] = tuple(WANTED)
) -> None:
    """Draw gears until so many of each scene are measured; what the data file has is not run again."""
    rows = read(folder / DATA)
    for scene in scenes:
        number = 0
        while number < tried and count(rows, scene) < measured:
            if not any(row["scene"] == scene and int(row["number"]) == number for row in rows):
                rows += rows_of(scene, number)
                write(rows, folder / DATA)
            number += 1


def count(rows: list[dict[str, Any]], scene: str) -> int:
    """Gears of a scene that were measured at all wanted accuracies."""
    numbers = Counter(
        int(row["number"]) for row in rows if row["scene"] == scene and row["verdict"] in ("kept", "missed")
    )
    return sum(each == len(WANTED[scene]) for each in numbers.values())


def rows_of(scene: str, number: int) -> list[dict[str, Any]]:
    """One gear and test, at every wanted accuracy."""
    gear = random_gear(np.random.default_rng([SEED, number]), scene)
    right: Curve | str | None = None
    rows: list[dict[str, Any]] = []
    for wanted in WANTED[scene]:
        row, got = asked(scene, gear, wanted)
        if got is not None:
            right = right or right_curve(scene, gear)
            row |= compared(got, right, wanted)
        rows.append({"scene": scene, "number": number, "wanted": wanted} | row)
    print(*rows, sep="\n", flush=True)
    return rows


def asked(scene: str, gear: SteeringGear, wanted: float) -> tuple[dict[str, Any], Curve | None]:
    """What `--accuracy` gives at a wanted accuracy [%], and its curve where that is promised to be right."""
    try:
        result = simulate(scene, gear, accuracy=f"{wanted}%")
    except InputError as error:
        return {"verdict": "refused", "said": str(error)}, None
    row = {"cpu_ms": f"{1e3 * result.cpu_s:.3g}", "model": result.fidelity["name"]}
    if result.status is not Status.OK:
        return row | {"verdict": result.status.value, "said": result.message}, None
    if beyond := beyond_promise(gear, result.signals) or (beyond_swings(gear) if scene == "reversal" else ""):
        return row | {"verdict": "not promised", "said": beyond}, None
    choices = {name: value for name, value in result.fidelity.items() if name in Fidelity.model_fields}
    got = curve_of(scene, dict(result.signals), gear, Fidelity().replace(choices))
    return row | {"said": result.findings.get("accuracy_checked", "")}, got


def right_curve(scene: str, gear: SteeringGear) -> Curve | str:
    """The gear's right curve, or why there is none."""
    try:
        return curve(ScenePlan(scene, gear, Fidelity.preset("quasi-static")))
    except (NotFoundError, np.linalg.LinAlgError) as error:
        return str(error)


def compared(got: Curve, right: Curve | str, wanted: float) -> dict[str, Any]:
    """Verdict and error [%] of a curve."""
    if isinstance(right, str):
        return {"verdict": "no reference", "said": right}
    error = difference(got, right)
    return {"verdict": "kept" if error <= wanted else "missed", "error": f"{error:.3g}"}


def read(path: Path) -> list[dict[str, Any]]:
    """Return the rows of a run before this one."""
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def write(rows: list[dict[str, Any]], path: Path) -> None:
    """Write all rows as a table."""
    with path.open("w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(rows)


def kept_table(folder: Path) -> str:
    """Gears of each scene that keep what is wanted, and the others."""
    rows = read(folder / DATA)
    lines = []
    for scene, wanted in WANTED.items():
        for percent in wanted:
            own = [row for row in rows if row["scene"] == scene and float(row["wanted"]) == percent]
            verdicts = Counter(row["verdict"] for row in own)
            errors = [float(row["error"]) for row in own if row["error"]]
            measured = verdicts["kept"] + verdicts["missed"]
            others = len(own) - measured - verdicts["not promised"]
            worst = f"{max(errors):.2g} %" if errors else "-"
            kept = f"{verdicts['kept']} of {measured}"
            lines.append((scene, f"{percent:g} %", kept, worst, verdicts["not promised"], others))
    return markdown(
        ("scene", "wanted", "kept", "worst", "not promised, and says so", "not ok, and says so"), lines
    )


TOPIC = Topic(
    "whether --accuracy keeps its promise on gears and tests of all kinds",
    "10 min",
    "accuracy_speed",
    run,
    {"measured": 1, "tried": 1, "scenes": ("free-pinion-torque",)},
    {"promises_kept": kept_table},
)
