"""Random plans over every declared parameter, each compared with figures known before it is run.

Of `PLANS` plans model and steps are random too; `GEARS` random gears are run in presets, as a user would.
Each has its own seed and a hard time limit. The right figures come from `verification.plan_reference`; a plan
that a check before the run refuses is run all the same, to see whether the refusal was a false alarm. Those
that need the same kernels are run one after the other, the most frequent ones first, for kernels compile for
a minute; among them plans and gears alternate. A run that is stopped goes on where it was.

    text_of(plan_of(792))       the settings of a plan
"""

import csv
import json
import multiprocessing
import multiprocessing.connection
import os
from collections import Counter
from collections.abc import Mapping
from hashlib import sha256
from math import isfinite, nan
from pathlib import Path
from time import monotonic, process_time
from typing import Any

import numpy as np

from benchmarks.topic import Topic, markdown
from rps_exudyn.base.compiling import CompileStep, listeners
from rps_exudyn.base.errors import InputError
from rps_exudyn.results.outcome import Code, Status
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.checks.before_run import refused
from rps_exudyn.simulate.run_plan import run_unchecked
from verification.plan_reference import Expected, expected
from verification.sampler import random_plan, usual_plan
from verification.stability import ScenePlan

SEED = 20261122
PLANS, GEARS = 1000, 300
PRESETS = ("quasi-static", "flank") * 8 + ("full",)
TIME_LIMIT = 30.0  # [s] of CPU time of one plan with its reference
COMPILING = 300.0  # [s] more where kernels are compiled; such a plan is done again
WRONG = 0.02  # error of the figure that must not be called ok
WRONG_RIPPLE = 0.05  # error of the peak-to-peak over the mean, likewise
RIPPLES = ("torque_peak_to_peak", "push_force_peak_to_peak")
DATA = "random_plans.csv"
COLUMNS = (
    "number", "kind", "verdict", "status", "error", "ripple_error", "reference", "refused", "message",
    "reference_seconds", "seconds", "plan",
)  # fmt: skip

WRONGLY_OK = ("SILENTLY WRONG", "SILENTLY WRONG RIPPLE")


def plan_of(number: int) -> ScenePlan:
    """The random plan of that number; from `PLANS` on a random gear in a preset."""
    rng = np.random.default_rng([SEED, number])
    return random_plan(rng) if number < PLANS else usual_plan(rng, PRESETS[number % len(PRESETS)])


def text_of(plan: ScenePlan) -> str:
    """What was drawn, for `--set`: scene, and all that differs from the defaults [SI]."""
    model = {f"fidelity.{path}": value for path, value in plan.fidelity.changes().items()}
    return json.dumps({"scene": plan.scene} | plan.gear.changes() | model, default=float)


def mark_of(plan: ScenePlan) -> str:
    """A short mark of what was drawn: another one where declarations or ranges have changed since."""
    return sha256(text_of(plan).encode()).hexdigest()[:12]


# --- one plan, in the child -------------------------------------------------------------------------
def outcome_of(number: int) -> dict[str, Any]:
    """Outcome of a plan, and its errors; one that failed and says so needs no reference."""
    plan = plan_of(number)
    start = process_time()
    refusal = "; ".join(refused(plan.gear, plan.fidelity, steady=scene_named(plan.scene).steady))
    try:
        result = run_unchecked(plan.scene, plan.gear, plan.fidelity)
    except InputError as error:
        return {"refused": refusal, "status": "input-error", "message": str(error)}
    except Exception as error:  # what is refused need not run
        if not refusal:
            raise
        return {"refused": refusal, "status": "crashed", "message": f"{type(error).__name__}: {error}"}
    found: dict[str, Any] = {"refused": refusal, "status": result.status.value}
    found |= {"message": result.message, "codes": result.codes}
    found["seconds"] = process_time() - start
    if result.status not in (Status.OK, Status.INVALID):
        return found
    start = process_time()
    right = expected(plan)
    found |= {"reference": right.cause or right.method, "reference_seconds": process_time() - start}
    return found | errors(plan, result, right)


def errors(plan: ScenePlan, result: Result, right: Expected) -> dict[str, float]:
    """Error of the scene's figure, and of the ripple over the mean where the summary has one; else nan."""
    figure = plan.figure(result)
    ripple = next((result.summary[name] for name in RIPPLES if name in result.summary), nan)
    return {
        "error": figure / right.figure - 1 if right.figure else nan,
        "ripple_error": (ripple - right.ripple) / abs(right.figure) if right.figure else nan,
    }


def child(pipe: multiprocessing.connection.Connection) -> None:
    """Do plans by their numbers, as the parent sends them; compiling is on no plan's clock."""
    compiled: list[int] = []

    def listen(step: CompileStep) -> None:
        if not compiled:
            pipe.send("compiling")
        compiled.append(step.done)

    listeners.append(listen)
    while True:
        compiled.clear()
        try:
            number = pipe.recv()
        except EOFError:  # the parent has ended
            return
        outcome = _guarded(number)
        if compiled:
            pipe.send("again")
            outcome = _guarded(number)
        pipe.send(outcome)


def _guarded(number: int) -> dict[str, Any]:
    try:
        return outcome_of(number)
    except Exception as error:
        return {"status": "crashed", "message": f"{type(error).__name__}: {error}"}


# --- all plans --------------------------------------------------------------------------------------
class Child:
    """A process that does plans, killed and started again when one is out of time."""

    def __init__(self) -> None:
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, other = context.Pipe()
        self.process = context.Process(target=child, args=(other,), daemon=True)
        self.process.start()
        other.close()

    def _used(self) -> float:
        """CPU time of the process so far [s]; elapsed time where the system does not tell."""
        try:
            fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        except OSError:
            return monotonic()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def do(self, number: int, limit: float) -> dict[str, Any]:
        """Outcome of a plan, or that it took longer than the limit [s] or ended its process."""
        self.pipe.send(number)
        end = self._used() + limit
        try:
            while self._used() < end:
                if not self.pipe.poll(1.0):
                    continue
                if isinstance(told := self.pipe.recv(), dict):
                    return told
                end = self._used() + limit + (COMPILING if told == "compiling" else 0.0)
            status, message = "timeout", f"more than {limit:g} s of CPU time"
        except EOFError:
            status, message = "crashed", "its process ended"
        self.process.kill()
        self.process.join()
        self._start()
        return {"status": status, "message": message}


def verdict(row: dict[str, Any]) -> str:
    """Return whether a plan was right, refused rightly or not, failed, or was silently wrong."""
    if row["status"] == "input-error":
        return "wrong input"
    if Code.BEYOND_LAW in row.get("codes", ()):  # of which the reference, by the same law, says nothing
        return "beyond the contact's law"
    error, ripple = row.get("error", nan), row.get("ripple_error", nan)
    mean_right, ripple_right = abs(error) <= WRONG, not abs(ripple) > WRONG_RIPPLE
    right, sound = mean_right and ripple_right, row["status"] == Status.OK
    if row.get("refused"):
        return "refused, was right" if sound and right else "refused"
    if not sound:
        return f"{row['status']}, was right" if row["status"] == Status.INVALID and right else row["status"]
    if not isfinite(error):
        return "ok, no reference"
    if right:
        return "right"
    return WRONGLY_OK[0] if not mean_right else WRONGLY_OK[1]


def run(folder: Path, plans: int = PLANS, gears: int = GEARS) -> None:
    """Run the first of both kinds, one after the other in a process of their own.

    What stands in the data file already is left as it is: delete the file to begin anew.
    """
    rows: dict[int, dict[str, Any]] = {int(row["number"]): row for row in read(folder / DATA)}
    worker = Child()
    drawn = {number: plan_of(number) for number in order(plans, gears)}
    for number in by_kernels(drawn):
        mark = mark_of(drawn[number])
        if rows.get(number, {}).get("plan") == mark:
            continue
        row: dict[str, Any] = {"number": number, "kind": "plan" if number < PLANS else "gear", "plan": mark}
        row |= worker.do(number, TIME_LIMIT)
        row["verdict"] = verdict(row)
        if row["verdict"] in WRONGLY_OK:
            print({name: row.get(name) for name in COLUMNS}, flush=True)
        rows[number] = row  # anew where it was drawn from other declarations
        write([rows[known] for known in sorted(rows)], folder / DATA)


def order(plans: int, gears: int) -> list[int]:
    """Numbers of plans and gears, spread evenly among each other."""
    parts = [((k + 0.5) / plans, k) for k in range(plans)]
    parts += [((k + 0.5) / gears, PLANS + k) for k in range(gears)]
    return [number for _, number in sorted(parts)]


def by_kernels(drawn: Mapping[int, ScenePlan]) -> list[int]:
    """Numbers of plans, those first whose kernels most of them share: a new combination compiles for a
    minute."""
    shared = Counter(map(kernels_of, drawn.values()))
    return sorted(drawn, key=lambda number: -shared[kernels_of(drawn[number])])


def kernels_of(plan: ScenePlan) -> tuple[str | bool, ...]:
    """What decides which kernels a plan needs."""
    model, gear = plan.fidelity, plan.gear
    bent = model.rack == "flexible" or gear.rack.bow != 0 or plan.scene == "yoke-impact"
    return model.solver, model.mesh, gear.mesh.law, model.bush == "chain", bent


def read(path: Path) -> list[dict[str, Any]]:
    """Return the plans that a run before this one did."""
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def write(rows: list[dict[str, Any]], path: Path) -> None:
    """Write all plans as a table."""
    with path.open("w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        table.writerows(
            row | {name: f"{value:.4g}" for name, value in row.items() if isinstance(value, float)}
            for row in rows
        )


def verdicts_table(folder: Path) -> str:
    """Verdicts of all plans and gears."""
    rows = read(folder / DATA)
    kinds = ("plan", "gear")
    counts = {kind: Counter(row["verdict"] for row in rows if row["kind"] == kind) for kind in kinds}
    names = [name for name, _ in sum(counts.values(), Counter()).most_common() if name not in WRONGLY_OK]
    lines = [("all", *(counts[kind].total() for kind in kinds))]
    lines += [(name, *(counts[kind][name] for kind in kinds)) for name in names]
    for name in WRONGLY_OK:
        lines.append((f"**{name.lower()}**", *(f"**{counts[kind][name]}**" for kind in kinds)))
    return markdown(("verdict", "random plans", "random gears"), lines)


TOPIC = Topic(
    "1000 random plans and 300 gears compared with references: right, refused, failed, silently wrong",
    "20 min",
    "stability",
    run,
    {"plans": 2, "gears": 2},
    {"random_plans": verdicts_table},
)
