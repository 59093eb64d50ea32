"""All orders of a curve over the pinion angle, and the torques that the losses take."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rps_exudyn.analysis.harmonics import LEAST_PER_PERIOD, harmonics
from rps_exudyn.analysis.work_balance import PLACES


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Terms of values ~ sum of amplitude cos(order angle + phase), shape (n,); amplitude[0] is the mean."""

    orders: np.ndarray  # 0, 1, .. periods per revolution
    amplitude: np.ndarray  # in the unit of the values
    phase: np.ndarray  # at the centre position, in (-pi, pi] [rad]


def order_spectrum(angle: np.ndarray, values: np.ndarray, highest: int) -> Spectrum | None:
    """Orders 0 to `highest`, or as far as the recorded points resolve them; None without a whole revolution.

    Angles [rad] rise or fall, shape (n,).
    """
    found = harmonics(angle, values, 2 * np.pi, highest)
    if found is None:
        return None
    resolved = int(2 * np.pi / np.abs(np.diff(angle)).max() / LEAST_PER_PERIOD * (1 + 1e-9))
    found = found[: resolved + 1]
    return Spectrum(np.arange(found.size), np.abs(found), np.angle(found))


def loss_torques(signals: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Place -> work lost there per angle turned, shape (n,) [N m]; for a record in one direction.

    Their sum is the drive's torque except for what is stored and what a load takes or gives.
    """
    turned = np.abs(signals["pinion_angle"] - signals["pinion_angle"][0])
    return {
        place: sum((np.gradient(signals[name], turned) for name in present), start=np.zeros_like(turned))
        for place, names in PLACES.items()
        if (present := [name for name in names if name in signals])
    }
