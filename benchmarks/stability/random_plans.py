"""Random plans over every declared parameter, scene and choice, compared with references made without them.

Of four plans one is a random gear in a preset, as a user would run it; the others have random models and
steps too. Each has its own seed and hard time limits. The scene's figure is judged by `plan_reference` and
`behind_column` of verification, every other metric by finer runs, where half their steps confirm it. A plan
that a check before the run refuses is run all the same, to see whether the refusal was a false alarm. A run
that is stopped goes on where it was.
"""

import json
import multiprocessing.connection
import os
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from hashlib import sha256
from math import isfinite, nan
from pathlib import Path
from time import monotonic, process_time
from typing import Any

import numpy as np

from benchmarks.topic import Topic, load_rows, markdown, save_rows
from rps_exudyn.base.compiling import CompileStep, listeners
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.friction_law import LAWS, RUBBING_PARTS
from rps_exudyn.results.outcome import Code, Status
from rps_exudyn.results.quantities import LOSS_SHARES, SCATTERS, SUMMARY
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.checks.rules import refused
from rps_exudyn.simulate.run_plan import run_unchecked
from rps_exudyn.solvers.temperature_and_wear import tested_gear
from verification.behind_column import settled_figures
from verification.plan_reference import expected, finer_metrics
from verification.refined_steps import NotFoundError
from verification.sampler import random_plan, usual_plan
from verification.stability import ScenePlan, cpu_time_limit

SEED = 20261124
PLANS = 1000
EVERY_PRESET = 4  # of so many plans one has a preset
TIME_LIMIT = 30.0  # [s] of CPU time of one plan ...
REFERENCE_LIMIT = 10.0  # ... and of each of its references
COMPILING = 300.0  # [s] more where kernels are compiled; such a plan is done again
SURE = 0.3  # of a metric's tolerance, the doubt above which a reference judges nothing
OF_LARGEST = 0.01  # of the largest metric of a unit, besides its own size, by which an error is counted
LEAST_SIZES = {"m": 1e-7, "rad": 1e-6, "": 1e-3}  # the same where sizes of one unit have nothing in common
BY_EQUATIONS = ("free-pinion-torque", "rack-push", "load-test", "reversal", "yoke-impact")
BEHIND_COLUMN = ("steering-feel", "stick-slip")
RIPPLES = ("torque_peak_to_peak", "push_force_peak_to_peak")
OWN_UNITS = ("N*m", "N", "J", "W")
NOT_JUDGED = "energy_residual"  # a check of the run itself
LARGEST_SHOWN = 0.1  # of plans lost or called wrong, from which a kind of them has a row
DATA = "random_plans.csv"
COLUMNS = (
    "number", "scene", "friction", "model", "verdict", "status", "error", "metric", "metric_error", "judged",
    "reference", "refused", "message", "reference_seconds", "seconds", "plan",
)  # fmt: skip

OutcomeOf = Callable[[Any, Callable[[dict[str, Any]], None]], dict[str, Any]]
"""Number of a plan, and what gets a part of its outcome early -> its outcome."""

OTHER = 0.05  # error of a metric that must not be called ok
SCATTERED = 2  # times the scatter that is printed with a metric, by which it may change
WRONGLY_OK = ("SILENTLY WRONG", "SILENTLY WRONG METRIC")
DISPUTED = "right by one of two references"
LOST = ("no-convergence", "diverged", "timeout", "crashed")
FALSE_ALARMS = ("invalid, was right", "refused, was right")


def plan_of(number: int) -> ScenePlan:
    """The random plan of that number."""
    rng = np.random.default_rng([SEED, number])
    return usual_plan(rng) if number % EVERY_PRESET == 0 else random_plan(rng)


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


# --- one plan, in the child -------------------------------------------------------------------------
def outcome_of(number: int, done: Callable[[dict[str, Any]], None] = lambda found: None) -> dict[str, Any]:
    """Outcome of a plan, and its errors; one that failed and says so needs no reference.

    `done` gets the outcome before the references are made, and after each.
    """
    plan, start, refusal = plan_of(number), process_time(), ""
    try:
        tested = replace(plan, gear=tested_gear(plan.gear))
        refusal = "; ".join(refused(tested.gear, plan.fidelity, motion=scene_named(plan.scene).motion))
        result = run_unchecked(plan.scene, plan.gear, plan.fidelity)
    except InputError as error:
        return {"refused": refusal, "status": "input-error", "message": str(error)}
    except Exception as error:  # what is refused need not run
        if not refusal:
            raise
        return {"refused": refusal, "status": "crashed", "message": f"{type(error).__name__}: {error}"}
    found: dict[str, Any] = {"refused": refusal, "status": result.status.value, "codes": result.codes}
    found |= {"message": result.message, "seconds": process_time() - start}
    failed = result.status not in (Status.OK, Status.INVALID) or Code.BEYOND_LAW in result.codes
    if failed or plan.fidelity.solver == "closed-form":
        return found
    done(found)
    start, made = process_time(), list[tuple[str, Values]]()
    for reference in references(tested, result.summary.keys()):
        made.append(reference)
        names, right = zip(*made, strict=True)
        found |= {"reference": "; ".join(names), "reference_seconds": process_time() - start}
        found |= errors(plan, result.summary, right)
        done(found)
    return found


Values = dict[str, tuple[float, float]]
"""Metric -> its right value, and how far that can be doubted."""


def references(plan: ScenePlan, printed: Collection[str]) -> Iterator[tuple[str, Values]]:
    """Yield what each reference is, or why there is none, and the right values of printed metrics by it."""
    if plan.scene in BY_EQUATIONS:
        yield by_equations(plan, printed)
    if plan.scene in BEHIND_COLUMN:
        yield behind_column(plan)
    try:
        yield "finer runs", finer_metrics(plan)
    except NotFoundError as error:
        yield str(error), {}


def by_equations(plan: ScenePlan, printed: Collection[str]) -> tuple[str, Values]:
    """Return the scene's figure and ripple by other methods than the package's."""
    try:
        with cpu_time_limit(REFERENCE_LIMIT):
            right = expected(plan)
    except TimeoutError as error:
        return str(error), {}
    if not isfinite(right.figure):
        return right.cause or right.method, {}
    values = {scene_named(plan.scene).figure: (right.figure, right.figure_doubt)}
    still = plan.fidelity.solver == "equilibrium" and right.method == "equilibria"
    if still and isfinite(right.ripple):  # vibration adds to that of dynamics, by what the start excites
        values |= {name: (right.ripple, right.ripple_doubt) for name in RIPPLES if name in printed}
    return right.cause or right.method, values


def behind_column(plan: ScenePlan) -> tuple[str, Values]:
    """Return the scene's figure behind a column, integrated by a method of its own."""
    try:
        right, finer = settled_figures(plan, REFERENCE_LIMIT / 2)
    except (NotFoundError, TimeoutError, np.linalg.LinAlgError) as error:
        return str(error), {}
    values = {scene_named(plan.scene).figure: (right.figure, 0.0)}
    if plan.scene == "stick-slip":
        values["breakaway_torque"] = right.peak, 0.0
    return f"implicit Runge-Kutta, {finer}", values


def errors(plan: ScenePlan, summary: Mapping[str, float], right: Sequence[Values]) -> dict[str, Any]:
    """Error of the scene's figure, and that of the metric that is most wrong, its name, and how many are
    judged; whether one is right by a reference and wrong by another, both sure of themselves.

    The figure is judged by the reference that it is nearest to, of those that are sure of it; another metric
    by the first of these, unless that one alone calls it wrong.
    """
    figure = scene_named(plan.scene).figure
    found: dict[str, list[float]] = {}
    for values in right:
        for name in summary.keys() & values.keys() - {NOT_JUDGED}:
            value, doubt = values[name]
            scatter = SCATTERED * summary.get(SCATTERS.get(name, ""), 0.0)  # printed with it
            size = max(size_of(name, values), scatter / tolerance(name))
            if size > 0 and doubt <= SURE * tolerance(name) * size:
                found.setdefault(name, []).append((summary[name] - value) / size)

    def taken(name: str) -> float:
        first, nearest = found[name][0], min(found[name], key=abs)
        return nearest if name == figure or is_wrong(name, first) else first

    def is_disputed(name: str) -> bool:
        against = found[name] if name == figure else found[name][:1]
        return not is_wrong(name, taken(name)) and any(is_wrong(name, each) for each in against)

    others = found.keys() - {figure}
    worst = max(sorted(others), key=lambda name: abs(taken(name)) / tolerance(name), default="")
    return {
        "error": taken(figure) if figure in found else nan,
        "metric": worst,
        "metric_error": taken(worst) if worst else nan,
        "judged": len(found),
        "disputed": any(map(is_disputed, found)),
    }


def tolerance(name: str) -> float:
    """Return the error of a metric that must not be called ok."""
    return OTHER


def is_wrong(name: str, error: float) -> bool:
    """Return whether a metric is off by more than its tolerance."""
    return abs(error) > tolerance(name)


def size_of(name: str, right: Mapping[str, tuple[float, float]]) -> float:
    """Return what the error of a metric is counted by, in its unit: its size and a hundredth of the largest
    of its kind, for what is small besides may be wrong by more; shares of the loss are of one kind."""
    unit = SUMMARY[name].unit if name in SUMMARY else ""
    least = SUMMARY[name].least if name in SUMMARY else 0.0
    own, alike = max(abs(right[name][0]), least), LOSS_SHARES
    if unit in OWN_UNITS:
        alike = frozenset(other for other in right if other in SUMMARY and SUMMARY[other].unit == unit)
    if name not in alike:
        return own + LEAST_SIZES.get(unit, 0.0)
    return own + OF_LARGEST * max(abs(right[other][0]) for other in alike & right.keys())


def child(pipe: multiprocessing.connection.Connection, outcome_of: OutcomeOf) -> None:
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

    def do(self, number: Any, limit: float, then: float = REFERENCE_LIMIT) -> dict[str, Any]:
        """Outcome of a plan, or that it took longer than the limit [s] or ended its process; `then` is the
        limit of what follows each part that it hands over early."""
        self.pipe.send(number)
        end, ran = self._used() + limit, {}
        try:
            while self._used() < end:
                if not self.pipe.poll(1.0):
                    continue
                if isinstance(received := self.pipe.recv(), dict):
                    return received
                if isinstance(received, tuple):
                    ran, limit = received[1], then
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


def verdict(row: dict[str, Any]) -> str:
    """Return whether a plan was right, refused rightly or not, failed, or was silently wrong."""
    if row["status"] == "input-error":
        return "wrong input"
    if Code.BEYOND_LAW in row.get("codes", ()):  # of which the reference, by the same law, says nothing
        return "beyond the contact's law"
    if row.get("model") == "closed-form":  # formulas, whose errors stand where they are described
        return "by formula" if row["status"] == Status.OK else row["status"]
    error, other = row.get("error", nan), row.get("metric_error", nan)
    judged = isfinite(error) or isfinite(other)
    wrong = is_wrong(scene_named(row["scene"]).figure, error)
    right, sound = not (wrong or is_wrong(row.get("metric", ""), other)), row["status"] == Status.OK
    if row.get("refused"):
        return "refused, was right" if sound and judged and right else "refused"
    if not sound:
        return "invalid, was right" if row["status"] == Status.INVALID and judged and right else row["status"]
    if not judged:
        return "ok, no reference"
    if right:
        return DISPUTED if row.get("disputed") else "right"
    return WRONGLY_OK[0] if wrong else WRONGLY_OK[1]


def run(folder: Path, plans: int = PLANS) -> None:
    """Run the first plans, one after the other in a process of their own.

    What stands in the data file already is left as it is: delete the file to begin anew.
    """
    worker = Child(outcome_of)

    def judged(number: int) -> dict[str, Any]:
        plan = plan_of(number)
        row = described(number, plan) | worker.do(number, TIME_LIMIT)
        row["verdict"] = verdict(row)
        if row["verdict"] in WRONGLY_OK:
            print({name: row.get(name) for name in COLUMNS}, flush=True)
        return row

    go_on(folder / DATA, COLUMNS, plans, plan_of, judged)


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


def write(rows: list[dict[str, Any]], path: Path, columns: Sequence[str] = COLUMNS) -> None:
    """Write all plans as a table."""
    values = [[row.get(name, "") for name in columns] for row in rows]
    save_rows(path, columns, [[f"{x:.4g}" if isinstance(x, float) else x for x in row] for row in values])


def verdicts_table(folder: Path) -> str:
    """Verdicts of all plans."""
    rows, kinds = load_rows(folder / DATA), ("random model", "preset")
    of_kind = {kind: [row for row in rows if kind_of(row) == kind] for kind in kinds}
    counts = {kind: Counter(row["verdict"] for row in of_kind[kind]) for kind in kinds}
    names = [name for name, _ in sum(counts.values(), Counter()).most_common() if name not in WRONGLY_OK]
    lines = [("all", *(counts[kind].total() for kind in kinds))]
    lines += [(name, *(counts[kind][name] for kind in kinds)) for name in names]
    for name in WRONGLY_OK:
        lines.append((f"**{name.lower()}**", *(f"**{counts[kind][name]}**" for kind in kinds)))
    return markdown(("verdict", *kinds), lines)


def kind_of(row: Mapping[str, str]) -> str:
    """Return whether the model of a row's plan is a preset."""
    return "random model" if int(row["number"]) % EVERY_PRESET else "preset"


def losses_table(folder: Path) -> str:
    """Plans lost and false alarms of those run, by scene, friction law and model, where one is many."""
    rows = load_rows(folder / DATA)
    lines: list[tuple[str, ...]] = []
    for column in ("scene", "friction", "model"):
        for value, count in sorted(Counter(row[column] for row in rows).items()):
            verdicts = [row["verdict"] for row in rows if row[column] == value]
            shares = [sum(each in kind for each in verdicts) / count for kind in (LOST, FALSE_ALARMS)]
            if max(shares) >= LARGEST_SHOWN:
                lines.append((value, str(count), *(f"{share:.0%}" for share in shares)))
    return markdown(("scene, friction, model", "plans", "lost", "false alarms"), lines)


TOPIC = Topic(
    "3 h", "stability", run, {"plans": 2}, {"random_plans": verdicts_table, "lost_plans": losses_table}
)
