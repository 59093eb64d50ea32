"""The supported pinion: its shaft on two bearings in a housing that yields, with axial float between stops.

Coordinates u of the shaft's axis where it crosses the middle of the mesh: displacements along e, Y and k of
the pinion's frame, small rotations about e and Y. At the station z of a bearing the axis is displaced by

    d = (u_e + z u_tilt_Y, u_Y - z u_tilt_e)

and with the radial clearance c/2 the bearing presses with K (|d| - c/2)+ against d; axially likewise with
half the float. The shaft needs no coordinates: each overhang is a cantilever off the rigid toothed part of
half-length h, in series with its bearing,

    1/K = 1/k + (l - h)^3 / (3 E I) + (l - h) / (kappa G A),        l = |z|, kappa = 0.886 of a round section,

which is exact for two bearings and loads on the toothed part (Timoshenko's beam). The housing's seat, of the
compliance C at the mesh, stands in series too: the pinion's place is p = u + C f(u), and forces m on the
pinion are balanced where m = f. By virtual work they act on u with (1 + C f'), so that no work is lost.

Within clearance and float, where nothing holds the shaft, a spring of a share of their stiffness does.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inline, record, record_type, stacked
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import mm
from rps_exudyn.forces.force_element import FRICTION_STATE, Part
from rps_exudyn.forces.friction import LAW, Patches, constant_law, slide, slide_slopes
from rps_exudyn.forces.rigid_motion import fill_rotation, turn_of
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.tooth_stiffness import POISSON_RATIO, YOUNGS_MODULUS
from rps_exudyn.parameters.declaration import numbers_in
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear

SIZE = 5  # coordinates of a supported pinion beside its rotation
CENTRING = 3e-5  # over the stiffness of what it stands for: 0.01 N at 15 um of the default bearings
SHEAR_FACTOR = 6 * (1 + POISSON_RATIO) / (7 + 6 * POISSON_RATIO)  # of a round section (Cowper 1966)
SEAT_VALUES = 6, 36  # of `housing.seat_stiffness`: its diagonal, or all rows


Numbers = np.ndarray | float

SUPPORT = record_type(
    [
        ("frame", "f8", (3, 3)),  # rows e, Y, k in the housing
        ("origin", "f8", (3,)),  # of the pinion, from the rack's reference point at rest [m]
        ("station", "f8", (2,)),  # of upper and lower bearing along k [m]
        ("stiffness", "f8", (2,)),  # of bearing and shaft in series [N/m]
        ("clearance", "f8", (2,)),  # radial, half the diametral one [m]
        # of a force on the input shaft: what it bends the shaft by at the upper bearing, along e and Y [m],
        # and itself on the pinion's place
        ("bent", "f8", (2,)),
        ("pressed", "f8", (SIZE,)),
        ("axial_stiffness", "f8"),  # [N/m]
        ("half_float", "f8"),  # [m]
        ("friction", "f8"),  # against axial motion [N]
        ("seat", "f8", (SIZE, SIZE)),  # compliance of the housing's seat
        ("law", LAW),
    ]
)
"""Record of the pinion's supports."""

OUTPUTS = (
    "pinion_across",
    "pinion_y",
    "pinion_axial",
    "upper_bearing_force",
    "lower_bearing_force",
    "axial_bearing_force",
    *FRICTION_STATE,
    *(f"mesh_on_{i}" for i in range(7 + SIZE)),  # forces of the teeth on pinion, rack and supports
)
PART = Part("support", (), OUTPUTS)


@inline
def held(u, data, force, slope):  # type: ignore[no-untyped-def]
    """Fill the elastic force of the supports (5,) against u (5,) and its derivative (5, 5); return the stored
    energy and the forces of upper, lower and axial bearing."""
    for i in range(SIZE):
        force[i] = 0.0
        for j in range(SIZE):
            slope[i, j] = 0.0
    energy, upper, lower = 0.0, 0.0, 0.0
    for b in range(2):
        z, gap, stiffness = data.station[b], data.clearance[b], data.stiffness[b]
        d_e, d_y = u[0] + z * u[4], u[1] - z * u[3]
        if b == 0:
            d_e, d_y = d_e + data.bent[0], d_y + data.bent[1]
        size = np.sqrt(d_e * d_e + d_y * d_y)
        centring = CENTRING * stiffness if gap > 0 else 0.0
        along, across = centring, centring
        pressed = max(size - gap, 0.0)
        n_e, n_y = (d_e / size, d_y / size) if size > 0 else (1.0, 0.0)
        if size > gap or gap == 0:
            along += stiffness
            across += stiffness * (pressed / size if size > 0 else 1.0)
        f_e, f_y = across * d_e, across * d_y
        k_ee = along * n_e * n_e + across * n_y * n_y
        k_yy = along * n_y * n_y + across * n_e * n_e
        k_ey = (along - across) * n_e * n_y
        energy += 0.5 * stiffness * pressed * pressed + 0.5 * centring * size * size
        if b == 0:
            upper = np.sqrt(f_e * f_e + f_y * f_y)
        else:
            lower = np.sqrt(f_e * f_e + f_y * f_y)
        force[0] += f_e
        force[4] += z * f_e
        force[1] += f_y
        force[3] -= z * f_y
        slope[0, 0] += k_ee
        slope[0, 1] += k_ey
        slope[1, 0] += k_ey
        slope[1, 1] += k_yy
        slope[0, 4] += z * k_ee
        slope[4, 0] += z * k_ee
        slope[4, 4] += z * z * k_ee
        slope[1, 3] -= z * k_yy
        slope[3, 1] -= z * k_yy
        slope[3, 3] += z * z * k_yy
        slope[0, 3] -= z * k_ey
        slope[3, 0] -= z * k_ey
        slope[1, 4] += z * k_ey
        slope[4, 1] += z * k_ey
        slope[3, 4] -= z * z * k_ey
        slope[4, 3] -= z * z * k_ey
    w, half = u[2], data.half_float
    beyond = max(abs(w) - half, 0.0)
    sense = 1.0 if w > 0 else -1.0
    force[2] = sense * data.axial_stiffness * beyond
    energy += 0.5 * data.axial_stiffness * beyond * beyond
    if beyond > 0 or half == 0:
        slope[2, 2] = data.axial_stiffness
    if half > 0:
        centring = CENTRING * data.axial_stiffness
        force[2] += centring * w
        slope[2, 2] += centring
        energy += 0.5 * centring * w * w
    for i in range(SIZE):
        for j in range(SIZE):
            energy += 0.5 * force[i] * data.seat[i, j] * force[j]
    return energy, upper, lower, force[2]


@inline
def place_of(u, v, data, force, slope, by_seat, p, p_rate):  # type: ignore[no-untyped-def]
    """Fill the pinion's place p = u + C f(u) (5,), its rates, and their derivative 1 + C f' (5, 5)."""
    for i in range(SIZE):
        p[i], p_rate[i] = u[i], 0.0
        for j in range(SIZE):
            p[i] += data.seat[i, j] * force[j]
            by_seat[i, j] = 1.0 if i == j else 0.0
            for k in range(SIZE):
                by_seat[i, j] += data.seat[i, k] * slope[k, j]
    for i in range(SIZE):
        for j in range(SIZE):
            p_rate[i] += by_seat[i, j] * v[j]


@inline
def axial_friction(rate, data, memory, out):  # type: ignore[no-untyped-def]
    """Friction against the shaft's axial rate; fills (power, work lost, energy stored) and returns the force
    and its derivative by the rate."""
    law = data.law
    if not law.has_state:
        out[0] = out[1] = out[2] = 0.0
        return 0.0, 0.0
    drag, _, stored, lost = slide(data.friction, rate, 0.0, law.place, law, memory)
    ahead, _, _, _, _, _, _, _ = slide_slopes(data.friction, rate, 0.0, 0.0, law.place, law, memory)
    out[0], out[1], out[2] = drag * rate, lost, stored
    return -drag, -ahead


@inline
def seen_from_pinion(place, rate, p, p_rate, data, carry):  # type: ignore[no-untyped-def]
    """Replace coordinates and rates of the rack (6,) by those that a rack has beside a pinion at its design
    place; fill `carry` (6, 11) with the derivatives by the rack's coordinates and the pinion's place."""
    e, y, frame = data.frame[0], data.frame[1], stacked((3, 3))
    turn, angles = stacked((3, 3)), stacked((3, 3))
    t = (p[3] * e[0] + p[4] * y[0], p[3] * e[1] + p[4] * y[1], p[3] * e[2] + p[4] * y[2])
    half = 0.5 * (t[0] * t[0] + t[1] * t[1] + t[2] * t[2])
    for i in range(3):  # of the pinion's rotation, to the third power of its tilt
        for j in range(3):
            turn[i, j] = 0.5 * t[i] * t[j]
        turn[i, i] += 1.0 - half
    turn[0, 1], turn[1, 0] = turn[0, 1] - t[2], turn[1, 0] + t[2]
    turn[0, 2], turn[2, 0] = turn[0, 2] + t[1], turn[2, 0] - t[1]
    turn[1, 2], turn[2, 1] = turn[1, 2] - t[0], turn[2, 1] + t[0]
    fill_rotation(place[3:6], angles)
    before = turn_of(place[3:6])
    w = stacked(3)
    for i in range(3):
        moved = p[0] * e[i] + p[1] * y[i] + p[2] * data.frame[2, i]
        w[i] = place[i] - data.origin[i] - moved
        for j in range(3):
            frame[i, j] = turn[0, i] * angles[0, j] + turn[1, i] * angles[1, j] + turn[2, i] * angles[2, j]
    a, b = np.arctan2(-frame[1, 2], frame[2, 2]), np.arcsin(frame[0, 2])
    c = np.arctan2(-frame[0, 1], frame[0, 0])
    ca, sa, cb, sb = np.cos(a), np.sin(a), np.cos(b), np.sin(b)
    move, spin = stacked(3), stacked(3)
    for j in range(11):
        for i in range(3):
            move[i] = spin[i] = 0.0
        if j < 3:
            move[j] = 1.0
        elif j == 3:
            spin[0] = 1.0
        elif j < 6:
            axis = before.about_b if j == 4 else before.about_c
            spin[0], spin[1], spin[2] = axis[0], axis[1], axis[2]
        elif j < 9:
            for i in range(3):
                move[i] = -data.frame[j - 6, i]
        else:
            x = data.frame[j - 9]
            move[0], move[1] = -(x[1] * w[2] - x[2] * w[1]), -(x[2] * w[0] - x[0] * w[2])
            move[2] = -(x[0] * w[1] - x[1] * w[0])
            spin[0], spin[1], spin[2] = -x[0], -x[1], -x[2]
        for i in range(3):
            carry[i, j] = turn[0, i] * move[0] + turn[1, i] * move[1] + turn[2, i] * move[2]
        s_x = turn[0, 0] * spin[0] + turn[1, 0] * spin[1] + turn[2, 0] * spin[2]
        s_y = turn[0, 1] * spin[0] + turn[1, 1] * spin[1] + turn[2, 1] * spin[2]
        s_z = turn[0, 2] * spin[0] + turn[1, 2] * spin[1] + turn[2, 2] * spin[2]
        carry[4, j] = ca * s_y + sa * s_z
        carry[5, j] = (ca * s_z - sa * s_y) / cb
        carry[3, j] = s_x - sb * carry[5, j]
    for i in range(3):
        place[i] = data.origin[i] + turn[0, i] * w[0] + turn[1, i] * w[1] + turn[2, i] * w[2]
    place[3], place[4], place[5] = a, b, c
    for i in range(6):
        move_rate = 0.0
        for j in range(6):
            move_rate += carry[i, j] * rate[j]
        for j in range(SIZE):
            move_rate += carry[i, 6 + j] * p_rate[j]
        if i < 3:
            move[i] = move_rate
        else:
            spin[i - 3] = move_rate
    for i in range(3):
        rate[i], rate[3 + i] = move[i], spin[i]


# --- the shaft of a gear ---------------------------------------------------------------------------
class Overhang(NamedTuple):
    """Shaft from the rigid toothed part over a bearing to its end: deflections per force, a cantilever's."""

    at_bearing: float  # by a force there [m/N]
    between: float  # at the bearing by a force on the end, and at the end by one on the bearing
    at_end: float  # by a force there

    @classmethod
    def of(cls, gear: SteeringGear, bearing: float, end: float) -> "Overhang":
        """Of bearing and end at distances from the middle of the mesh [m], the end at or beyond it."""
        rigid, radius = gear.pinion.face_width / 2, gear.pinion.shaft_diameter / 2
        a, b = bearing - rigid, end - rigid
        bending = YOUNGS_MODULUS * np.pi * radius**4 / 4
        shear = SHEAR_FACTOR * YOUNGS_MODULUS / (2 * (1 + POISSON_RATIO)) * np.pi * radius**2
        at_bearing, at_end = (float(x**3 / (3 * bending) + x / shear) for x in (a, b))
        return cls(at_bearing, float(a**2 * (3 * b - a) / (6 * bending) + a / shear), at_end)


@dataclass(frozen=True, eq=False)
class ShaftLoad:
    """A force on the input shaft's end and what it does to the shaft above the upper bearing."""

    station: float  # of the end [m]
    overhang: Overhang
    force: np.ndarray  # along e, Y and k (3,) [N]

    @classmethod
    def of(cls, gear: SteeringGear, force: np.ndarray) -> "ShaftLoad":
        """A force on the input shaft of a gear."""
        end = shaft_end(gear)
        return cls(end, Overhang.of(gear, gear.bearing.upper_position, end), force)

    def on(self, support: np.void) -> None:
        """Let the force act on the supports of a record."""
        across = self.force[:2]
        support["bent"] = self.overhang.between * across
        tilting = -self.station * across[1], self.station * across[0]
        support["pressed"] = np.concatenate([self.force, tilting])

    def end(self, support: np.record, u: np.ndarray) -> tuple[np.ndarray, float]:
        """Return the displacement of the end along e, Y and k (3,) [m], and the energy [J] that the shaft
        stores beside that of the supports at u (5,)."""
        self.on(support)
        z, across = support.station[0], self.force[:2]
        d = np.array([u[0] + z * u[4], u[1] - z * u[3]]) + support.bent
        size = float(np.hypot(*d))
        pressed = support.stiffness[0] * max(size - support.clearance[0], 0.0) * d / size if size else 0 * d
        force, slope = np.empty(SIZE), np.empty((SIZE, SIZE))
        held.py_func(u, support, force, slope)
        p = u + support.seat @ force
        moved = np.array([p[0] + self.station * p[4], p[1] - self.station * p[3], p[2]])
        moved[:2] += self.overhang.at_end * across - self.overhang.between * pressed
        energy = 0.5 * self.overhang.at_end * across @ across - self.overhang.between * across @ pressed
        return moved, float(energy)


def shaft_end(gear: SteeringGear) -> float:
    """Return the station of the input shaft's end, above the upper bearing [m]."""
    return max(gear.pinion.shaft_length / 2, gear.bearing.upper_position)


def bearing_stiffnesses(gear: SteeringGear) -> tuple[float, float]:
    """Return the stiffness of upper and lower bearing in series with the shaft [N/m]."""
    bearing = gear.bearing
    pairs = (
        (bearing.upper_position, bearing.upper_stiffness),
        (-bearing.lower_position, bearing.lower_stiffness),
    )
    upper, lower = (float(1 / (1 / k + Overhang.of(gear, z, z).at_bearing)) for z, k in pairs)
    return upper, lower


def seat_compliance(gear: SteeringGear) -> np.ndarray:
    """Return the compliance of the housing's seat on the coordinates of the pinion (5, 5); 0 of a rigid one.

    `housing.seat_stiffness` holds at the middle of the mesh, along and about e, Y and k.
    """
    values = np.array(numbers_in(gear.housing.seat_stiffness))
    if not values.size:
        return np.zeros((SIZE, SIZE))
    whole = np.diag(values) if values.size == SEAT_VALUES[0] else values.reshape(6, 6)
    if not np.allclose(whole, whole.T, rtol=1e-6) or not np.linalg.eigvalsh(whole).min() > 0:
        raise InputError(
            f"housing.seat_stiffness is {gear.housing.seat_stiffness}; it must be symmetric and resist "
            "every motion, with eigenvalues above 0."
        )
    return np.asarray(np.linalg.inv(whole)[:SIZE, :SIZE])


def with_float(gear: SteeringGear, fidelity: Fidelity) -> Fidelity:
    """Return the model of a scene that needs the pinion's supports where float or clearances are given."""
    bearing = gear.bearing
    loose = gear.pinion.axial_float or bearing.upper_clearance or bearing.lower_clearance
    return fidelity.with_support(needed=bool(loose))


def support_record(gear: SteeringGear, patches: Patches) -> np.record:
    """Return the record of the pinion's supports.

    Raises:
        InputError: bearings within the teeth, or a seat that yields without resistance.
    """
    pair, pinion, bearing = GearPair.of(gear), gear.pinion, gear.bearing
    if min(bearing.upper_position, -bearing.lower_position) < pinion.face_width / 2:
        raise InputError(
            f"bearing.upper_position is {mm(bearing.upper_position)} and bearing.lower_position "
            f"{mm(bearing.lower_position)}; the bearings of a supported pinion must stand beside its teeth, "
            f"{mm(pinion.face_width / 2)} and more from the middle of the mesh."
        )
    return record(
        SUPPORT,
        frame=pair.pinion_frame.T,
        origin=pair.pinion_origin - np.array([0.0, pair.bar_axis_height, 0.0]),
        station=np.array([bearing.upper_position, bearing.lower_position]),
        stiffness=np.array(bearing_stiffnesses(gear)),
        clearance=np.array([bearing.upper_clearance, bearing.lower_clearance]) / 2,
        bent=np.zeros(2),
        pressed=np.zeros(SIZE),
        axial_stiffness=bearing.axial_stiffness,
        half_float=pinion.axial_float / 2,
        friction=pinion.axial_friction,
        seat=seat_compliance(gear),
        law=constant_law(patches, pinion.axial_friction, bearing.bristle_travel),
    )


def at_rest(support: np.ndarray, preload: Numbers) -> tuple[np.ndarray, np.ndarray]:
    """Return the coordinates (5,) of a pinion that a preload [N] presses away from the rack, and by how much
    its axis yields there [m]; of records (n,) and their preloads (n, 5) and (n,).

    Each bearing carries its share of the force, beyond its clearance together with the centring.
    """
    force, stations = np.asarray(preload)[..., None], support["station"]
    apart = stations[..., :1] - stations[..., 1:]
    shares = stations[..., ::-1] * np.array([-1.0, 1.0]) / apart
    stiffness, gap = support["stiffness"], support["clearance"]
    beyond = (shares * force / stiffness + gap) / (1 + np.where(gap > 0, CENTRING, 0.0))
    moved = -np.where(beyond > gap, beyond, np.where(gap > 0, shares * force / (CENTRING * stiffness), 0.0))
    place = np.zeros((*moved.shape[:-1], SIZE))
    place[..., 1] = (shares * moved).sum(axis=-1)
    place[..., 3] = (moved[..., 1] - moved[..., 0]) / apart[..., 0]
    return place, support["seat"][..., 1, 1] * force[..., 0] - place[..., 1]
