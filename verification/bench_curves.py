"""Free torques by a formula of their own, with the noise and the rigs of benches.

Neither contact law nor equilibria of the package: level, eccentricity and ripple are written down here, with
the lengths of the default gear.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from verification.made_up_curves import BenchNoise, with_noise

ARMS = 9.43e-3, 6.26e-3  # torque per preload and coefficient, of teeth and seat [m]
GAIN = 5.575e-3  # rack travel per radian [m/rad]
SPRING = 50e3  # of plunger and what holds the rack straight, against a lift of the teeth [N/m]
LIFTED, SHIFTED = 0.169, 1.13  # torque that no lift changes [N m]; travel's change over that of a lift
TEETH = 6


@dataclass(frozen=True)
class BenchGear:
    """What is true of a gear on the bench; SI."""

    preload: float = 350.0
    friction: float = 0.085
    yoke_friction: float = 0.12
    drag: float = 20.0
    bearing: float = 0.03
    runout: float = 15e-6
    direction: float = 1.2  # of the runout
    ripple: float = 0.03  # of the level at the order of the teeth
    area: bool = False  # ripple that grows with the contact's area: sharper, another phase

    @property
    def level(self) -> float:
        """Mean free torque [N m]."""
        return (
            self.preload * (ARMS[0] * self.friction + ARMS[1] * self.yoke_friction)
            + GAIN * self.drag
            + self.bearing
        )

    def curve(self, angle: np.ndarray, direction: int) -> np.ndarray:
        """Torque at pinion angles (n,) one way [N m]."""
        phase = angle + self.direction
        arm = SHIFTED * (self.level - self.bearing) / GAIN + SPRING * (self.level - LIFTED) / self.preload
        teeth = TEETH * angle + (1.0 if self.area else 0.3)
        own = np.cos(teeth) + (0.6 if self.area else 0.3) * np.cos(2 * teeth + 0.5)
        stored = 0.5 * np.sin(teeth + 0.4)  # what the teeth take and give back
        friction = self.level * (1 + self.ripple * own) + arm * self.runout * np.cos(phase)
        return (
            direction * friction
            - self.preload * self.runout * np.sin(phase)
            + self.level * self.ripple * stored
        )


def drawn_gear(random: np.random.Generator) -> BenchGear:
    """A gear out of what a fit believes of the default one before any test."""
    return BenchGear(
        preload=300.0 * np.exp(0.25 * random.standard_normal()),
        friction=0.1 * np.exp(0.25 * random.standard_normal()),
        runout=15e-6 * np.hypot(*random.standard_normal(2)),
        direction=random.uniform(0, 2 * np.pi),
    )


@dataclass(frozen=True)
class BenchKind:
    """One kind of noise and rig."""

    noise: BenchNoise
    runs: int = 1
    spacing: float = 1.0  # of the points [deg]
    area: bool = False
    is_white: bool = False


_AR = BenchNoise(0.01, correlated=0.017)
_ALL = replace(_AR, drift=0.02, zero=0.03, spikes=0.03, repeatability=0.02)
KINDS = {
    "white 2 %": BenchKind(BenchNoise(0.02), is_white=True),
    "white 2 %, 0.25 deg": BenchKind(BenchNoise(0.02), spacing=0.25, is_white=True),
    "AR 1.7 % over 20 deg, white 1 %": BenchKind(_AR),
    "AR 2 % over 5 deg": BenchKind(BenchNoise(0.0, correlated=0.02, length=np.radians(5.0))),
    "AR and drift 3 %": BenchKind(replace(_AR, drift=0.03)),
    "random walk 4 %": BenchKind(BenchNoise(0.01, walk=0.04)),
    "spikes, 3 % of the points": BenchKind(BenchNoise(0.01, spikes=0.03)),
    "steps of 0.05 N m": BenchKind(BenchNoise(0.01, step=0.05)),
    "lag 1.5 deg back, zero 3 %": BenchKind(BenchNoise(0.01, lag=np.radians(1.5), zero=0.03)),
    "cardan 5 %": BenchKind(BenchNoise(0.01, cardan=0.05)),
    "coupling 5 %": BenchKind(BenchNoise(0.01, coupling=0.05)),
    "bow 10 %": BenchKind(BenchNoise(0.01, bow=0.1)),
    "law area": BenchKind(BenchNoise(0.02), area=True, is_white=True),
    "repeatability 3 %, one run": BenchKind(BenchNoise(0.01, repeatability=0.03)),
    "repeatability 3 %, AR, three runs": BenchKind(replace(_AR, repeatability=0.03), runs=3),
    "everything": BenchKind(_ALL),
    "everything, three runs": BenchKind(_ALL, runs=3),
    "forth only, zero 2 %": BenchKind(BenchNoise(0.01, zero=0.02, one_way=True)),
}
"""The 18 kinds of noise and rig whose intervals must hold."""


def bench_record(gear: BenchGear, spacing: float = 1.0) -> dict[str, np.ndarray]:
    """One turn forth and back in steps of `spacing` [deg], without noise."""
    forth = np.radians(np.arange(-180.0, 180.0 + spacing / 2, spacing))
    angle = np.concatenate([forth, forth[::-1]])
    value = np.concatenate([gear.curve(forth, 1), gear.curve(forth[::-1], -1)])
    return {"pinion_angle": angle, "value": value}


def folder_of(
    path: Path, count: int, spacing: float = 1.0, scatter: float = 0.07, slope: float = 0.0
) -> Path:
    """A folder with the free torque of each gear of a batch, whose preloads scatter and drift by `slope` of
    their mean over the batch."""
    random = np.random.default_rng(4)
    noise = BenchNoise(white=0.02, repeatability=0.02)
    for number in range(1, count + 1):
        drift = slope * ((number - 0.5) / count - 0.5)
        gear = BenchGear(preload=350 * (1 + scatter * random.standard_normal() + drift))
        record = with_noise(bench_record(gear, spacing), noise, random)
        table = np.column_stack([np.degrees(record["pinion_angle"]), record["value"]])
        head = "angle [deg],torque [N m]"
        np.savetxt(path / f"gear{number}.csv", table, "%.5f", delimiter=",", header=head, comments="")
    return path
