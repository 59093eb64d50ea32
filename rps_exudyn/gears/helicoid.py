"""Analytic flank of the pinion: an involute helicoid, ruled by straight generators.

Pinion frame (e, Y, k): origin in the middle of the gear, z along the gear's axis, pinion angle 0.
With e_r(psi), e_t(psi) the polar unit vectors, the flank of tooth m, side s = +-1, is

    P(psi, Z) = r_b e_r + s q e_t + Z e_z,     q = s r_b (Theta - psi - Z twist)  tangent length, >= 0
    Theta     = pi/2 + pi/z + 2 pi m / z + s (s_t / (2 r_p) + inv alpha_t)
    n         = s (cos beta_b e_t + sin beta_b e_z)                               out of the tooth

so that psi = const is a straight generator with one normal all along it, R^2 = r_b^2 + q^2, the area
element is dA = q / cos beta_b dpsi dZ and the radius of curvature across the generators q / cos beta_b.
Side -1 is the flank that drives the rack towards +X. Turning the pinion by phi adds -phi to Theta and psi.

A modified flank (relief, crowning, errors: `FlankForm`) is displaced within its transverse section, along
e_t, so that the end faces stay plane. Pitch and lead error leave it a helicoid, with Theta and twist changed.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from rps_exudyn.gears.basic_rack import arc_segments, half_angle
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.trochoid import form_point, root_profile


def root_angle(pair: GearPair, tooth: int, side: int) -> float:
    """Angle Theta of a perfect involute's root on the base circle at Z = 0 [rad]."""
    centre = np.pi / 2 + np.pi / pair.teeth * (1 + 2 * tooth)
    return float(centre + side * half_angle(pair, pair.base_radius))


@dataclass(frozen=True)
class Flank:
    """One flank of the pinion."""

    pair: GearPair
    tooth: int
    side: int  # -1 drives the rack towards +X, +1 towards -X
    form: FlankForm = field(default_factory=FlankForm)

    @cached_property
    def theta(self) -> float:
        """Angle Theta of the involute's root on the base circle at Z = 0 [rad]."""
        turn = self.form.turns(self.pair)[self.tooth % self.pair.teeth]
        return root_angle(self.pair, self.tooth, self.side) + float(turn)

    @cached_property
    def twist(self) -> float:
        """Turn of the transverse section per axial length [rad/m]."""
        return self.form.twist(self.pair)

    @cached_property
    def beta_b(self) -> float:
        """Base helix angle [rad]."""
        return float(np.arctan(self.pair.base_radius * self.twist))

    # --- limits --------------------------------------------------------------------------------
    @cached_property
    def form_tangent_length(self) -> float:
        """Tangent length where the trochoid of the root begins [m]."""
        return form_point(self.pair).tangent_length

    @cached_property
    def tip_tangent_length(self) -> float:
        """Tangent length at the tip circle [m]."""
        return float(np.sqrt(self.pair.tip_radius**2 - self.pair.base_radius**2))

    # --- coordinates ---------------------------------------------------------------------------
    def tangent_length(self, psi: np.ndarray | float, Z: np.ndarray | float) -> np.ndarray:
        """Tangent length q [m]."""
        return np.asarray(self.side * self.pair.base_radius * (self.theta - psi - Z * self.twist))

    def generator(self, q: np.ndarray | float, Z: np.ndarray | float) -> np.ndarray:
        """Angle psi of the generator through (q, Z) [rad]."""
        return np.asarray(self.theta - Z * self.twist - self.side * q / self.pair.base_radius)

    # --- surface -------------------------------------------------------------------------------
    def point(self, psi: np.ndarray | float, Z: np.ndarray | float) -> np.ndarray:
        """Points of the flank, modifications included, pinion frame [m], shape (..., 3)."""
        q = self.tangent_length(psi, Z)
        psi, Z = np.broadcast_arrays(psi, Z)
        ends = self.form_tangent_length, self.tip_tangent_length
        surplus = self.form.deviation(q, Z, ends, self.pair.face_width)
        if self.form.grid is not None:  # normal to the flank -> along the tangent
            tooth = self.tooth % self.pair.teeth
            surplus = surplus + self.form.grid.at(q, Z, tooth, self.side) / np.cos(self.beta_b)
        along = self.side * (q + surplus)
        c, s, rb = np.cos(psi), np.sin(psi), self.pair.base_radius
        return np.stack([rb * c - along * s, rb * s + along * c, Z], axis=-1)

    def normal(self, psi: np.ndarray | float) -> np.ndarray:
        """Unit normals out of the tooth, of the helicoid, shape (..., 3)."""
        psi = np.asarray(psi, dtype=float)
        cb, sb = np.cos(self.beta_b), np.sin(self.beta_b)
        return self.side * np.stack([-cb * np.sin(psi), cb * np.cos(psi), np.full_like(psi, sb)], axis=-1)

    def area_element(self, psi: np.ndarray | float, Z: np.ndarray | float) -> np.ndarray:
        """Area element dA / (dpsi dZ) = q / cos beta_b, and radius of curvature across the generator [m]."""
        return self.tangent_length(psi, Z) / np.cos(self.beta_b)

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Signed distance of points (..., 3) from the helicoid, positive outside the tooth [m].

        Exact: the parallel surfaces of an involute helicoid are the same helicoid, turned. Points inside
        the base cylinder are taken on it.
        """
        x, y, Z = np.moveaxis(np.asarray(points, dtype=float), -1, 0)
        rb, s = self.pair.base_radius, self.side
        q = np.sqrt(np.maximum(x**2 + y**2 - rb**2, 0))
        root = np.arctan2(y, x) + s * (q / rb - np.arctan2(q, rb)) + Z * self.twist
        turn = np.remainder(root - self.theta + np.pi, 2 * np.pi) - np.pi
        return s * rb * turn * np.cos(self.beta_b)


def transverse_profile(pair: GearPair, chord_error: float) -> np.ndarray:
    """Transverse section at Z = 0: a closed polygon, counter-clockwise, shape (n, 2) [m].

    It begins in the tooth space centred on +Y; the same polygon turned by -Z twist is the section at Z.
    Chords stay within `chord_error` [m].
    """
    tooth = tooth_profile(pair, chord_error)
    angle = 2 * np.pi / pair.teeth * np.arange(pair.teeth)
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    x, y = tooth[:, 0], tooth[:, 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1).reshape(-1, 2)


def tooth_profile(pair: GearPair, chord_error: float) -> np.ndarray:
    """The root of the space on +Y and the tooth beyond it, one pitch of the section, shape (n, 2) [m]."""
    rising, falling = Flank(pair, 0, -1), Flank(pair, 0, +1)
    q0, qa = rising.form_tangent_length, rising.tip_tangent_length
    n = max(int(np.ceil((qa - q0) / (pair.base_radius * generator_step(pair, chord_error)))), 1)
    q = np.linspace(q0, qa, n + 1)
    up = rising.point(rising.generator(q, 0.0), 0.0)[:, :2]
    down = falling.point(falling.generator(q, 0.0), 0.0)[::-1, :2]
    return np.concatenate([root_profile(pair, chord_error)[1:-1], up, crest_profile(pair, chord_error), down])


def crest_profile(pair: GearPair, chord_error: float) -> np.ndarray:
    """Inner points of tooth 0's crest on the tip circle at Z = 0, polar angle ascending, shape (n, 2) [m]."""
    half, middle = float(half_angle(pair, pair.tip_radius)), np.pi / 2 + np.pi / pair.teeth
    n = arc_segments(pair.tip_radius, 2 * half, chord_error)
    angle = middle + half * np.linspace(-1, 1, n + 1)[1:-1]
    return pair.tip_radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def generator_step(pair: GearPair, chord_error: float) -> float:
    """Angle between generators whose flat strips stay within `chord_error` [m] of the flank [rad].

    The strip's sagitta is rho (dpsi cos beta_b)^2 / 8 with rho = q / cos beta_b, largest at the tip.
    """
    q = np.sqrt(pair.tip_radius**2 - pair.base_radius**2)
    return float(np.sqrt(8 * chord_error / (q * np.cos(pair.beta_b))))
