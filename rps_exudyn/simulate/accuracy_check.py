"""Check of a run's accuracy on the gear at hand: the same in half the steps and finer strips.

The table of `by_accuracy` holds the error of a setting on many gears. A gear unlike them, or a test that
stops the yoke at its nut, may need more; so each run is compared with one in half the steps, and gives way to
it until the two agree. Steps of impacts are parts of the plunger's swing. Equilibria of a fast test are
compared with dynamics as well, in which each tooth that enters sets the rack vibrating.

A signal's error is the RMS over the motion in % of its mean, the larger of joining its instants by straight
lines and smoothly; that of a number of the summary is in % of the number.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from rps_exudyn.analysis.curve import difference
from rps_exudyn.analysis.passes import passes
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Interrupted, Status, each_once
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.refine import refine
from rps_exudyn.scenes.scene_run import SceneRun

Recorded = SceneRun | Result
"""A run of a scene, with its signals and summary."""


def is_signal(scene: str, quantity: str) -> bool:
    """Return whether a quantity is the scene's signal; the others are numbers of its summary."""
    return quantity == scene_named(scene).signal


def error_between(
    quantity: str,
    scene: str,
    gear: SteeringGear,
    run: tuple[Recorded, Fidelity],
    truer: tuple[Recorded, Fidelity],
) -> float:
    """Return how far a quantity of a run lies from that of a truer one [%]; nan where only one has it."""
    if is_signal(scene, quantity):
        own, true = (
            scene_named(scene).curve(each.signals, gear, fidelity) for each, fidelity in (run, truer)
        )
        return difference(own, true)
    own_value, value = (each.summary.get(quantity) for each, _ in (run, truer))
    if own_value == value:  # or neither has one: where nothing is hit, there is no peak
        return 0.0
    if own_value is None or value is None:
        return float("nan")
    return 100 * abs(own_value - value) / abs(value) if value else float("nan")


AGREED = 0.5  # of the wanted error: what is left is at most as much again, where a curve has jumps
MOST_FINER = {"equilibrium": 5, "generalized-alpha": 4}
"""Solver -> times that steps are halved."""
STATIONS, POINTS = 12, 6  # finest strips: more show nothing
SLOW, SLOW_AT, GROWTH = 20 * np.pi / 30, 0.1, 0.4
"""Up to this speed of the pinion [rad/s] vibration of random gears stays below 0.1 %; for another accuracy
the speed is its power `GROWTH` times as large: 50 rpm for 1 %."""
VIBRATION_STEP = 5e-5  # of dynamics that show it [s]
PITCHES = 2  # over which it is looked for

Run = Callable[[SteeringGear, Fidelity], Result]
Modelled = tuple[Result, Fidelity]


@dataclass(frozen=True)
class Wanted:
    """An accuracy that is asked for.

    Attributes:
        scene: name of the scene.
        quantity: its signal, or a number of its summary.
        percent: largest error [%].
    """

    scene: str
    quantity: str
    percent: float

    def error(
        self, gear: SteeringGear, run: tuple[Result, Fidelity], truer: tuple[Result, Fidelity]
    ) -> float:
        """Return how far a run lies from a truer one [%]."""
        return error_between(self.quantity, self.scene, gear, run, truer)


def kept_by(run: Run, wanted: Wanted, gear: SteeringGear, first: Fidelity) -> Result:
    """Return the first run that a finer one confirms, with the change in its findings.

    Raises:
        Interrupted: Ctrl-C; it carries the last whole run, or else what was recorded.
    """
    own_steps = scene_named(wanted.scene).needs_inertia and not first.swing_steps

    def finer(coarse: Modelled, _: int) -> Modelled:
        model = finer_than(coarse[1], taken_step(coarse[0], wanted.scene, coarse[1]))
        try:
            return run(gear, model), model
        except Interrupted:
            raise Interrupted(coarse[0]) from None

    refined = refine(
        (run(gear, first), first),
        finer,
        0 if own_steps else MOST_FINER.get(first.solver, 0),
        usable=lambda each: each[0].status is Status.OK,
        change=partial(wanted.error, gear),
        allowed=AGREED * wanted.percent,
    )
    if (failed := refined.failed) is not None:
        ends = f"not confirmed: in finer steps it ends {failed[0].status}, {failed[0].message}"
        return _finding(refined.finest[0], ends, Code.ACCURACY_NOT_CONFIRMED)
    if not refined.times:
        return refined.finest[0]
    found = (
        f"in half the steps and finer strips {_named(wanted)} differs by {refined.change:.2g} %{_rms(wanted)}"
    )
    if not refined.confirmed:
        return _finding(refined.finest[0], f"NOT reached: {found} from this run", Code.ACCURACY_NOT_REACHED)
    result, fidelity = refined.runs[-2]
    text, *codes = vibrating(run, wanted, gear, fidelity)
    return _finding(result, found + text, *codes, doubt=text.removeprefix("; "))


def vibrating(
    run: Run, wanted: Wanted, gear: SteeringGear, fidelity: Fidelity
) -> tuple[str] | tuple[str, Code]:
    """Compare equilibria of a fast steady test with dynamics over its first pitches; return what was found,
    empty for other runs, and the code of a promise that does not hold."""
    scene = scene_named(wanted.scene)
    slow = gear.test.speed <= SLOW * (wanted.percent / SLOW_AT) ** GROWTH
    if fidelity.solver != "equilibrium" or slow or not scene.steady:
        return ("",)
    turns = min(gear.test.turns, PITCHES / gear.pinion.teeth)
    part = gear.replace({"test.turns": turns, "test.path": scene.short_path})
    moving = Fidelity.preset("flank").replace({"step_angle": gear.test.speed * VIBRATION_STEP})
    try:
        still, moved = run(part, fidelity), run(part, moving)
    except InputError as beyond:  # the first pitches of a way from lock to lock may lie elsewhere
        return _not_promised(f"it is unknown whether the gear vibrates at this speed, {beyond}")
    if not (still.status is Status.OK and moved.status is Status.OK):
        return _not_promised(
            f"the dynamic run that would show vibration ends {moved.status}, {moved.message}"
        )
    error = wanted.error(part, (still, fidelity), (moved, moving))
    if error <= AGREED * wanted.percent:
        return (f", dynamics by {error:.2g} %",)
    return _not_promised(
        f"the gear vibrates at this speed: dynamics differ by {error:.2g} % RMS from "
        "equilibria, and by more in shorter steps"
    )


def _not_promised(why: str) -> tuple[str, Code]:
    return f"; NOT promised: {why}", Code.ACCURACY_NOT_PROMISED


def taken_step(result: Result, scene: str, fidelity: Fidelity) -> float:
    """Return the pinion angle of a run's steps [rad], which may be halved where its record asked for it: half
    of the step that was asked for could be the one that was taken."""
    halved = fidelity.step_angle / 2 ** int(result.findings.get("halvings", 0))
    if fidelity.solver != "equilibrium" or not scene_named(scene).steady:
        return halved
    ways = [np.abs(np.diff(way.signals["pinion_angle"])) for way in passes(result.signals)]
    return min(halved, *(float(np.median(way)) for way in ways))


def finer_than(fidelity: Fidelity, step: float) -> Fidelity:
    """Return a model in half of a step [rad], or of the plunger's swing, and with finer strips."""
    stations, points = fidelity.strip_stations, fidelity.strip_points
    steps = {"swing_steps": 2 * fidelity.swing_steps} if fidelity.swing_steps else {"step_angle": step / 2}
    return fidelity.replace(
        {
            **steps,
            "strip_stations": max(stations, min(STATIONS, round(1.5 * stations))),
            "strip_points": max(points, min(POINTS, points + 1)),
        }
    )


def _named(wanted: Wanted) -> str:
    return "the curve" if is_signal(wanted.scene, wanted.quantity) else wanted.quantity


def _rms(wanted: Wanted) -> str:
    return " RMS" if is_signal(wanted.scene, wanted.quantity) else ""


def _finding(result: Result, text: str, *codes: Code, doubt: str = "") -> Result:
    """Return a run with what was found, which is the first of its remarks where the accuracy is in doubt."""
    findings = {**result.findings, "accuracy_checked": text}
    remark = [f"the accuracy asked for is in doubt: {doubt or text}"] if codes else []
    message = "; ".join(filter(None, [*remark, result.message]))
    return replace(result, findings=findings, message=message, codes=each_once([*result.codes, *codes]))
