"""Evaluating the requirements of a gear: each number with its band, and whether it is kept.

A requirement is kept if at least `ASSURED` of the gears drawn keep it; samples that failed do not, and where
they decide it is open. Numbers that hang on the teeth alone have no band.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.roots import bracketed_root
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.tooth_strength import flank_stress, pinion_form, rack_form, root_stress
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.requirements.limits import Limit
from rps_exudyn.solvers.closed_form import load_test
from rps_exudyn.uncertainty.band import Band, band_of_runs
from rps_exudyn.uncertainty.quick_band import quick_band

ASSURED = 0.95  # of the gears
RATED_TORQUE = 30.0  # [N m]
LIGHTEST, HEAVIEST = 0.5, 400.0  # weights between which a kept efficiency is looked for [kg]
MODEL = Fidelity.preset("quasi-static").replace({"step_angle": "2 deg"})
TURN: dict[str, object] = {"test.path": "there-and-back", "test.start_angle": -np.pi, "test.turns": 1.0}


@dataclass(frozen=True)
class Judged:
    """One requirement of a gear, SI."""

    name: str
    limit: Limit
    nominal: float
    low: float  # 5 % of the band; the nominal number without one
    high: float  # 95 %
    share: float  # of the gears that keep the limit
    failed: float = 0.0  # share of the samples that gave no number
    remark: str = ""

    @property
    def kept(self) -> bool:
        """Whether enough gears keep it."""
        return self.share >= ASSURED

    @property
    def verdict(self) -> str:
        """Return pass, fail, or open where samples that failed decide."""
        if self.kept:
            return "pass"
        return "open" if self.share + self.failed >= ASSURED else "fail"


def judge(
    gear: SteeringGear,
    inputs: Mapping[str, Distribution],
    limits: Mapping[str, Limit],
    rated_torque: float = RATED_TORQUE,
    samples: int = 48,
    told: Callable[[str], None] | None = None,
) -> Iterator[Judged]:
    """Yield every requirement of the gear, in the order of `limits.REQUIRED`.

    Args:
        gear: its own load mass is the weight of the efficiencies.
        inputs: distributions of its parameters, for the bands.
        limits: name -> limit.
        rated_torque: on the pinion [N m].
        samples: of each band.
        told: what is computed next.

    Raises:
        InputError: a gear that cannot be run.
    """
    if not rated_torque > 0:
        raise InputError(f"the rated torque is {rated_torque:g} N m; it must be more than 0 N m.")
    tell = told or (lambda text: None)
    tell("free torque and its variation")
    yield from _of_turning(gear, inputs, limits, samples)
    tell("efficiencies")
    yield _of_efficiency(gear, inputs, limits["efficiency_ratio"], samples)
    tell(f"teeth and lift under {rated_torque:g} N m")
    pair = GearPair.of(gear)
    yield _exact("rated_root_pinion", root_stress(gear, pinion_form(pair), rated_torque), limits)
    yield _exact("rated_root_rack", root_stress(gear, rack_form(pair), rated_torque), limits)
    yield _exact("rated_flank", flank_stress(gear, rated_torque), limits)
    lifting = gear.replace({"test.lift_torque": rated_torque})
    lift = band_of_runs("rack-lift", lifting, MODEL, inputs, max(samples // 2, 8))
    yield _from_band("rated_lift", "rack_lift", lift, limits)
    yield _exact("travel", 2 * RackBar.of(gear).largest_displacement, limits)
    yield _exact("gain", 2 * np.pi * float(pair.gain), limits)


def _of_turning(
    gear: SteeringGear, inputs: Mapping[str, Distribution], limits: Mapping[str, Limit], samples: int
) -> Iterator[Judged]:
    """Torques over a turn about the centre; lock to lock where the torque changes along the travel."""
    path = {"test.path": "lock-to-lock"} if gear.rack.bow or gear.installation.gravity else TURN
    band = quick_band(gear.replace(path), MODEL, inputs, samples)
    yield _from_band("free_torque", "torque_mean", band, limits)
    yield _from_band("variation_on_centre", "torque_on_centre_variation", band, limits)
    yield _from_band("variation_off_centre", "torque_off_centre_variation", band, limits)


def _of_efficiency(
    gear: SteeringGear, inputs: Mapping[str, Distribution], limit: Limit, samples: int
) -> Judged:
    short = gear.replace({"test.path": "there-and-back", "test.turns": 2 / gear.pinion.teeth})
    band = band_of_runs("load-test", short, MODEL, inputs, max(samples // 2, 8))
    judged = _from_band("efficiency_ratio", "efficiency_ratio", band, {"efficiency_ratio": limit})
    weight = f"With {gear.test.load_mass:.4g} kg; the ratio is about 1 - (T_0 / W s')^2"
    if judged.kept:
        return replace(judged, remark=weight)
    enough = weight_for_ratio(gear, limit.least)
    found = f"it would take {enough:.3g} kg" if enough else f"no weight up to {HEAVIEST:g} kg is enough"
    return replace(judged, remark=f"{weight}: {found} at the medians, by the closed form")


def weight_for_ratio(gear: SteeringGear, ratio: float) -> float | None:
    """Return the least weight with which reverse over forward efficiency reaches a ratio, by the closed form
    [kg]; None if none does."""

    def beyond(mass: float) -> float:
        return load_test(gear, mass).efficiency_ratio - ratio

    masses = np.geomspace(LIGHTEST, HEAVIEST, 40)
    for lighter, heavier in pairwise(masses.tolist()):
        if beyond(heavier) >= 0:
            return (
                bracketed_root(beyond, lighter, heavier, tolerance=1e-6) if beyond(lighter) < 0 else lighter
            )
    return None


def _exact(name: str, value: float, limits: Mapping[str, Limit]) -> Judged:
    limit, value = limits[name], float(value)
    return Judged(name, limit, value, value, value, float(limit.keeps(value)))


def _from_band(name: str, figure: str, band: Band, limits: Mapping[str, Limit]) -> Judged:
    """Judge a figure by its band: the share of its runs; failed ones keep nothing."""
    limit, numbers = limits[name], band.drawn.numbers[figure]
    known = numbers[np.isfinite(numbers)]
    nominal = band.nominal.summary[figure]
    share = float(np.count_nonzero(limit.keeps(known)) / numbers.size)
    found = band.figures[figure]
    missing = numbers.size - known.size
    cause = next(iter(band.drawn.failures), "")
    remark = f"{missing} of {numbers.size} samples failed, most often {cause}" if missing else ""
    return Judged(name, limit, nominal, found.low, found.high, share, missing / numbers.size, remark)
