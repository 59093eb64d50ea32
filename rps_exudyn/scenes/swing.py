"""A swing to and fro, recorded over cycles that are all alike.

The equilibria that lead to its start are far apart and few, so that the rack may still roll into its cycle
during the record. It shows: the first cycle does not end where it began. Such a swing is made again from more
and more cycles before the record; one that never settles is no swing that repeats, and says so.
"""

import numpy as np

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code
from rps_exudyn.scenes.maneuver import Maneuver
from rps_exudyn.scenes.refine import refine
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.scene import RunOptions
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS
from rps_exudyn.solvers.drive import Swing
from rps_exudyn.solvers.record import COORDINATES

CYCLES_BEFORE = {"equilibrium": (1, 4, 16, 48), "generalized-alpha": (1, 4)}
"""Solver -> cycles before the record from which a swing is begun, one after the other."""
CLOSED = 0.01  # of the largest torque, by which a cycle may end elsewhere than it began ...
IN_PLACE = 0.002  # ... and of the rack's travel: a drift this slow goes on for ten cycles and more


def run_swing(gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver, options: RunOptions) -> SceneRun:
    """Make a swing, from earlier where its first cycle does not close; invalid if it never does."""
    before = CYCLES_BEFORE.get(fidelity.solver, ())
    refined = refine(
        run_maneuver(gear, fidelity, maneuver, options),
        lambda _, times: run_maneuver(gear, fidelity, maneuver.begun_earlier(before[times - 1]), options),
        len(before),
        asks=lambda run: run.ok and unclosed(run.signals, maneuver) > 1,
    )
    run = refined.finest
    if before and run.ok and (beyond := unclosed(run.signals, maneuver)) > 1:
        return run.invalid(
            Code.SWING_NOT_SETTLED,
            f"the swing does not settle: after {before[-1]} cycles the next one still ends {beyond:.2g} "
            f"times as far from where it began as is allowed, {CLOSED:.0%} of the torque and "
            f"{IN_PLACE:.1%} of the rack's travel",
        )
    return run


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
