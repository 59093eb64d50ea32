"""Made-up measured curves: what the model shows, with noise as test benches have it. No measurement.

White noise is new at every point; correlated noise keeps its sign over some ten degrees; a drift grows along
a pass; repeatability changes a whole pass; a sensor has a zero, steps, spikes; a rig has a coupling, a cardan
joint, a torque channel that comes late.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from rps_exudyn.analysis.passes import passes
from rps_exudyn.inference.fitting.bench_tests import BenchTest
from rps_exudyn.inference.fitting.identifiability import logarithmic_slopes
from rps_exudyn.inference.fitting.prediction import formula_means
from rps_exudyn.inference.fitting.unknowns import LEVEL
from rps_exudyn.inference.measured.reading import PUSH, TORQUE
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import MeasuredTorque
from rps_exudyn.solvers.closed_form import GRAVITY
from verification.law_area import by_law

SCENES = {
    "free": "free-pinion-torque",
    "reversal": "reversal",
    "load-test": "load-test",
    "rack-push": "rack-push",
    "rack-on-rollers": "rack-on-rollers",
}


@dataclass(frozen=True)
class BenchNoise:
    """Noise of a bench; sizes in parts of the level that friction makes."""

    white: float = 0.02
    correlated: float = 0.0
    length: float = np.radians(20.0)  # over which it keeps its sign [rad]
    drift: float = 0.0  # over a pass
    repeatability: float = 0.0  # of a whole run
    zero: float = 0.0  # of the sensor
    walk: float = 0.0  # of a random walk after a pass
    spikes: float = 0.0  # part of the points
    step: float = 0.0  # of the sensor [N m]
    lag: float = 0.0  # of the torque on the way back [rad]
    coupling: float = 0.0  # friction's first order, fixed to the angle
    cardan: float = 0.0  # its second order
    bow: float = 0.0  # at the ends of the travel, quadratic
    one_way: bool = False


REAL = BenchNoise(white=0.01, correlated=0.0173, drift=0.02, repeatability=0.02, zero=0.02)
"""2 % in all, three quarters of its variance correlated over 20 degrees."""


def true_curve(gear: SteeringGear, test: BenchTest, law: str | None = None) -> dict[str, np.ndarray]:
    """Return what the model shows in a test: `pinion_angle` [rad], `value` [N m] or [N], to and fro over the
    gear's turns about the middle.

    Raises:
        RuntimeError: the simulation fails.
    """
    from rps_exudyn.simulate.run import simulate

    gear = gear.replace({"test.path": "there-and-back", "test.start_angle": -gear.test.turns * np.pi})
    if law:
        gear = by_law(gear, law)
    if test.kind in ("yoke-out", "bearing"):
        angle = np.concatenate([np.linspace(-np.pi, np.pi, 361), np.linspace(np.pi, -np.pi, 361)[1:]])
        forth, back = formula_means(gear, test)
        return {"pinion_angle": angle, "value": np.where(np.arange(angle.size) < 361, forth, back)}
    if test.kind == "reversal":
        gear = gear.replace({"test.start_angle": 0.0})
    if test.kind == "load-test":
        gear = gear.replace({"test.load_mass": test.load / GRAVITY})
    result = simulate(SCENES[test.kind], gear, Fidelity.preset("quasi-static"))
    if result.status != "ok":
        raise RuntimeError(f"{test.title}: {result.status}: {result.message}")
    driven, value = ("rack_displacement", "rack_force") if test.pushed else ("pinion_angle", "pinion_torque")
    return {"pinion_angle": result[driven], "value": result[value]}


def with_noise(
    curve: dict[str, np.ndarray], noise: BenchNoise, random: np.random.Generator
) -> dict[str, np.ndarray]:
    """Return the curve as a bench would record it; sizes are in parts of what friction makes of it."""
    angle, value = curve["pinion_angle"], curve["value"].copy()
    ways = list(_parts(angle))
    means = [float(value[part].mean()) for part in ways]
    weight = (means[0] + means[-1]) / 2 if len(means) > 1 else 0.0  # of a load, which no run changes
    size, walked = abs(means[0] - weight), 0.0
    run, phases = 1 + noise.repeatability * random.standard_normal(), random.uniform(0, 2 * np.pi, 2)
    for number, part in enumerate(ways):
        turned, own = np.abs(angle[part] - angle[part][0]), angle[part]
        if noise.lag and number:
            value[part] = np.interp(own + noise.lag, own[::-1], value[part][::-1])
        sense, place = np.sign(means[number] - weight), (own - own.mean()) / max(float(np.ptp(own)), 1e-12)
        locked = noise.coupling * np.cos(own + phases[0]) + noise.cardan * np.cos(2 * own + phases[1])
        value[part] += sense * size * (locked + noise.bow * (12 * place**2 - 1) / 2)
        slow = np.exp(-np.diff(turned, prepend=turned[0]) / noise.length)
        kept = _kept(slow, random) if noise.correlated else 0.0
        drift = noise.drift * random.standard_normal() * turned / max(float(turned[-1]), 1e-12)
        white = noise.white * random.standard_normal(own.size)
        if noise.walk:
            walk = walked + noise.walk * np.cumsum(random.standard_normal(own.size)) / np.sqrt(own.size)
            drift, walked = drift + walk, walk[-1]
        value[part] = weight + run * (value[part] - weight)
        value[part] += size * (white + noise.correlated * kept + drift)
        if noise.spikes:
            hit = random.random(own.size) < noise.spikes
            value[part] += np.where(hit, 0.2 * size * random.choice([-1.0, 1.0], own.size), 0.0)
    value += size * noise.zero * random.standard_normal()
    if noise.step:
        value = noise.step * np.round(value / noise.step)
    kept_rows = ways[0] if noise.one_way else slice(None)
    return {name: each[kept_rows] for name, each in {**curve, "value": value}.items()}


def measured_curve(
    curve: dict[str, np.ndarray], test: BenchTest, name: str = "made up"
) -> tuple[BenchTest, MeasuredTorque]:
    """Return a curve as the reading of a file would."""
    driven, value = PUSH if test.pushed else TORQUE
    return test, MeasuredTorque(name, {driven: curve["pinion_angle"], value: curve["value"]})


def _parts(angle: np.ndarray) -> Iterator[slice]:
    turn = len(passes({"pinion_angle": angle})[0].angle)
    yield slice(0, turn)
    if turn < angle.size:
        yield slice(turn, angle.size)


def _kept(slow: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """An Ornstein-Uhlenbeck process of unit variance, whose steps keep the part `slow` (n,)."""
    values, last = np.empty(slow.size), random.standard_normal()
    for i, part in enumerate(slow.tolist()):
        last = part * last + np.sqrt(1 - part**2) * random.standard_normal()
        values[i] = last
    return values


# --- The gear that fits of made-up curves look for, 17 to 25 % off the expected one in each parameter

TRUE: dict[str, object] = {
    "yoke.preload": 350.0,
    "mesh.friction": 0.085,
    "yoke.friction": 0.12,
    "bush.drag": 25.0,
    "pinion.runout": 20e-6,
    "pinion.runout_angle": "70 deg",
}
FREE = BenchTest("free")
WEIGHTS = tuple(BenchTest("load-test", mass * GRAVITY) for mass in (40.0, 80.0, 150.0))
SET = (FREE, BenchTest("yoke-out"), BenchTest("bearing"), *WEIGHTS)
SPIKE, SPIKES = 10.0, 0.03  # standard deviations, part of the points
DISTURBED, SHIFT = np.radians(25.0), 8.0  # of one pass, standard deviations
GAPS, GAP = 3, np.radians(27.6)  # in each pass: 23 % of it
WHITE = BenchNoise()
REPEATED = BenchNoise(repeatability=0.02, zero=0.02)


@cache
def true_gear() -> SteeringGear:
    """The gear of the made-up curves."""
    return SteeringGear().replace(TRUE)


@cache
def curve_of(test: BenchTest, law: str = "line") -> dict[str, np.ndarray]:
    """The true curve of a test by a contact law."""
    return true_curve(true_gear(), test, law)


@cache
def true_level(law: str = "line") -> float:
    """Mean free torque of the true gear, half the difference of both directions [N m]."""
    curve = curve_of(FREE, law)
    turned = passes({"pinion_angle": curve["pinion_angle"], "value": curve["value"]})
    means = [np.trapezoid(each.signals["value"], each.angle) / np.ptp(each.angle) for each in turned]
    return float(sum(abs(mean) for mean in means) / 2)


def measured(test: BenchTest, noise: BenchNoise, random: np.random.Generator, law: str = "line") -> Any:
    """One made-up file of a test."""
    return measured_curve(with_noise(curve_of(test, law), noise, random), test)


def spiked(curve: MeasuredTorque, random: np.random.Generator) -> MeasuredTorque:
    """Some points far off, to either side."""
    torque = curve.signals["pinion_torque"].copy()
    hit = random.random(torque.size) < SPIKES
    size = SPIKE * WHITE.white * np.abs(torque).mean()
    torque[hit] += size * random.choice([-1.0, 1.0], hit.sum())
    return MeasuredTorque(curve.name, {**curve.signals, "pinion_torque": torque})


def disturbed(curve: MeasuredTorque, random: np.random.Generator) -> MeasuredTorque:
    """A stretch of the first pass off to one side."""
    angle, torque = curve.signals["pinion_angle"], curve.signals["pinion_torque"].copy()
    begin = random.uniform(angle.min(), angle.max() - DISTURBED)
    inside = (angle >= begin) & (angle < begin + DISTURBED) & (np.arange(angle.size) < angle.size // 2)
    torque[inside] += SHIFT * WHITE.white * np.abs(torque).mean()
    return MeasuredTorque(curve.name, {**curve.signals, "pinion_torque": torque})


def with_gaps(curve: MeasuredTorque, random: np.random.Generator) -> MeasuredTorque:
    """Stretches missing, others in each pass."""
    angle = curve.signals["pinion_angle"]
    kept = np.ones(angle.size, dtype=bool)
    for way in (np.arange(angle.size) < angle.size // 2, np.arange(angle.size) >= angle.size // 2):
        third = np.ptp(angle) / GAPS
        for i in range(GAPS):
            begin = angle.min() + i * third + random.uniform(0, third - GAP)
            kept &= ~(way & (angle >= begin) & (angle < begin + GAP))
    return MeasuredTorque(curve.name, {name: values[kept] for name, values in curve.signals.items()})


def forward_only(curve: MeasuredTorque, random: np.random.Generator) -> MeasuredTorque:
    """The first pass."""
    half = curve.signals["pinion_angle"].size // 2
    return MeasuredTorque(curve.name, {name: values[:half] for name, values in curve.signals.items()})


Disturbance = Callable[[MeasuredTorque, np.random.Generator], MeasuredTorque]
DISTURBANCES: dict[str, Disturbance] = {
    "spikes": spiked,
    "disturbed": disturbed,
    "missing": with_gaps,
    "one way": forward_only,
}


def least_deviations(noise: BenchNoise, runs: int = 1, points: int = 722) -> dict[str, float]:
    """Cramer and Rao's bound of the logarithms of the level's parameters, from the whole set of tests.

    No unbiased estimator scatters less. Half the difference of both directions has the noise of the run, half
    the sum that of the zero; slopes are the closed form's at the true gear. No prior belief is counted.
    """
    paths, information = tuple(LEVEL), np.zeros((len(LEVEL), len(LEVEL)))
    for test in SET:
        means, slopes = formula_means(true_gear(), test), logarithmic_slopes(true_gear(), test, paths)
        friction = abs(means[0] - means[1]) / 2
        halves = (slopes[0] - slopes[1], noise.repeatability), (slopes[0] + slopes[1], noise.zero)
        for slope, common in halves:
            sd = friction * np.hypot(noise.white / np.sqrt(points), common)
            information += runs * np.outer(slope / 2, slope / 2) / sd**2
    deviations = np.sqrt(np.diag(np.linalg.inv(information)))
    return dict(zip(paths, deviations.tolist(), strict=True))
