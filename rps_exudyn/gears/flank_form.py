"""Wanted modifications and errors of the pinion's flanks, off the perfect involute helicoid.

Deviations are measured as gear testers do (ISO 1328-1): in the transverse section, along the line of
action, which is the tangent e_t at the base circle; positive where there is more material than designed.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rps_exudyn.parameters import SteeringGear

if TYPE_CHECKING:
    from rps_exudyn.gears.helicoid import Flank


@dataclass(frozen=True)
class FlankForm:
    """What is taken off or added; all zero for the perfect flank. Lengths [m]."""

    tip_relief: float = 0.0  # taken off at the tip
    tip_relief_length: float = 1e-3  # length of roll from the tip over which it fades out, parabolically
    crowning: float = 0.0  # taken off at both end faces, parabolically
    profile_slope: float = 0.0  # f_Halpha: surplus at the tip, linear from the form circle
    pitch_error: float = (
        0.0  # f_pt: tooth 0 is displaced by it along the reference circle, polar angle ascending
    )

    @classmethod
    def of(cls, gear: SteeringGear) -> "FlankForm":
        pinion = gear.pinion
        return cls(
            pinion.tip_relief,
            pinion.tip_relief_length,
            pinion.crowning,
            pinion.profile_slope,
            pinion.pitch_error,
        )

    def deviation(self, flank: "Flank", q: np.ndarray, Z: np.ndarray | float) -> np.ndarray:
        """Surplus along the transverse tangent at tangent length q and axial position Z [m]."""
        q0, qa = flank.form_tangent_length, flank.tip_tangent_length
        into_relief = np.maximum(1 - (qa - q) / self.tip_relief_length, 0)
        across = 2 * np.asarray(Z) / flank.pair.face_width
        rise = (q - q0) / (qa - q0)
        return self.profile_slope * rise - self.tip_relief * into_relief**2 - self.crowning * across**2

    def turn(self, flank: "Flank") -> float:
        """Angle by which the pitch error displaces this tooth [rad]."""
        is_first = flank.tooth % flank.pair.teeth == 0
        return self.pitch_error / flank.pair.reference_radius if is_first else 0.0
