"""What the steady scenes share: their maneuvers, and the metrics of their records, of one gear or of many."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Remark
from rps_exudyn.scenes.maneuver import Maneuver, StepLimits
from rps_exudyn.scenes.scene_run import Signals


@dataclass(frozen=True)
class Turned:
    """Records of a steady test; of many gears over the same instants signals have one more axis, the first,
    and numbers are arrays (n,).

    Attributes:
        gear: what all gears have in common; what differs stands beside it.
        signals: of the maneuvers recorded, joined.
        beside: of the maneuver that is not recorded; {} if there is none.
        gain: rack travel per radian [m].
        load: that pulls at the rack's end [N].
        step_angle: of the model [rad].
    """

    gear: SteeringGear
    signals: Signals
    beside: Signals
    gain: Any
    load: Any
    step_angle: float


@dataclass(frozen=True)
class SteadyTest:
    """The steady maneuvers of a scene, and the metrics of their record.

    Attributes:
        maneuvers: (gear, step angle, least steps) -> those recorded, and one beside them or None; raises
            InputError if they leave the rack's teeth.
        metrics: the summary of a record; of many gears arrays.
        curve: signals that show the drive's torque or force alone.
        remarks: on that summary, a list for each gear.
        formulas: figures of a gear beside, without its record.
    """

    maneuvers: Callable[[SteeringGear, float, StepLimits], tuple[list[Maneuver], Maneuver | None]]
    metrics: Callable[[Turned], dict[str, Any]]
    curve: tuple[str, ...]
    remarks: Callable[[Turned], list[list[Remark]]] = lambda turned: [[] for _ in range(np.size(turned.gain))]
    formulas: Callable[[SteeringGear], dict[str, float]] | None = None
