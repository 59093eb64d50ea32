"""A swing to and fro, by the rig's motion or by a torque, recorded over cycles that are all alike.

The equilibria that lead to a swing's start are far apart and few, so that the rack may still roll into its
cycle during the record. It shows: the first cycle does not end where it began. Such a swing is made again from
more and more cycles before the record. One that a torque drives swings freely on its tyres at first; it is
made from more cycles before until its metrics do not change. A swing that never settles is invalid.
"""

import numpy as np

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code
from rps_exudyn.scenes.confirmation import AGREED, Metrics, changed, confirmed, most_finer
from rps_exudyn.scenes.maneuver import Maneuver
from rps_exudyn.scenes.refine import refine
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.scene import RunOptions
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS
from rps_exudyn.solvers.drive import Swing
from rps_exudyn.solvers.record import COORDINATES
from rps_exudyn.solvers.steering_column import WheelTorque

CYCLES_BEFORE = {"equilibrium": (1, 4, 16, 48), "generalized-alpha": (1, 4)}
"""Solver -> cycles before the record from which a swing is begun, one after the other ..."""
CYCLES_UNDER_TORQUE = (2, 6, 14, 30, 62)  # ... and one that a torque drives
CLOSED = 0.01  # of the largest torque, by which a cycle may end elsewhere than it began ...
IN_PLACE = 0.002  # ... and of the rack's travel: a drift this slow goes on for ten cycles and more


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
    run, settled = _settled(gear, fidelity, maneuver, options, metrics)

    def made(halvings: int) -> SceneRun:
        earlier = settled.begun_earlier(1) if halvings else settled
        return run_maneuver(gear, fidelity, earlier.halved(halvings), options)

    return confirmed(run, metrics, made, figure, most=most_finer(fidelity, options), always=True)


def _settled(
    gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver, options: RunOptions, metrics: Metrics
) -> tuple[SceneRun, Maneuver]:
    """Return a swing whose cycles are alike, and its maneuver; invalid if they never become so."""
    torque = isinstance(maneuver.drive, WheelTorque)
    before = CYCLES_UNDER_TORQUE if torque else CYCLES_BEFORE.get(fidelity.solver, ())
    maneuvers = [maneuver, *(maneuver.begun_earlier(cycles) for cycles in before)]
    refined = refine(
        run_maneuver(gear, fidelity, maneuver, options),
        lambda _, times: run_maneuver(gear, fidelity, maneuvers[times], options),
        len(before),
        asks=lambda run: run.ok and (torque or unclosed(run.signals, maneuver) > 1),
        change=(lambda a, b: changed(metrics, a, b)) if torque else None,
        allowed=AGREED,
    )
    run, settled = refined.finest, maneuvers[refined.times]
    if not (before and run.ok):
        return run, settled
    if torque and not refined.confirmed:
        return run.invalid(Code.SWING_NOT_SETTLED, _changing(refined.change, before[-1])), settled
    if not torque and (beyond := unclosed(run.signals, maneuver)) > 1:
        return run.invalid(Code.SWING_NOT_SETTLED, _open(beyond, before[-1])), settled
    return run, settled


def _changing(change: float, cycles: int) -> str:
    return (
        f"the swing does not settle: from {cycles} cycles before the record a metric still changes by "
        f"{change:.2g} times its tolerance, allowed are {AGREED:g}; the hand's torque may be near resonance of "
        "the wheel on the tyres"
    )


def _open(beyond: float, cycles: int) -> str:
    return (
        f"the swing does not settle: after {cycles} cycles the next one still ends {beyond:.2g} "
        f"times as far from where it began as is allowed, {CLOSED:.0%} of the torque and "
        f"{IN_PLACE:.1%} of the rack's travel"
    )


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
