"""The cheapest set of tolerance classes: gears that are run once serve all sets, by their weights.

A gear drawn from the mixture q of all that was drawn counts for a set s with the weight p_s / q of its values
(Veach and Guibas 1995, balance heuristic), which no number of tolerances makes infinite. The first gears mix
all classes evenly; then gears of the set that is chosen are added, until it stays the choice. At last the
chosen set meets fresh gears, which had no part in the choice.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import content_of, replacing
from rps_exudyn.base.screen import open_screen
from rps_exudyn.inference.uncertainty.samples import TOGETHER, Samples
from rps_exudyn.optimisation.confirmation import FLANK, MODELS, TEETH
from rps_exudyn.optimisation.evaluation import run_series, with_given
from rps_exudyn.optimisation.search import computed_results, hash_of, store_of
from rps_exudyn.optimisation.tolerances import ToleranceProblem
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.simulate.cases.run_cases import CaseRunner
from rps_exudyn.study.case_progress import CasesRow
from rps_exudyn.study.definition import Case
from rps_exudyn.study.store import Store

ADDED = 512  # gears of a chosen set
ROUNDS = 8  # sets that are chosen one after the other, at most
Chosen = tuple[int, ...]
"""Number of the class of each tolerance; () mixes all classes."""


@dataclass(frozen=True)
class Share:
    """A share of gears, and its standard error."""

    value: float
    error: float


@dataclass(frozen=True)
class Step:
    """A step of one tolerance from the chosen set: by how much cost and scrap rise."""

    path: str
    before: str
    after: str
    cost: float
    scrap: Share

    @property
    def cost_per_percent(self) -> float:
        """Cost of a per cent less scrap; nan where the change of scrap is less than twice its error."""
        clear = abs(self.scrap.value) > 2 * self.scrap.error
        return -self.cost / (100 * self.scrap.value) if clear else np.nan


@dataclass(eq=False)
class Pool:
    """Gears that were run, and how they were drawn."""

    problem: ToleranceProblem
    blocks: list[tuple[Chosen, Result]] = field(default_factory=list)

    @cached_property
    def sets(self) -> np.ndarray:
        """All sets, as `ToleranceProblem.sets`."""
        return self.problem.sets

    @property
    def values(self) -> dict[str, np.ndarray]:
        """Path -> values of all gears (n,)."""
        found = [result.findings["values"] for _, result in self.blocks]
        return {path: np.concatenate([each[path] for each in found]) for path in self.problem.classes}

    @property
    def missed(self) -> np.ndarray:
        """Which limits each gear misses, (limits, n); one that failed misses all."""
        return np.concatenate([_missed(self.problem, result) for _, result in self.blocks], axis=1)

    @property
    def weights(self) -> np.ndarray:
        """Weights of the gears in each set, (sets, n), of the mean 1."""
        values, classes = self.values, self.problem.classes
        densities = [
            np.array([one.scatter.density(values[path]) for one in own]) for path, own in classes.items()
        ]
        sizes = [len(result.findings["numbers"][0]) for _, result in self.blocks]
        mixture = np.zeros(sum(sizes))
        for (chosen, _), size in zip(self.blocks, sizes, strict=True):
            each = [own[chosen[k]] if chosen else own.mean(axis=0) for k, own in enumerate(densities)]
            mixture += size / sum(sizes) * np.prod(each, axis=0)
        found = np.ones((len(self.sets), sum(sizes))) / mixture
        for own, at in zip(densities, self.sets.T, strict=True):
            found *= own[at]
        return np.asarray(found / found.mean(axis=1, keepdims=True))


def _missed(problem: ToleranceProblem, result: Result) -> np.ndarray:
    limits = [each.limit for each in problem.problem.constraints]
    numbers = np.array(result.findings["numbers"], dtype=float)
    return np.array([~limit.keeps(own) for limit, own in zip(limits, numbers, strict=True)])


@dataclass(frozen=True, eq=False)
class Tolerancing:
    """What was found. Sets are in the order of `ToleranceProblem.sets`.

    Attributes:
        problem: what was asked for.
        folder: that holds the gears.
        costs: of each set, (sets,).
        scrap: share of the gears that miss a limit, (sets,).
        errors: standard errors of it, (sets,).
        chosen: number of the cheapest set that keeps the share; that of the least scrap where none does.
        steps: each step of one tolerance from that set.
        fresh: model -> scrap of the chosen set on fresh gears.
        misses: name of a limit -> share of the gears of the chosen set that miss it.
        gears: that were run for the choice.
    """

    problem: ToleranceProblem
    folder: Path
    costs: np.ndarray
    scrap: np.ndarray
    errors: np.ndarray
    chosen: int
    steps: Sequence[Step]
    fresh: Mapping[str, Share]
    misses: Mapping[str, float]
    gears: int

    @property
    def front(self) -> list[int]:
        """Numbers of the sets than which no cheaper one has less scrap, by their cost."""
        order = np.lexsort((self.scrap, self.costs))
        least = np.minimum.accumulate(np.append(np.inf, self.scrap[order]))[:-1]
        return [int(i) for i in order[self.scrap[order] < least]] if self.keeps else []

    @property
    def keeps(self) -> bool:
        """Whether the chosen set keeps the share."""
        return bool(1 - self.scrap[self.chosen] >= self.problem.share)

    @property
    def classes(self) -> dict[str, str]:
        """Path -> name of the chosen class."""
        at = self.problem.sets[self.chosen].tolist()
        return {path: own[k].name for (path, own), k in zip(self.problem.classes.items(), at, strict=True)}


def gears_of(problem: ToleranceProblem, chosen: Chosen, count: int, seed: int, model: str) -> Result:
    """Run gears of a set, or of all classes mixed: their values and numbers, as findings of a result."""
    made, rng = problem.problem.study.base, np.random.default_rng([seed, 1])
    gear, drawn = made.steering_gear, Samples.drawn(problem.inputs, count, seed)
    quantile, table = drawn.quantile, drawn.values
    for k, (path, own) in enumerate(problem.classes.items()):
        u = quantile[:, list(drawn.inputs).index(path)]
        at = np.full(count, chosen[k]) if chosen else rng.permutation(np.arange(count) % len(own))
        table[path] = np.array([each.scatter.quantile(u) for each in own])[at, np.arange(count)]
    table = with_given(gear, table)
    fidelity = Fidelity.preset("flank") if model == FLANK else made.fidelity
    runs, numbers = dict[tuple[Any, ...], Any](), []
    for limit in problem.problem.constraints:
        asked = limit.number
        settings = asked.settings_of(gear) | ({"mesh.law": "teeth"} if model == TEETH else {})
        if (key := (asked.scene, *settings.items())) not in runs:
            runs[key] = run_series(asked.scene, gear.replace(settings), fidelity, table)
        series = runs[key]
        numbers.append(np.where(series.ok, series.summary[asked.metric], np.nan)[:-1].tolist())
    found = {"values": {path: table[path][:-1].tolist() for path in problem.classes}, "numbers": numbers}
    kept: dict[str, Any] = {"fidelity": fidelity.model_dump(), "solver": {}, "findings": found, "summary": {}}
    scene = problem.problem.study.scene
    return Result(scene=scene, gear=gear, status=Status.OK, cpu_s=0.0, wall_s=0.0, **kept)


def search_tolerances(problem: ToleranceProblem, folder: Path, runner: CaseRunner) -> Tolerancing:
    """Choose the set, and confirm it; what the folder holds is not computed again.

    Raises:
        InputError: the gear without errors fails, or the folder cannot be used.
    """
    store = store_of(problem.problem, folder)
    store.make_folders(blocks=False)
    with store.locked():
        if not (store.path / "study.json").exists():
            store.write_description()
        content = content_of(problem.problem.study.file)
        with replacing(store.path / "study.toml") as partial_file:
            partial_file.write_bytes(content)
        pool = Pool(problem)
        _add(pool, store, runner, (), problem.problem.samples)
        choice = _choice(pool)
        for _ in range(ROUNDS):
            chosen = tuple(pool.sets[choice].tolist())
            if chosen in [before for before, _ in pool.blocks]:
                break
            _add(pool, store, runner, chosen, min(ADDED, problem.problem.samples))
            choice = _choice(pool)
        return _found(pool, choice, folder, _fresh(pool, choice, store, runner))


def _add(pool: Pool, store: Store, runner: CaseRunner, chosen: Chosen, count: int) -> None:
    seed = pool.problem.problem.study.seed
    pool.blocks += [
        (chosen, each) for each in _run(pool.problem, store, runner, chosen, count, seed, MODELS[0])
    ]


def _run(
    problem: ToleranceProblem,
    store: Store,
    runner: CaseRunner,
    chosen: Chosen,
    count: int,
    seed: int,
    model: str,
) -> list[Result]:
    """Return gears in parts of `TOGETHER`, each a case of the store."""
    begins = range(0, count, TOGETHER)
    drawn = [str(sorted((path, str(each)) for path, each in problem.inputs.items())), str(problem.classes)]
    calls = []
    for number, begin in enumerate(begins):
        size, own_seed = min(TOGETHER, count - begin), seed * 1000 + number
        content = [hash_of(problem.problem, {}), *drawn, chosen, size, own_seed, model]
        name = hashlib.sha256(json.dumps(content).encode()).hexdigest()[:16]
        calls.append((Case(name, {}), partial(gears_of, problem, chosen, size, own_seed, model)))
    row = CasesRow(len(calls))
    with open_screen() as screen, screen.row(row):
        results = computed_results(problem.problem, store, calls, runner, row)
    for each in results.values():
        if each.status is not Status.OK:
            raise InputError(f"gears of these tolerances cannot be computed: {each.message}")
    return [results[case.hash] for case, _ in calls]


def _fresh(pool: Pool, choice: int, store: Store, runner: CaseRunner) -> dict[str, Share]:
    found, problem = {}, pool.problem
    chosen, (count, others) = tuple(pool.sets[choice].tolist()), problem.problem.confirm
    for model, size in zip(MODELS, (count, others, others), strict=True):
        if size:
            ran = _run(problem, store, runner, chosen, size, problem.problem.study.seed + 1, model)
            bad = np.concatenate([_missed(problem, each).any(axis=0) for each in ran])
            scrap = float(bad.mean())
            # of a share without a miss: that of half a miss
            kept = max(scrap, 0.5 / size)
            found[model] = Share(scrap, float(np.sqrt(kept * (1 - min(kept, 1 - 0.5 / size)) / size)))
    return found


def _choice(pool: Pool) -> int:
    """The cheapest set that keeps the share; that of the least scrap where none does."""
    scrap = pool.weights @ pool.missed.any(axis=0) / pool.missed.shape[1]
    costs = pool.problem.costs
    keeping = np.flatnonzero(1 - scrap >= pool.problem.share)
    if not keeping.size:
        return int(np.lexsort((costs, scrap))[0])
    return int(keeping[np.lexsort((scrap[keeping], costs[keeping]))[0]])


def _found(pool: Pool, choice: int, folder: Path, fresh: Mapping[str, Share]) -> Tolerancing:
    problem, weights, missed, sets = pool.problem, pool.weights, pool.missed, pool.sets
    bad, costs, count = missed.any(axis=0), pool.problem.costs, missed.shape[1]
    scrap = weights @ bad / count
    parts = weights * (bad - scrap[:, None])
    errors = np.sqrt((parts**2).sum(axis=1)) / count
    steps = []
    for k, (path, own) in enumerate(problem.classes.items()):
        for sense in (-1, 1):
            other = sets[choice] + sense * (np.arange(sets.shape[1]) == k)
            if 0 <= other[k] < len(own):
                at = int(np.flatnonzero((sets == other).all(axis=1))[0])
                error = float(np.sqrt(((parts[at] - parts[choice]) ** 2).sum())) / count
                change = Share(float(scrap[at] - scrap[choice]), error)
                names = own[sets[choice, k]].name, own[other[k]].name
                steps.append(Step(path, *names, float(costs[at] - costs[choice]), change))
    of_limits = [each.number.name for each in problem.problem.constraints]
    misses = dict(zip(of_limits, (missed @ weights[choice] / count).tolist(), strict=True))
    return Tolerancing(problem, folder, costs, scrap, errors, choice, steps, fresh, misses, count)
