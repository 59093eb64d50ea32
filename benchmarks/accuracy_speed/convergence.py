"""Observed orders of convergence of measured points, beside those that theory expects.

    measurement.orders = fitted_orders(measurement)

A rule says which points belong together, what makes them finer, and which of their errors falls with it.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks.accuracy_speed.measurement import Measurement, Order, Point
from rps_exudyn.scenes import scene_named
from verification.work_precision import FAR_ABOVE, observed_order


@dataclass(frozen=True)
class Rule:
    """One kind of refinement: its points, what is made finer, which error falls with it."""

    study: str
    knob: str
    size: Callable[[Point], float]
    error: str
    of: Callable[[Point], float]
    expected: float
    why: str
    belongs: Callable[[Point], bool] = lambda point: True


def fitted_orders(measurement: Measurement) -> list[Order]:
    """Fitted orders of the rules whose points the measurement has."""
    return list(_fitted(measurement))


def _fitted(measurement: Measurement) -> Iterator[Order]:
    for rule in RULES if scene_named(measurement.scene).steady else ():
        points = [p for p in measurement.points if p.ok and p.study == rule.study and rule.belongs(p)]
        if not points:
            continue
        size = np.array([rule.size(point) for point in points])
        error = np.array([rule.of(point) for point in points])
        floor = measurement.reference.uncertainty
        above = int((np.isfinite(error) & (error > FAR_ABOVE * floor)).sum())
        order = observed_order(size, error, floor)
        yield Order(
            points[0].family,
            rule.knob,
            rule.error,
            np.nan if order is None else order,
            rule.expected,
            above,
            rule.why,
        )


def _step(point: Point) -> float:
    return point.fidelity.step_angle


def _scatter(point: Point) -> float:
    """RMS about the bias [%]."""
    return float(np.sqrt(max(point.rms**2 - point.bias**2, 0.0)))


def _cuts(point: Point) -> float:
    found = re.search(r"cuts (\d+)", point.label)
    return 1 / float(found[1]) if found else np.nan


def _micrometres(point: Point) -> float:
    found = re.search(r"([\d.]+) um", point.label)
    return float(found[1]) if found else np.nan


FINEST, COARSEST = 0.5, 5.0  # steps over which an order is fitted [deg]
LINES, SPLINES = "RMS joined by lines", "RMS joined by splines"


def _asymptotic(point: Point) -> bool:
    """Strips finer than the error, and twelve angles on a pitch at least."""
    return point.fidelity.strip_stations >= 6 and FINEST <= np.degrees(_step(point)) <= COARSEST


RULES = [
    Rule(study, "step", _step, kind, of, expected, why, _asymptotic)
    for study in ("quasi_static", "flank")
    for kind, of, expected, why in (
        (LINES, lambda p: p.rms_linear, 2.0, "chords of a smooth curve"),
        (SPLINES, lambda p: p.rms, 4.0, "cubics of a curve without kinks; every kink costs some of it"),
    )
]
OF_SPHERES = (
    "distance of the spheres",
    lambda p: 1 / p.fidelity.profile_samples,
    "RMS about the bias",
    _scatter,
    2.0,
)
OF_FACETS = "RMS against the same spheres on the analytic flank", lambda p: p.rms
RULES += [
    Rule(
        "spheres_at_rest",
        *OF_SPHERES,
        "midpoint rule over a strip; beyond 54 along the profile 0.06 % stay, the spheres' radius",
        lambda p: p.fidelity.profile_samples <= 54,
    ),
    Rule("general_contact", *OF_SPHERES, "the same, in dynamics"),
    Rule("shaping", "angle of a cut", _cuts, *OF_FACETS, 2.0, "scallops as high as the square of the cut"),
    Rule("chord", "chord error of the triangles", _micrometres, *OF_FACETS, 1.0, "depth is linear in it"),
    Rule("shaping", "angle of a cut", _cuts, "material left over", _micrometres, 2.0, "the same"),
]
