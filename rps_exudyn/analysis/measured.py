"""A measured torque curve, compared with a simulated one in each direction; `measured.reading` reads it.

A gear repeats its torque after each turn of the pinion. Where the simulation covers a turn, a measured angle
stands for that angle plus or minus whole turns that was simulated: `turns_onto` returns how many.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rps_exudyn.analysis.hysteresis import RUNNING
from rps_exudyn.analysis.passes import Pass, Signals, common_angles, longest_pass, passes
from rps_exudyn.analysis.result_comparison import SignalPair, signal_pair
from rps_exudyn.analysis.torque import describe_torque
from rps_exudyn.base.errors import check_kind
from rps_exudyn.results.quantities import SIGNALS, SUMMARY
from rps_exudyn.results.result import MeasuredTorque, Result

FEWEST = 3  # rows that make a curve
TURN = 2 * np.pi  # [rad]
SAME_ANGLE = 1e-6  # [rad]
NOTHING_TO_COMPARE = (
    "Nothing to compare: the measured and the simulated torque have no pinion angle in common."
)


@dataclass(frozen=True, eq=False)
class AgainstMeasured:
    """A simulated and a measured torque in one direction, over the angles that both cover."""

    direction: int  # +1 moves the rack along +X
    angle_range: tuple[float, float]  # of the file [rad]
    simulated_range: tuple[float, float]  # of the simulation, that stands for it [rad]
    torque: SignalPair  # first measured, second simulated
    measured: dict[str, float]  # metrics of `describe_torque` over these angles
    simulated: dict[str, float]

    @property
    def heading(self) -> str:
        """Direction and angles in words."""
        low, high = (_shown(angle) for angle in self.angle_range)
        sign = "+" if self.direction > 0 else "-"
        words = f"Torque towards {sign}X, pinion angles of {low} to {high}"
        if turns_onto(np.array(self.angle_range), np.array(self.simulated_range)).any():
            low, high = (_shown(angle) for angle in self.simulated_range)
            words += f" (the simulated {low} to {high} stand for every turn)"
        return words

    @property
    def rows(self) -> list[tuple[str, str, str]]:
        """Name, measured and simulated value of each metric that both have, with their units."""
        return [
            (name, SUMMARY[name].show(value), SUMMARY[name].show(self.simulated[name]))
            for name, value in self.measured.items()
            if name in self.simulated
        ]

    @property
    def difference(self) -> str:
        """How far the curves lie apart, in words."""
        pair = self.torque
        return (
            f"difference: RMS {pair.shown(pair.rms)}, largest {pair.shown(pair.largest)} of the measured mean"
        )


def _shown(angle: float) -> str:
    return SIGNALS["pinion_angle"].show(round(float(angle), 9) + 0.0)


def turns_onto(angle: np.ndarray, simulated: np.ndarray) -> np.ndarray:
    """Return the fewest whole turns that bring angles (n,) into the range of the simulated ones, all in rad.

    They are 0 where the simulation covers less than a turn.
    """
    if not (simulated.size and np.ptp(simulated) >= TURN - SAME_ANGLE):
        return np.zeros(angle.shape)
    fewest = np.ceil((simulated.min() - SAME_ANGLE - angle) / TURN)
    most = np.floor((simulated.max() + SAME_ANGLE - angle) / TURN)
    return np.clip(0.0, fewest, most)


def rows_at_reversal(turned: Pass) -> int:
    """Return how many rows at the begin of a pass of a free torque precede its running torque and lie below
    all later ones: a torque that is recorded late has the sign of the pass before."""
    torque = turned.direction * turned.signals["pinion_torque"]
    begin = int(np.argmax(torque >= RUNNING * np.median(torque)))
    below = np.flatnonzero(torque[:begin] < torque[begin:].min())
    return int(below[-1]) + 1 if below.size else 0


def _opposes_motion(signals: Signals) -> bool:
    """Whether a simulated torque is friction alone in every row, without load, spring or reversal."""
    return {"pinion_angle", "pinion_torque"} <= signals.keys() and all(
        (each.direction * each.signals["pinion_torque"] > 0).all() for each in passes(signals)
    )


def onto_simulated(measured: MeasuredTorque, signals: Signals, *, at_reversal: bool = False) -> list[Pass]:
    """Return the measured curve in pieces of one direction each, their angles within the simulated range by
    whole turns: the rows in which the torque runs, or those `at_reversal`."""
    pieces, is_friction = [], _opposes_motion(signals)
    for turned in passes(measured.signals):
        begin = rows_at_reversal(turned) if is_friction else 0
        chosen = slice(begin) if at_reversal else slice(begin, None)
        turned = Pass(turned.direction, {name: values[chosen] for name, values in turned.signals.items()})
        simulated = longest_pass(signals, turned.direction) or longest_pass(signals, -turned.direction)
        turns = turns_onto(turned.angle, simulated.angle if simulated else np.zeros(0))
        for part in np.split(np.arange(turns.size), np.flatnonzero(np.diff(turns)) + 1):
            piece = {name: values[part] for name, values in turned.signals.items()}
            piece["pinion_angle"] = piece["pinion_angle"] + TURN * turns[part]
            pieces.append(Pass(turned.direction, piece))
    return pieces


def residuals(measured: MeasuredTorque, signals: Signals) -> list[Pass]:
    """Return the measured less the simulated torque in each piece of the measured curve, at its angles that
    were simulated in the same direction."""
    pieces = []
    for piece in onto_simulated(measured, signals):
        ours = longest_pass(signals, piece.direction)
        if ours is None:
            continue
        low, high = ours.angle.min() - SAME_ANGLE, ours.angle.max() + SAME_ANGLE
        angle = piece.angle[inside := (piece.angle >= low) & (piece.angle <= high)]
        torque = piece.signals["pinion_torque"][inside] - ours.over(angle, "pinion_torque")
        if angle.size:
            pieces.append(Pass(piece.direction, {"pinion_angle": angle, "pinion_torque": torque}))
    return pieces


def compared_with_own(result: Result) -> list[AgainstMeasured] | None:
    """Compare a result with the measured torque that it keeps; None if it keeps none."""
    if result.measured is None:
        return None
    return compare_with_measured(result.measured, result.signals, result.gear.pinion.teeth)


def compare_with_measured(measured: MeasuredTorque, signals: Signals, teeth: int) -> list[AgainstMeasured]:
    """Compare the torques in each direction in which both were recorded, +X first: at common angles, or where
    the simulation covers a turn at all measured ones. Measured rows at a reversal are left out.

    Args:
        measured: with `pinion_angle` [rad] and `pinion_torque` [N m], shape (n,).
        signals: those of a result, shape (m,) each; [] results where they have no pinion torque.
        teeth: of the pinion, for the ripple's period.

    Examples:
        >>> from rps_exudyn.results.result import MeasuredTorque
        >>> result = rps.run("free-pinion-torque", fidelity="quasi-static")
        >>> itself = MeasuredTorque("itself", result.signals)
        >>> [each.direction for each in rps.compare_with_measured(itself, result.signals, 6)]
        [1]
    """
    check_kind("measured", measured, MeasuredTorque, "a curve of read_measured_torque")
    check_kind("signals", signals, Mapping, "the signals of a result")
    compared: list[AgainstMeasured] = []
    for direction in (+1, -1) if "pinion_torque" in signals else ():
        ours, theirs = (longest_pass(each, direction) for each in (signals, measured.signals))
        if ours is None or theirs is None:
            continue
        begin = rows_at_reversal(theirs) if _opposes_motion(signals) else 0
        theirs = Pass(direction, {name: values[begin:] for name, values in theirs.signals.items()})
        turns = np.unique(turns_onto(theirs.angle, ours.angle))
        angle = common_angles(theirs.angle, np.concatenate([ours.angle - TURN * turn for turn in turns]))
        angle = angle[np.diff(angle, prepend=-np.inf) > SAME_ANGLE]
        if angle.size < FEWEST:
            continue
        simulated = ours.over(angle + TURN * turns_onto(angle, ours.angle), "pinion_torque")
        curves = [theirs.over(angle, "pinion_torque"), simulated]
        compared.append(
            AgainstMeasured(
                direction,
                (float(angle[0]), float(angle[-1])),
                (float(ours.angle.min()), float(ours.angle.max())),
                signal_pair("pinion_torque", angle, *curves),
                *(describe_torque(angle, torque, teeth) for torque in curves),
            )
        )
    return compared
