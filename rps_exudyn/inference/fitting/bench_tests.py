"""The tests of a bench whose curves can be fitted, and the files that hold them.

free             the pinion is turned, the rack carries nothing (the scene free-pinion-torque)
reversal         the same to and fro over some ten degrees
load-test@80kg   the pinion raises a weight at the rack's end, and lowers it
rack-push        the rack is pushed, the pinion follows
rack-on-rollers  the rack is pushed between the yoke and rollers, which stand where the pinion was
yoke-out         the pinion is turned without the yoke: nothing presses the teeth together
bearing          the pinion alone in its bearings
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from operator import itemgetter
from pathlib import Path

import numpy as np

from rps_exudyn.analysis.passes import Pass, passes
from rps_exudyn.base import units
from rps_exudyn.base.errors import InputError, are, lines_in_words
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.inference.fitting.noise import robust_deviation
from rps_exudyn.inference.measured.reading import PUSH, TORQUE, read_curve
from rps_exudyn.inference.measured.turning import speeds
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import MeasuredTorque
from rps_exudyn.scenes.load_test import SCENE as LOAD_TEST
from rps_exudyn.scenes.rack_on_rollers import SCENE as RACK_ON_ROLLERS
from rps_exudyn.scenes.rack_push import SCENE as RACK_PUSH
from rps_exudyn.scenes.reversal import SCENE as REVERSAL
from rps_exudyn.solvers.closed_form import GRAVITY


@dataclass(frozen=True)
class Minutes:
    """Time of a test: to set up, and for each run."""

    setup: float
    run: float


@dataclass(frozen=True)
class BenchKind:
    """What distinguishes one kind of test."""

    by_angle: bool = False  # its curves are compared angle by angle; others by their means
    turns_about: bool = False  # the motion turns back, so that friction turns about
    weighted: bool = False  # a weight at the rack's end belongs to it
    minutes: Minutes = Minutes(5, 5)  # estimated time of the test
    quantities: tuple[str, str] = TORQUE  # driven coordinate and measured torque or force


KINDS = {
    "free": BenchKind(by_angle=True),
    REVERSAL.name: BenchKind(by_angle=True, turns_about=True),
    LOAD_TEST.name: BenchKind(weighted=True, minutes=Minutes(10, 7)),
    RACK_PUSH.name: BenchKind(quantities=PUSH, minutes=Minutes(10, 5)),
    RACK_ON_ROLLERS.name: BenchKind(quantities=PUSH, minutes=Minutes(35, 5)),
    "yoke-out": BenchKind(minutes=Minutes(15, 5)),
    "bearing": BenchKind(minutes=Minutes(15, 5)),
}
"""Name in front of a file -> kind of test."""
_NAMED = re.compile(rf"(?P<kind>{'|'.join(KINDS)})(?:@(?P<load>[^=]+))?=(?P<file>.+)", re.S)
MOST_POINTS = 720  # of a pass: more are taken together by their medians
UNSIGNED = 0.5  # least ratio of absolute values of friction in both directions
MIXED = 1.5  # of two speeds, from which on friction may differ between them
SHORTEST = 0.2  # of the longest pass: what is shorter is a jerk, whose torque shows no sign
WHOLE = 0.8  # of the longest pass one way: what is shorter is the way to the start, or a part of a pass
SEAM = 0.05  # of the travel, by which two parts of a pass may overlap or lie apart
TURNING = np.radians(3.0)  # after a turn of a reversal, where friction is still turning about
LATE, TOO_LATE = np.radians([3.0, 15.0])  # after or before a turn, where a torque changes: said, refused
SETTLED = 0.25  # of a pass, from its end, that shows the torque of a direction


@dataclass(frozen=True)
class BenchTest:
    kind: str
    load: float = 0.0  # that pulls the rack's end towards -X [N]

    @property
    def of_kind(self) -> BenchKind:
        return KINDS[self.kind]

    @property
    def pushed(self) -> bool:
        return self.of_kind.quantities == PUSH

    @property
    def title(self) -> str:
        """Its name for a reader, and in front of a file."""
        return f"{self.kind}@{abs(self.load) / GRAVITY:.4g}kg" if self.load else self.kind

    @property
    def unit(self) -> str:
        """SI unit of what is measured."""
        return "N" if self.pushed else "N*m"


@dataclass(frozen=True, eq=False)
class MeasuredPass:
    """What a file holds of one pass; the torque is that of the result files' signs."""

    test: BenchTest
    run: int  # number of the file
    direction: int  # +1 moves the rack along +X
    angle: np.ndarray  # pinion angle, or displacement of a rack push, rising [rad] or [m], shape (n,)
    value: np.ndarray  # torque [N m] or force [N], shape (n,)
    speeds: np.ndarray = field(default_factory=lambda: np.zeros(0))  # [rad/s] or [m/s], where it is recorded
    rows: tuple[np.ndarray, np.ndarray] | None = None  # angle and value of every row, if they are more

    @property
    def every_row(self) -> tuple[np.ndarray, np.ndarray]:
        """Angles, rising, and values of every row."""
        return self.rows or (self.angle, self.value)


@dataclass(frozen=True, eq=False)
class Measurement:
    """All passes of all files, and what was taken for granted."""

    passes: tuple[MeasuredPass, ...]
    names: tuple[str, ...]  # of the files, by their number
    assumed: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()  # rows of the files that no pass has, and why
    late: tuple[str, ...] = ()  # files whose torque follows the motion late, or is ahead, and by how much

    @property
    def tests(self) -> list[BenchTest]:
        """The tests, each once, in the order in which they come."""
        return list(dict.fromkeys(each.test for each in self.passes))


def named_test(text: str) -> tuple[BenchTest, Path]:
    """Return test and file of "FILE" or "TEST=FILE", for instance "load-test@80kg=heavy.csv".

    Raises:
        InputError: a load that is no mass, or a load test without one.
    """
    found = None if Path(text).exists() else _NAMED.fullmatch(text)
    if not found:
        return BenchTest("free"), Path(text)
    kind, load, file = found["kind"], found["load"], Path(found["file"])
    if KINDS[kind].weighted != (load is not None):
        example = f"{LOAD_TEST.name}@80kg=FILE"
        raise InputError(f"{text} must state a weight exactly if it is a load test: {example}.")
    try:
        mass = units.to_si(load, "kg") if load else 0.0
    except ValueError as error:
        raise InputError(f"{text}: the weight {error}.") from None
    if load and not 0 < mass < 1e4:
        raise InputError(f"{text}: the weight is {mass:g} kg; it must be more than 0 and less than 10000 kg.")
    return BenchTest(kind, mass * GRAVITY), file


def read_measurement(
    files: Iterable[str | Path], columns: Mapping[str, str] | None = None, gear: SteeringGear | None = None
) -> Measurement:
    """Read the passes of all files; where one has the rack's travel instead of an angle, of this gear.

    Raises:
        InputError: files that cannot be read, all of them at once.
    """
    curves, problems, read = [], list[str](), set[tuple[BenchTest, Path]]()
    gain = float(GearPair.of(gear or SteeringGear()).gain)
    for text in files:
        try:
            test, path = named_test(str(text))
            if (given := (test, path.resolve())) in read:
                problems.append(f"{path} is given twice for the same test; a repeat is a file of its own.")
                continue
            read.add(given)
            curves.append((test, read_curve(path, test.of_kind.quantities, columns, gain)))
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    return measurement_of(curves)


def measurement_of(curves: Iterable[tuple[BenchTest, MeasuredTorque]]) -> Measurement:
    """Divide curves into passes.

    Raises:
        InputError: there are none.
    """
    found = list[MeasuredPass]()
    names, assumed, left_out, late = (list[str]() for _ in range(4))
    for run, (test, curve) in enumerate(curves):
        driven, measured = test.of_kind.quantities
        signals = {"pinion_angle": curve.signals[driven], "value": curve.signals[measured]}
        lines = {"line": np.arange(1.0, curve.signals[driven].size + 1), **curve.beside}
        turned = passes(signals | lines)
        after, delay = (0.0, "") if test.pushed else _lateness(turned, curve.name)
        late += [delay] if delay else []
        turned = _joined(turned)
        of_file = [_measured_pass(test, run, each, after) for each in turned]
        kept = _are_whole(of_file)
        rows = (*curve.left_out, *_rows_left_out(turned, of_file, kept, lines["line"], after))
        left_out += [f"{curve.name}: {sentence}" for sentence in rows]
        of_file = [each for each, is_kept in zip(of_file, kept, strict=True) if is_kept]
        of_file, said = _with_signs(of_file, curve.name)
        found += of_file
        names.append(curve.name)
        count = "1 pass" if len(of_file) == 1 else f"{len(of_file)} passes"
        assumed += [f"{curve.name}: {sentence}" for sentence in (*curve.assumed, count, *said)]
    if not found:
        raise InputError("a fit needs at least one measured curve.")
    return Measurement(tuple(found), tuple(names), tuple(assumed), tuple(left_out), tuple(late))


def _lateness(turned: Sequence[Pass], name: str) -> tuple[float, str]:
    """Angle [rad] by which the torque follows each turn of the motion, negative where it is ahead, and what
    is said of it; 0 and "" where it changes within `LATE`, as friction does.

    Raises:
        InputError: it is off by more than `TOO_LATE`.
    """
    found = []
    for before, after in pairwise(turned):
        step = float(np.median(np.abs(np.diff(before.angle)))) if before.angle.size > 1 else 0.0
        joined = abs(after.angle[0] - before.angle[-1]) <= 3 * step + 1e-9
        if before.direction == after.direction or not joined or min(before.angle.size, after.angle.size) < 12:
            continue
        ends = [each.signals["value"][-max(3, int(SETTLED * each.angle.size)) :] for each in (before, after)]
        first, last = (float(np.median(end)) for end in ends)
        if abs(last - first) < 4 * max(robust_deviation(np.diff(end)) for end in ends):
            continue  # noise hides when it changes
        middle = (first + last) / 2
        has_changed = [(each.signals["value"] - middle) * (last - first) > 0 for each in (before, after)]
        late, early = int(np.argmax(has_changed[1])), int(np.argmin(has_changed[0][::-1]))
        turn, sign, place = (after, 1, late) if late else (before, -1, -1 - early)
        begin = 0 if late else -1
        clock = turn.signals.get("clock")
        seconds = abs(float(clock[place] - clock[begin])) if clock is not None else np.nan
        found.append((sign * abs(float(turn.angle[place] - turn.angle[begin])), seconds))
    if not found:
        return 0.0, ""
    angle, seconds = (float(each) for each in np.median(np.array(found), axis=0))
    if abs(angle) <= LATE:
        return 0.0, ""
    time = f" ({seconds:.2g} s)" if np.isfinite(seconds) else ""
    when, which = ("after", "its channel") if angle > 0 else ("before", "the channel of the angle")
    said = f"the torque changes {np.degrees(abs(angle)):.2g} deg{time} {when} the motion reverses"
    if abs(angle) > TOO_LATE:
        raise InputError(
            f"{name}: {said} (limit {np.degrees(TOO_LATE):.0f} deg): {which} is late; shift it by "
            "that time, or record angle and torque by one clock."
        )
    return 1.5 * angle, f"{name}: {said}: {which} may be late{', or the rig has play' if angle > 0 else ''}"


def _joined(turned: Sequence[Pass]) -> list[Pass]:
    """The passes, of which two that are parts of one, as if the motion began in the middle, are joined."""
    left, found = list(turned), []
    while left:
        first = left.pop(0)
        other = next((each for each in left if _are_parts(first, each, turned)), None)
        if other is not None:
            left.remove(other)
            parts = sorted((first, other), key=lambda each: first.direction * float(each.angle.mean()))
            joined = {name: np.concatenate([each.signals[name] for each in parts]) for name in first.signals}
            first = Pass(first.direction, joined)
        found.append(first)
    return found


def _are_parts(first: Pass, second: Pass, turned: Sequence[Pass]) -> bool:
    longest = max(float(np.ptp(each.angle)) for each in turned)
    both = np.concatenate([first.angle, second.angle])
    overlap = min(first.angle.max(), second.angle.max()) - max(first.angle.min(), second.angle.min())
    return bool(
        first.direction == second.direction
        and np.ptp(both) > WHOLE * longest
        and max(np.ptp(first.angle), np.ptp(second.angle)) < WHOLE * longest
        and abs(overlap) < SEAM * longest
    )


def _are_whole(found: Sequence[MeasuredPass]) -> list[bool]:
    """Which passes cover most of what the longest one their way covers."""
    covered = np.array([np.ptp(each.angle) for each in found])
    senses = np.array([each.direction for each in found])
    longest = {sense: covered[senses == sense].max() for sense in set(senses.tolist())}
    return [bool(np.ptp(each.angle) > WHOLE * longest[each.direction]) for each in found]


def _measured_pass(test: BenchTest, run: int, turned: Pass, after: float = 0.0) -> MeasuredPass:
    inside = _sliding(test, turned, after)
    angle, value = turned.angle[inside], turned.signals["value"][inside]
    order = np.argsort(angle)
    angle, value = angle[order], value[order]
    rows = None
    if angle.size > MOST_POINTS:
        rows = angle, value
        parts = np.array_split(np.arange(angle.size), MOST_POINTS)
        angle = np.array([angle[part].mean() for part in parts])
        value = np.array([np.median(value[part]) for part in parts])
    return MeasuredPass(test, run, turned.direction, angle, value, speeds(turned.signals), rows)


def _sliding(test: BenchTest, turned: Pass, after: float) -> np.ndarray:
    """Which rows of a pass are compared, shape (n,): those of a reversal where friction has turned about, and
    those beyond an angle `after` its begin, as far as a torque is late; before its end, if it is negative."""
    angle = turned.angle
    inside = (angle > angle.min() + TURNING) & (angle < angle.max() - TURNING)
    if not (test.of_kind.turns_about and inside.sum() > 2):
        inside = np.ones(angle.size, dtype=bool)
    settled = inside & (np.abs(angle - angle[0 if after > 0 else -1]) >= abs(after))
    return settled if settled.sum() > 2 else inside


def _rows_left_out(
    turned: Sequence[Pass],
    measured: Sequence[MeasuredPass],
    kept: Sequence[bool],
    lines: np.ndarray,
    after: float,
) -> Iterator[str]:
    """Which rows of a file, by their numbers of lines (n,), are in none of its measured passes, and why."""
    unmoved = np.setdiff1d(lines, np.concatenate([each.signals["line"] for each in turned]))
    if unmoved.size:
        yield f"{_rows(unmoved)}, where the angle stands still or jumps back"
    for each, found, is_kept in zip(turned, measured, kept, strict=True):
        inside, numbers = _sliding(found.test, each, after), each.signals["line"]
        if not is_kept:
            yield f"{_rows(numbers)}, a pass shorter than {100 * WHOLE:.0f} % of the longest its way"
            continue
        if not inside.all():
            degrees = np.degrees(max(abs(after), TURNING if found.test.of_kind.turns_about else 0.0))
            yield f"{_rows(numbers[~inside])}, within {degrees:.2g} deg of a reversal of the motion"
        if inside.sum() > MOST_POINTS:
            yield f"{inside.sum()} rows of a pass are reduced to {MOST_POINTS} medians"


def _rows(lines: np.ndarray) -> str:
    numbers = np.sort(lines).astype(int).tolist()
    return f"{are(len(numbers), 'row')} left out, {lines_in_words(numbers)}"


def _with_signs(found: list[MeasuredPass], name: str) -> tuple[list[MeasuredPass], list[str]]:
    """Give the values the signs of the result files, where a bench records them otherwise.

    Raises:
        InputError: they have signs that friction cannot have.
    """
    test = found[0].test
    if test.of_kind.weighted:
        if max(_means(found).values()) < 0:
            turned = BenchTest(test.kind, -test.load)
            return [replace(each, test=turned) for each in found], ["the weight pulls the rack towards +X"]
        return found, []
    factors, said = _factors(found, name)
    signed = []
    for each in found:
        sign, rows = factors[each.direction], each.rows
        rows = rows and (rows[0], sign * rows[1])
        signed.append(replace(each, value=sign * each.value, rows=rows))
    return signed, said


def _means(found: Sequence[MeasuredPass]) -> dict[int, float]:
    """Direction -> mean over its passes."""
    ways = {sense: [each.value.mean() for each in found if each.direction == sense] for sense in (1, -1)}
    return {sense: float(np.mean(way)) for sense, way in ways.items() if way}


def _factors(found: Sequence[MeasuredPass], name: str) -> tuple[dict[int, int], list[str]]:
    """Factors that give torques of both directions the signs of result files, and what is said of it.

    Raises:
        InputError: the means are no friction about zero: they have both signs in one direction, or one sign
            and different sizes in both.
    """
    for sense in (1, -1):
        of_direction = [float(each.value.mean()) for each in found if each.direction == sense]
        low, high = min(of_direction, default=0.0), max(of_direction, default=0.0)
        if -low > UNSIGNED * high > 0:
            raise InputError(
                f"{name} has passes in one direction of the angle whose torques have opposite signs, "
                f"{high:.3g} and {low:.3g} in SI; the angle must decrease where the motion goes back."
            )
    means = _means(found)
    if len(means) == 2 and means[1] * means[-1] > 0:
        sizes = sorted(abs(mean) for mean in means.values())
        if sizes[0] < UNSIGNED * sizes[1]:
            raise InputError(
                f"{name} has means of {means[1]:.3g} and {means[-1]:.3g} in both directions, in SI: they are "
                f"neither absolute values nor centred on zero; subtract the sensor's zero."
            )
        sign = 1 if means[1] > 0 else -1
        said = "torques with one sign in both directions are read as against the motion"
        return {1: sign, -1: -sign}, [said]
    if any(sense * mean < 0 for sense, mean in means.items()):
        return {1: -1, -1: -1}, ["torques are negative along the motion; their signs are reversed"]
    return {1: 1, -1: 1}, []


def with_signs(curve: MeasuredTorque) -> MeasuredTorque:
    """Return a free torque with the signs of result files, where a bench records them otherwise.

    A curve whose means are no friction about zero is returned as it is.
    """
    signals = {**curve.signals, "row": np.arange(curve.signals["pinion_angle"].size)}
    turned = passes(signals)
    shortest = SHORTEST * max((float(np.ptp(each.angle)) for each in turned), default=0.0)
    turned = [each for each in turned if np.ptp(each.angle) > shortest]
    test = BenchTest("free")
    measured = [MeasuredPass(test, 0, p.direction, p.angle, p.signals["pinion_torque"]) for p in turned]
    try:
        factors, said = _factors(measured, curve.name)
    except InputError:
        return curve
    if not said:
        return curve
    begins = np.array([int(each.signals["row"].min()) for each in turned])
    directions = np.array([each.direction for each in turned])[np.argsort(begins)]
    place = np.searchsorted(np.sort(begins), signals["row"], side="right") - 1
    signs = np.array([factors[int(each)] for each in directions])[np.maximum(place, 0)]
    torque = signs * curve.signals["pinion_torque"]
    return replace(curve, signals={**curve.signals, "pinion_torque": torque}, assumed=(*curve.assumed, *said))


def mixed_speeds(measurement: Measurement, gain: float) -> list[str]:
    """Return what is to be said if curves were turned at different speeds, as far as they are recorded.

    `gain` is the rack's travel per turning angle [m/rad], which compares a rack push with the others.
    """
    turned = [
        (speed / (gain if each.test.pushed else 1.0), f"{measurement.names[each.run]} ({each.test.title})")
        for each in measurement.passes
        for speed in each.speeds.tolist()
    ]
    if not turned:
        return []
    slowest, fastest = (find(turned, key=itemgetter(0)) for find in (min, max))
    if fastest[0] < MIXED * slowest[0]:
        return []
    low, high = (f"{np.degrees(speed):.3g} deg/s" for speed, _ in (slowest, fastest))
    places = " and ".join(dict.fromkeys((slowest[1], fastest[1])))
    return [
        f"speeds are mixed, {low} to {high} in {places}: one friction coefficient is fitted to all of "
        f"them; run every test at one speed"
    ]
