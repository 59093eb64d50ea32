"""Gears of the wide population in every scene, by every friction law: how many runs of dynamics are lost.

Gears and tests are drawn by `verification.sampler`, all their parts with the same friction law. Those that
equilibria end `ok`, or refuse only because inertia matters, are run by dynamics (`flank`); where equilibria
cannot show the scene, those that they end `ok` in turning steadily. Lost is a run that did not converge,
diverged, crashed, or took more than 30 s of CPU time. A run that is stopped goes on
where it was.
"""

from collections.abc import Callable, Iterable
from itertools import product
from pathlib import Path
from time import process_time
from typing import Any
from zlib import crc32

import numpy as np

from benchmarks.stability.plan_worker import LOST, Child
from benchmarks.topic import Topic, load_rows, markdown, save_rows
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.friction_law import LAWS, RUBBING_PARTS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Status
from rps_exudyn.scenes import scene_named
from rps_exudyn.simulate.run import simulate
from verification.sampler import SCENE_WEIGHTS, random_gear

SEED = 33
TIME_LIMIT = 30.0  # [s] of CPU time of a run
GEARS = 5  # in each scene by each law
STEADY = "free-pinion-torque"
SCENES = [scene for scene in SCENE_WEIGHTS if not scene_named(scene).at_rest]
TOO_FAST = (Code.TURN_TOO_FAST,)  # for equilibria: dynamics follow
DATA = "wide_gears.csv"
COLUMNS = ("scene", "law", "number", "equilibria", "dynamics", "codes", "restarts", "seconds", "message")


def drawn(scene: str, law: str, number: int) -> SteeringGear:
    """The gear of that number, all its parts with one friction law."""
    rng = np.random.default_rng([SEED, crc32(f"{scene} {law}".encode()), number])
    return random_gear(rng, scene).replace({f"{part}.friction_law": law for part in RUBBING_PARTS})


def outcome_of(
    key: tuple[str, str, int], done: Callable[[dict[str, Any]], None] = lambda found: None
) -> dict[str, Any]:
    """How a gear ends by equilibria and by dynamics; `done` gets the first, before the second is run."""
    (scene, *_), gear, start, found = key, drawn(*key), process_time(), dict[str, Any]()
    for name, fidelity in (("equilibria", "quasi-static"), ("dynamics", "flank")):
        steadily = name == "equilibria" and scene_named(scene).needs_inertia
        try:
            result = simulate(STEADY if steadily else scene, gear, fidelity)
        except InputError as error:
            return found | {name: Status.INVALID.value, "message": str(error)}
        found |= {name: result.status.value, "message": result.message, "codes": " ".join(result.codes)}
        found |= {"restarts": result.counters.get("restarts", 0), "seconds": process_time() - start}
        if result.status is not Status.OK and tuple(result.codes) != TOO_FAST:
            break
        done(found | {"dynamics": Status.TIMEOUT.value})
    return found


def run(folder: Path, gears: int = GEARS, scenes: Iterable[str] = SCENES) -> None:
    """Run so many gears in each scene by each law that are not in the data file yet."""
    rows: list[dict[str, Any]] = [*load_rows(folder / DATA)]
    worker = Child(outcome_of)
    known = {(row["scene"], row["law"], int(row["number"])) for row in rows}
    for number, scene, law in product(range(gears), scenes, LAWS):
        if (scene, law, number) in known:
            continue
        found = worker.do((scene, law, number), TIME_LIMIT)
        found.setdefault("equilibria", found.get("status"))  # of a process that ended meanwhile
        rows.append({"scene": scene, "law": law, "number": number} | found)
        save_rows(folder / DATA, COLUMNS, [[each.get(name, "") for name in COLUMNS] for each in rows])


def losses_table(folder: Path) -> str:
    """Gears lost of those run, by law and scene; scenes that lose none stand in one line."""
    rows = load_rows(folder / DATA)

    def line(name: str, column: str, *values: str) -> tuple[str, ...]:
        cells = []
        for model in ("equilibria", "dynamics"):
            ran = [row[model] for row in rows if row[model] and (not values or row[column] in values)]
            cells.append(f"{sum(each in LOST for each in ran)} of {len(ran)}")
        return name, *cells

    scenes = dict.fromkeys(row["scene"] for row in rows)
    losing = {row["scene"] for row in rows if {row["equilibria"], row["dynamics"]} & {*LOST}}
    others = [scene for scene in scenes if scene not in losing]
    lines = [
        line(each, column, each) for column, kinds in (("law", LAWS), ("scene", scenes)) for each in kinds
    ]
    lines = [each for each in lines if each[0] not in others]
    if others:
        lines.append(line(f"{len(others)} others", "scene", *others))
    return markdown(("law, scene", "equilibria", "dynamics"), [*lines, line("**all**", "law")])


TOPIC = Topic("30 min", "stability", run, {"gears": 1, "scenes": (STEADY,)}, {"wide_gears": losses_table})
