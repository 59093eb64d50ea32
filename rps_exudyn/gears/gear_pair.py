"""How pinion and rack stand to each other: frames, radii, the active path of contact.

    Housing frame, origin where the pinion's nominal axis crosses the mesh's middle plane:

        Y ^                                  X  the rack's travel
          |      plunger, pushes along -Y    Y  from the pinion's axis to the rack
     -----+------------------ rack's axis    Z  X x Y, along the pinion for parallel axes
     /\\/\\/\\/\\/\\/\\/\\/\\/\\/\\ teeth, tips down
          P  pitch point, r_p above the axis
     .....O..... pinion axis k               X ->

    Pinion axis   k = cos(delta) Z + sin(delta) X,  delta = beta_r - beta_p (+ the installation's angle error)
    Pinion frame  (e, Y, k),                        e = cos(delta) X - sin(delta) Z
    Tooth trace   w = sin(beta_r) X + cos(beta_r) Z = sin(beta_p) e + cos(beta_p) k  at the pitch point
    Rack's cross direction of the teeth            u = cos(beta_r) X - sin(beta_r) Z

The pinion angle phi counts positive when the rack moves along +X, which is a rotation of -phi about k.
At phi = 0 and rack displacement 0 a tooth space of the pinion and a tooth of the rack are centred at P.
Symbols follow ISO 21771; formulas without a source are derived in the geometry page of the documentation.
"""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from rps_exudyn.gears.course import Course, Function, Mesh, course_of
from rps_exudyn.parameters.gear import SteeringGear


@dataclass(frozen=True)
class GearPair:
    """Lengths [m] and angles [rad] of one pinion with its rack."""

    teeth: int
    module: float  # normal module m_n
    alpha_n: float
    beta_p: float
    beta_r: float
    profile_shift: float
    tip_radius: float
    face_width: float
    rack_addendum: float  # h_aP m_n
    rack_dedendum: float  # h_fP m_n
    fillet_radius: float  # rho_fP m_n
    bar_radius: float
    reference_height: float
    angle_error: float
    axis_offset: float
    runout: float
    runout_angle: float
    course: Course | None = None  # of a variable ratio

    @classmethod
    def of(cls, gear: SteeringGear) -> "GearPair":
        """The pair of a gear; equal pairs are one object, which keeps what it has computed."""
        pinion, rack, m = gear.pinion, gear.rack, gear.pinion.normal_module
        pair = cls(
            teeth=pinion.teeth,
            module=m,
            alpha_n=pinion.pressure_angle,
            beta_p=pinion.helix_angle,
            beta_r=rack.tooth_angle,
            profile_shift=pinion.profile_shift,
            tip_radius=pinion.tip_diameter / 2,
            face_width=pinion.face_width,
            rack_addendum=gear.basic_rack.addendum * m,
            rack_dedendum=gear.basic_rack.dedendum * m,
            fillet_radius=gear.basic_rack.fillet_radius * m,
            bar_radius=rack.bar_diameter / 2,
            reference_height=rack.reference_height,
            angle_error=gear.installation.angle_error,
            axis_offset=gear.installation.axis_offset,
            runout=pinion.runout,
            runout_angle=pinion.runout_angle,
        )
        if not rack.ratio.is_constant:
            pair = replace(pair, course=course_of(rack.ratio, pair.design_mesh, float(pair.gain)))
        return _shared(pair)

    @cached_property
    def design(self) -> "GearPair":
        """The pair without runout and errors of installation: what gears of one design have in common."""
        return _shared(replace(self, angle_error=0.0, axis_offset=0.0, runout=0.0, runout_angle=0.0))

    @cached_property
    def centred(self) -> "GearPair":
        """The pair without runout."""
        return _shared(replace(self, runout=0.0, runout_angle=0.0))

    # --- pinion ------------------------------------------------------------------------------
    @cached_property
    def reference_radius(self) -> float:
        """r_p = z m_n / (2 cos beta_p)."""
        return self.teeth * self.module / (2 * np.cos(self.beta_p))

    @cached_property
    def alpha_t(self) -> float:
        """Transverse pressure angle."""
        return float(np.arctan(np.tan(self.alpha_n) / np.cos(self.beta_p)))

    @cached_property
    def base_radius(self) -> float:
        """r_b = r_p cos(alpha_t)."""
        return self.reference_radius * np.cos(self.alpha_t)

    @cached_property
    def beta_b(self) -> float:
        """Base helix angle."""
        return float(np.arcsin(np.sin(self.beta_p) * np.cos(self.alpha_n)))

    @cached_property
    def twist(self) -> float:
        """Turn of the transverse section per axial length, tan(beta_p) / r_p [rad/m]."""
        return float(np.tan(self.beta_p) / self.reference_radius)

    @cached_property
    def root_radius(self) -> float:
        """Radius of the root circle that the cutter leaves."""
        return self.reference_radius + self.profile_shift * self.module - self.rack_dedendum

    @cached_property
    def eccentricity(self) -> np.ndarray:
        """Gear centre from the axis of rotation, in the turning pinion frame, shape (3,).

        At pinion angle phi the centre stands runout * cos(phi + runout_angle) towards the rack.
        """
        return self.runout * np.array([np.sin(self.runout_angle), np.cos(self.runout_angle), 0])

    # --- rack --------------------------------------------------------------------------------
    @cached_property
    def design_mesh(self) -> Mesh:
        """What the pinion at its designed shaft angle makes of a gain."""
        tip_length = float(np.sqrt(max(self.tip_radius**2 - self.base_radius**2, 0.0)))
        return Mesh(float(self.base_radius), self.beta_b, self.beta_r - self.beta_p, tip_length)

    def travel_at(self, angle: Function) -> Any:
        """The perfect rack's travel X at pinion angles [rad], of their shape [m]."""
        return self.gain * angle if self.course is None else self.course.travel(angle)

    def gain_at(self, angle: Function) -> Any:
        """Rack travel per radian at pinion angles [rad]: one number of a constant ratio [m/rad]."""
        return self.gain if self.course is None else self.course.gain(angle)

    @cached_property
    def travel_rule(self) -> Any:
        """The gain [m/rad], or of a variable ratio the travel as a function of the pinion's angle."""
        return float(self.gain) if self.course is None else self.course.travel

    def angle_at(self, travel: Function) -> Any:
        """The pinion's angle at a travel of the perfect rack [m], of its shape [rad]."""
        return travel / self.gain if self.course is None else self.course.angle(travel)

    @cached_property
    def gain(self) -> float:
        """Rack travel per radian of pinion, z m_n / (2 cos beta_r), or in the middle of a course [m/rad]."""
        if self.course is not None:
            return float(self.course.gain(0.0))
        return self.teeth * self.module / (2 * np.cos(self.beta_r))

    @property
    def least_gain(self) -> float:
        """Least rack travel per radian of pinion along the travel [m/rad]."""
        return float(self.gain if self.course is None else self.course.gain(self.course.places).min())

    @cached_property
    def normal_base_pitch(self) -> float:
        """p_bn = pi m_n cos(alpha_n)."""
        return np.pi * self.module * np.cos(self.alpha_n)

    @cached_property
    def rack_pitch(self) -> float:
        """Distance of the rack's teeth along X, in the middle of a variable ratio."""
        if self.course is not None:
            return self.gain * 2 * np.pi / self.teeth
        return np.pi * self.module / np.cos(self.beta_r)

    @cached_property
    def reference_line_height(self) -> float:
        """Y of the rack's reference line above the pinion's axis: r_p + x m_n."""
        return self.reference_radius + self.profile_shift * self.module

    @cached_property
    def bar_axis_height(self) -> float:
        """Y of the bar's axis above the pinion's axis."""
        return self.reference_line_height + self.reference_height

    # --- directions in the housing frame -----------------------------------------------------
    @cached_property
    def delta(self) -> float:
        """Shaft angle as installed: beta_r - beta_p + angle error."""
        return self.beta_r - self.beta_p + self.angle_error

    @cached_property
    def pinion_frame(self) -> np.ndarray:
        """Columns e, Y, k: pinion frame -> housing frame, shape (3, 3)."""
        c, s = np.cos(self.delta), np.sin(self.delta)
        return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])

    @cached_property
    def pinion_origin(self) -> np.ndarray:
        """Middle of the gear on the axis of rotation, housing frame, shape (3,)."""
        return np.array([0.0, self.axis_offset, 0.0])

    @cached_property
    def trace(self) -> np.ndarray:
        """w, direction of the rack's teeth, shape (3,)."""
        return np.array([np.sin(self.beta_r), 0, np.cos(self.beta_r)])

    @cached_property
    def cross_trace(self) -> np.ndarray:
        """u, across the rack's teeth, shape (3,)."""
        return np.array([np.cos(self.beta_r), 0, -np.sin(self.beta_r)])

    def rack_flank_normal(self, side: int) -> np.ndarray:
        """Return the outward unit normal of the rack flank that touches pinion flank `side`, shape (3,).

        Side -1 drives the rack towards +X (drive flank), side +1 towards -X (coast flank); it is the sign
        of the pinion flank's outward normal along its own transverse tangent, see `helicoid`.
        """
        return side * np.cos(self.alpha_n) * self.cross_trace - np.sin(self.alpha_n) * np.array([0.0, 1, 0])

    # --- path of contact -----------------------------------------------------------------------
    @cached_property
    def active_path(self) -> tuple[float, float]:
        """q0, qa: ends of the path of contact (ISO 21771) from the pitch point, transverse section [m].

        q0 is where the rack's tips (or the base circle) end it, qa where the pinion's tips do.
        """
        tip_line = (self.profile_shift * self.module - self.rack_addendum) / np.sin(self.alpha_t)
        q0 = max(tip_line, -self.base_radius * np.tan(self.alpha_t))
        qa = np.sqrt(max(self.tip_radius**2 - self.base_radius**2, 0)) - self.reference_radius * np.sin(
            self.alpha_t
        )
        return float(q0), float(qa)

    @cached_property
    def overlap_ratio(self) -> float:
        """epsilon_beta."""
        return float(self.face_width * abs(np.sin(self.beta_p)) / (np.pi * self.module))

    # --- sliding -----------------------------------------------------------------------------
    def friction_lever(self, q: np.ndarray | float) -> np.ndarray:
        """Sliding speed over pinion speed at q on the path of contact [m].

        l(q) = sqrt(l_s^2 + q^2 + 2 q l_s sin(alpha_t) sin(beta_p)), l_s = -r_p sin(delta) / cos(beta_r).
        """
        ls = -self.reference_radius * np.sin(self.delta) / np.cos(self.beta_r)
        return np.sqrt(
            ls**2 + np.square(q) + 2 * np.asarray(q) * ls * np.sin(self.alpha_t) * np.sin(self.beta_p)
        )

    @cached_property
    def least_sliding(self) -> float:
        """Smallest friction lever in mesh [m]; at least a tenth of the mean, for parallel axes."""
        levers = self.friction_levers
        return float(max(levers.min(), 0.1 * levers.mean()))

    @cached_property
    def friction_levers(self) -> np.ndarray:
        """Friction levers at points of the path of contact [m]."""
        return self.friction_lever(np.linspace(*self.active_path, 201))


@lru_cache(maxsize=64)
def _shared(pair: GearPair) -> GearPair:
    return pair
