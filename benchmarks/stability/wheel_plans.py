"""Random plans of the scenes that turn the wheel, each compared with an integration of its own.

Gears are drawn as for the other random plans, but each part's friction law as well, with its numbers; models
are presets with a random friction zone. The reference (`verification.behind_column`) is made in shorter steps
until two lengths of them agree, and says nothing where they do not. A run that is stopped goes on where it
was.
"""

from collections import Counter
from functools import cache
from math import nan
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from benchmarks.stability.random_plans import COLUMNS, WRONG, WRONGLY_OK, mark_of, read, verdict, write
from benchmarks.topic import Topic, markdown
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.scenes.checks.before_run import refused
from rps_exudyn.simulate.run_plan import run_unchecked
from verification.behind_column import Behind, Wheel, WheelFigures, settled_figures, size_of
from verification.refined_steps import NotFoundError
from verification.sampler import REACHES, drawn, random_gear
from verification.stability import ScenePlan, cpu_time_limit
from verification.stated_ranges import GEAR

SEED = 17
PLANS = 200
SCENES = ("steering-feel", "stick-slip")
ZONES = 1e-3, 1e-2
TIME_LIMIT = 10.0  # [s] of CPU time of a plan, and of each of its references
DATA = "wheel_plans.csv"


def plan_of(number: int) -> ScenePlan:
    """The random plan of that number."""
    rng = np.random.default_rng([SEED, number])
    scene = SCENES[number % len(SCENES)]
    while True:
        gear = random_gear(rng, "reversal" if scene == "stick-slip" else scene)
        laws = {path: value for path, value in drawn(rng, type(gear), GEAR).items() if "friction_law" in path}
        gear = gear.replace(laws)
        try:
            REACHES[scene](gear)
        except InputError:
            continue
        break
    still = scene == "steering-feel" and rng.random() < 0.5
    zone = float(np.exp(rng.uniform(*np.log(ZONES))))
    fidelity = Fidelity.preset("quasi-static" if still else "flank").replace({"zone_ratio": zone})
    return ScenePlan(scene, gear, fidelity)


@cache
def warm_up(scene: str, law: str, solver: str, bowed: bool) -> None:
    """Load or compile the kernels of a model, which is on no plan's clock."""
    bow = 1e-6 if bowed else 0.0
    gear = SteeringGear().replace({"mesh.law": law, "test.amplitude": "1 deg", "rack.bow": bow})
    fidelity = Fidelity.preset("quasi-static" if solver == "equilibrium" else "flank")
    run_unchecked(scene, gear, fidelity)
    Behind.at_rest(ScenePlan(scene, gear, fidelity), Wheel(np.zeros_like, np.zeros_like)).go(1e-4)


def outcome_of(plan: ScenePlan) -> dict[str, Any]:
    """Outcome of a plan, and its errors; one that failed and says so needs no reference."""
    warm_up(plan.scene, plan.gear.mesh.contact_law, plan.fidelity.solver, plan.gear.rack.bow != 0)
    start = process_time()
    found: dict[str, Any] = {"refused": "; ".join(refused(plan.gear, plan.fidelity, steady=False))}
    try:
        with cpu_time_limit(TIME_LIMIT):
            result = run_unchecked(plan.scene, plan.gear, plan.fidelity)
    except InputError as error:
        return found | {"status": "input-error", "message": str(error)}
    except TimeoutError as error:
        return found | {"status": "timeout", "message": str(error)}
    found |= {"status": result.status.value, "message": result.message, "codes": result.codes}
    found["seconds"] = process_time() - start
    if result.status not in (Status.OK, Status.INVALID):
        return found
    start = process_time()
    try:
        right, finer = settled_figures(plan, TIME_LIMIT)
    except (NotFoundError, TimeoutError, np.linalg.LinAlgError) as error:
        found |= {"reference": str(error)}
    else:
        found |= {"reference": f"implicit Runge-Kutta, {finer}", **errors(plan, result, right)}
    return found | {"reference_seconds": process_time() - start}


def errors(plan: ScenePlan, result: Result, right: WheelFigures) -> dict[str, float]:
    """Error of the figure; of stick-slip's peak as well."""
    error = (plan.figure(result) - right.figure) / size_of(plan, right)
    if plan.scene == "steering-feel":
        return {"error": error, "metric_error": nan}
    return {"error": error, "metric_error": result.summary["breakaway_torque"] / right.peak - 1}


def run(folder: Path, plans: int = PLANS, first: int = 0) -> None:
    """Run plans from a first one on; what stands in the data file already is left as it is."""
    rows: dict[int, dict[str, Any]] = {int(row["number"]): row for row in read(folder / DATA)}
    for number in range(first, plans):
        plan = plan_of(number)
        if rows.get(number, {}).get("plan") == mark_of(plan):
            continue
        row = {"number": number, "scene": plan.scene, "plan": mark_of(plan), **outcome_of(plan)}
        row["verdict"] = verdict(row)
        if row["verdict"] in WRONGLY_OK:
            print({name: row.get(name) for name in COLUMNS}, flush=True)
        rows[number] = row
        write([rows[known] for known in sorted(rows)], folder / DATA)


def verdicts_table(folder: Path) -> str:
    """Verdicts of the plans of each scene, and their largest errors."""
    rows = read(folder / DATA)
    counts = {scene: Counter(row["verdict"] for row in rows if row["scene"] == scene) for scene in SCENES}
    names = [name for name, _ in sum(counts.values(), Counter()).most_common() if name not in WRONGLY_OK]
    lines = [("all", *(counts[scene].total() for scene in SCENES))]
    lines += [(name, *(counts[scene][name] for scene in SCENES)) for name in names]
    lines += [
        (f"**{name.lower()}**", *(f"**{counts[scene][name]}**" for scene in SCENES)) for name in WRONGLY_OK
    ]
    right = [
        [abs(float(row["error"])) for row in rows if row["scene"] == scene and row["verdict"] == "right"]
        for scene in SCENES
    ]
    lines.append(
        ("largest error of those right", *(f"{100 * max(each):.2g} %" if each else "-" for each in right))
    )
    return markdown(("verdict", *SCENES), lines)


TOPIC = Topic(
    f"{PLANS} random plans of steering-feel and stick-slip against an integration of its own, to {WRONG:.0%}",
    "30 min",
    "stability",
    run,
    {"plans": 2, "first": 1},
    {"wheel_plans": verdicts_table},
)
