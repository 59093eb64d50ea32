"""The root that the basic rack's rounded tip generates between two teeth, in closed form.

Transverse section, tooth space centred on +Y. The cutter's tooth stands at X = 0 when the pinion is at
angle 0, its pitch line at Y = 0, Y outwards. A point (X, Y) of its tip with normal n cuts its final point
when that normal passes through the pitch point (law of gearing), r phi = Y n_x / n_y - X, at

    x = (X + r phi) cos phi - (r + Y) sin phi,   y = (X + r phi) sin phi + (r + Y) cos phi.

`eta` runs along the rounding: alpha_n at C1, where the straight flank ends, to pi/2 at the flat tip.
Where the root meets the involute is the *form point*. Without undercut it is the point that C1 generates;
with undercut the trochoid crosses the involute further out.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from rps_exudyn.gears.basic_rack import arc_segments, cutter_tip_centre, half_angle, sagitta, straight_depth
from rps_exudyn.gears.gear_pair import GearPair


class FormPoint(NamedTuple):
    """The point where involute and trochoid meet."""

    eta: float  # of the trochoid [rad]
    tangent_length: float  # of the involute, q_form [m]
    radius: float  # R_form = sqrt(r_b^2 + q_form^2) [m]
    undercut: bool


def trochoid(pair: GearPair, eta: np.ndarray | float) -> np.ndarray:
    """Right half of the root, transverse points [m], shape (..., 2)."""
    along, height, phi = _generation(pair, np.asarray(eta, dtype=float))
    return np.stack(
        [along * np.cos(phi) - height * np.sin(phi), along * np.sin(phi) + height * np.cos(phi)], axis=-1
    )


def _generation(pair: GearPair, eta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return X + r phi, r + Y [m] and phi [rad] at which points of the cutter's tip cut."""
    u, y = cutter_tip_centre(pair)
    rho, cos_beta = pair.fillet_radius, np.cos(pair.beta_p)
    X = (u + rho * np.cos(eta)) / cos_beta
    Y = y - rho * np.sin(eta) + pair.profile_shift * pair.module
    roll = -Y * np.cos(eta) * cos_beta / np.sin(eta) - X  # r phi; the normal is (cos eta cos beta, -sin eta)
    return X + roll, pair.reference_radius + Y, roll / pair.reference_radius


def root_section(pair: GearPair) -> tuple[float, float]:
    """Return the root's section of ISO 6336-3, where it leans 30 degrees against the middle of its tooth.

    Distance from the pinion's axis along the tooth's middle, and half the thickness there, transverse [m];
    those of the fillet's end where none of it leans as much.
    """
    middle = np.pi / pair.teeth  # of the next tooth, from +Y

    def lean(eta: float) -> float:
        phi = float(_generation(pair, np.asarray(eta))[2])
        return np.arctan2(np.sin(eta), np.cos(eta) * np.cos(pair.beta_p)) - phi - middle - np.radians(30)

    low, high = form_point(pair).eta, np.pi / 2
    if lean(low) < 0 < lean(high):
        from scipy.optimize import brentq  # loads in a third of a second

        eta = float(brentq(lean, low, high, xtol=1e-12))
    else:
        eta = low if lean(low) >= 0 else high
    x, y = trochoid(pair, eta)
    along = np.array([np.sin(middle), np.cos(middle)])
    across = np.array([np.cos(middle), -np.sin(middle)])
    return float(along @ [x, y]), abs(float(across @ [x, y]))


def form_point(pair: GearPair) -> FormPoint:
    """The point where the pinion's involute ends and its root begins.

    Raises:
        ValueError: undercut leaves nothing of the involute.
    """
    return _form_point(pair.design)


@lru_cache(maxsize=64)
def _form_point(pair: GearPair) -> FormPoint:
    r, rb = pair.reference_radius, pair.base_radius
    height = pair.profile_shift * pair.module - straight_depth(pair)  # of C1 above the pitch line
    q = r * np.sin(pair.alpha_t) + height / np.sin(pair.alpha_t)
    if q >= 0:
        return FormPoint(pair.alpha_n, q, float(np.hypot(rb, q)), undercut=False)
    from scipy.optimize import brentq  # loads in a third of a second

    def gap(eta: float) -> float:  # of the trochoid from the involute, as an angle at the same radius
        x, y = trochoid(pair, eta)
        return float(np.arctan2(x, y) - (np.pi / pair.teeth - half_angle(pair, float(np.hypot(x, y)))))

    start = pair.alpha_n
    at_base = float(brentq(lambda eta: np.hypot(*trochoid(pair, eta)) - rb, start, np.pi / 2, xtol=1e-15))
    if not gap(start) * gap(at_base) < 0:
        raise ValueError("the undercut leaves no involute")
    eta = float(brentq(gap, start, at_base, xtol=1e-15))
    radius = float(np.hypot(*trochoid(pair, eta)))
    return FormPoint(eta, float(np.sqrt(radius**2 - rb**2)), radius, undercut=True)


def root_profile(pair: GearPair, chord_error: float) -> np.ndarray:
    """The whole root of a tooth space, form point to form point, shape (n, 2), polar angle ascending [m].

    Chords stay within `chord_error` [m].
    """
    start = form_point(pair).eta
    right = trochoid(pair, np.linspace(start, np.pi / 2, 1 + _segments(pair, start, chord_error)))
    flat = np.arctan2(*right[-1])  # half angle of the root circle's arc, from +Y
    n = arc_segments(pair.root_radius, 2 * flat, chord_error)
    angle = np.linspace(flat, -flat, n + 1)[1:-1]
    arc = pair.root_radius * np.stack([np.sin(angle), np.cos(angle)], axis=-1)
    return np.concatenate([right, arc, right[::-1] * [-1, 1]])


def _segments(pair: GearPair, start: float, chord_error: float) -> int:
    """Chords for the trochoid: the deviation measured on a trial division falls with 1 / n^2."""
    trial = 64
    height = sagitta(trochoid(pair, np.linspace(start, np.pi / 2, 2 * trial + 1)), 0)
    return max(int(np.ceil(trial * np.sqrt(height / chord_error))), 2)
