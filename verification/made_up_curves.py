"""Made-up measured curves: what the model shows, with noise as test benches have it. No measurement.

White noise is new at every point; correlated noise keeps its sign over some ten degrees; a drift grows along
a pass; repeatability changes a whole pass; a sensor has a zero, steps, spikes; a rig has a coupling, a cardan
joint, a torque channel that comes late.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rps_exudyn.analysis.passes import passes
from rps_exudyn.inference.fitting.bench_tests import BenchTest
from rps_exudyn.inference.fitting.prediction import formula_means
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
    """Return what the model shows in a test: `pinion_angle` [rad], `value` [N m] or [N], to and fro.

    Raises:
        RuntimeError: the simulation fails.
    """
    from rps_exudyn.simulate.run import simulate

    gear = gear.replace({"test.path": "there-and-back", "test.start_angle": -np.pi})
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
