"""Whether `--accuracy` keeps its promise on other gears, under tests drawn from the wide ranges.

Each scene gets random gears and tests like those of the table (`verification.wide_tests`), but other ones.
Each is run by `--accuracy` 1 and 0.1 % as a user would run it, and compared with a truth of its own by the
table's methods. A promise is kept if the error and the methods' difference together are within what was
wanted, missed if the error less their difference is not, and undecided between. Gears are drawn until
`JUDGED` promises of a scene and an accuracy are kept or missed. A run outside the promise's scope says so:
it fails, is refused, or calls its accuracy not promised, not reached or not confirmed.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from benchmarks.accuracy_speed.promise_scenes import SCENES, Measured
from benchmarks.topic import Topic, begun, load_data, markdown, save_data
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import write_json
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Status
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.law_by_scene import with_law
from rps_exudyn.simulate.by_accuracy import choose, known_scenes
from rps_exudyn.simulate.run import simulate
from verification.limited import cpu_limit
from verification.scene_truth import Truth, truth_of
from verification.wide_tests import gears_under_tests

SEED = 31
WANTED = (1.0, 0.1)
CHECKED = {name: SCENES[name] for name in SCENES if name in known_scenes()}
JUDGED, MOST = 20, 400  # promises kept or missed, and gears drawn, most of which rattle refuses at once
DATA = "promise_check.json"
PARTIAL = "promise_check.partial.json"
SAID = {Code.ACCURACY_NOT_PROMISED, Code.ACCURACY_NOT_REACHED, Code.ACCURACY_NOT_CONFIRMED}


def run(
    folder: Path,
    scenes: Mapping[str, Measured] = MappingProxyType(CHECKED),
    judged: int = JUDGED,
    most: int = MOST,
) -> None:
    """Draw gears, run and judge them; a run goes on with what the folder has."""
    keep = folder / PARTIAL
    rows: dict[str, list[dict[str, Any]]] = begun(keep)
    for scene, measured in scenes.items():
        known = rows.setdefault(scene, [])
        while len(known) < most and min(len(_promised(known, at)) for at in range(len(WANTED))) < judged:
            gear = gears_under_tests(SEED, scene, len(known) + 1)[-1]
            known.append(checked(scene, gear, measured))
            print(scene, len(known), [each["verdict"] for each in known[-1]["by"]], flush=True)
            write_json(keep, rows)
    save_data(folder / DATA, {"seed": SEED, "scenes": rows})
    keep.unlink()


def _promised(rows: Sequence[Mapping[str, Any]], at: int) -> list[Mapping[str, Any]]:
    """What was kept or missed of the promises of an accuracy, by its place."""
    return [row["by"][at] for row in rows if row["by"][at]["verdict"] in ("kept", "missed")]


def checked(scene: str, gear: SteeringGear, measured: Measured) -> dict[str, Any]:
    """What the promises were on one gear."""
    gear = with_law(gear, Fidelity.preset("flank"), scene_named(scene).law)  # as the run takes it
    allowed = measured.allowed(scene)
    everything = dict.fromkeys(allowed, np.inf)
    try:
        with cpu_limit(measured.longest):
            truth = truth_of(scene, gear, measured.methods, tuple(allowed), everything)
    except ArithmeticError as error:  # without a reference no run is judged, and none is made
        return {"reference": str(error), "by": [{"verdict": "no reference"} for _ in WANTED]}
    verdicts = [verdict_on(scene, gear, truth, wanted, measured.longest) for wanted in WANTED]
    return {"reference": truth.uncertainty, "by": verdicts}


def verdict_on(scene: str, gear: SteeringGear, truth: Truth, wanted: float, longest: float) -> dict[str, Any]:
    """Run a gear by an accuracy [%], and judge what came out."""
    try:
        quantity = choose(scene, gear, wanted).quantity
        with cpu_limit(longest):
            result = simulate(scene, gear, accuracy=f"{wanted:g}%")
    except InputError as refusal:
        return {"verdict": "refused", "said": str(refusal)}
    except ArithmeticError as late:
        return {"verdict": "too long", "said": str(late)}
    answer = {"quantity": quantity, "model": result.fidelity["name"]}
    if result.status is not Status.OK:
        return {**answer, "verdict": str(result.status), "said": result.message}
    error = truth.errors_of(result, Fidelity.model_validate(result.fidelity))[quantity]
    doubt = truth.uncertainty[quantity]
    verdict = "kept" if error + doubt <= wanted else "missed" if error - doubt > wanted else "undecided"
    if not SAID.isdisjoint(result.codes):
        verdict = "outside"
    return {**answer, "error": error, "doubt": doubt, "verdict": verdict}


def check_table(folder: Path) -> str:
    """Promises kept, by scene and accuracy, and what became of the runs that were not judged."""
    rows = []
    for scene, known in load_data(folder / DATA)["scenes"].items():
        cells, others = [], Counter[str]()
        for at in range(len(WANTED)):
            promised = _promised(known, at)
            worst = max((each["error"] for each in promised), default=0.0)
            kept = sum(each["verdict"] == "kept" for each in promised)
            cells.append(f"{kept} of {len(promised)}, {worst:.1g} %")
            verdicts = (row["by"][at]["verdict"] for row in known)
            others += Counter(each for each in verdicts if each not in ("kept", "missed"))
        rows.append((scene, *cells, ", ".join(f"{count} {name}" for name, count in others.most_common())))
    head = ("scene", *(f"{wanted:g} % wanted: kept, largest error" for wanted in WANTED), "not judged")
    return markdown(head, rows)


TOPIC = Topic(
    "30 min",
    "accuracy_speed",
    run,
    {"scenes": {"rack-lift": SCENES["rack-lift"]}, "judged": 1, "most": 1},
    {"promise_check": check_table},
)
