"""Plans by their numbers, one after the other in a process of their own, and rows of what became of them."""

import json
import multiprocessing.connection
import os
from collections.abc import Callable, Sequence
from hashlib import sha256
from pathlib import Path
from time import monotonic
from typing import Any

from benchmarks.topic import load_rows, save_rows
from rps_exudyn.base.progress import Making, makers
from rps_exudyn.parameters.friction_law import LAWS, RUBBING_PARTS
from rps_exudyn.results.outcome import Status
from verification.stability import ScenePlan

COMPILING = 300.0  # [s] more where kernels are compiled; such a plan is done again
LOST = ("no-convergence", "diverged", "timeout", "crashed")

OutcomeOf = Callable[[Any, Callable[[dict[str, Any]], None]], dict[str, Any]]
"""Number of a plan, and what gets a part of its outcome early -> its outcome."""


def friction_of(plan: ScenePlan) -> str:
    """The law of a plan's parts that goes farthest beyond Coulomb's."""
    return max((getattr(plan.gear, part).friction_law for part in RUBBING_PARTS), key=list(LAWS).index)


def model_of(plan: ScenePlan) -> str:
    """The preset, or how a plan's motion is found."""
    usual = not plan.fidelity.changes() or plan.fidelity.based_on != "flank"
    return plan.fidelity.based_on if usual else plan.fidelity.solver


def text_of(plan: ScenePlan) -> str:
    """What was drawn, for `--set`: scene, and all that differs from the defaults [SI]."""
    model = {f"fidelity.{path}": value for path, value in plan.fidelity.changes().items()}
    return json.dumps({"scene": plan.scene} | plan.gear.changes() | model, default=float)


def mark_of(plan: ScenePlan) -> str:
    """A short mark of what was drawn: another one where declarations or ranges have changed since."""
    return sha256(text_of(plan).encode()).hexdigest()[:12]


def child(pipe: multiprocessing.connection.Connection, outcome_of: OutcomeOf) -> None:
    """Do plans by their numbers, as the parent sends them; compiling is on no plan's clock."""
    compiled: list[str] = []

    def listen(step: Making) -> None:
        if not compiled:
            pipe.send("compiling")
        compiled.append(step.sentence)

    makers.append(listen)
    while True:
        compiled.clear()
        try:
            number = pipe.recv()
        except EOFError:  # the parent has ended
            return
        outcome = _guarded(outcome_of, number, lambda found: pipe.send(("ran", found)))
        if compiled:
            pipe.send("again")
            outcome = _guarded(outcome_of, number, lambda found: pipe.send(("ran", found)))
        pipe.send(outcome)


def _guarded(outcome_of: OutcomeOf, number: Any, done: Callable[[dict[str, Any]], None]) -> dict[str, Any]:
    ran: dict[str, Any] = {}

    def kept(found: dict[str, Any]) -> None:
        ran.update(found)
        done(found)

    try:
        return outcome_of(number, kept)
    except Exception as error:
        if ran:
            return ran | {"reference": f"{type(error).__name__}: {error}"}
        return {"status": "crashed", "message": f"{type(error).__name__}: {error}"}


# --- all plans --------------------------------------------------------------------------------------
class Child:
    """A process that does plans, killed and started again when one is out of time."""

    def __init__(self, outcome_of: OutcomeOf) -> None:
        """`outcome_of` is a function of a module: the number of a plan -> what became of it."""
        self._outcome_of = outcome_of
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, other = context.Pipe()
        self.process = context.Process(target=child, args=(other, self._outcome_of), daemon=True)
        self.process.start()
        other.close()

    def _used(self) -> float:
        """CPU time of the process so far [s]; elapsed time where the system does not tell."""
        try:
            fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        except OSError:
            return monotonic()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def do(self, number: Any, limit: float) -> dict[str, Any]:
        """Outcome of a plan, or that it took longer than the limit [s], which begins anew with each part that
        it hands over early, or ended its process."""
        self.pipe.send(number)
        end, ran = self._used() + limit, {}
        try:
            while self._used() < end:
                if not self.pipe.poll(1.0):
                    continue
                if isinstance(received := self.pipe.recv(), dict):
                    return received
                if isinstance(received, tuple):
                    ran = received[1]
                end = self._used() + limit + (COMPILING if received == "compiling" else 0.0)
            status, message = Status.TIMEOUT.value, f"more than {limit:g} s of CPU time"
        except EOFError:
            status, message = "crashed", "its process ended"
        self.process.kill()
        self.process.join()
        self._start()
        if ran:
            return ran | {"reference": "; ".join(filter(None, (ran.get("reference"), message)))}
        return {"status": status, "message": message}


def described(number: int, plan: ScenePlan) -> dict[str, Any]:
    """Return what a row states of a plan before it is run."""
    row: dict[str, Any] = {"number": number, "plan": mark_of(plan), "scene": plan.scene}
    return row | {"friction": friction_of(plan), "model": model_of(plan)}


def go_on(
    path: Path,
    columns: Sequence[str],
    plans: int,
    plan_of: Callable[[int], ScenePlan],
    row_of: Callable[[int], dict[str, Any]],
) -> None:
    """Add the rows of the first plans to a data file, one after the other, which is written after each.

    A row that stands in it is left as it is, unless the plan was drawn from other declarations.
    """
    rows: dict[int, dict[str, Any]] = {int(row["number"]): row for row in load_rows(path)}
    for number in range(plans):
        if rows.get(number, {}).get("plan") == mark_of(plan_of(number)):
            continue
        rows[number] = row_of(number)
        write([rows[known] for known in sorted(rows)], path, columns)


def write(rows: list[dict[str, Any]], path: Path, columns: Sequence[str]) -> None:
    """Write all plans as a table."""
    values = [[row.get(name, "") for name in columns] for row in rows]
    save_rows(path, columns, [[f"{x:.4g}" if isinstance(x, float) else x for x in row] for row in values])
