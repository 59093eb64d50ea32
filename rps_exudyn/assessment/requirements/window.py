"""Window: the interval of a parameter in which a share of a series keeps the chosen requirements.

    found = window(gear, "yoke.preload", {"free_torque": {"least": "0.8 N*m", "most": "1.8 N*m"}})
    [(end.value, end.error, end.limited_by) for end in found.ends]

The same gears, in parts of their distributions, are computed at a few values of the parameter, together.
Polynomials of the inputs take their numbers to many more gears, whose numbers are interpolated between these
values. So the share is known at all values. Then the ends themselves are computed, too. Of two parameters
there is a map.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from rps_exudyn.assessment.requirements.judging import (
    RATED_TORQUE,
    as_tested,
    numbers_without_runs,
    sources_of,
)
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import shown, to_si
from rps_exudyn.gears.geometry_report import check_gear
from rps_exudyn.inference.uncertainty.band import FEWEST, OnProgress
from rps_exudyn.inference.uncertainty.input_sets import uncertain_inputs
from rps_exudyn.inference.uncertainty.joint import JointInputs
from rps_exudyn.inference.uncertainty.samples import Samples
from rps_exudyn.inference.uncertainty.statistics import Polynomials, legendre_terms
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.parameters.fidelity import FOR_MEANS
from rps_exudyn.parameters.gear import SteeringGear, declared_number
from rps_exudyn.results.limit import Limit
from rps_exudyn.results.requirements import limits_in, read_only
from rps_exudyn.scenes.contact_law import LAW_OF_SERIES, resolve_contact_law
from rps_exudyn.simulate.batch import batch

SAMPLES, OF_MAP = 128, 64  # gears at each value of one parameter, of two
DRAWN = 4096  # gears by the polynomials
AGAIN = 24  # draws of the runs, for errors
FACTORS = np.geomspace(1 / 5, 5, 15)  # times the gear's value: where a window is looked for
NODES, OF_EACH = 3, 4  # values of one parameter that are computed first, of each of two
DENSE = {1: 401, 2: 31}  # values in between, by the number of parameters
HALVINGS = 12  # of the way to a value without a gear
EVERY = slice(None)
FIRST_PASS = {"torque_mean", "torque_peak_to_peak", "torque_tooth_order", "torque_first_order"}
"""Metrics of the first pass of a free turn, which need no way back."""
Point = tuple[float, ...]


@dataclass(frozen=True)
class End:
    """An end of a window, SI: standard errors by the number of gears and by the numerical error; the limits
    that forbid more, each with its side that does; none where the search ended there, and why."""

    value: float
    sampling: float
    numerical: float
    limits: Mapping[str, Limit]
    cause: str = ""

    @property
    def limited_by(self) -> tuple[str, ...]:
        """Names of the limits that forbid more."""
        return tuple(self.limits)

    @property
    def error(self) -> float:
        """Both errors together."""
        return float(np.hypot(self.sampling, self.numerical))


@dataclass(frozen=True, eq=False)
class Window:
    """What was found. Arrays have an axis for each parameter.

    Attributes:
        paths: of the parameters.
        places: of each parameter, where shares are known, SI.
        shares: of the gears that keep all limits.
        each: name -> of those that keep that limit.
        share: wanted one.
        ends: low and high end; () without a window, or of two parameters.
        best: path -> value, where the share is largest; in the middle of the window where there is one.
        limits: name -> limit.
        samples: gears at each computed value.
        computed: values that were computed.
    """

    paths: tuple[str, ...]
    places: tuple[np.ndarray, ...]
    shares: np.ndarray
    each: Mapping[str, np.ndarray]
    share: float
    ends: tuple[End, ...]
    best: Mapping[str, float]
    limits: Mapping[str, Limit]
    samples: int
    computed: int

    @property
    def best_share(self) -> float:
        """Largest share of gears that keep all limits."""
        return float(self.shares.max())

    @property
    def forbidden_by(self) -> tuple[str, ...]:
        """Limits that most gears miss where the share is largest."""
        at = np.unravel_index(int(self.shares.argmax()), self.shares.shape)
        return _most_missed({name: float(each[at]) for name, each in self.each.items()})


def _most_missed(kept: Mapping[str, float]) -> tuple[str, ...]:
    missed = {name: 1 - share for name, share in kept.items()}
    return tuple(name for name, each in missed.items() if each > max(missed.values()) / 2)


def window(
    gear: SteeringGear,
    paths: str | Sequence[str],
    limits: Mapping[str, Any] | str | Path,
    *,
    share: str | float = "95%",
    inputs: str | None = None,
    own: Mapping[str, Distribution] | None = None,
    ranges: Mapping[str, tuple[Any, Any]] | None = None,
    rated_torque: float = RATED_TORQUE,
    samples: int | None = None,
    seed: int = 0,
    on_progress: OnProgress | None = None,
) -> Window:
    """Return where a share of the gears keeps the limits.

    Args:
        gear: its values are those of all other parameters.
        paths: of one parameter, or of two.
        limits: name of a requirement or a metric -> table with least, most or both; or a file of them.
        share: of the gears, more than 0 and less than 100 %.
        inputs: set of the errors: series, unknown or own.
        own: distributions that the gear's parameters carry.
        ranges: path -> least and most value to look at; of one parameter by default a fifth to five times the
            gear's value.
        rated_torque: on the pinion [N m], of the requirements that have one.
        samples: gears at each value.
        seed: of their random numbers.
        on_progress: called with the number of values that are done, and of all.

    Raises:
        InputError: a share, a parameter, limits or ranges that cannot be.

    Examples:
        >>> found = rps.window(
        ...     rps.SteeringGear(), "yoke.preload", {"free_torque": {"most": "0.7 N*m"}}, samples=16
        ... )
        >>> 260 < found.ends[1].value < 290, found.ends[1].limited_by
        (True, ('free_torque',))
    """
    names = (paths,) if isinstance(paths, str) else tuple(paths)
    asked = read_only(Path(limits)) if isinstance(limits, str | Path) else limits_in(limits, "limits")
    wanted, searched = _share(share), [_places(gear, path, (ranges or {}).get(path)) for path in names]
    if len(names) == 2 and (missing := [path for path in names if path not in (ranges or {})]):
        raise InputError(f"a map needs the range of each parameter; give that of {' and '.join(missing)}.")
    if len(names) not in DENSE or len(set(names)) < len(names):
        raise InputError(f"a window has one parameter or two, but {', '.join(names) or 'none'} is given.")
    if twice := [path for path in names if path in (own or {})]:
        raise InputError(f"{twice[0]} carries a distribution, but the window varies it; give it one value.")
    count = samples or (SAMPLES if len(names) == 1 else OF_MAP)
    if count < FEWEST:
        raise InputError(f"the window has {count} gears at each value; it needs at least {FEWEST}.")
    middle = gear.replace(
        {path: float(np.median(places)) for path, places in zip(names, searched, strict=True)}
    )
    drawn = uncertain_inputs(middle, inputs, own or {})
    sources = sources_of(asked, gear, uncertain_inputs(gear, inputs, own or {}), rated_torque)
    series = _Series(gear, names, asked, sources, rated_torque, inputs, own or {}, drawn, count, seed)
    report = on_progress or (lambda done, of: None)
    report(0, 2)
    if len(names) == 1:
        axes = [np.linspace(*series.narrowed(searched[0]), NODES)]
    else:
        axes = [np.linspace(places[0], places[-1], OF_EACH) for places in searched]
    series.compute(_grid(axes))
    report(1, 2)
    if len(names) == 1:
        ends = series.ends(axes, wanted) or (float(series.found(axes, wanted).best[names[0]]),)
        series.compute([(end,) for end in dict.fromkeys(ends) if end not in axes[0]])
        axes = [np.unique(np.append(axes[0], ends))]
    return series.with_errors(axes, series.found(axes, wanted))


def _grid(axes: Sequence[np.ndarray]) -> list[Point]:
    return list(product(*(axis.tolist() for axis in axes)))


def _share(share: str | float) -> float:
    try:
        value = to_si(share, "")
    except ValueError:
        value = np.nan
    if not 0 < value < 1:
        near = "99.9 %" if value >= 1 else "0.1 %" if value <= 0 else "95 %"
        raise InputError(
            f"the share is {shown(share)}; it must be more than 0 % and less than 100 %, for instance {near}."
        )
    return value


def _places(gear: SteeringGear, path: str, given: tuple[Any, Any] | None) -> np.ndarray:
    """Rising values at which the window of a parameter is looked for.

    Raises:
        InputError: no number of that path, or a range that cannot be.
    """
    unit, value = declared_number(path, ["yoke.preload"]).unit, float(gear.value_at(path))
    assert unit is not None
    if given is None:
        if not value:
            raise InputError(f"{path} is {unit.show(0.0)}; give the range in which its window is looked for.")
        return np.sort(value * FACTORS)
    try:
        low, high = (to_si(each.strip() if isinstance(each, str) else each, unit.si) for each in given)
    except ValueError as error:
        raise InputError(f"the range of {path} {error}.") from None
    if not low < high:
        raise InputError(f"the range of {path} is {unit.show(low)} to {unit.show(high)}; it must rise.")
    for end in (low, high):
        gear.replace({path: end})
    return np.linspace(low, high, len(FACTORS))


Numbers = dict[str, tuple[np.ndarray, np.ndarray]]
"""Name of a limit -> numbers of gears (n,), nan where one failed, and half widths of their error bars."""


@dataclass(frozen=True, eq=False)
class _Series:
    """Gears of a series at some values of the parameters, and their numbers."""

    gear: SteeringGear
    paths: tuple[str, ...]
    limits: Mapping[str, Limit]
    sources: Mapping[str, tuple[str, str]]
    rated_torque: float
    inputs: str | None
    own: Mapping[str, Distribution]
    drawn: JointInputs  # in the middle of the values: what varies
    count: int
    seed: int
    known: dict[Point, Numbers] = field(default_factory=dict)
    # last value of the parameter with a gear -> why there is none beyond
    causes: dict[float, str] = field(default_factory=dict)

    @cached_property
    def quantiles(self) -> tuple[np.ndarray, np.ndarray]:
        """Of the inputs of the runs, and of the gears by the polynomials."""
        runs = Samples.drawn(self.drawn, self.count, self.seed)
        return runs.quantile, Samples.drawn(self.drawn, DRAWN, self.seed + 1).quantile

    def compute(self, points: Sequence[Point]) -> None:
        """Compute the series at the points, with the same random numbers at each."""
        self.known.update(zip(points, self._numbers(points, self.quantiles[0]), strict=True))

    def _numbers(self, points: Sequence[Point], quantile: np.ndarray) -> list[Numbers]:
        """Run gears at quantiles (n, inputs) at all points together, scene by scene."""
        found: list[Numbers] = [{} for _ in points]
        gears = [self.gear.replace(dict(zip(self.paths, point, strict=True))) for point in points]
        rows, columns = len(quantile), dict[str, list[np.ndarray]]()
        for gear in gears:
            drawn = uncertain_inputs(gear, self.inputs, self.own)
            for path in (*self.paths, *(path for path in self.drawn if path not in self.paths)):
                at = (
                    quantile[:, list(self.drawn).index(path)]
                    if path in drawn and path in self.drawn
                    else None
                )
                value = np.full(rows, gear.value_at(path)) if at is None else drawn[path].quantile(at)
                columns.setdefault(path, []).append(value)
        table = {path: np.concatenate(each) for path, each in columns.items()}
        for scene in dict.fromkeys(scene for scene, _ in self.sources.values()) if points else ():
            metrics = {name: metric for name, (of, metric) in self.sources.items() if of == scene}
            tested = as_tested(self.gear, scene, self.rated_torque)
            if tested.test.path == "there-and-back" and set(metrics.values()) <= FIRST_PASS:
                tested = tested.replace({"test.path": "one-way"})
            tested = resolve_contact_law(tested, FOR_MEANS, LAW_OF_SERIES, table)
            ran = batch(scene, tested, table, fidelity=FOR_MEANS, keep="torque")
            for name, metric in metrics.items():
                both = np.split(ran.summary[metric], len(points)), np.split(ran.errors[metric], len(points))
                for numbers, values, bars in zip(found, *both, strict=True):
                    numbers[name] = values, np.nan_to_num(bars)
        names = [name for name in self.limits if name not in self.sources]
        for gear, numbers in zip(gears, found, strict=True) if names else ():
            exact = dict.fromkeys(names, np.nan)
            if not _refusal(gear):
                exact = numbers_without_runs(names, gear, self.limits, self.rated_torque)
            numbers |= {name: (np.full(rows, value), np.zeros(rows)) for name, value in exact.items()}
        return found

    def narrowed(self, places: np.ndarray) -> tuple[float, float]:
        """Return the ends of a range about the values of one parameter at which the gear at the medians keeps
        the limits; where there are none, about the value that misses them least."""
        (path,) = self.paths
        points = self.admissible(np.union1d(places, _within(places, float(self.gear.value_at(path)))))
        if not points:
            raise InputError(f"{path} has no values at which there is a gear: {self.refused(places[0])}")
        medians = np.full((1, len(self.drawn)), 0.5)
        missed = np.array(
            [
                max(_missed(self.limits[name], float(values[0])) for name, (values, _) in numbers.items())
                for numbers in self._numbers([(each,) for each in points], medians)
            ]
        )
        first = last = int(missed.argmin())
        while first > 0 and missed[first - 1] <= 0:
            first -= 1
        while last < len(missed) - 1 and missed[last + 1] <= 0:
            last += 1
        first -= int(first > 0 and np.isfinite(missed[first - 1]))
        last += int(last < len(missed) - 1 and np.isfinite(missed[last + 1]))
        if first == last:
            raise InputError(f"{path} has no values at which the gear can be computed.")
        return points[first], points[last]

    def refused(self, value: float) -> str:
        """Return why there is no gear with a value of the parameter; "" if there is."""
        try:
            return _refusal(self.gear.replace({self.paths[0]: value}))
        except InputError as error:
            return error.problems[0]

    def admissible(self, places: np.ndarray) -> list[float]:
        """Return those of rising values with which there is a gear, and between these and others the last
        ones that have."""
        refused, found = [self.refused(place) for place in places.tolist()], list[float]()
        for i, place in enumerate(places.tolist()):
            if refused[i]:
                continue
            others = (k for k in (i - 1, i + 1) if 0 <= k < len(places) and refused[k])
            found += sorted([place, *(self._last(place, float(places[k])) for k in others)])
        return found

    def _last(self, value: float, beyond: float) -> float:
        """Return the last value with a gear before another one without; keep the cause of its refusal."""
        cause = self.refused(beyond)
        for _ in range(HALVINGS):
            middle = (value + beyond) / 2
            if why := self.refused(middle):
                beyond, cause = middle, why
            else:
                value = middle
        self.causes[value] = cause
        return value

    def found(self, axes: Sequence[np.ndarray], share: float) -> Window:
        """Return the shares between the points of a grid, and where the share is largest."""
        dense = tuple(np.linspace(axis[0], axis[-1], DENSE[len(axes)]) for axis in axes)
        each = self.shares(axes, dense)
        shares = each.pop("")
        top = np.unravel_index(int(shares.argmax()), shares.shape)
        best = {path: float(dense[k][top[k]]) for k, path in enumerate(self.paths)}
        computed = int(np.prod([len(axis) for axis in axes]))
        return Window(self.paths, dense, shares, each, share, (), best, self.limits, self.count, computed)

    def ends(self, axes: Sequence[np.ndarray], share: float, sign: int = 0) -> tuple[float, ...]:
        """Return both ends of the window of one parameter; () without a window."""
        places = np.linspace(axes[0][0], axes[0][-1], DENSE[1])
        shares = self.shares(axes, (places,), sign=sign)[""]
        found = tuple(_crossing(places, shares, sense, share) for sense in (-1, 1))
        return found if shares.max() >= share else ()

    def with_errors(self, axes: Sequence[np.ndarray], found: Window) -> Window:
        """Return a window of one parameter with its ends."""
        if len(axes) > 1 or not (values := self.ends(axes, found.share)):
            return found
        (places,), rng, made = found.places, np.random.default_rng(self.seed), []
        rows = [rng.choice(self.count, self.count) for _ in range(AGAIN)]
        again = [self.shares(axes, (np.array(values),), some)[""] for some in rows]
        moved = [self.ends(axes, found.share, sign) or (found.best[self.paths[0]],) * 2 for sign in (-1, 1)]
        for k, sense in enumerate((-1, 1)):
            errors, limited = (0.0, 0.0), dict[str, Limit]()
            if places[0] < values[k] < places[-1]:
                deviation = float(np.std([one[k] for one in again]))
                levels = (found.share - deviation, found.share + deviation)
                sampling = np.ptp([_crossing(places, found.shares, sense, level) for level in levels])
                errors = float(sampling) / 2, abs(moved[1][k] - moved[0][k]) / 2
                names = _most_missed(
                    {name: float(np.interp(values[k], places, one)) for name, one in found.each.items()}
                )
                limited = {name: self._side(name, values[k], sense, found.share) for name in names}
            cause = "" if limited else self.causes.get(float(values[k]), "")
            made.append(End(values[k], *errors, limited, cause))
        return replace(found, ends=tuple(made), best={self.paths[0]: sum(values) / 2})

    def _side(self, name: str, end: float, sense: int, share: float) -> Limit:
        """Return the side of a limit that too many gears miss at the computed value behind an end."""
        (beyond,) = min(self.known, key=lambda at: (sense * (at[0] - end) < 0, abs(at[0] - end)))
        values = self.known[beyond,][name][0]
        return self.limits[name].missed(*np.nanquantile(values, (1 - share, share)).tolist())

    def shares(
        self,
        axes: Sequence[np.ndarray],
        dense: Sequence[np.ndarray],
        rows: np.ndarray | slice = EVERY,
        sign: int = 0,
    ) -> dict[str, np.ndarray]:
        """Return name -> share of the gears that keep a limit at places between the axes' points, "" for all
        limits; from some rows of the runs, with numbers that are wrong by `sign` times their error bars.

        Polynomials of the inputs' quantiles through the runs give the numbers of many gears, with what they
        leave at one of the runs drawn at random.
        """
        points, shape = _grid(axes), [len(axis) for axis in axes]
        runs, drawn = self.quantiles
        fitted = Polynomials.at(runs[rows], {})
        virtual = legendre_terms(drawn, fitted.degree)
        chosen = np.random.default_rng(self.seed).integers(0, self.count, DRAWN)
        widened = np.sqrt(self.count / (self.count - fitted.terms.shape[1]))
        kept = {}
        for name, limit in self.limits.items():
            values, bars = (np.array([self.known[point][name][k][rows] for point in points]) for k in (0, 1))
            failed = ~np.isfinite(values)
            values = np.where(failed, _mean(values)[:, None], values) + sign * np.median(bars)
            coefficients = values @ fitted.inverse.T
            left = widened * (values - coefficients @ fitted.terms.T)
            many = coefficients @ virtual.T + left[:, chosen]
            at = _between(axes, dense, many.reshape(*shape, DRAWN))
            works = _between(axes, dense, failed[:, chosen].astype(float).reshape(*shape, DRAWN)) < 1e-9
            kept[name] = limit.keeps(at) & works
        kept[""] = np.logical_and.reduce(list(kept.values()))
        return {name: each.mean(axis=-1) for name, each in kept.items()}


def _refusal(gear: SteeringGear) -> str:
    """Return why a gear cannot exist; "" if it can."""
    try:
        check_gear(gear)
    except InputError as error:
        return error.problems[0]
    return ""


def _within(places: np.ndarray, value: float) -> list[float]:
    return [value] if places[0] < value < places[-1] else []


def _missed(limit: Limit, value: float) -> float:
    """How far a number lies beyond a limit, over the size of the limit; inf of none."""
    beyond = max(limit.least - value, value - limit.most)
    return beyond / (limit.finite or 1.0) if np.isfinite(value) else np.inf


def _mean(values: np.ndarray) -> np.ndarray:
    """Means (k,) of the known ones of values (k, n), which stand for those that failed."""
    known = np.isfinite(values)
    return np.asarray(np.where(known, values, 0.0).sum(axis=1) / np.maximum(known.sum(axis=1), 1))


def _between(axes: Sequence[np.ndarray], dense: Sequence[np.ndarray], values: np.ndarray) -> np.ndarray:
    """Interpolate by monotone cubic pieces along all axes but the last."""
    from scipy.interpolate import PchipInterpolator

    for k, (axis, places) in enumerate(zip(axes, dense, strict=True)):
        values = PchipInterpolator(axis, values, axis=k)(places)
    return values


def _crossing(places: np.ndarray, shares: np.ndarray, sense: int, level: float) -> float:
    """Return the place where the shares fall below a level, from their largest on to one side; that of the
    largest where they are below it."""
    inner = np.arange(len(places))[::sense]
    inner = inner[list(inner).index(int(shares.argmax())) :]
    below = inner[shares[inner] < level]
    if not below.size:
        return float(places[inner[-1]])
    outside = int(below[0])
    inside = outside - sense if outside != inner[0] else outside
    part = (shares[inside] - level) / (shares[inside] - shares[outside]) if inside != outside else 0.0
    return float(places[inside] + part * (places[outside] - places[inside]))
