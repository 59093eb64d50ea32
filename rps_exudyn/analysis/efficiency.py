"""The load test's efficiencies (IS 13476): a weight on the rack, raised and lowered by the pinion.

With the weight's force W, the rack's travel s' per radian and mean torques T_f raising, T_r holding while
it is lowered:

    forward = W s' / T_f        reverse = T_r / (W s')

gross, as the standard measures them; net with the free torque T_0 tared, W s' / (T_f - T_0) and
(T_r + T_0) / (W s'). While both flanks touch, T_f - T_r = 2 T_0 nearly, and the ratio reverse / forward is
1 - (T_0 / W s')^2: heavier weights look better. Means are over whole tooth pitches. Numbers below 0 and
above 1 are no efficiencies, see `LoadTest.remarks`.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from rps_exudyn.analysis.passes import Signals, both_directions, longest_pass, passes, whole_periods
from rps_exudyn.analysis.torque import mean
from rps_exudyn.results.outcome import Code, Remark

LEFT = 0.1  # of the free torque, to be left of a torque from which it is tared: means are right to 0.5 %


@dataclass(frozen=True)
class LoadTest:
    """Torques of a weight on the rack, raised and lowered, and the efficiencies (IS 13476) from them."""

    load: float  # the weight's force [N]
    ideal_torque: float  # load times rack gain [N m]
    torque_forward: float  # raising [N m]
    torque_reverse: float  # holding while it is lowered; negative: the weight cannot drive the gear [N m]
    free_torque: float  # without the weight [N m]

    @property
    def efficiency_forward(self) -> float:
        """W s' / T_f, gross."""
        return self.ideal_torque / self.torque_forward

    @property
    def efficiency_reverse(self) -> float:
        """T_r / (W s'), gross."""
        return self.torque_reverse / self.ideal_torque

    @property
    def efficiency_forward_net(self) -> float:
        """W s' / (T_f - T_0), with the free torque tared."""
        return self.ideal_torque / self.tared["forward"]

    @property
    def efficiency_reverse_net(self) -> float:
        """(T_r + T_0) / (W s'), with the free torque tared."""
        return self.tared["reverse"] / self.ideal_torque

    @property
    def tared(self) -> dict[str, Any]:
        """What is left of the torques without the free torque, "forward" and "reverse" [N m]."""
        return {
            "forward": self.torque_forward - self.free_torque,
            "reverse": self.torque_reverse + self.free_torque,
        }

    @property
    def cancels(self) -> dict[str, Any]:
        """Whether that is too little for a net efficiency."""
        return {way: np.abs(left) < LEFT * self.free_torque for way, left in self.tared.items()}

    @property
    def efficiency_ratio(self) -> float:
        """Reverse over forward, gross; the paper asks for 0.9."""
        return self.efficiency_reverse / self.efficiency_forward

    @property
    def self_locking(self) -> bool:
        """Return whether the weight cannot drive the gear: it must be pushed down."""
        return self.torque_reverse < 0

    def remarks(self) -> Iterator[Remark]:
        """Yield why a number that is called efficiency is none, sentences without a full stop."""
        lost = {
            "forward": self.torque_forward - self.ideal_torque,  # while it is raised
            "reverse": self.ideal_torque - self.torque_reverse,  # while it is lowered
        }
        if self.self_locking:
            yield Remark(
                Code.NO_EFFICIENCY,
                "the gear is self-locking: the weight must be pushed down with "
                f"{-self.torque_reverse:.4g} N m, for friction takes {lost['reverse']:.4g} N m and the "
                f"weight gives {self.ideal_torque:.4g}; efficiency_reverse and efficiency_ratio are below 0 "
                "and no efficiencies",
            )
        for way, does in (("forward", "raised"), ("reverse", "lowered")):
            if self.cancels[way]:
                yield Remark(
                    Code.NO_EFFICIENCY,
                    f"efficiency_{way}_net is omitted: while the weight is {does}, {self.tared[way]:.4g} N m "
                    f"of the torque are left without the free torque of {self.free_torque:.4g} N m",
                )
                continue
            net = getattr(self, f"efficiency_{way}_net")
            if not 0 <= round(net, 3) <= 1:
                yield Remark(
                    Code.NO_EFFICIENCY,
                    f"efficiency_{way}_net is {net:.1%} and no efficiency: while the weight is {does} "
                    f"friction takes {lost[way]:.4g} N m, and the free torque of {self.free_torque:.4g} N m "
                    "is tared",
                )


def measured_load_test(signals: Signals, load: Any, gain: Any, free_torque: Any, pitch: float) -> LoadTest:
    """Evaluate a record of raising (pinion angle rises) and lowering at the angles common to both.

    Means are over the whole tooth pitches from the smallest of these angles; over all of them, if they are
    less than one pitch. Of many gears load, gain and free torque are arrays, one number for each, and so are
    the numbers of the load test.

    Args:
        signals: pinion_angle [rad] and pinion_torque [N m], both directions.
        load: the weight's force on the rack towards -X [N], above zero.
        gain: rack travel per radian of pinion [m], or the travel as a function of its angle.
        free_torque: mean torque of the same gear without the weight [N m].
        pitch: pinion angle of a tooth [rad].

    Raises:
        ValueError: the record lacks one direction, or shares no angles.
    """
    if (both := both_directions(passes(signals))) is None:
        raise ValueError("a load test needs a record of raising and of lowering at common pinion angles")
    *directions, common = both
    angle = whole_periods(common, pitch)
    raising, lowering = (mean(angle, each.over(angle, "pinion_torque")) for each in directions)
    if callable(gain):
        gain = float(np.ptp(gain(angle)) / np.ptp(angle))
    return LoadTest(load, load * gain, raising, lowering, free_torque)


def free_torque_of(signals: Signals, pitch: float) -> float:
    """Mean size of the torque of a record in one direction, over whole tooth pitches if there is one [N m].

    Raises:
        ValueError: the record has no pass.
    """
    turned = longest_pass(signals, +1) or longest_pass(signals, -1)
    if turned is None:
        raise ValueError("a free torque needs a record in which the pinion turns")
    angle = whole_periods(np.sort(turned.angle), pitch)
    return abs(mean(angle, turned.over(angle, "pinion_torque")))


def describe_load_test(test: LoadTest) -> dict[str, float]:
    """Metrics, by their names there; no efficiencies without a load.

    Of many gears, nan is a net efficiency that one lacks.
    """
    torques = {
        "torque_forward": test.torque_forward,
        "torque_reverse": test.torque_reverse,
        "free_torque": test.free_torque,
    }
    if not np.all(np.asarray(test.load) > 0):
        return torques
    of_many = np.ndim(test.torque_forward) > 0
    gross = {f"efficiency_{name}": getattr(test, f"efficiency_{name}") for name in ("forward", "reverse")}
    net = {
        f"efficiency_{way}_net": np.where(cancels, np.nan, getattr(test, f"efficiency_{way}_net"))[()]
        for way, cancels in test.cancels.items()
        if of_many or not cancels
    }
    return torques | gross | net | {"efficiency_ratio": test.efficiency_ratio}
