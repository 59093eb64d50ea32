"""Whether equilibria keep a wanted accuracy on the gear at hand: the same in half the steps and finer strips.

The table of `by_accuracy` knows what a setting is worth on many gears. A gear unlike them, or a test that
stops the yoke at its nut, may need more; equilibria cost so little that each run is compared with a finer
one, and gives way to it until the two agree.
"""

from collections.abc import Callable
from dataclasses import replace

from rps_exudyn.analysis.curve import difference
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Interrupted, Status
from rps_exudyn.results.result import Result
from rps_exudyn.scenes.headline import curve_of

AGREED = 0.5  # of the wanted error: what is left is at most as much again, where a curve has jumps
MOST_FINER = 5
STATIONS, POINTS = 12, 6  # finest strips: more show nothing


def kept_by(
    run: Callable[[Fidelity], Result], scene: str, gear: SteeringGear, first: Fidelity, wanted: float
) -> Result:
    """Return the first run that a finer one confirms within `wanted` [%]; it says so in its findings.

    Models with inertia are run once: for them the table alone stands.

    Raises:
        Interrupted: Ctrl-C; it carries the last whole run, or else what was recorded.
    """
    result, fidelity = run(first), first
    if first.solver != "equilibrium" or result.status is not Status.OK:
        return result
    for _ in range(MOST_FINER):
        finer = finer_than(fidelity)
        try:
            truer = run(finer)
        except Interrupted:
            raise Interrupted(result) from None
        if truer.status is not Status.OK:
            return _finding(result, f"not confirmed: in finer steps it ends {truer.status}, {truer.message}")
        error = difference(
            curve_of(scene, result.signals, gear, fidelity), curve_of(scene, truer.signals, gear, finer)
        )
        found = f"in half the steps and finer strips the curve differs by {error:.2g} % RMS"
        if error <= AGREED * wanted:
            return _finding(result, found)
        result, fidelity = truer, finer
    return _finding(result, f"NOT reached: {found} from this one")


def finer_than(fidelity: Fidelity) -> Fidelity:
    """Return a model in half the steps and with finer strips."""
    stations, points = fidelity.strip_stations, fidelity.strip_points
    return fidelity.replace(
        {
            "step_angle": fidelity.step_angle / 2,
            "strip_stations": max(stations, min(STATIONS, round(1.5 * stations))),
            "strip_points": max(points, min(POINTS, points + 1)),
        }
    )


def _finding(result: Result, text: str) -> Result:
    return replace(result, findings={**result.findings, "accuracy_checked": text})
