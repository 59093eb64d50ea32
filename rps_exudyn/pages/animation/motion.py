"""Where every body is at the shown instants of a record, with its deflections as they are or magnified.

Deflections are magnified about their mean over the record, displacements by one factor and angles by
another: the mean lift of -8 um, magnified too, would press the rack's teeth through the pinion's.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.rigid_motion import rotation_matrix
from rps_exudyn.gears.export import turned
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.solids import plunger_ends
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import Result

MOST_FRAMES = 361
DISPLACEMENTS, TILTS = ("rack_y", "rack_z", "plunger_displacement"), ("rack_roll", "rack_yaw", "rack_pitch")
SHOWN_LIFT, SHOWN_TILT = 0.45e-3, 0.03  # to which the largest deviation is magnified at most [m], [rad]
ROUND = np.array([1, 3, 10, 30, 100, 300, 1000])

Pose = tuple[np.ndarray, np.ndarray]  # rotation (3, 3) and origin (3,) [m] in the housing frame


class Factors(NamedTuple):
    """By how much deflections are magnified."""

    displacement: float = 1.0
    tilt: float = 1.0


AS_COMPUTED = Factors()


@dataclass(frozen=True, eq=False)
class Motion:
    """A record's poses.

    Attributes:
        gear: whose motion it is.
        signals: the chosen instants of the record, each signal of shape (frames,); deflections that the
            record lacks are 0.
        recorded: instants of the whole record.
        rigid: whether the record lacks the deflections.
    """

    gear: SteeringGear
    signals: Mapping[str, np.ndarray]
    recorded: int
    rigid: bool

    @classmethod
    def of(cls, result: Result) -> "Motion":
        """The motion of a result.

        Raises:
            InputError: it has no signals, or neither the pinion's angle nor the rack's displacement.
        """
        signals = result.signals
        for name in ("pinion_angle", "rack_displacement"):
            if name not in signals:
                why = result.message or f"its {name} was not kept"
                raise InputError(f"There is no motion to show: {why.rstrip('.')}.")
        chosen = chosen_frames(signals)
        frames = {name: np.asarray(values)[chosen] for name, values in signals.items()}
        lacking = [name for name in (*DISPLACEMENTS, *TILTS) if name not in signals]
        frames |= {name: np.zeros(chosen.size) for name in lacking}
        return cls(result.gear, frames, len(signals["pinion_angle"]), "rack_y" in lacking)

    @property
    def frames(self) -> int:
        """Number of instants shown."""
        return int(self.signals["pinion_angle"].size)

    @cached_property
    def largest_factors(self) -> Factors:
        """The round factors that make the deflections visible without taking the bodies apart."""
        limits = {SHOWN_LIFT: DISPLACEMENTS, SHOWN_TILT: TILTS}
        return Factors(*(_round_factor(shown, map(self.deviation, names)) for shown, names in limits.items()))

    def deviation(self, name: str) -> np.ndarray:
        """A signal less its mean, shape (frames,)."""
        return np.asarray(self.signals[name] - self.signals[name].mean())

    def magnified(self, name: str, factor: float) -> np.ndarray:
        """A deflection, magnified about its mean, shape (frames,)."""
        return self.signals[name].mean() + factor * self.deviation(name)

    def poses(self, frame: int, factors: Factors = AS_COMPUTED) -> dict[str, Pose]:
        """The pose of each part at one instant."""
        pair, upright = GearPair.of(self.gear), np.eye(3)
        axis, bush = pair.bar_axis_height, self.gear.bush
        lift = self.magnified("plunger_displacement", factors.displacement)[frame]
        turn = pair.pinion_frame @ turned(self.signals["pinion_angle"][frame])
        behind = np.array([0.0, axis + lift, 0.0])
        return {
            "pinion": (turn, pair.pinion_origin),
            "rack": self._rack(frame, factors),
            "plunger": (upright, behind),
            "spring": (upright, behind),
            "yokenut": (upright, np.array([0.0, axis, 0.0])),
            "bearings": (pair.pinion_frame, pair.pinion_origin),
            "bush": (upright, np.array([bush.distance + bush.length / 2, axis, 0.0])),
        }

    def _rack(self, frame: int, factors: Factors) -> Pose:
        """Rack frame; the bar's axis keeps its lift above the pitch point, along which it travels."""
        rotation = rotation_matrix(np.array([self.magnified(name, factors.tilt)[frame] for name in TILTS]))
        y, z = (self.magnified(name, factors.displacement)[frame] for name in ("rack_y", "rack_z"))
        x = self.signals["rack_displacement"][frame]
        along, rise, swing = rotation[:, 0]
        height = GearPair.of(self.gear).bar_axis_height
        return rotation, np.array([x, height + y + x * rise / along, z + x * swing / along])


def exploded(gear: SteeringGear) -> dict[str, np.ndarray]:
    """How far each part stands from its place in the exploded view, shape (3,) [m]."""
    step = 0.35 * (plunger_ends(gear)[1] + gear.yoke.plunger_length)
    steps = {"pinion": -1.2, "bearings": -1.2, "rack": 0.0, "plunger": 1.1, "spring": 2.1, "yokenut": 3.0}
    away = {name: np.array([0.0, count * step, 0.0]) for name, count in steps.items()}
    return away | {"bush": np.array([-0.35 * gear.bush.distance, 0.0, 0.0])}


def chosen_frames(signals: Mapping[str, np.ndarray]) -> np.ndarray:
    """Numbers of the instants shown: evenly spread, with those of every signal's extremes."""
    count = len(signals["pinion_angle"])
    if count <= MOST_FRAMES:
        return np.arange(count)
    even = np.round(np.linspace(0, count - 1, MOST_FRAMES)).astype(int)
    extremes = [each(values) for values in signals.values() for each in (np.argmin, np.argmax)]
    return np.unique(np.concatenate([even, extremes]))


def _round_factor(shown: float, deviations: Iterable[np.ndarray]) -> float:
    """The largest round factor by which the largest deviation stays below `shown`."""
    largest = max(float(np.abs(each).max()) for each in deviations)
    if largest == 0.0:
        return 1.0
    return float(ROUND[max(int(np.searchsorted(ROUND, shown / largest, side="right")) - 1, 0)])
