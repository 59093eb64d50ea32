"""The cheapest set of tolerance classes: gears that are run once serve all sets, by their weights.

A gear drawn from the mixture q of all that was drawn counts for a set s with the weight p_s / q of its values
(Veach and Guibas 1995, balance heuristic), which no number of tolerances makes infinite. The first gears mix
all classes evenly; then gears of the set that is chosen are added, until it stays the choice. At last the
chosen set meets fresh gears, which had no part in the choice.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import content_of, replacing
from rps_exudyn.base.screen import open_screen
from rps_exudyn.inference.uncertainty.samples import TOGETHER, Samples
from rps_exudyn.optimisation.confirmation import FLANK, MODELS, TEETH
from rps_exudyn.optimisation.evaluation import run_series, with_given
from rps_exudyn.optimisation.goals import Constraint
from rps_exudyn.optimisation.search import computed_results, hash_of, store_of
from rps_exudyn.optimisation.tolerances import ToleranceProblem
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.simulate.batch import Batch, batch
from rps_exudyn.simulate.cases.run_cases import CaseRunner
from rps_exudyn.study.case_progress import CasesRow
from rps_exudyn.study.definition import Case
from rps_exudyn.study.store import Store

ADDED = 512  # gears of a chosen set
ROUNDS = 8  # sets that are chosen one after the other, at most
WEIGHTS_AT_ONCE = 2**22  # of gears in sets: 32 MB
Chosen = tuple[int, ...]
"""Number of the class of each tolerance; () mixes all classes."""


@dataclass(frozen=True)
class Share:
    """A share of gears, its standard error, and its numerical one: how far it moves if all gears are wrong by
    their error bars to the same side. An unknown bar counts as infinite."""

    value: float
    error: float
    numerical: float = 0.0


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


class SetShares(NamedTuple):
    """Shares of the gears of each set that miss a limit, and their standard errors, (sets,); of those that
    miss each limit, (sets, limits)."""

    scrap: np.ndarray
    errors: np.ndarray
    misses: np.ndarray


@dataclass(frozen=True, eq=False)
class Pool:
    """Gears that were run, and how they were drawn."""

    problem: ToleranceProblem
    blocks: Sequence[tuple[Chosen, Result]]

    @cached_property
    def sets(self) -> np.ndarray:
        """All sets, as `ToleranceProblem.sets`."""
        return self.problem.sets

    @cached_property
    def missed(self) -> np.ndarray:
        """Which limits each gear misses, (limits, n); one that failed misses all."""
        return np.concatenate([_missed(self.problem, result) for _, result in self.blocks], axis=1)

    @cached_property
    def densities(self) -> list[np.ndarray]:
        """Densities of the gears' values by the classes of each tolerance, (classes, n)."""
        found = [result.findings["values"] for _, result in self.blocks]
        values = {path: np.concatenate([each[path] for each in found]) for path in self.problem.classes}
        classes = self.problem.classes.items()
        return [np.array([one.scatter.density(values[path]) for one in own]) for path, own in classes]

    @cached_property
    def mixture(self) -> np.ndarray:
        """Density by which each gear was drawn, (n,)."""
        sizes = [len(result.findings["numbers"][0]) for _, result in self.blocks]
        mixture = np.zeros(sum(sizes))
        for (chosen, _), size in zip(self.blocks, sizes, strict=True):
            each = [own[chosen[k]] if chosen else own.mean(axis=0) for k, own in enumerate(self.densities)]
            mixture += size / sum(sizes) * np.prod(each, axis=0)
        return mixture

    def weights(self, sets: np.ndarray) -> np.ndarray:
        """Weights of the gears in sets (m, tolerances), (m, n), of the mean 1."""
        found = np.ones((len(sets), len(self.mixture))) / self.mixture
        for own, at in zip(self.densities, sets.T, strict=True):
            found *= own[at]
        return np.asarray(found / found.mean(axis=1, keepdims=True))

    @cached_property
    def shares(self) -> SetShares:
        """Shares of all sets; so many weights are held at once as `WEIGHTS_AT_ONCE` allows."""
        bad, (limits, count) = self.missed.any(axis=0), self.missed.shape
        found = np.empty((len(self.sets), 2 + limits))
        at_once = max(1, WEIGHTS_AT_ONCE // count)
        for begin in range(0, len(found), at_once):
            rows = slice(begin, begin + at_once)
            weights = self.weights(self.sets[rows])
            found[rows, 0], found[rows, 2:] = weights @ bad / count, weights @ self.missed.T / count
            found[rows, 1] = np.sqrt(((weights * (bad - found[rows, :1])) ** 2).sum(axis=1)) / count
        return SetShares(found[:, 0], found[:, 1], found[:, 2:])

    @cached_property
    def choice(self) -> int:
        """The cheapest set that keeps all shares; where none does, that which lacks the least of them."""
        scrap, costs, problem = self.shares.scrap, self.problem.costs, self.problem
        lack = np.maximum(
            problem.share - (1 - scrap), (problem.shares - (1 - self.shares.misses)).max(axis=1)
        )
        keeping = np.flatnonzero(lack <= 0)
        if not keeping.size:
            return int(np.lexsort((costs, lack))[0])
        return int(keeping[np.lexsort((scrap[keeping], costs[keeping]))[0]])


def _missed(problem: ToleranceProblem, result: Result, moved: int = 0) -> np.ndarray:
    """Which limits each gear misses, (limits, n); with `moved` = -1 or 1 if all numbers are wrong by their
    error bars to that side."""
    limits = [each.limit for each in problem.problem.constraints]
    numbers = np.array(result.findings["numbers"], dtype=float)
    if moved:
        bars = np.array(result.findings["bars"], dtype=float)
        numbers = numbers + moved * np.where(np.isfinite(bars), bars, np.inf)
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
        misses: share of the gears of the chosen set that miss each limit, in the order of the problem's.
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
    misses: Sequence[float]
    gears: int

    @property
    def front(self) -> list[int]:
        """Numbers of the sets than which no cheaper one has less scrap, by their cost."""
        order = np.lexsort((self.scrap, self.costs))
        least = np.minimum.accumulate(np.append(np.inf, self.scrap[order]))[:-1]
        return [int(i) for i in order[self.scrap[order] < least]] if self.keeps else []

    @property
    def keeps(self) -> bool:
        """Whether the chosen set keeps the share of all limits, and those of single ones."""
        return bool(1 - self.scrap[self.chosen] >= self.problem.share) and not self.not_kept

    @property
    def not_kept(self) -> list[str]:
        """Limits whose own share the chosen set does not keep."""
        return [each.number.name for each, missed, share in self.limits if 1 - missed < share]

    @property
    def limits(self) -> list[tuple[Constraint, float, float]]:
        """Each limit, the share of the gears of the chosen set that miss it, and its own share."""
        wanted = self.problem.shares.tolist()
        return list(zip(self.problem.problem.constraints, self.misses, wanted, strict=True))

    @property
    def kept(self) -> Share:
        """Share of the gears of the chosen set that keep all limits."""
        return Share(float(1 - self.scrap[self.chosen]), float(self.errors[self.chosen]))

    @property
    def classes(self) -> dict[str, str]:
        """Path -> name of the chosen class."""
        at = self.problem.sets[self.chosen].tolist()
        return {path: own[k].name for (path, own), k in zip(self.problem.classes.items(), at, strict=True)}


def gears_of(problem: ToleranceProblem, chosen: Chosen, count: int, seed: int, model: str) -> Result:
    """Run gears of a set, or of all classes mixed: values, numbers and error bars, as findings of a result.

    Without a model they are those of the choice: the search's model without error bars.
    """
    made, rng = problem.problem.study.base, np.random.default_rng([seed, 1])
    gear, drawn = made.steering_gear, Samples.drawn(problem.inputs, count, seed)
    quantile, table = drawn.quantile, drawn.values
    for k, (path, own) in enumerate(problem.classes.items()):
        u = quantile[:, list(drawn.inputs).index(path)]
        at = np.full(count, chosen[k]) if chosen else rng.permutation(np.arange(count) % len(own))
        table[path] = np.array([each.scatter.quantile(u) for each in own])[at, np.arange(count)]
    table = with_given(gear, table)
    fidelity = Fidelity.preset("flank") if model == FLANK else made.fidelity
    runs, numbers, bars = dict[tuple[Any, ...], Batch](), [], []
    for limit in problem.problem.constraints:
        asked = limit.number
        settings = asked.settings_of(gear) | ({"mesh.law": "teeth"} if model == TEETH else {})
        if (key := (asked.scene, *settings.items())) not in runs:
            tested = asked.scene, gear.replace(settings)
            runs[key] = (
                batch(*tested, table, fidelity=fidelity, keep="torque")
                if model
                else run_series(*tested, fidelity, table)
            )
        series = runs[key]
        numbers.append(np.where(series.ok, series.summary[asked.metric], np.nan)[:-1].tolist())
        bars.append(np.where(series.ok, series.errors[asked.metric], np.nan)[:-1].tolist())
    values = {path: table[path][:-1].tolist() for path in problem.classes}
    found = {"values": values, "numbers": numbers, "bars": bars}
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
        pool, chosen, count = Pool(problem, ()), (), problem.problem.samples
        for _ in range(ROUNDS + 1):
            ran = _run(problem, store, runner, chosen, count, problem.problem.study.seed, "")
            pool = Pool(problem, (*pool.blocks, *((chosen, each) for each in ran)))
            chosen, count = tuple(pool.sets[pool.choice].tolist()), min(ADDED, problem.problem.samples)
            if chosen in [before for before, _ in pool.blocks]:
                break
        return _found(pool, folder, _fresh(pool, store, runner))


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


def _fresh(pool: Pool, store: Store, runner: CaseRunner) -> dict[str, Share]:
    found, problem = {}, pool.problem
    chosen, (count, others) = tuple(pool.sets[pool.choice].tolist()), problem.problem.confirm
    for model, size in zip(MODELS, (count, others, others), strict=True):
        if size:
            ran = _run(problem, store, runner, chosen, size, problem.problem.study.seed + 1, model)
            scrap, *moved = (
                float(np.concatenate([_missed(problem, each, side).any(axis=0) for each in ran]).mean())
                for side in (0, -1, 1)
            )
            # of a share without a miss: that of half a miss
            kept = max(scrap, 0.5 / size)
            error = float(np.sqrt(kept * (1 - min(kept, 1 - 0.5 / size)) / size))
            found[model] = Share(scrap, error, max(abs(each - scrap) for each in moved))
    return found


def _found(pool: Pool, folder: Path, fresh: Mapping[str, Share]) -> Tolerancing:
    problem, choice, sets, costs = pool.problem, pool.choice, pool.sets, pool.problem.costs
    scrap, errors, misses = pool.shares
    bad, count = pool.missed.any(axis=0), pool.missed.shape[1]

    def parts(at: int) -> np.ndarray:
        return np.asarray(pool.weights(sets[[at]])[0] * (bad - scrap[at]))

    steps, here = [], parts(choice)
    for k, (path, own) in enumerate(problem.classes.items()):
        for sense in (-1, 1):
            other = sets[choice] + sense * (np.arange(sets.shape[1]) == k)
            if 0 <= other[k] < len(own):
                at = int(np.flatnonzero((sets == other).all(axis=1))[0])
                error = float(np.sqrt(((parts(at) - here) ** 2).sum())) / count
                change = Share(float(scrap[at] - scrap[choice]), error)
                names = own[sets[choice, k]].name, own[other[k]].name
                steps.append(Step(path, *names, float(costs[at] - costs[choice]), change))
    missed = misses[choice].tolist()
    return Tolerancing(problem, folder, costs, scrap, errors, choice, steps, fresh, missed, count)
