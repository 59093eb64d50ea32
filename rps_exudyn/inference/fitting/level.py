"""The level of a measured test without any model of the gear, with its uncertainty budget (GUM).

Two intervals, each with its name: that of **this run** holds noise, resolution and drift, and says what the
torque was at that time; that of **the gear** also holds repeatability and calibration. One run with a
repeatability of 3 % and a run with white noise of 2 % may be the same curve: no interval does for both.

The half sum of both directions holds -P e sin(phi) of an eccentric pinion, free of friction: P e is measured,
the runout e follows from it and the preload.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.inference.fitting import noise
from rps_exudyn.inference.fitting.bench_tests import BenchTest, MeasuredPass
from rps_exudyn.inference.fitting.noise import NORMAL, AveragedLaw, Parts, Regression, covers, waves

REPEATABILITY = 0.02  # of a run's level, declared: known to 35 % ...
DECLARED = 4.0  # ... which is as good as from so many degrees of freedom (GUM G.4.2)
CALIBRATION = 0.005  # of the level
ZERO = 0.03  # of the level: standard deviation of a sensor's zero
UNSEEN = 0.05  # of the level: waves of a turn, or of a tooth pitch, that a shorter pass does not show
FOUND_WAVE = 2.45  # standard deviations: chi squared of two components, 95 %
SEVERAL_PARTS = 1.3  # by which correlated noise widens a wave: one turn does not show how long it lasts
LEAST_CORRELATED = 0.25  # probability that is counted whatever the curve shows
LIKELY = 0.5  # probability of correlated noise from which on it is counted so
SIZE_SCATTER = 0.02  # of a wave's size, from run to run
OVERLAP = 0.5  # least part of the shorter pass that both directions cover


@dataclass(frozen=True)
class BudgetRow:
    """One contribution to the interval of a level."""

    name: str  # what contributes
    half: float  # half of its 95 % interval, in the unit of the level
    of_run: bool  # whether it belongs to the level of this run; others are of the gear's alone
    basis: str  # where it is from


@dataclass(frozen=True, eq=False)
class Wave:
    """A wave of the angle: cosine and sine (2,), standard deviation of either, and its quantile of 97.5 %."""

    vector: np.ndarray
    sd: float
    quantile: float = NORMAL

    @property
    def size(self) -> float:
        """Amplitude as it is seen."""
        return float(np.hypot(*self.vector))

    @property
    def is_seen(self) -> bool:
        """Whether noise alone makes such a wave in less than 5 %."""
        return self.size > FOUND_WAVE * self.sd


@dataclass(frozen=True, eq=False)
class LevelEstimate:
    """The level of one test: half the difference of both directions, or the only direction's mean."""

    test: BenchTest  # what was measured
    value: float  # level, in the test's unit
    half_sum: float | None  # half the sum of both directions; None of one direction
    directions: tuple[int, ...]  # +1, -1, or both
    runs: int  # how many
    budget: tuple[BudgetRow, ...]  # contributions to the interval
    noise_sd: float  # standard deviation of the level
    drift_sd: float  # likewise
    repeat_sd: float  # of the mean of the runs from their scatter, declared or found
    run_levels: np.ndarray  # of the runs, (runs,)
    first: Wave | None  # the once-per-turn wave of the half sum, where a turn is covered
    friction_waves: Mapping[int, Wave]  # of friction itself: the half difference's first and second order
    bend: tuple[float, float]  # quadratic part of the half difference along the travel, and its deviation
    tooth_waves: Mapping[float, Wave]  # by their order over the number of teeth
    correlated: float  # probability that noise keeps its sign over some degrees
    spikes: int  # points that were left out
    asks: tuple[str, ...] = ()  # what is to be asked of the user

    @property
    def both_ways(self) -> bool:
        return len(self.directions) == 2

    def _interval(self, rows: Iterable[BudgetRow]) -> tuple[float, float]:
        half = float(np.sqrt(sum(row.half**2 for row in rows)))
        return self.value - half, self.value + half

    @property
    def run_interval(self) -> tuple[float, float]:
        return self._interval(row for row in self.budget if row.of_run)

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval of the level of the gear."""
        return self._interval(self.budget)

    @property
    def sd(self) -> float:
        """Standard deviation of the level of the gear, as its interval has it."""
        return (self.interval[1] - self.value) / NORMAL

    @property
    def noise(self) -> str:
        """What the interval rests on most."""
        largest = max(self.budget, key=lambda row: row.half)
        return f"most of it {largest.name}: {largest.basis}"

    @property
    def data_sd(self) -> float:
        """Standard deviation of the level without calibration, which all tests share."""
        of_run = [row.half / NORMAL for row in self.budget if row.of_run]
        return float(np.sqrt(self.repeat_sd**2 + sum(each**2 for each in of_run)))


def levels_of(passes: Sequence[MeasuredPass], teeth: int, gain: float) -> list[LevelEstimate]:
    """Return the level of each test; `gain` is the rack's travel per radian of pinion [m/rad].

    Raises:
        InputError: both directions of a run cover different angles.
    """
    tests = list(dict.fromkeys(each.test for each in passes))
    found = [_level(test, [each for each in passes if each.test == test], teeth, gain) for test in tests]
    return _with_repeatability(found)


@dataclass(frozen=True, eq=False)
class _Run:
    """One run: its passes, forth first, as recorded but for spikes; angles of the pinion [rad]."""

    passes: tuple[tuple[np.ndarray, np.ndarray], ...]
    spikes: int
    steps: tuple[float, ...]  # of the sensor, by pass
    constant: bool  # whether no pass shows a step
    white: float  # of a point


def _runs(test: BenchTest, passes: Sequence[MeasuredPass], gain: float) -> tuple[list[_Run], tuple[int, ...]]:
    by_direction = {sense: [each for each in passes if each.direction == sense] for sense in (1, -1)}
    directions = tuple(sense for sense in (1, -1) if by_direction[sense])
    paired = zip(*(by_direction[sense] for sense in directions), strict=False)
    runs = []
    for passes_of_run in paired:
        cleaned, spikes, steps, shown, white = [], 0, [], [], []
        for each in passes_of_run:
            angle, value = each.every_row
            step = noise.resolution_of(value)
            regular = noise.is_regular(value, step)
            cleaned.append((angle[regular] / (gain if test.pushed else 1.0), value[regular]))
            spikes += int((~regular).sum())
            steps.append(step)
            shown += [step] if np.ptp(value) > 0 else []
            white.append(noise.white_deviation(value[regular]))
        runs.append(_Run(tuple(cleaned), spikes, tuple(shown or steps), not shown, float(np.mean(white))))
    return runs, directions


def _parts(test: BenchTest, runs: Sequence[_Run]) -> list[Parts]:
    """The parts of each run over the angles that all passes cover; rows: half difference, half sum."""
    begins, ends = np.array([(angle.min(), angle.max()) for run in runs for angle, _ in run.passes]).T
    low, high, shortest = float(begins.max()), float(ends.min()), float((ends - begins).min())
    if high - low < OVERLAP * shortest or not high > low:
        raise InputError(
            f"the passes of {test.title} cover different angles of the pinion: they share "
            f"{np.degrees(max(high - low, 0.0)):.3g} of {np.degrees(shortest):.3g} deg; measure the same "
            "range forth and back, and in each run."
        )
    found = [noise.parts_of(run.passes, low, high) for run in runs]
    if len(runs[0].passes) == 1:
        return found
    means = [each.values for each in found]
    halves = [np.array([(forth - back) / 2, (forth + back) / 2]) for forth, back in means]
    return [replace(each, values=values) for each, values in zip(found, halves, strict=True)]


def _level(test: BenchTest, passes: Sequence[MeasuredPass], teeth: int, gain: float) -> LevelEstimate:
    runs, directions = _runs(test, passes, gain)
    both, count = len(directions) == 2, len(runs)
    per_run = _parts(test, runs)
    if not both:
        per_run = [replace(each, values=directions[0] * each.values) for each in per_run]
    span, orders = per_run[0].span, (1, 2, teeth, 2 * teeth)
    groups = _alike(per_run)
    angles = [group[0].angle for group in groups]
    effects = [_limited(np.ones((angle.size, 1)), angle, span, orders) for angle in angles]
    # Weights (k,) of the parts whose sum is the level, beside the waves of turn and teeth
    functionals = [np.linalg.pinv(each)[0] for each in effects]
    levels = _means(groups, functionals, 0)
    value = float(levels.mean())
    law = noise.averaged_law(
        [_regression(group, 1, span, (1, teeth, 2 * teeth), bent=False) for group in groups] if both else [],
        [_regression(group, 0, span, orders, bent=True) for group in groups],
        abs(value),
    )
    variances = sum(
        len(group) * np.einsum("k,lkj,j->l", g, each.regression.parts.laws.covariance, g)
        for g, group, each in zip(functionals, groups, law.differences, strict=True)
    )
    noise_sd = law.half_interval(np.asarray(variances)) / count / NORMAL
    drift = _drift(law, count)
    step, white = min(min(run.steps) for run in runs), float(np.mean([run.white for run in runs]))
    dithered = float(np.exp(-2 * (np.pi * white / step) ** 2)) if step else 0.0
    lasts = law.correlated > LIKELY
    kind = "noise correlated over some degrees" if lasts else "white noise within the run"
    steps = f"steps of {step:.3g} {test.unit.replace('*', ' ')}" if step else "no steps are seen"
    rows = [
        BudgetRow("noise", NORMAL * noise_sd, True, f"{kind}, by restricted likelihood"),
        BudgetRow("resolution", NORMAL * step / np.sqrt(12) * dithered, True, steps),
        BudgetRow("drift", NORMAL * drift, True, "slope of the half sum along the travel"),
    ]
    if not both:
        zero = _students(DECLARED) * ZERO * abs(value)
        rows.append(BudgetRow("zero, one way only", zero, True, f"{100 * ZERO:.2g} % declared"))
    for order, name in ((1, "waves of a turn"), (teeth, "ripple of the teeth")):
        if not covers(span, order):
            leak = abs(np.sinc(order * span / (2 * np.pi))) * UNSEEN * abs(value) / np.sqrt(2)
            rows.append(BudgetRow(name, NORMAL * leak, True, "the passes are shorter than one"))
    asks = [
        f"{count} points of {test.title} are at {each:.4g}: check the end of its sensor's range"
        for each, count in sorted(_at_an_end(passes).items())
    ]
    if all(run.constant for run in runs):
        asks.append(f"{test.title} holds one value only: state the smallest step of its sensor")
    return LevelEstimate(
        test=test,
        value=value,
        half_sum=float(_means(groups, functionals, 1).mean()) if both else None,
        directions=directions,
        runs=count,
        budget=tuple(rows),
        noise_sd=noise_sd,
        drift_sd=drift,
        repeat_sd=0.0,
        run_levels=levels,
        first=_first(law, both, count, step * dithered, value) if covers(span, 1) else None,
        friction_waves=_friction_waves(law, span),
        bend=_bend(law, count),
        tooth_waves=_tooth_waves(groups, law, both, teeth),
        correlated=law.correlated,
        spikes=sum(run.spikes for run in runs),
        asks=tuple(asks),
    )


LEVELS, AT_END, LEAST_AT_END = 8, 5, 5  # of values; times as often as its neighbours; points


def _at_an_end(passes: Sequence[MeasuredPass]) -> dict[float, int]:
    """Largest and smallest value that passes have again and again beside what they have near it -> how often:
    that of a sensor whose range ends there."""
    values, counts = np.unique(np.concatenate([each.every_row[1] for each in passes]), return_counts=True)
    if values.size < LEVELS:
        return {}
    ends = ((values[-1], counts[-1], counts[-4:-1]), (values[0], counts[0], counts[1:4]))
    return {
        float(value): int(count)
        for value, count, beside in ends
        if count >= LEAST_AT_END and count > AT_END * beside.max()
    }


def _alike(per_run: Sequence[Parts]) -> list[list[Parts]]:
    """Runs in groups of the same parts and numbers of points."""
    groups: dict[bytes, list[Parts]] = {}
    for each in per_run:
        groups.setdefault(each.angle.tobytes() + each.points.tobytes(), []).append(each)
    return list(groups.values())


def _limited(columns: np.ndarray, angle: np.ndarray, span: float, orders: Sequence[float]) -> np.ndarray:
    """The columns with as many waves as the parts can show beside noise."""
    for kept in range(len(orders), -1, -1):
        effects = np.hstack([columns, waves(angle, span, orders[:kept])])
        if angle.size >= 2 * effects.shape[1] or not kept:
            return effects
    return columns


def _regression(
    group: Sequence[Parts], row: int, span: float, orders: Sequence[float], bent: bool
) -> Regression:
    parts = group[0]
    columns = [np.ones_like(parts.place)]
    if bent and parts.angle.size >= 12:
        columns += [parts.place, 12 * parts.place**2 - 1]
    effects = _limited(np.column_stack(columns), parts.angle, span, orders)
    return Regression(parts, effects, np.array([each.values[row] for each in group]).T)


def _means(groups: Sequence[Sequence[Parts]], functionals: Sequence[np.ndarray], row: int) -> np.ndarray:
    """The weighted sum of a row of the parts, of each run: shape (runs,)."""
    pairs = zip(functionals, groups, strict=True)
    return np.array([g @ each.values[row] for g, group in pairs for each in group])


def _drift(law: AveragedLaw, runs: int) -> float:
    """Standard deviation of the level from drift: what drifts evenly over a pass is seen in the half sum.

    A zero that drifts evenly over both passes is in the half difference alone.
    """
    along = law.square_of_tilt() / 4
    across = 0.0
    if law.differences and law.differences[0].regression.effects.shape[1] > 2:
        slope, sd = _effect(law, law.differences, 1)
        across = (max(0.0, abs(float(slope[0])) - 2 * sd) / 2) ** 2 / 3
    one = float(np.sqrt(along + across))
    return one if runs == 1 else one / np.sqrt(runs) * _students(runs) / NORMAL


def _effect(law: AveragedLaw, solved: Sequence, column: int) -> tuple[np.ndarray, float]:
    """Mean over all runs of two neighbouring effects (2,), and their standard deviation."""
    found = [law.effect(each, column) for each in solved]
    vectors = np.concatenate([each[0] for each in found])
    counts = [each[0].shape[0] for each in found]
    variance = sum(np.mean(each[1]) * count for each, count in zip(found, counts, strict=True))
    return vectors.mean(axis=0), float(np.sqrt(variance)) / sum(counts)


def _first(law: AveragedLaw, both: bool, runs: int, step: float, level: float) -> Wave:
    """The once-per-turn wave of the half sum; of one direction, of its torque."""
    solved = law.sums if both else law.differences
    column = 1 if both else 3
    if solved[0].regression.effects.shape[1] < column + 2:
        return Wave(np.zeros(2), abs(level))
    vectors = np.concatenate([law.effect(each, column)[0] for each in solved])
    _, sd = _effect(law, solved, column)
    sd *= 1 + (SEVERAL_PARTS - 1) * max(law.correlated, LEAST_CORRELATED)
    sd = float(np.hypot(sd, step / np.sqrt(24 if both else 12)))
    quantile = NORMAL
    if runs > 1:
        from scipy.special import chdtri

        scatter = float(((vectors - vectors.mean(axis=0)) ** 2).sum())
        freedom = 2 * (runs - 1)
        if scatter > chdtri(freedom, 0.01) * runs * sd**2:
            sd, quantile = float(np.sqrt(scatter / freedom / runs)), _students(freedom)
    return Wave(vectors.mean(axis=0), sd if both else float(np.hypot(sd, ZERO * abs(level))), quantile)


def _friction_waves(law: AveragedLaw, span: float) -> dict[int, Wave]:
    """First and second order of the half difference, as far as the travel shows them."""
    found = {}
    effects = law.differences[0].regression.effects.shape[1]
    for order, column in ((1, 3), (2, 5)):
        if covers(span, 1) and effects >= column + 2:
            vector, sd = _effect(law, law.differences, column)
            found[order] = Wave(vector, sd * (1 + (SEVERAL_PARTS - 1) * law.correlated))
    return found


def _bend(law: AveragedLaw, runs: int) -> tuple[float, float]:
    if law.differences[0].regression.effects.shape[1] < 4:
        return 0.0, np.inf
    found = [law.effect(each, 1) for each in law.differences]
    vectors, variance = np.concatenate([each[0] for each in found]), np.mean([each[1][1] for each in found])
    return float(vectors[:, 1].mean()), float(np.sqrt(variance / runs))


LOWEST_ORDER, HIGHEST_RATIO = 2.5, 4.0  # of waves: of a turn; times the number of teeth
NEAR_ORDER = 1.0  # of a turn: waves that a large one touches
RAYLEIGH = 1.1774  # median of a wave's size over its deviation


def _tooth_waves(
    groups: Sequence[Sequence[Parts]], law: AveragedLaw, both: bool, teeth: int
) -> dict[float, Wave]:
    """Waves of the half sum, or of the only direction, by their order over the number of teeth, for an
    encoder's ratio.

    What is left of slow waves is noise of all of them; where it is correlated, at least the waves of half to
    twice the order.
    """
    parts = groups[0][0]
    if not covers(parts.span, 1):
        return {}
    value = np.mean([each.values[1 if both else 0] for group in groups[:1] for each in group], axis=0)
    slow = np.column_stack([np.ones_like(parts.place), parts.place, waves(parts.angle, parts.span, (1, 2))])
    left = value - slow @ np.linalg.lstsq(slow, value, rcond=None)[0]
    orders = np.arange(LOWEST_ORDER, HIGHEST_RATIO * teeth + 0.25, 0.5)
    orders = orders[parts.angle.size > 2.5 * orders * parts.span / (2 * np.pi)]
    columns = [waves(parts.angle, parts.span, (order,)) for order in orders]
    vectors = [np.linalg.lstsq(each, left, rcond=None)[0] for each in columns]
    sizes = np.hypot(*np.array(vectors).T) if vectors else np.zeros(0)
    white = float(np.std(left) * np.sqrt(2 / left.size))
    found = {}
    for order, vector in zip(orders, vectors, strict=True):
        beside = (orders > order / 2) & (orders < 2 * order) & (np.abs(orders - order) > NEAR_ORDER)
        local = float(np.median(sizes[beside])) / RAYLEIGH if beside.any() else 0.0
        found[float(order / teeth)] = Wave(vector, max(white, local))
    return found


# --- From this run to the gear

UNLIKE = 1e-3  # probability below which a test's scatter is taken for its own


def _with_repeatability(found: list[LevelEstimate]) -> list[LevelEstimate]:
    """The levels with the rows that make them the gear's; several tests share their scatter."""
    from scipy.special import chdtri

    repeated = [each for each in found if each.runs > 1 and each.value]
    freedom = sum(each.runs - 1 for each in repeated)
    parts = [float(np.var(each.run_levels, ddof=1)) / each.value**2 for each in repeated]
    pooled = sum(part * (each.runs - 1) for part, each in zip(parts, repeated, strict=True))
    pooled = pooled / freedom if freedom else 0.0
    scatters = dict(zip([each.test for each in repeated], parts, strict=True))
    done = []
    for each in found:
        scatter = pooled
        if each.runs > 1 and len(repeated) > 1:
            most = pooled * float(chdtri(each.runs - 1, UNLIKE))
            scatter = scatters[each.test] if scatters[each.test] * (each.runs - 1) > most else pooled
        one = each.noise_sd**2 + each.drift_sd**2
        declared = (REPEATABILITY * each.value) ** 2 + each.runs * one
        known = freedom if each.runs > 1 else 0
        square = scatter * each.value**2
        variance = (DECLARED * declared + known * square) / (DECLARED + known)
        if known:
            variance = max(variance, square)
        sd = float(np.sqrt(variance / each.runs))
        basis = f"{100 * REPEATABILITY:.2g} % declared"
        if known:
            basis += f", and {100 * np.sqrt(scatter):.2g} % found with {known} degrees of freedom"
        calibration = NORMAL * CALIBRATION * abs(each.value)
        rows = (
            BudgetRow("repeatability", _students(DECLARED + known) * sd, False, basis),
            BudgetRow("calibration", calibration, False, f"{100 * CALIBRATION:.2g} % declared"),
        )
        done.append(replace(each, budget=(*each.budget, *rows), repeat_sd=sd))
    return done


def _students(freedom: float) -> float:
    """The quantile of 97.5 % of Student's t."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.975))


# --- Runout


@dataclass(frozen=True)
class Runout:
    """The runout by the half sum: P e as it is measured, and e = P e / P [m].

    Where it is not found, both intervals begin at zero.
    """

    stored: float  # P e [N m]
    stored_interval: tuple[float, float]
    size: float  # e [m]
    interval: tuple[float, float]
    is_found: bool
    vector: np.ndarray  # of the half sum [N m], cosine and sine of the measured angle
    angle_sd: float  # of its direction [rad]


def runout_of(
    level: LevelEstimate, preload: float, preload_sd: float, prior: Wave | None = None
) -> Runout | None:
    """Return the runout from a free turning and the preload [N] with the deviation of its logarithm; None
    where no turn was covered. `prior` is the half sum's wave expected before."""
    wave = level.first
    if wave is None:
        return None
    if prior is not None:
        information = wave.sd**-2 + prior.sd**-2
        vector = (wave.vector / wave.sd**2 + prior.vector / prior.sd**2) / information
        wave = Wave(vector, float(information**-0.5), wave.quantile)
    seen = wave.size
    size = float(np.sqrt(max(seen**2 - wave.sd**2, 0.0)))
    half = wave.quantile * float(np.hypot(wave.sd, SIZE_SCATTER * size / np.sqrt(level.runs)))
    is_found = wave.is_seen and level.both_ways
    low, high = (max(0.0, size - half), size + half) if is_found else (0.0, seen + NORMAL * wave.sd)
    middle = size / preload
    below, above = (1 - np.exp(-NORMAL * preload_sd)), (np.exp(NORMAL * preload_sd) - 1)
    least = max(0.0, float(middle - np.hypot((size - low) / preload, below * middle))) if is_found else 0.0
    beyond = np.hypot((high - size) / preload, above * middle if is_found else above * high / preload)
    ends, angle_sd = (least, float(middle + beyond)), float(wave.sd / max(seen, 1e-300))
    return Runout(size, (low, high), middle, ends, is_found, wave.vector, angle_sd)
