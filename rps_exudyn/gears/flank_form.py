"""Wanted modifications and errors of the pinion's flanks: deviations from the perfect involute helicoid.

Deviations are measured as gear testers do (ISO 1328-1): in the transverse section, along the line of
action, which is the tangent e_t at the base circle; positive where there is more material than designed.
Pitch and lead error turn the sections of a tooth: they move both of its flanks the same way.
"""

from dataclasses import dataclass, fields

import numpy as np

from rps_exudyn.gears.flank_grid import FlankGrid, measured_flanks
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.pitch_errors import pinion_errors
from rps_exudyn.parameters.gear import SteeringGear


@dataclass(frozen=True)
class FlankForm:
    """Deviations of a flank; all zero for the perfect one. Lengths [m]."""

    tip_relief: float = 0.0  # taken off at the tip
    tip_relief_length: float = 1e-3  # length of roll from the tip over which it fades out, parabolically
    crowning: float = 0.0  # taken off at both end faces, parabolically
    profile_slope: float = 0.0  # f_Halpha: surplus at the tip, linear from the form circle
    pitch_error: float = 0.0  # f_pt: shift of tooth 0 along the reference circle, polar angle ascending
    pitch_errors: tuple[float, ...] = ()  # the same of every tooth
    grid: FlankGrid | None = None  # as measured, normal to the flank
    lead_error: float = 0.0  # f_Hbeta: over the face width; > 0 where the helix angle is too large

    @classmethod
    def of(cls, gear: SteeringGear) -> "FlankForm":
        """The form of a gear's pinion."""
        own = {each.name: getattr(gear.pinion, each.name) for each in fields(cls) if each.name != "grid"}
        errors = tuple(pinion_errors(gear).tolist())
        return cls(**own | {"pitch_errors": errors, "grid": measured_flanks(gear).pinion})

    def deviation(
        self, q: np.ndarray, Z: np.ndarray | float, ends: tuple[float, float], face_width: float
    ) -> np.ndarray:
        """Surplus along the transverse tangent at tangent length q and axial position Z [m], but for the
        measured grid's, which differs from flank to flank.

        `ends` are the tangent lengths of form and tip circle [m].
        """
        q0, qa = ends
        into_relief = np.maximum(1 - (qa - q) / self.tip_relief_length, 0)
        across = 2 * np.asarray(Z) / face_width
        rise = (q - q0) / (qa - q0)
        return self.profile_slope * rise - self.tip_relief * into_relief**2 - self.crowning * across**2

    def turns(self, pair: GearPair) -> np.ndarray:
        """Angles by which the pitch errors displace the teeth, (z,) [rad]."""
        shifts = np.array(self.pitch_errors or np.zeros(pair.teeth))
        shifts[0] += self.pitch_error
        return shifts / pair.reference_radius

    def twist(self, pair: GearPair) -> float:
        """Turn of the transverse section per axial length, lead error included [rad/m].

        Over the face width the flank leaves the designed one by f_Hbeta along the line of action. A spur
        gear's error counts as a positive helix angle does.
        """
        hand = -1 if pair.beta_p < 0 else 1
        return pair.twist + hand * self.lead_error / (pair.base_radius * pair.face_width)
