"""Whether runs by `--accuracy` are as exact as asked for, on random tests of every scene.

Gears of the usual kind under tests from the wide ranges are run by 1 and 0.1 %. The scene's own metric is
compared with a reference that is made without the ladder: by another method where there is one, else by finer
runs, with a doubt of their own. A run is judged where that doubt is at most half of what is asked; it misses
where its error is larger than asked for by more than the doubt. A run that is stopped goes on where it was.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from time import process_time
from typing import Any

from benchmarks.stability.plan_worker import Child, described, go_on
from benchmarks.stability.references import best_reference, size_in
from benchmarks.topic import Topic, load_rows, markdown
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.outcome import Code, Status
from rps_exudyn.scenes import SCENE_NAMES, scene_named
from rps_exudyn.simulate.by_accuracy import AccuracyGoal, climb
from rps_exudyn.simulate.cases.time_limit import TimeLimit
from rps_exudyn.solvers.temperature_and_wear import tested_gear
from verification.sampler import REACHES
from verification.stability import ScenePlan
from verification.wide_tests import gears_under_tests

SEED = 20261130
TESTS = 60  # of each scene
WANTED = (1.0, 0.1)  # [%]
SCENES = tuple(name for name in SCENE_NAMES if name in REACHES)
CLIMB_LIMIT = 20.0  # [s] of elapsed time, beyond which no level is begun
TIME_LIMIT = 120.0  # [s] of CPU time of one test with its references
SURE = 0.5  # of what is asked for, the doubt above which a reference judges nothing
DATA = "climb.csv"
COLUMNS = (
    *("number", "plan", "scene", "friction", "model", "status", "seconds", "message", "reference"),
    *(f"{name}_{wanted:g}" for wanted in WANTED for name in ("by", "reached", "cost", "error", "doubt")),
)


def plan_of(number: int) -> ScenePlan:
    """The test of that number; scenes take turns."""
    scene = SCENES[number % len(SCENES)]
    (gear,) = gears_under_tests([SEED, number], scene, 1)
    model = Fidelity.preset("flank" if scene_named(scene).needs_inertia else "quasi-static")
    return ScenePlan(scene, gear, model)


def outcome_of(number: int, done: Callable[[dict[str, Any]], None] = lambda found: None) -> dict[str, Any]:
    """What came of a test by each accuracy: preset and level, whether reached, cost [s], error and its doubt
    over the metric's size [%]."""
    plan, begun, found = plan_of(number), process_time(), dict[str, Any]()
    main_metric, results = scene_named(plan.scene).main_metric, {}
    for wanted in WANTED:
        try:
            result = climb(plan.scene, plan.gear, AccuracyGoal.of(f"{wanted:g}%"), TimeLimit(CLIMB_LIMIT))
        except InputError as error:
            return found | {"status": "input-error", "message": str(error)}
        found |= {"status": result.status.value, "message": result.message, "seconds": process_time() - begun}
        reached = result.status is Status.OK and Code.ACCURACY_NOT_REACHED not in result.codes
        found |= {f"by_{wanted:g}": f"{result.fidelity['based_on']} {result.findings.get('level', '')}"}
        found |= {f"reached_{wanted:g}": int(reached), f"cost_{wanted:g}": result.cpu_s}
        done(found)
        if reached and main_metric in result.summary:
            results[wanted] = result
    tested = replace(plan, gear=tested_gear(plan.gear))
    right = best_reference(tested, main_metric) if results else None
    if right is None:
        return found
    how, value, doubt = right
    for wanted, result in results.items():
        size = size_in(result, main_metric)
        found |= {f"error_{wanted:g}": 100 * abs(result.summary[main_metric] - value) / size}
        found |= {f"doubt_{wanted:g}": 100 * doubt / size}
    return found | {"reference": how}


def run(folder: Path, plans: int = TESTS * len(SCENES)) -> None:
    """Run so many tests, scene after scene, one after the other in a process of their own."""
    worker = Child(outcome_of)

    def row_of(number: int) -> dict[str, Any]:
        return described(number, plan_of(number)) | worker.do(number, TIME_LIMIT)

    go_on(folder / DATA, COLUMNS, plans, plan_of, row_of)
    print(climb_table(folder), flush=True)


def climb_table(folder: Path) -> str:
    """Tests reached, misses of those that are judged, and cost, by accuracy."""
    rows, lines = load_rows(folder / DATA), []
    for wanted in WANTED:
        some = [row for row in rows if row[f"by_{wanted:g}"]]
        reached = [row for row in some if row[f"reached_{wanted:g}"] == "1"]
        judged = [(error, doubt) for error, doubt in map(_judged(wanted), reached) if doubt <= SURE * wanted]
        misses = sum(error - doubt > wanted for error, doubt in judged)
        largest = f"{max(error for error, _ in judged):.2g} %" if judged else "-"
        seconds = sum(float(row[f"cost_{wanted:g}"]) for row in some)
        lines.append(
            (f"{wanted:g} %", len(some), len(reached), len(judged), misses, largest, f"{seconds:.3g} s")
        )
    head = "asked for", "tests", "reached", "judged", "misses", "largest error", "CPU time"
    return markdown(head, lines)


def _judged(wanted: float) -> Callable[[Mapping[str, str]], tuple[float, float]]:
    """Return what reads error and doubt of a row [%]; inf where there is no reference."""
    return lambda row: (float(row[f"error_{wanted:g}"] or "inf"), float(row[f"doubt_{wanted:g}"] or "inf"))


TOPIC = Topic("2 h", "accuracy_speed", run, {"plans": 2}, {"climb": climb_table})
