"""A measured torque curve, compared with a simulated one in each direction; `measured.reading` reads it."""

from dataclasses import dataclass, field

import numpy as np

from rps_exudyn.analysis.comparison import SignalPair, signal_pair
from rps_exudyn.analysis.passes import Signals, common_angles, longest_pass
from rps_exudyn.analysis.torque import describe_torque

FEWEST = 3  # rows that make a curve


@dataclass(frozen=True, eq=False)
class MeasuredTorque:
    """A measured curve in SI units, in the order of its file."""

    name: str
    signals: dict[str, np.ndarray]  # pinion_angle [rad], pinion_torque [N m], shape (n,); or of a rack push
    assumed: tuple[str, ...] = ()  # what the reading of the file took for granted
    beside: dict[str, np.ndarray] = field(default_factory=dict)  # clock [s], speed [rad/s]; (n,)


@dataclass(frozen=True, eq=False)
class AgainstMeasured:
    """A simulated and a measured torque in one direction, over the angles that both cover."""

    direction: int  # +1 moves the rack along +X
    angle_range: tuple[float, float]  # [rad]
    torque: SignalPair  # first measured, second simulated
    measured: dict[str, float]  # figures of `describe_torque` over these angles
    simulated: dict[str, float]


def compare_with_measured(measured: MeasuredTorque, signals: Signals, teeth: int) -> list[AgainstMeasured]:
    """Compare the torques in each direction in which both were recorded at common angles, +X first."""
    compared: list[AgainstMeasured] = []
    for direction in (+1, -1) if "pinion_torque" in signals else ():
        ours, theirs = (longest_pass(each, direction) for each in (signals, measured.signals))
        if ours is None or theirs is None:
            continue
        angle = common_angles(theirs.angle, ours.angle)
        if angle.size < FEWEST:
            continue
        curves = [each.over(angle, "pinion_torque") for each in (theirs, ours)]
        figures = [describe_torque(angle, torque, teeth) for torque in curves]
        pair = signal_pair("pinion_torque", angle, *curves)
        compared.append(AgainstMeasured(direction, (float(angle[0]), float(angle[-1])), pair, *figures))
    return compared
