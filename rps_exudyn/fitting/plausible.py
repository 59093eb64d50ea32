"""Whether measured values can be those of a gear like the one that is expected: the wrong unit shows here."""

from collections.abc import Iterator

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.fitting.bench_tests import MeasuredPass, Measurement
from rps_exudyn.fitting.prediction import TURN, formula_means
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import largest_angle

FAR = 20.0  # times what is expected, more or less: N m for N mm, N cm or in-lb shows, another gear does not
MOST_TRAVELS = 3.0  # times the angle over which the expected rack has teeth: rad for deg shows


def check_sizes(measurement: Measurement, gear: SteeringGear) -> None:
    """Refuse torques, forces and angles that no gear like the expected one can have.

    Raises:
        InputError: one sentence for each file that holds such.
    """
    problems = []
    for run, name in enumerate(measurement.names):
        passes = [each for each in measurement.passes if each.run == run]
        problems += [f"{name} {why}." for why in (*_sizes(passes, gear), *_travels(passes, gear))]
    if problems:
        raise InputError(problems)


def _sizes(passes: list[MeasuredPass], gear: SteeringGear) -> Iterator[str]:
    expected = max(abs(mean) for mean in formula_means(gear, passes[0].test))
    size = max(abs(float(np.median(each.value))) for each in passes)
    if expected > 0 and not 1 / FAR < size / expected < FAR:
        unit = passes[0].test.unit.replace("*", " ")
        what = "force" if unit == "N" else "torque"
        yield (
            f"has a mean {what} of {size:.3g} {unit} where the gear given would show {expected:.3g} {unit}: "
            f"look at the unit of its {what}, or give a gear that is nearer by --gear"
        )


def _travels(passes: list[MeasuredPass], gear: SteeringGear) -> Iterator[str]:
    turned = max(float(np.ptp(each.angle)) for each in passes)
    whole = 2 * largest_angle(gear)
    if passes[0].test.of_kind.by_angle and turned > MOST_TRAVELS * whole:
        yield (
            f"covers {turned / TURN:.3g} turns of the pinion where the gear given has teeth for "
            f"{whole / TURN:.3g}: look at the unit of its angle"
        )
