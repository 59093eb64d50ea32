"""Plan of tests: which, how often and in which order, so that parameters reach wanted intervals cheaply.

What a programme would determine is known before anything is measured: Fisher's information of the levels,
with the repeatability that is declared, what tests share, the nuisances, and the change by the other contact
law. From a programme of everything those runs are taken away whose time is the largest beside what they
determine, as long as the wanted intervals are kept; then runs are exchanged (Atkinson, Donev and Tobias,
Optimum Experimental Designs, ch. 12). The order is that of the largest gain of ln det of the information
(D-optimal) per minute.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.inference.fitting.bench_tests import KINDS, BenchTest, Minutes, named_test
from rps_exudyn.inference.fitting.identifiability import candidates
from rps_exudyn.inference.fitting.level_fit import LevelModel
from rps_exudyn.inference.fitting.noise import NORMAL
from rps_exudyn.inference.fitting.prediction import NoPredictionError, Prediction
from rps_exudyn.inference.fitting.problem import expected_rows
from rps_exudyn.inference.fitting.unknowns import BY_LOAD, LEVEL, WITHOUT_YOKE, nuisance_unknowns, unknowns_of
from rps_exudyn.parameters.declaration import read_toml
from rps_exudyn.parameters.gear import SteeringGear, check_constant_ratio

MOST_RUNS = 10  # of a test
LARGEST_WANTED = 1.0  # half of an interval, of the value
USUAL_TARGETS = {"yoke.preload": 0.20, "mesh.friction": 0.35, "yoke.friction": 0.40}
"""Path -> half of the 95 % interval, of the value, where nothing else is wanted."""

MINUTES = {name: kind.minutes for name, kind in KINDS.items()}
"""Kind of test -> its time; estimates of a bench's staff are to replace them (`read_minutes`)."""


def read_minutes(path: str | Path) -> dict[str, Minutes]:
    """Return the table of minutes with what a TOML file changes: `[free]`, `setup = 5`, `run = 5`.

    Raises:
        InputError: a test that does not exist, or times that cannot be.
    """
    found, problems = dict(MINUTES), []
    for kind, table in read_toml(path).items():
        if kind not in KINDS or not isinstance(table, Mapping):
            problems.append(f"{path}: [{kind}] is no test; there are {', '.join(KINDS)}.")
            continue
        times = dict(vars(found[kind]))
        for key, value in table.items():
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if key not in times:
                problems.append(f"{path}: {kind}.{key} is no time; there are setup and run, in minutes.")
            elif not (number and 0 <= value < 1e5) or (key == "run" and not value > 0):
                allowed = "a number of minutes, from 0 (run: more than 0) to 100000"
                problems.append(f"{path}: {kind}.{key} is {value!r}; it must be {allowed}.")
            else:
                times[key] = float(value)
        found[kind] = Minutes(**times)
    if problems:
        raise InputError(problems)
    return found


def parse_targets(texts: Sequence[str]) -> dict[str, float]:
    """Return path -> wanted half interval, of the value, of texts such as "yoke.preload=5%".

    Raises:
        InputError: everything that is wrong with them.
    """
    targets, problems = {}, []
    for text in texts:
        path, _, wanted = text.partition("=")
        path = path.strip()
        try:
            half = float(wanted.strip().removesuffix("%").strip()) / (100.0 if "%" in wanted else 1.0)
        except ValueError:
            half = np.nan
        if path not in LEVEL:
            problems.append(f"{text}: {path or text} is no target; there are {', '.join(LEVEL)}.")
        elif not 0 < half <= LARGEST_WANTED:
            allowed = "half of the 95 % interval, more than 0 and at most 100 %"
            problems.append(f"{text}: write {allowed}, for instance {path}=5%.")
        else:
            targets[path] = half
    if problems:
        raise InputError(problems)
    return targets or dict(USUAL_TARGETS)


@dataclass(frozen=True)
class PlannedTest:
    """A test of a programme, and what all tests so far determine."""

    test: BenchTest
    runs: int
    minutes: float
    half_intervals: Mapping[str, float]  # path -> half of the 95 % interval, of the value, after it


@dataclass(frozen=True)
class Plan:
    """Tests in their order, and whether they reach what is wanted."""

    targets: Mapping[str, float]
    tests: tuple[PlannedTest, ...]

    @property
    def minutes(self) -> float:
        return sum(each.minutes for each in self.tests)

    @property
    def half_intervals(self) -> Mapping[str, float]:
        """Half of each 95 % interval, of the value, after all tests."""
        return self.tests[-1].half_intervals

    @property
    def missed(self) -> dict[str, float]:
        """What is wanted and not reached by any number of runs: path -> half interval."""
        reached = self.half_intervals.items()
        return {path: half for path, half in reached if half > self.targets.get(path, np.inf)}


def plan(
    targets: Mapping[str, float],
    gear: SteeringGear | None = None,
    minutes: Mapping[str, Minutes] | None = None,
) -> Plan:
    """Return the cheapest programme that brings parameters to their wanted half intervals.

    Where none does, it is that of the most runs of all tests.

    Args:
        targets: path -> half of the 95 % interval, of the value.
        gear: what is expected.
        minutes: of each kind of test.

    Raises:
        InputError: a gear that has no equilibrium in a test.

    Examples:
        >>> from rps_exudyn.inference.fitting.plan import plan
        >>> [each.test.title for each in plan({"bearing.friction_torque": 0.1}).tests]
        ['bearing', 'free']
    """
    gear = gear or SteeringGear()
    check_constant_ratio(gear, "a plan of tests")
    tests = [BenchTest("free"), *candidates(gear)]  # of free turning, one run is always made
    design = _Design.of(gear, tests, minutes or MINUTES)
    chosen = whole = dict.fromkeys(tests, MOST_RUNS)
    if _reached(design.half_intervals(whole), targets):
        chosen = _exchanged(design, _reduced(design, whole, targets), targets)
    return Plan(targets, tuple(_in_order(design, chosen, targets)))


def programme(
    texts: Sequence[str], gear: SteeringGear | None = None, minutes: Mapping[str, Minutes] | None = None
) -> Plan:
    """Return what a given programme would determine: texts such as "load-test@150kg x 3".

    Raises:
        InputError: no such test, or a gear without equilibrium in one.
    """
    runs: dict[BenchTest, int] = {}
    for text in texts:
        name, _, count = text.partition(" x ")
        test, _ = named_test(f"{name.strip()}=none")
        runs[test] = runs.get(test, 0) + int(count or 1)
    design = _Design.of(gear or SteeringGear(), list(runs), minutes or MINUTES)
    return Plan({}, tuple(_in_order(design, runs, {})))


Runs = Mapping[BenchTest, int]


@dataclass(frozen=True, eq=False)
class _Design:
    """Levels of all tests at the expected gear, by closed form and simulation, and their times."""

    model: LevelModel  # of one run of each test, corrected by its simulation; two rows a test
    means: Mapping[BenchTest, list[float]]  # towards +X and -X
    slopes: np.ndarray  # of the rows, (rows, unknowns)
    by_law: np.ndarray  # change of the rows by the other contact law, (rows,)
    minutes: Mapping[str, Minutes]

    @classmethod
    def of(
        cls,
        gear: SteeringGear,
        tests: Sequence[BenchTest],
        minutes: Mapping[str, Minutes],
    ) -> "_Design":
        unknowns = [*unknowns_of(gear, LEVEL, {}), *nuisance_unknowns([BY_LOAD, WITHOUT_YOKE])]
        u = np.array([each.before for each in unknowns])
        other = gear.replace({"mesh.law": "line" if gear.mesh.law == "teeth" else "teeth"})
        means, by_law = {}, {}
        for test in tests:
            prediction = Prediction.of([test])
            (block,) = prediction.blocks
            try:
                expected, changed = (block.means(prediction.simulated(each)) for each in (gear, other))
            except NoPredictionError as error:
                raise InputError(f"no plan for the expected gear: {error}.") from None
            means[test], by_law[test] = expected.tolist(), changed - expected
        rows = expected_rows(means, dict.fromkeys(tests, 1))
        model = LevelModel.of(rows, unknowns, gear).corrected(u, rows.values)
        return cls(model, means, model.slopes(u), rows.of_means(by_law), minutes)

    def cost(self, runs: Runs) -> float:
        made = [(self.minutes[test.kind], count) for test, count in runs.items() if count]
        return sum(each.setup + count * each.run for each, count in made)

    def information(self, runs: Runs) -> tuple[np.ndarray, np.ndarray]:
        """Information of a programme (n, n) with the priors, and what the other law moves (n,)."""
        made = {test: count for test, count in runs.items() if count}
        _, sd = self.model.priors()
        if not made:
            return np.diag(sd**-2.0), np.zeros(sd.size)
        where = [i for test in made for i, each in enumerate(self.model.rows.tests) if each == test]
        corrections = {name: getattr(self.model, name)[where] for name in ("factors", "terms", "near")}
        model = replace(self.model, rows=expected_rows(self.means, made), **corrections)
        slopes = np.asfortranarray(self.slopes[where])
        weighted = np.linalg.solve(model.covariance, np.column_stack([slopes, self.by_law[where]]))
        information = np.diag(sd**-2.0) + slopes.T @ weighted[:, :-1]
        return information, np.linalg.solve(information, slopes.T @ weighted[:, -1])

    def half_intervals(self, runs: Runs) -> dict[str, float]:
        """Half of each 95 % interval that a fit would print, of the value."""
        information, law = self.information(runs)
        sd = np.sqrt(np.diag(np.linalg.inv(information)))
        half = np.exp(NORMAL * sd + np.abs(law)) - 1
        known = zip(self.model.unknowns, half.tolist(), strict=True)
        return {each.path: one for each, one in known if not each.is_nuisance}


def _reached(half_intervals: Mapping[str, float], targets: Mapping[str, float]) -> bool:
    return all(half_intervals[path] <= target for path, target in targets.items())


def _excess(half_intervals: Mapping[str, float], targets: Mapping[str, float]) -> float:
    return float(sum(np.log(half_intervals[path] / target) for path, target in targets.items()))


def _reduced(design: _Design, runs: Runs, targets: Mapping[str, float]) -> dict[BenchTest, int]:
    """The programme without the runs that are not needed: those first that save the most for what they
    determine."""
    now = dict(runs)
    while True:
        cost, excess, best = design.cost(now), _excess(design.half_intervals(now), targets), None
        for fewer in ({**now, test: left} for test, count in now.items() for left in _left(test, count)):
            half_intervals = design.half_intervals(fewer)
            if _reached(half_intervals, targets):
                merit = (cost - design.cost(fewer)) / max(_excess(half_intervals, targets) - excess, 1e-6)
                best = max(best or (merit, fewer), (merit, fewer), key=lambda pair: pair[0])
        if best is None:
            return {test: count for test, count in now.items() if count}
        now = best[1]


def _left(test: BenchTest, count: int) -> set[int]:
    """Runs of a test after some are left out: one, or all; of the free turning, which shows the runout and
    guards the rest, one stays."""
    least = 1 if test.kind == "free" else 0
    return {max(count - 1, least), least} - {count} if count else set()


def _exchanged(design: _Design, runs: Runs, targets: Mapping[str, float]) -> dict[BenchTest, int]:
    """The programme with runs of one test exchanged for those of others, while that is cheaper."""
    now = {**dict.fromkeys(design.means, 0), **runs}
    while True:
        cheapest, best = design.cost(now), None
        for less, more, added in product(now, now, (1, 2, 3)):
            if less == more or now[more] + added > MOST_RUNS:
                continue
            for left in _left(less, now[less]):
                tried = {**now, less: left, more: now[more] + added}
                cost = design.cost(tried)
                if cost < cheapest - 1e-9 and _reached(design.half_intervals(tried), targets):
                    cheapest, best = cost, tried
        if best is None:
            return {test: count for test, count in now.items() if count}
        now = {**dict.fromkeys(design.means, 0), **_reduced(design, best, targets)}


def _in_order(design: _Design, runs: Runs, targets: Mapping[str, float]) -> Iterator[PlannedTest]:
    """The tests by their gain of information per minute, and what they determine."""
    done: dict[BenchTest, int] = {}
    left = dict(runs)
    while left:
        begin = np.linalg.slogdet(design.information(done)[0])[1]

        def gain(test: BenchTest, begin: float = begin) -> float:
            after = np.linalg.slogdet(design.information({**done, test: left[test]})[0])[1]
            return float(after - begin) / design.cost({test: left[test]})

        test = max(left, key=gain)
        done[test] = left.pop(test)
        yield PlannedTest(test, done[test], design.cost({test: done[test]}), design.half_intervals(done))
