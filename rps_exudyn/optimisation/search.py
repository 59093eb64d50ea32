"""The search among designs, by pymoo's NSGA-II, in a study's folder: each design is a case, stored when done.

The search asks for designs in an order that follows from the seed and from the numbers of those before. It is
begun anew each time, and takes from the folder what is there: a killed search ends as one that was not.
"""

import hashlib
import json
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import content_of, replacing
from rps_exudyn.base.screen import open_screen
from rps_exudyn.optimisation.definition import Problem, values_at
from rps_exudyn.optimisation.evaluation import evaluate
from rps_exudyn.parameters.derived import DERIVED
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.block import CaseRecord, CaseRow
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.provenance import provenance
from rps_exudyn.results.result import Result, read_result
from rps_exudyn.simulate.cases.run_cases import CaseRunner
from rps_exudyn.simulate.cases.task import Task
from rps_exudyn.study.case_progress import CasesRow, Group, case_line, groups, log_lines
from rps_exudyn.study.cases import case_hash, describe
from rps_exudyn.study.definition import Case, Value
from rps_exudyn.study.store import Store

DESIGN = "optimised"
AGAIN = (Status.CRASHED, Status.TIMEOUT)  # the machine may have been the cause
FAR = 1e9  # objective and excess of a refused design: any other is better
DIGITS = 9  # of a place between bounds


@dataclass(frozen=True, eq=False)
class Design:
    """A design that was computed.

    Attributes:
        case: its hash and its variables.
        gear: with these, and with the parameters that follow.
        numbers: by the order of `Problem.numbers`, SI, nan where not needed; () of one that is refused.
        excess: of each constraint, see `Constraint.excess`.
    """

    case: Case
    gear: SteeringGear
    numbers: tuple[float, ...]
    excess: tuple[float, ...]

    @property
    def is_feasible(self) -> bool:
        """Whether it has all numbers, and they keep all limits."""
        return bool(self.numbers) and all(each <= 0 for each in self.excess)

    @classmethod
    def of(cls, problem: Problem, case: Case, result: Result) -> "Design":
        """Take the design from its result."""
        numbers = tuple(result.findings["numbers"]) if result.status is Status.OK else ()
        of_limits = numbers[len(problem.objectives) :]
        pairs = zip(problem.constraints, of_limits, strict=True) if numbers else ()
        return cls(case, result.gear, numbers, tuple(limit.excess(value) for limit, value in pairs))

    def costs(self, problem: Problem) -> list[float]:
        """Return its objectives, less is better; one that was not needed is far from all others."""
        pairs = zip(problem.objectives, self.numbers, strict=False)
        known = [FAR if np.isnan(value) else each.sense * value for each, value in pairs]
        return known or [FAR] * len(problem.objectives)


@dataclass(frozen=True)
class Search:
    """What a search has found: the gear as given, all designs, the best of them, causes of refusals."""

    problem: Problem
    store: Store
    given: Design
    designs: tuple[Design, ...]
    refused: Sequence[Group]

    @cached_property
    def front(self) -> list[Design]:
        """Return the designs that keep all limits and that no other one is better than in every objective, by
        the first objective."""
        known = [each for each in self.designs if each.is_feasible]
        shape = len(known), len(self.problem.objectives)
        costs = np.array([each.costs(self.problem) for each in known]).reshape(shape)
        best = [
            i
            for i, own in enumerate(costs)
            if not ((costs <= own).all(axis=1) & (costs < own).any(axis=1)).any()
        ]
        return [known[i] for i in sorted(best, key=lambda i: tuple(costs[i]))]


def hash_of(problem: Problem, values: Mapping[str, Value]) -> str:
    """Return the name of a design: of all that its numbers depend on."""
    base = problem.study.base
    content = [case_hash(problem.study.scene, base, base.fidelity), problem.fingerprint]
    text = json.dumps(
        [content, sorted(values.items()), sorted(problem.kept.items()), sorted(problem.keep.items())]
    )
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def store_of(problem: Problem, folder: Path) -> Store:
    """Return the folder of an optimisation as a study's, whose description has no case yet.

    Raises:
        InputError: it holds something else.
    """
    study = problem.study
    about = describe(replace(study, samples=1), provenance())
    own = {*(axis.name for axis in study.axes), *problem.keep.values(), *DERIVED}
    base = {path: value for path, value in about.base.items() if path not in own}
    return Store.of(folder, replace(about, base=base, design=DESIGN, cases=()))


def search(problem: Problem, folder: Path, runner: CaseRunner) -> Search:
    """Search until all designs that the problem allows are computed; what the folder holds is not repeated.

    Raises:
        InputError: pymoo is not installed, or the folder cannot be used.
    """

    def calls(cases: Sequence[Case]) -> list[tuple[Case, Callable[[], Result]]]:
        return [(case, partial(evaluate, problem, case.values)) for case in cases]

    asked = _asked(problem)
    store, designs = store_of(problem, folder), dict[str, Design]()
    rows: list[tuple[Case, CaseRow]] = []
    store.make_folders(blocks=False)
    with store.locked():
        if not (store.path / "study.json").exists():  # by which the folder is known from now on
            store.write_description()
        content = content_of(problem.study.file)
        with replacing(store.path / "study.toml") as partial_file:
            partial_file.write_bytes(content)
        row = CasesRow(problem.study.samples)
        given = Case(hash_of(problem, {}), {})
        with open_screen() as screen, screen.row(row):
            of_given = computed_results(problem, store, calls([given]), runner, CasesRow(1))[given.hash]
            points = next(asked)
            while points is not None:
                cases = [Case(hash_of(problem, values), values) for values in points]
                new = {case.hash: case for case in cases if case.hash not in designs}
                results = computed_results(problem, store, calls([*new.values()]), runner, row)
                for name, case in new.items():
                    designs[name] = Design.of(problem, case, results[name])
                    rows.append((case, CaseRow.of(CaseRecord.of(name, results[name]))))
                store.description = replace(
                    store.description, cases=tuple(each.case for each in designs.values())
                )
                store.write_description()
                points = asked.send([designs[case.hash] for case in cases])
        start = Design.of(problem, given, of_given)
        refused = [group for group in groups(rows) if group.status is not Status.OK]
        return Search(problem, store, start, tuple(designs.values()), refused)


def computed_results(
    problem: Problem,
    store: Store,
    calls: Sequence[tuple[Case, Callable[[], Result]]],
    runner: CaseRunner,
    row: CasesRow,
) -> dict[str, Result]:
    """Return hash -> result of each case; those that the folder lacks are computed and stored."""
    found, tasks = dict[str, Result](), dict[Task, Case]()
    for case, call in calls:
        with suppress(InputError):  # there is none, or a damaged one
            if (stored := read_result(store.path_of(case.hash))).status not in AGAIN:
                found[case.hash] = stored
        if case.hash not in found:
            tasks[Task(call)] = case
    row.count([each.status for each in found.values()])
    for task, answer in runner.run(list(tasks)):
        case, base = tasks[task], problem.study.base
        result = answer.result(problem.study.scene, base.steering_gear, base.fidelity)
        result.save(store.path_of(case.hash))
        if case.values:
            line = case_line(store.description, case, CaseRow.of(CaseRecord.of(case.hash, result)))
            log_lines(store.path / "study.log", [line])
        row.count([result.status])
        found[case.hash] = result
    return found


Asked = list[dict[str, Value]]


def _asked(problem: Problem) -> Generator[Asked | None, list[Design], None]:
    """Yield the variables of one generation after the other, and take its designs computed; at last None."""
    try:
        from pymoo.config import Config

        Config.warnings["not_compiled"] = False
        from pymoo.algorithms.moo.nsga2 import NSGA2
        from pymoo.core.evaluator import Evaluator
        from pymoo.core.problem import Problem as Searched
        from pymoo.problems.static import StaticProblem
    except ImportError:
        raise InputError("Optimisation needs pymoo: install rps-exudyn with its extra [optimise].") from None
    from scipy.stats import qmc

    study, size = problem.study, problem.population
    limits = len(problem.constraints) + 1  # the last one: the design has all numbers
    first = qmc.LatinHypercube(len(study.axes), rng=np.random.default_rng(study.seed)).random(size)
    searched = Searched(
        n_var=len(study.axes), n_obj=len(problem.objectives), n_ieq_constr=limits, xl=0.0, xu=1.0
    )
    algorithm = NSGA2(pop_size=size, sampling=first.round(DIGITS), eliminate_duplicates=True)
    algorithm.setup(searched, termination=("n_gen", 10**6), seed=study.seed, verbose=False)
    left = study.samples
    while left > 0:
        asked = algorithm.ask()
        points = asked.get("X").round(DIGITS)[: max(left, 0)]
        done = yield [values_at(problem.study.axes, point) for point in points]
        left -= len(points)
        if len(points) < len(asked):
            break
        costs = np.array([each.costs(problem) for each in done])
        excess = [[*each.excess, -1.0] if each.numbers else [FAR] * limits for each in done]
        Evaluator().eval(StaticProblem(searched, F=costs, G=np.array(excess)), asked)
        algorithm.tell(infills=asked)
    yield None
