"""Whether the metrics of a run stand: each is confirmed as `quantities` declares, or left out.

Every second instant of a record shows what its steps miss of means, a curve through the instants, with its
kinks, what its extremes miss between them, at the cost of reading the record again; a steady motion is made
again only where these doubt a metric, or where equilibria take the rack's rolling late. A motion to and fro,
or with impacts, is made again in half the steps with twice the stations of a line and half the zone of
friction, of one that is not wide, a swing from another cycle before. Inertia is added to the record of steady
equilibria, which leave it out. What still changes, or is not resolved by the finest steps, is left out, and a
run whose own figure changes, or whose finer run fails, is invalid.
"""

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np

from rps_exudyn.analysis.curve import midpoints_added, pieces_of
from rps_exudyn.analysis.passes import at_instants
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Interrupted, Remark, Status
from rps_exudyn.results.quantities import (
    ANOTHER_CYCLE,
    EXTREMES,
    LEAST_SHARE,
    LOSS_SHARES,
    LOST_MOTIONS,
    NEEDS_STATIONS,
    OF_ONE_WHOLE,
    OTHER,
    RACK_RANGES,
    SCATTERED,
    SCATTERS,
    SIGNALS,
    SPREADS,
    SUMMARY,
    WANDERING,
    WITHOUT_FINER_STEPS,
    Quantity,
)
from rps_exudyn.scenes.checks.needs_finer import coarse_strips, doubled_stations
from rps_exudyn.scenes.checks.neglected_inertia import (
    FREE_OF_RANGES,
    FREE_OF_SHARES,
    MovedMasses,
    beside_travel,
    ringing,
    with_inertia,
)
from rps_exudyn.scenes.ladder import cycles_before
from rps_exudyn.scenes.maneuver import Maneuver
from rps_exudyn.scenes.refine import refine
from rps_exudyn.scenes.remarks import few_stations, part_of_pitch, unresolved_peaks
from rps_exudyn.scenes.run_maneuver import left_open, run_ever_longer, run_maneuver
from rps_exudyn.scenes.scene import RunOptions
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.scenes.sizes import sizes
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS
from rps_exudyn.solvers.prescribed_motion import Swing
from rps_exudyn.solvers.record import COORDINATES
from rps_exudyn.solvers.steering_column import WheelTorque

Metrics = Callable[[Signals], dict[str, Any]]
DRIVES = {
    "pinion_torque": {name for name in SPREADS | EXTREMES if name.startswith("torque_")}
    - {"torque_tooth_order"},
    "rack_force": {"push_force_peak_to_peak"},
}
"""Signal of a drive -> metrics of how it varies."""
ERROR = "transmission_error_peak_to_peak"
RINGS = 2  # times what one change of a rate excites, by which the transmission error changes: 0.2 to 2 ...
PRESSED = 5  # ... and times the share of inertia, by which the teeth's depth does: 2 to 13 are found
MOST_FINER = {"equilibrium": 3, "generalized-alpha": 1}
"""Solver -> times that the steps of a motion are halved for its metrics; formulas have none."""
MOST_OF_UNEVEN = 2  # the same of equilibria to and fro, once more for their figure
LEAST_ROLL = 1e-6  # range of a rack that does not roll [rad]
LATE = 0.15  # half a step of the rack's rolling, over its range: of its rate 3 % are missed
FIRST_ORDER = 2  # times what all instants miss of a curve with kinks, half of them miss ...
SHOWN = {"equilibrium": 0.6, "generalized-alpha": 0.8}
"""Solver -> ... and the least part of it that a curve through them shows: 0.7 of spikes of equilibria."""
NARROW_ZONE = 0.002  # of friction, over the smallest sliding speed: it moves no metric of a swing by 3 %
WIDEST_FINER = 0.05  # the same, half of which confirms a run whose own zone is wider
WIDE_ZONE = 0.2  # the same, above which it may change what a steady motion gives, as teeth near a pitch line
FIRST_ORDER_SHRUNK, LEAST_SHRUNK = 0.5, 0.75  # a change over that before, by which what comes is guessed
AGREED = 0.4  # of a metric's tolerance: where curves have kinks, as much again or more is left ...
KINKED = 0.5  # ... and of one of a motion to and fro, or with impacts, whose steps are not halved once more
SMALL_SCATTER = 0.1  # of a metric, beside which its scatter changes
COMPARED = {Code.TURN_TOO_FAST}  # limits that a finer run may exceed and still confirm
FEW_INSTANTS = 20  # of a record, half of which are too few to show what all of them miss
SLOW = 2 * np.pi * 20 / 60  # speed of the pinion up to which teeth that enter hardly shake the gear [rad/s]


def run_and_confirm(
    gear: SteeringGear,
    fidelity: Fidelity,
    maneuvers: Sequence[Maneuver],
    options: RunOptions,
    metrics: Metrics,
    figure: str,
    first: SceneRun | None = None,
    always: bool = False,
) -> SceneRun:
    """Make maneuvers, and again in half the steps where their record doubts a metric, where teeth that enter
    may shake the gear, or always; arguments as of `confirmed`. `first` is their run if it is made already.

    Raises:
        InputError: the fidelity's solver cannot make them.
    """

    if options.level is not None:
        return (first or run_maneuver(gear, fidelity, maneuvers, options)).described(metrics)
    steady = maneuvers[0].is_steady
    unshown = (
        SPREADS if steady and fidelity.mesh == "general-contact" else frozenset()
    )  # no run confirms them

    def asked(signals: Signals) -> dict[str, Any]:
        found = {name: each for name, each in metrics(signals).items() if name not in unshown}
        return {name: each for name, each in found.items() if name == figure or options.wants([name])}

    def made(halvings: int) -> SceneRun:
        model = fidelity
        if not steady or wide:
            model = with_finer_friction(fidelity, halvings - run.halvings)
        elif coarse:
            model = doubled_stations(fidelity, halvings)
        return run_maneuver(gear, model, maneuvers, options.halved(halvings))

    run = first or run_maneuver(gear, fidelity, maneuvers, options)
    by_equilibria = fidelity.solver == "equilibrium"  # which confirm their strips themselves
    coarse = steady and not by_equilibria and coarse_strips(run.signals, fidelity, gear)
    wide = steady and fidelity.zone_ratio > WIDE_ZONE
    if by_equilibria:
        always = always or (steady and bool(run.signals) and bool(rolls_late(run.signals) > LATE))
    else:
        few = bool(run.signals) and len(run.signals["time"]) < FEW_INSTANTS
        always = always or coarse or (steady and (few or gear.test.speed > SLOW))
    always = always or wide
    most, more = most_finer(fidelity, options, smooth=steady and (by_equilibria or not (coarse or wide)))
    run = confirmed(run, asked, made, figure, most=most, for_figure=more, always=always, smooth=steady)
    run = with_stations_enough(run, gear, fidelity)
    if not steady:
        return run
    if by_equilibria and run.ok:
        run = without_neglected(run, asked, figure, MovedMasses.of(gear))
    drive = maneuvers[0].drive
    place = "pinion_angle" if drive.body == "pinion" else "rack_displacement"
    unseen = unresolved_peaks(fidelity, run, drive.signal, place)
    in_part = part_of_pitch(gear, fidelity, run.signals)
    remark, left_out = unseen or (None, frozenset())
    of_pitches = LOSS_SHARES | EXTREMES if in_part else frozenset()
    return run.noting(remark, in_part).without(left_out | of_pitches)


def with_stations_enough(run: SceneRun, gear: SteeringGear, fidelity: Fidelity) -> SceneRun:
    """Return a run without the small metrics for which its stations on a line of contact are too few."""
    remark = few_stations(gear, fidelity) if NEEDS_STATIONS & run.summary.keys() else None
    return run.noting(remark).without(NEEDS_STATIONS) if remark else run


def without_neglected(run: SceneRun, metrics: Metrics, figure: str, masses: MovedMasses) -> SceneRun:
    """Return equilibria of steady motion without the metrics that inertia would change, which they leave out;
    invalid if their figure is one of them."""
    change = _beyond(by_inertia(metrics, run.signals, run.summary, masses), KINKED)
    if not change:
        return run
    if figure in change:
        text = f"the motion is too fast for equilibria: inertia changes {_all_shown(change)}"
        return run.invalid(Code.TURN_TOO_FAST, f"{text}; choose generalized-alpha")
    return run.without(with_wholes(change)).noting(inertia_matters(change, run.summary))


def inertia_matters(change: Mapping[str, float], printed: Container[str]) -> Remark:
    """Return the remark on metrics that need inertia, metric -> what that may change over its tolerance; of
    its whole only those that would be printed are named."""
    shown = _all_shown(change, printed)
    return Remark(
        Code.METRIC_NOT_CONFIRMED,
        f"omitted metrics that inertia, which equilibria leave out, may change: {shown}; choose the solver "
        "generalized-alpha for them",
    )


def with_finer_friction(fidelity: Fidelity, halvings: int) -> Fidelity:
    """Return the model of a motion that stops in finer steps: a zone of friction in which what should rest
    creeps, of `WIDEST_FINER` at most, is halved with them, and the stations of a line, which turn about one
    after the other, are doubled."""
    zone = max(min(fidelity.zone_ratio, WIDEST_FINER) / 2**halvings, min(fidelity.zone_ratio, NARROW_ZONE))
    return doubled_stations(fidelity, halvings).replace({"zone_ratio": zone})


def most_finer(fidelity: Fidelity, options: RunOptions, smooth: bool) -> tuple[int, int]:
    """Return how often the steps of a run are halved at most for its metrics, and once more, where its curves
    are not smooth, for its figure alone, because each time costs two to four times as much."""
    finest = min(MOST_FINER.get(fidelity.solver, 0), options.least_steps.halvings)
    if smooth:
        return finest, 0
    if fidelity.solver == "equilibrium":
        return min(finest, MOST_OF_UNEVEN), max(finest - MOST_OF_UNEVEN, 0)
    return finest, int(fidelity.solver == "generalized-alpha" and options.least_steps.halvings > 1)


def changes(values: Mapping[str, Any], finer: Mapping[str, Any], signals: Signals) -> dict[str, Any]:
    """Return by how much metrics change, over their tolerances; inf of one that only a single side has.

    Values are numbers, or arrays (n,) of many gears, nan of one that lacks the metric; `signals` are the
    record of one side, for its sizes.
    """

    def change(name: str, item: Quantity) -> Any:
        one, other = values.get(name, np.nan), finer.get(name, np.nan)
        if not (np.ndim(one) or np.ndim(other)) and not (name in values and name in finer):
            return np.inf
        item = replace(item, least=max(item.least, scattered(name, finer)))
        found = item.change(one, other, size.get(item.unit, 0.0))
        if not np.ndim(found):
            return found
        lacks = np.isnan(one), np.isnan(other)
        return np.where(lacks[0] == lacks[1], np.where(lacks[0], 0.0, found), np.inf)

    declared = {name: SUMMARY[name] for name in {**values, **finer} if SUMMARY[name].confirmed}
    size = sizes(signals, finer)
    return {name: change(name, item) for name, item in declared.items()}


def scattered(name: str, values: Mapping[str, float]) -> float:
    """Return the size below which a metric changes as if it had that size, because it scatters, or says how
    another one does; 0 of any other."""
    if name in SCATTERS:
        return SCATTERED * values.get(SCATTERS[name], 0.0) / OTHER
    metric = next((each for each, scatter in SCATTERS.items() if scatter == name), "")
    return SMALL_SCATTER * abs(values.get(metric, 0.0))


def figure_changes(metrics: Metrics, figure: str, run: SceneRun, later: SceneRun) -> float:
    """Return how far a run's figure changes from one run to a later one, over its tolerance; inf where one of
    them is not ok."""
    if not (run.ok and later.ok):
        return float("inf")
    change = changes(metrics(run.signals), metrics(later.signals), later.signals)
    return float(change.get(figure, 0.0))


def every_second(signals: Signals, stride: int = 2) -> Signals:
    """Return a record of every second instant (..., n) of each of its maneuvers, their ends kept; or of one
    in `stride`."""
    parts = [
        np.append(np.arange(i.start, i.stop - 1, stride), i.stop - 1) for i in pieces_of(signals["time"])
    ]
    kept = np.concatenate(parts)
    return {name: at_instants(values, kept) for name, values in signals.items()}


def with_midpoints(signals: Signals) -> Signals:
    """Return a record (..., n) with an instant more between any two of a maneuver, on the curve through those
    around it."""
    parts = list(pieces_of(signals["time"]))
    return {
        name: np.concatenate([midpoints_added(values[..., part]) for part in parts], axis=-1)
        for name, values in signals.items()
    }


def rolls_late(signals: Signals) -> Any:
    """Return half a step of the rack's rolling at its fastest, over the range of its roll; of many gears an
    array (n,). The parabolas by which equilibria take rates miss 4/3 of its square, of a sine."""
    late: Any = 0.0
    if "rack_roll" not in signals:
        return late
    roll = signals["rack_roll"]
    for part in pieces_of(signals["time"]):
        steps = np.ptp(np.diff(roll[..., part]), axis=-1)
        late = np.maximum(late, steps / 2 / np.maximum(np.ptp(roll[..., part], axis=-1), LEAST_ROLL))
    return late


def doubted(metrics: Metrics, signals: Signals, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return by how much metrics change where every second instant is left out, over their tolerances.

    Works are integrals of all instants, so that what follows from them alone does not change; a metric that
    half of the instants are too few to show is not looked at.
    """
    fewer = metrics(every_second(signals))
    return changes({name: values[name] for name in values if name in fewer}, fewer, signals)


def unresolved(metrics: Metrics, signals: Signals, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return by how much metrics change where a curve through the instants goes on between them, over their
    tolerances: extremes may lie there, and vibration from instant to instant swings on."""
    more = metrics(with_midpoints(signals))
    return changes(values, {name: more[name] for name in values if name in more}, signals)


def by_inertia(
    metrics: Metrics, signals: Signals, values: Mapping[str, Any], masses: MovedMasses
) -> dict[str, Any]:
    """Return by how much inertia, which equilibria leave out, changes metrics of a steady motion, over their
    tolerances; {} where it is too small to change any.

    Means and orders change as the drive does that overcomes the inertia along the travel. What varies changes
    by so much at most, and by the share of the drive by which inertia beside the travel changes the yoke's
    force; the teeth's depth changes by some times that share, and where the gear rings on it.
    """
    drive = next((name for name in DRIVES if name in signals), "")
    if not drive or "mesh_normal_force" not in signals:
        return {}
    beside, _ = beside_travel(signals, masses)
    added = with_inertia(signals, masses)
    most = np.ptp(added[drive] - signals[drive], axis=-1) + beside * np.abs(signals[drive]).mean(axis=-1)
    unnoticed = KINKED * OTHER * LEAST_SHARE * sizes(signals, {})[SIGNALS[drive].unit]
    if not np.any((most > unnoticed) | (beside > KINKED * FREE_OF_RANGES)):
        return {}
    varying = {name: values[name] + most for name in values if name in DRIVES[drive]}
    depth = PRESSED * beside * np.mean(signals["mesh_penetration"], axis=-1)
    depth = np.maximum(depth, RINGS * ringing(signals, masses))
    varying |= {name: values[name] + depth for name in values if name == ERROR}
    at_most = changes(values, varying, signals)
    found = changes(values, metrics(added), signals)
    found |= {name: KINKED * at_most[name] for name in varying}
    found |= dict.fromkeys(LOSS_SHARES & values.keys(), beside / FREE_OF_SHARES)
    return found | {name: beside / FREE_OF_RANGES for name in RACK_RANGES if name in values}


def doubts(
    halves: Mapping[str, Any], between: Mapping[str, Any], solver: str = "equilibrium"
) -> dict[str, Any]:
    """Return by how much a record's instants may miss metrics of a steady motion, over their tolerances: by
    what half of them change and what lies between them."""
    missed = {name: each / FIRST_ORDER for name, each in halves.items()}
    return larger(missed, {name: each / SHOWN[solver] for name, each in between.items()})


def confirmed(
    run: SceneRun,
    metrics: Metrics,
    finer: Callable[[int], SceneRun] | None,
    figure: str,
    *,
    most: int,
    for_figure: int = 0,
    always: bool = False,
    smooth: bool = False,
) -> SceneRun:
    """Return a run with the metrics that stand, in finer steps where its own do not show them.

    Args:
        run: that ended well, else its metrics are all that there is.
        metrics: signals -> metrics.
        finer: how often the steps are to be halved -> that run; None of a run whose steps show nothing.
        figure: name of the metric without which the run is invalid.
        most: how often they are halved at most; 0 leaves the metrics unconfirmed.
        for_figure: how often more where the figure still changes then.
        always: whether a finer run is made even where the record raises no doubt.
        smooth: whether its signals go on smoothly between the instants, so that they show what they miss;
            then a finer run that was made is taken, else only where it changes a metric.

    Raises:
        Interrupted: Ctrl-C; it carries the last whole run.
    """
    described = run.described(metrics)
    if not (run.ok and run.signals and most):
        return described
    begun, figure_moved, finer_runs = run.halvings, 0.0, 0

    @cache
    def between(each: SceneRun) -> dict[str, float]:
        return unresolved(metrics, each.signals, each.summary) if smooth else {}

    @cache
    def missed(each: SceneRun) -> dict[str, float]:
        halves = doubted(metrics, each.signals, each.summary)
        if not smooth:
            return halves
        return doubts(halves, between(each), each.outcome.settings.get("name", "equilibrium"))

    def changed(coarse: SceneRun, fine: SceneRun) -> dict[str, float]:
        return changes(coarse.summary, fine.summary, fine.signals)

    def confirms(fine: SceneRun) -> bool:
        exceeds = fine.outcome.status is Status.INVALID and COMPARED.issuperset(fine.outcome.codes)
        return fine.ok or exceeds

    def made(coarse: SceneRun, times: int) -> SceneRun:
        nonlocal finer_runs
        assert finer is not None
        finer_runs = times
        try:
            run = finer(begun + times)
        except Interrupted:
            raise Interrupted(coarse) from None
        return run.described(metrics) if confirms(run) else run  # one that failed lacks motions

    def not_standing(change: Mapping[str, float]) -> dict[str, float]:
        return _beyond(change, 1.0 if smooth else KINKED)

    def unsure(coarse: SceneRun, fine: SceneRun) -> float:
        nonlocal figure_moved
        change, between_fine = changed(coarse, fine), between(fine)
        figure_moved = change.get(figure, 0.0)
        if smooth and not always and not _beyond(larger(change, missed(fine)), 1.0):
            return 0.0
        asking = (each for name, each in change.items() if name not in WITHOUT_FINER_STEPS)
        return max([0.0, *asking, *(AGREED * each for each in between_fine.values())])

    first = missed(described)

    def asks(each: SceneRun) -> bool:
        if each is described:
            return always or bool(_beyond(first, 1.0))
        return each.ok and (finer_runs < most or figure_moved > AGREED)

    refined = refine(
        described,
        made,
        most + for_figure if finer is not None else 0,
        usable=confirms,
        asks=asks,
        change=unsure,
        allowed=AGREED,
    )
    finest = refined.finest
    if refined.confirmed and refined.times == 1 and not smooth:
        left = not_standing(changed(described, finest))
        return _left_out(_counted(described, refined.runs, 0), left, figure)
    if refined.failed is not None:
        return _counted(finest, refined.runs, begun + refined.times).unconfirmed(refined.failed)
    if refined.times:
        still = [changed(*pair) for pair in pairwise(refined.runs)]
        left = not_standing(larger(to_come(still), between(finest)))
    else:
        left = _beyond(first, 1.0)
    taken = refined.times if finest.ok else refined.times - 1
    return _left_out(_counted(refined.runs[taken], refined.runs, begun + taken), left, figure)


def to_come(found: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return by how much metrics may change in ever finer steps, from what one halving after the other
    changed: as much as the last one again, more where those before changed hardly more."""

    def ahead(name: str, change: float) -> float:
        before = [each.get(name, 0.0) / 2**n for n, each in enumerate(found[-2:-4:-1])]
        ratio = change / largest if 0 < (largest := max(before, default=0.0)) < np.inf else 0.0
        ratio = min(max(ratio, FIRST_ORDER_SHRUNK), LEAST_SHRUNK)
        return change * ratio / (1 - ratio)

    return {name: ahead(name, change) for name, change in found[-1].items()}


def larger(some: Mapping[str, Any], others: Mapping[str, Any]) -> dict[str, Any]:
    """Return the larger of two changes of each metric."""
    return {name: np.maximum(some.get(name, 0.0), others.get(name, 0.0)) for name in {**some, **others}}


def with_wholes(change: Mapping[str, Any]) -> dict[str, Any]:
    """Return changes in which each metric of one whole changes as the one of it that changes most, and a
    scatter as the metric that scatters."""
    found = dict(change) | {SCATTERS[name]: each for name, each in change.items() if name in SCATTERS}
    for whole in OF_ONE_WHOLE:
        if known := [change[name] for name in whole & change.keys()]:
            found |= dict.fromkeys(whole, np.fmax.reduce(known))
    return found


def _beyond(change: Mapping[str, float], allowed: float) -> dict[str, float]:
    """Return the metrics that change by more than is allowed."""
    return {name: value for name, value in change.items() if not value <= allowed}


def _counted(run: SceneRun, runs: Iterable[SceneRun], halvings: int) -> SceneRun:
    """Return a run with the time that all took, and how often its steps were halved."""
    cpu = sum(each.outcome.cpu_s for each in runs)
    found = {**run.outcome.findings, **({"halvings": halvings} if halvings else {})}
    return replace(run, outcome=replace(run.outcome, cpu_s=cpu, findings=found))


def _left_out(run: SceneRun, change: Mapping[str, float], figure: str) -> SceneRun:
    """Return a run without the metrics that change, with the reason; invalid without its figure."""
    if not change:
        return run
    if figure in change:
        shown = f"{figure} is not confirmed: {_by(change)} change {_all_shown(change)}"
        return run.invalid(Code.STEPS_TOO_COARSE, shown)
    return run.without(with_wholes(change)).noting(not_confirmed(change, run.summary))


def not_confirmed(change: Mapping[str, float], printed: Container[str]) -> Remark:
    """Return the remark on metrics that are left out, metric -> its change over its tolerance; of its whole
    only those that would be printed are named."""
    shown = _all_shown(change, printed, " ({})", "")
    return Remark(Code.METRIC_NOT_CONFIRMED, f"{shown} not shown: not converged")


def _by(change: Mapping[str, float]) -> str:
    return ANOTHER_CYCLE if any(_how(name) == ANOTHER_CYCLE for name in change) else _how(next(iter(change)))


def _all_shown(
    change: Mapping[str, float],
    printed: Container[str] = (),
    share: str = " by {}",
    altogether: str = " altogether",
) -> str:
    """The metrics, each with its change as a `share`, or `altogether` where that is no number."""
    shown = ", ".join(name + _shown(name, value, share, altogether) for name, value in change.items())
    with_them = sorted(name for name in with_wholes(change).keys() - change.keys() if name in printed)
    return f"{shown}, and with them {', '.join(with_them)}" if with_them else shown


def _how(name: str) -> str:
    how = SUMMARY[name].confirmed
    return how.by if how else ""


def _shown(name: str, change: float, share: str, altogether: str) -> str:
    how = SUMMARY[name].confirmed
    return (
        share.format(f"{100 * change * how.tolerance:.2g} %") if how and np.isfinite(change) else altogether
    )


# --- swings to and fro, recorded over cycles that are all alike ------------------------------------
# The equilibria that lead to the start of a swing are far apart and few, so that the rack may still roll into
# its cycle during the record: then the first cycle does not end where it began. Such a swing is made again
# from more and more cycles before the record. One that a torque drives swings freely on its tyres at first:
# it is made from more cycles before until its metrics do not change. One that never settles is invalid.

CYCLES_BEFORE = {"equilibrium": (1, 4, 16, 48), "generalized-alpha": (1, 4)}
"""Solver -> cycles before the record from which a swing is begun, one after the other ..."""
CYCLES_UNDER_TORQUE = (2, 6, 14, 30, 62)  # ... and one that a torque drives ...
TRIES_OF_INVALID = 1  # ... of which so many more are tried where a check fails
SEEN_TO_DRIFT = 4  # tries that show how fast a swing settles
OPEN = 0.05  # of its range, by which a motion beside the travel may end a cycle elsewhere than it began ...
OPEN_OF_LOST_MOTION = 0.006  # ... and where the lost motion is to be right to 5 %
CLOSED = 0.01  # of the largest torque, by which a cycle may end elsewhere than it began ...
IN_PLACE = 0.002  # ... and of the rack's travel: a drift this slow goes on for ten cycles and more
VIBRATES = 50  # times its range that a torque goes up and down in a record: smoothly it goes 2 to 6 times


def run_swing(
    gear: SteeringGear,
    fidelity: Fidelity,
    maneuver: Maneuver,
    options: RunOptions,
    metrics: Metrics,
    figure: str,
) -> SceneRun:
    """Make a swing from as many cycles before as it needs, with the metrics that half the steps and another
    cycle confirm; arguments as of `confirmed`. It is invalid if its cycles never become alike."""
    if options.level is not None:
        earlier = maneuver.begun_earlier(cycles_before(options.level))
        return run_maneuver(gear, fidelity, earlier, options).described(metrics)
    if isinstance(maneuver.drive, WheelTorque):
        run, settled = _settled_under_torque(gear, fidelity, maneuver, options, metrics, figure)
    else:
        run, settled = _settled(gear, fidelity, maneuver, options)

    def made(halvings: int) -> SceneRun:
        earlier = settled.begun_earlier(1) if halvings else settled
        stations = run.outcome.findings.get("strip_stations", fidelity.strip_stations)
        taken = fidelity.replace({"strip_stations": int(stations)})
        model = with_finer_friction(taken, halvings - run.halvings)
        return run_maneuver(gear, model, earlier, options.halved(halvings))

    most, more = most_finer(fidelity, options, smooth=False)
    run = confirmed(run, metrics, made, figure, most=most, for_figure=more, always=True)
    run = with_cycle_closed(with_stations_enough(run, gear, fidelity), gear, maneuver)
    return _with_cause(run, fidelity, maneuver.drive.signal)


def with_cycle_closed(run: SceneRun, gear: SteeringGear, maneuver: Maneuver) -> SceneRun:
    """Return a swing of the rig without the metrics of motions that wander on from cycle to cycle."""
    if not (run.ok and isinstance(maneuver.drive, Swing)):
        return run
    share, wander, limit = left_open(run.signals, float(GearPair.of(gear).gain)), WANDERING, OPEN
    omitted = "the rack's motions beside its travel, the transmission error and the lost motion are"
    if share <= OPEN:
        wander, limit, omitted = LOST_MOTIONS & run.summary.keys(), OPEN_OF_LOST_MOTION, "the lost motion is"
    if not wander or share <= limit:
        return run
    text = (
        f"{omitted} omitted: a motion beside the travel ends the cycle {share:.1%} of its range from where "
        f"it began (limit {limit:.1%})"
    )
    return run.noting(Remark(Code.METRIC_NOT_CONFIRMED, text)).without(wander)


def _with_cause(run: SceneRun, fidelity: Fidelity, signal: str) -> SceneRun:
    """Return a swing that a check fails with the cause in its message, where it vibrates: bristles of the
    teeth turn about too slowly across the sliding to damp vibration, which friction then excites."""
    dynamic = fidelity.solver == "generalized-alpha"
    if not (dynamic and run.outcome.status is Status.INVALID and signal in run.signals):
        return run
    times = float(np.abs(np.diff(run.signals[signal])).sum() / (np.ptp(run.signals[signal]) or np.inf))
    if not times > VIBRATES:
        return run
    cause = (
        f"{run.outcome.message}; the gear vibrates, its {signal} goes up and down by {times:.0f} times its "
        "range: longer steps damp that, and the fidelity quasi-static has no vibration"
    )
    return replace(run, outcome=replace(run.outcome, message=cause))


def _earlier(maneuver: Maneuver, before: Sequence[int]) -> list[Maneuver]:
    """Return a swing from 0 and more cycles before."""
    return [maneuver, *(maneuver.begun_earlier(cycles) for cycles in before)]


def _settled(
    gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver, options: RunOptions
) -> tuple[SceneRun, Maneuver]:
    """Return a swing of the rig whose first cycle closes, and its maneuver; invalid if it never does."""
    before = CYCLES_BEFORE.get(fidelity.solver, ())
    maneuvers = _earlier(maneuver, before)
    drifts: list[float] = []

    def asks(run: SceneRun) -> bool:
        if not run.ok:
            return False
        drifts.append(unclosed(run.signals, maneuver))
        return drifts[-1] > 1 and may_close(drifts, (0, *before))

    with run_ever_longer(gear, fidelity, options) as made:
        refined = refine(
            made(maneuver),
            lambda _, times: made(maneuvers[times]),
            len(before),
            asks=asks,
        )
    run, settled = refined.finest, maneuvers[refined.times]
    if before and run.ok and (beyond := unclosed(run.signals, maneuver)) > 1:
        return run.invalid(
            Code.SWING_NOT_SETTLED,
            f"the swing does not settle: after {(0, *before)[refined.times]} cycles the next one still "
            f"changes by {beyond:.2g} times the limits of {CLOSED:.0%} of the torque and {IN_PLACE:.1%} of "
            f"the rack's travel",
        ), settled
    return run, settled


def _settled_under_torque(
    gear: SteeringGear,
    fidelity: Fidelity,
    maneuver: Maneuver,
    options: RunOptions,
    metrics: Metrics,
    figure: str,
) -> tuple[SceneRun, Maneuver]:
    """Return a swing by a torque whose figure more cycles before do not change, and its maneuver.

    A check that an early cycle fails, a later one may pass; a swing that goes on failing ends so.
    """
    maneuvers = _earlier(maneuver, CYCLES_UNDER_TORQUE)
    tried: list[SceneRun] = []

    def asks(run: SceneRun) -> bool:
        tried.append(run)
        finished = run.outcome.status in (Status.OK, Status.INVALID) and bool(run.signals)
        return finished and (run.ok or len(tried) <= TRIES_OF_INVALID)

    with run_ever_longer(gear, fidelity, options) as made:
        refined = refine(
            made(maneuver),
            lambda _, times: made(maneuvers[times]),
            len(CYCLES_UNDER_TORQUE),
            asks=asks,
            change=lambda run, later: figure_changes(metrics, figure, run, later),
            allowed=AGREED,
        )
    run, settled = refined.finest, maneuvers[refined.times]
    if run.ok and not refined.confirmed:
        return run.invalid(
            Code.SWING_NOT_SETTLED,
            f"the swing does not settle: from {CYCLES_UNDER_TORQUE[-1]} cycles before the record {figure} "
            f"still changes by {refined.change * OTHER:.1%} (limit {AGREED * OTHER:.1%}); the hand's "
            "torque may be near resonance of the wheel on the tyres",
        ), settled
    return run, settled


def may_close(drifts: Sequence[float], cycles: Sequence[int]) -> bool:
    """Return whether the last and longest try, of so many cycles before each, may close a swing that drifts
    by so much more than is allowed: its drift shrinks on as it did from the try before."""
    tried = len(drifts)
    if tried < SEEN_TO_DRIFT or tried != len(cycles) - 1:
        return True
    times = (cycles[tried] - cycles[tried - 1]) / (cycles[tried - 1] - cycles[tried - 2])
    return drifts[-1] * (drifts[-1] / max(drifts[-2], 1e-9)) ** times <= 1


def unclosed(signals: Signals, maneuver: Maneuver) -> float:
    """Return how far the first recorded cycle of a swing ends from where it began, over what is allowed."""
    assert isinstance(maneuver.drive, Swing)
    time, lengths = signals["time"], CHARACTERISTIC_LENGTHS[2:]
    end = time[0] + maneuver.drive.period

    def moved(name: str) -> float:
        after = np.interp(end, time, signals[name])
        return abs(float(after - signals[name][0]))

    travel, torque = float(np.ptp(signals["rack_displacement"])), signals[maneuver.drive.signal]
    moves = [(name, length) for name, length in zip(COORDINATES, lengths, strict=True) if name in signals]
    shifted = max((moved(name) * length for name, length in moves), default=0.0)
    turned = moved(maneuver.drive.signal) / (CLOSED * float(np.abs(torque).max()) or np.inf)
    return max(turned, shifted / (IN_PLACE * travel or np.inf))
