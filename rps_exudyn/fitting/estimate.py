"""The outcome of a fit: estimates, what they rest on, and what is to be said about them."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from rps_exudyn.fitting.identify import Advice, Combination
from rps_exudyn.fitting.more_runs import MoreRuns
from rps_exudyn.fitting.problem import Problem
from rps_exudyn.fitting.series import Series
from rps_exudyn.parameters.gear import SteeringGear

UNMOVED = 0.97  # of the prior's deviation: what is left of it where the data say nothing


class Verdict(StrEnum):
    """What a fit says of a parameter."""

    FOUND = "found"  # the data tell it, whatever the others are
    BY_PRIOR = "follows from what was given of others"
    OPEN = "not separable"
    NOT_MOVED = "as given, not found"
    NOT_ZERO = "found, differs from zero"
    MAYBE_ZERO = "not different from zero"
    UNEXPLAINED = "not told: the curves are not explained to their noise"


def untold(sd: float, before: float) -> Verdict:
    """Verdict on an unknown that the data do not find: whether they narrowed its deviation at all."""
    return Verdict.NOT_MOVED if sd > UNMOVED * before else Verdict.OPEN


@dataclass(frozen=True)
class Estimate:
    """One parameter, SI."""

    path: str
    value: float
    interval: tuple[float, float]  # 95 %
    prior: float
    prior_sd: float  # relative where the parameter is positive, else SI
    sd: float  # the same
    by_law: float  # difference by the other contact law, likewise
    verdict: Verdict


@dataclass(frozen=True)
class Level:
    """Mean free torque, half the difference of both directions [N m]."""

    value: float
    interval: tuple[float, float]
    sd: float
    noise: str  # what the interval rests on


@dataclass(frozen=True, eq=False)
class FittedPass:
    """A measured pass with the model's curve and its 95 % band, for pictures."""

    name: str
    test: str
    by_angle: bool  # whether its curve is compared, not its mean alone
    direction: int
    angle: np.ndarray
    value: np.ndarray
    model: np.ndarray
    half_band: np.ndarray
    noise: float  # standard deviation of a point
    unit: str


@dataclass(frozen=True, eq=False)
class Fit:
    """What measured curves tell of a gear."""

    gear: SteeringGear  # with the estimates in place
    given: SteeringGear
    level: Level | None
    estimates: list[Estimate]
    combinations: list[Combination]
    correlations: np.ndarray  # of the unknowns in `correlated`, (n, n)
    correlated: list[str]
    advice: Advice | None
    repeats: MoreRuns | None
    offset: float  # of the measured pinion angle [rad]
    offset_sd: float
    passes: list[FittedPass]
    assumed: tuple[str, ...]
    warnings: tuple[str, ...]
    converged: bool
    simulations: int
    cpu_s: float
    problem: Problem = field(repr=False)
    series: Series = field(repr=False)  # for the next gear

    def estimate(self, path: str) -> Estimate:
        """The estimate of one parameter.

        Raises:
            KeyError: it was not fitted.
        """
        for each in self.estimates:
            if each.path == path:
                return each
        raise KeyError(path)

    @property
    def left_out(self) -> tuple[str, ...]:
        """Rows of the files that were not fitted, and why."""
        return self.problem.measurement.left_out

    @property
    def found(self) -> list[str]:
        """Parameters that the data tell by themselves."""
        return [each.path for each in self.estimates if each.verdict in (Verdict.FOUND, Verdict.NOT_ZERO)]
