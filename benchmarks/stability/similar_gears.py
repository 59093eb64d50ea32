"""Random gears and their twins, mirrored and in other units of length, force and time: results are similar.

No reference is needed. A constant with a unit in the code that should be a parameter shows as a difference,
and so does what an iteration leaves. Gears are those of `verification.population`, in all scenes one after
the other, in the preset that a user would take.
"""

import csv
from collections import Counter
from dataclasses import replace
from math import isnan, nan
from pathlib import Path

from benchmarks.stability.random_plans import WRONG, WRONG_METRIC, read
from benchmarks.topic import Topic, markdown
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import SCENE_NAMES, scene_named
from rps_exudyn.simulate.run import simulate
from verification.population import random_gears
from verification.similar import differences, in_units, mirrored

SEED, GEARS = 33, 21
UNITS = {"length": 2.0, "force": 4.0, "time": 2**0.5}  # moduli of steel and the acceleration of gravity stay
SIDES = {"radial_play_side": "radial_play_other_side", "radial_play_other_side": "radial_play_side"}
UNCERTAIN = 3.0  # standard uncertainties that a result prints beside a metric, by which twins may differ
DATA = "similar_gears.csv"
COLUMNS = ("number", "scene", "twin", "verdict", "status", "of_twin", "metric", "difference")
TEST = {"test.turns": 0.3, "test.load_mass": "20 kg", "test.tyre_stiffness": "30 N/mm", "test.road_phases": 1}


def pairs(number: int, gear: SteeringGear) -> list[dict[str, object]]:
    """Run a gear and its twins in one of the scenes: a row for each twin."""
    scene = SCENE_NAMES[number % len(SCENE_NAMES)]
    fidelity = Fidelity.preset("flank" if scene_named(scene).needs_inertia else "quasi-static")
    gear = gear.replace(TEST)
    first, rows = _run(scene, gear, fidelity), []
    for name, twin, units in (("mirrored", mirrored, {}), ("other units", _in_units, UNITS)):
        row: dict[str, object] = {"number": number, "scene": scene, "twin": name}
        try:
            second = _run(scene, twin(gear), fidelity)
        except InputError as error:
            rows.append(row | {"verdict": "not allowed", "metric": str(error)})
            continue
        metric, share = _worst(first, _turned_back(second) if name == "mirrored" else second, units, scene)
        states = {"status": first.status.value, "of_twin": second.status.value}
        if first.status is not second.status:
            verdict = "other outcome"
        elif first.status is not Status.OK:
            verdict = "both fail"
        else:
            verdict = "similar" if share <= 1 else "different"
        rows.append(row | states | {"verdict": verdict, "metric": metric, "difference": share})
    return rows


def _in_units(gear: SteeringGear) -> SteeringGear:
    return in_units(gear, **UNITS)


def _run(scene: str, gear: SteeringGear, fidelity: Fidelity) -> Result:
    return simulate(scene, gear, fidelity)


def _turned_back(result: Result) -> Result:
    """The result of a mirrored gear with its sides exchanged."""
    summary = dict(result.summary)
    for one, other in list(SIDES.items())[:1]:
        if one in summary and other in summary:
            summary[one], summary[other] = summary[other], summary[one]
    return replace(result, summary=summary)


def _worst(first: Result, second: Result, units: dict[str, float], scene: str) -> tuple[str, float]:
    """The metric whose difference is largest, over what is allowed."""
    if not (first.status is second.status is Status.OK):
        return "", nan
    shares = {}
    for name, share in differences(first, second, **units).items():
        allowed = WRONG if name == scene_named(scene).figure else WRONG_METRIC
        stem = name.removesuffix("_per_cycle")
        if uncertainty := first.summary.get(f"{stem}_uncertainty", 0.0):
            allowed = max(allowed, UNCERTAIN * uncertainty / abs(first.summary[name]))
        shares[name] = float("inf") if isnan(share) else abs(share) / allowed
    shares = {name: share for name, share in shares.items() if "scatter" not in name and "uncert" not in name}
    metric = max(shares, key=lambda name: shares[name], default="")
    return metric, shares.get(metric, 0.0)


def run(folder: Path, gears: int = GEARS) -> None:
    """Run gears and twins, and write a row for each pair."""
    rows = []
    for number, gear in enumerate(random_gears(SEED, gears)):
        rows += pairs(number, gear)
        with (folder / DATA).open("w", newline="") as file:
            table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            table.writeheader()
            table.writerows(
                row | {"difference": f"{row['difference']:.3g}"} if "difference" in row else row
                for row in rows
            )


def verdicts_table(folder: Path) -> str:
    """Verdicts by twin."""
    rows = read(folder / DATA)
    twins = sorted({row["twin"] for row in rows})
    counts = Counter((row["verdict"], row["twin"]) for row in rows)
    verdicts = sorted({row["verdict"] for row in rows})
    return markdown(
        ("verdict", *twins), [(each, *(counts[each, twin] for twin in twins)) for each in verdicts]
    )


TOPIC = Topic(
    "random gears, mirrored and in other units of length, force and time: results are similar",
    "3 min",
    "stability",
    run,
    {"gears": 1},
    {"similar_gears": verdicts_table},
)
