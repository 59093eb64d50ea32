"""Impact and rattle in the plane X-Y: an elastic bar between teeth, seat and bush, a plunger, nut and O-ring.

    shaken(gear, force, time)        # force of the yokenut [N] at evenly spread instants

The bar is Euler and Bernoulli's beam of finite elements, by its first modes: a full circle, and where it has
teeth the segment above their roots. It moves along X and Y and pitches; it neither rolls nor moves along Z.
Both flanks of the held pinion are one-sided springs along their normals in the middle of the mesh, with
Coulomb friction against slip; so is the seat, and without friction the nut behind the plunger. The O-ring is
a spring that yields at its friction. The bush is a cantilever tube. Classical Runge-Kutta steps: nothing of
the package's kernels is in it.
"""

from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numba import njit
from scipy.linalg import eigh

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_limits import transverse_contact_ratio
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.parameters.gear import SteeringGear

STEEL, POISSON_RATIO = 206e9, 0.3  # Young's modulus [Pa]
ELEMENT = 0.01  # longest element of the beam [m]
ZONE = 3e-4  # speed below which friction is linear [m/s]
STEP = 1e-6  # [s]


class Plane(NamedTuple):
    """The model: coordinates X of the bar, amplitudes of modes of unit mass (n), Y of the plunger."""

    mass: float  # of the bar [kg]
    frequency: np.ndarray  # of the modes, 0 of heave and pitch [rad/s], shape (n,)
    damping: float  # ratio
    at_mesh: np.ndarray  # deflection and slope by each mode, shape (2, n)
    at_seat: np.ndarray  # deflection at both points, shape (2, n)
    at_bush: np.ndarray  # deflection and slope, shape (2, n)
    at_end: np.ndarray  # deflection, shape (n,)
    teeth: np.ndarray  # stiffness of a side [N/m], alpha_n, beta_r, arm below the axis [m], friction
    seat: np.ndarray  # stiffness [N/m], bar's radius [m], friction over the force along Y
    bush: np.ndarray  # (2, 2) of deflection and slope
    drag: float  # of the bush [N]
    plunger: np.ndarray  # mass [kg], preload [N], rate [N/m], clearance [m], nut's stiffness [N/m]
    ring: np.ndarray  # friction [N], stiffness [N/m]


def plane_model(gear: SteeringGear) -> Plane:
    """Return the model of a gear with friction by Coulomb."""
    pair, bar, yoke, rack = GearPair.of(gear), RackBar.of(gear), gear.yoke, gear.rack
    radius, root = rack.bar_diameter / 2, rack.reference_height - pair.rack_dedendum
    full = np.pi * radius**2, np.pi * radius**4 / 4
    y = np.linspace(-root, radius, 2001)
    width = 2 * np.sqrt(np.maximum(radius**2 - y**2, 0))
    area = float(np.trapezoid(width, y))
    centre = float(np.trapezoid(width * y, y)) / area
    cut = area, float(np.trapezoid(width * (y - centre) ** 2, y))
    # teeth fill half of the ring between their roots and tips
    tip = rack.reference_height + pair.rack_addendum
    y = np.linspace(root, tip, 501)
    filled = area + float(np.trapezoid(np.sqrt(np.maximum(radius**2 - y**2, 0)), y))
    first, last = bar.toothed_ends
    nodes = np.unique(
        np.concatenate([_spread(a, b) for a, b in ((bar.x_min, first), (first, last), (last, bar.x_max))])
    )
    stiff, heavy = np.zeros((2 * nodes.size,) * 2), np.zeros((2 * nodes.size,) * 2)
    mass = 0.0
    for i, (a, b) in enumerate(pairwise(nodes)):
        toothed = first <= (a + b) / 2 <= last
        here, (_, inertia) = slice(2 * i, 2 * i + 4), cut if toothed else full
        weight = gear.rack.density * (filled if toothed else full[0])
        stiff[here, here] += STEEL * inertia * _bending(b - a)
        heavy[here, here] += weight * _inertia(b - a)
        mass += weight * (b - a)
    squares, shapes = eigh(stiff, heavy, subset_by_index=[0, 1 + rack.modes])
    squares[:2] = 0.0

    def at(x: float) -> np.ndarray:
        """Deflection and slope at a station by each mode."""
        i = int(np.clip(np.searchsorted(nodes, x) - 1, 0, nodes.size - 2))
        long = nodes[i + 1] - nodes[i]
        return _hermite((x - nodes[i]) / long, long) @ shapes[2 * i : 2 * i + 4]

    apart = yoke.seat_length / np.sqrt(12)  # of two points that resist pitch as the whole seat does
    phi = yoke.seat_angle
    wedge = 2 * np.sin(phi) / (phi + np.sin(phi) * np.cos(phi))
    length = pair.face_width * transverse_contact_ratio(pair) / np.cos(pair.beta_b)
    arm = pair.bar_axis_height - pair.reference_radius
    return Plane(
        mass=mass,
        frequency=np.sqrt(squares),
        damping=rack.modal_damping,
        at_mesh=at(0.0),
        at_seat=np.array([at(-apart)[0], at(apart)[0]]),
        at_bush=at(gear.bush.distance),
        at_end=at(bar.x_min)[0],
        teeth=np.array([length * line_stiffness(gear), pair.alpha_n, pair.beta_r, arm, gear.mesh.friction]),
        seat=np.array([yoke.seat_stiffness, radius, wedge * yoke.friction]),
        bush=_cantilever(gear),
        drag=gear.bush.drag,
        plunger=np.array(
            [yoke.plunger_mass, yoke.preload, yoke.spring_rate, yoke.clearance, yoke.nut_stiffness]
        ),
        ring=np.array([yoke.bore_friction, yoke.bore_friction / (2 * yoke.bristle_travel)]),
    )


def shaken(
    gear: SteeringGear, force: Callable[[float], np.ndarray], duration: float, sampled: float = 1e-5
) -> tuple[np.ndarray, np.ndarray]:
    """Return instants [s] and force of the yokenut [N] of a gear at rest that a force on the bar's end moves.

    Args:
        force: along X, Y (and Z, left out) at a time [s], shape (3,) [N].
        duration: of the record [s].
        sampled: time between the instants [s].
    """
    half = STEP / 2 * np.arange(round(2 * duration / STEP) + 3)
    forces = np.array([force(float(time))[:2] for time in half])
    return _run(plane_model(gear), forces, STEP, round(duration / STEP), round(sampled / STEP))


def _spread(a: float, b: float) -> np.ndarray:
    return np.linspace(a, b, int(np.ceil((b - a) / ELEMENT)) + 1)


def _bending(h: float) -> np.ndarray:
    rows = [[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2]]
    rows += [[-12, -6 * h, 12, -6 * h], [6 * h, 2 * h**2, -6 * h, 4 * h**2]]
    return np.array(rows) / h**3


def _inertia(h: float) -> np.ndarray:
    rows = [[156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2]]
    rows += [[54, 13 * h, 156, -22 * h], [-13 * h, -3 * h**2, -22 * h, 4 * h**2]]
    return np.array(rows) * h / 420


def _hermite(s: float, h: float) -> np.ndarray:
    """Deflection and slope at s in an element by its ends' deflections and slopes, shape (2, 4)."""
    place = [1 - 3 * s**2 + 2 * s**3, h * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3, h * (s**3 - s**2)]
    slope = [(6 * s**2 - 6 * s) / h, 1 - 4 * s + 3 * s**2, (6 * s - 6 * s**2) / h, 3 * s**2 - 2 * s]
    return np.array([place, slope])


def _cantilever(gear: SteeringGear) -> np.ndarray:
    """Stiffness of the bush's free end against deflection and slope of the bar, shape (2, 2)."""
    bush = gear.bush
    outer, inner, long = bush.outer_diameter / 2, bush.inner_diameter / 2, bush.length
    bending = bush.youngs_modulus * np.pi * (outer**4 - inner**4) / 4
    modulus = bush.youngs_modulus / (2 * (1 + bush.poisson_ratio))
    shear = modulus * np.pi * (outer**2 - inner**2) / 2
    # seen from the mesh the tube begins at its free end: a force along Y tilts it towards -X
    mixed = -(long**2) / (2 * bending)
    compliance = [[long**3 / (3 * bending) + long / shear, mixed], [mixed, long / bending]]
    return np.asarray(np.linalg.inv(compliance))


@njit
def _rates(state, force, p):  # type: ignore[no-untyped-def]
    """Rates of the state, and the nut's force."""
    n = p.frequency.size
    out = np.zeros(state.size)
    q, v = state[: n + 2], state[n + 2 : 2 * n + 4]
    a, rate = q[1 : n + 1], v[1 : n + 1]
    mass, preload, spring, clearance, nut = p.plunger
    load = np.zeros(n)
    # teeth: a side presses along its normal, and rubs in its plane
    stiffness, alpha, beta, arm, friction = p.teeth
    pitch, pitching = p.at_mesh[1] @ a, p.at_mesh[1] @ rate
    x, y = q[0] + arm * pitch, p.at_mesh[0] @ a
    vx, vy = v[0] + arm * pitching, p.at_mesh[0] @ rate
    along, at_mesh = force[0], 0.0
    at_arm = 0.0
    for side in (-1.0, 1.0):
        nx, ny = side * np.cos(alpha) * np.cos(beta), np.sin(alpha)
        nz = -side * np.cos(alpha) * np.sin(beta)
        depth = preload / (2 * stiffness * ny) - nx * x - ny * y
        if depth > 0:
            pressed = stiffness * depth
            parting = nx * vx + ny * vy
            sx, sy, sz = vx - parting * nx, vy - parting * ny, -parting * nz
            drag = friction * pressed / max(np.sqrt(sx * sx + sy * sy + sz * sz), ZONE)
            at_arm += pressed * nx - drag * sx
            at_mesh += pressed * ny - drag * sy
    along += at_arm
    load += at_mesh * p.at_mesh[0] + arm * at_arm * p.at_mesh[1]
    # seat
    of_seat = 0.0
    for i in range(2):
        depth = p.at_seat[i] @ a - q[n + 1] + preload / p.seat[0]
        pressed = p.seat[0] / 2 * max(depth, 0.0)
        load -= pressed * p.at_seat[i]
        of_seat += pressed
    slip = v[0] - p.seat[1] * pitching
    drag = -p.seat[2] * of_seat * slip / max(abs(slip), ZONE)
    along += drag
    load -= p.seat[1] * drag * p.at_mesh[1]
    # bush
    place, tilt = p.at_bush[0] @ a, p.at_bush[1] @ a
    load -= (p.bush[0, 0] * place + p.bush[0, 1] * tilt) * p.at_bush[0]
    load -= (p.bush[1, 0] * place + p.bush[1, 1] * tilt) * p.at_bush[1]
    along -= p.drag * v[0] / max(abs(v[0]), ZONE)
    load += force[1] * p.at_end
    # plunger, with an O-ring whose spring yields
    ring, of_nut = state[2 * n + 4], nut * max(q[n + 1] - clearance, 0.0)
    on_plunger = of_seat - preload - spring * q[n + 1] - of_nut - p.ring[1] * ring
    yielding = p.ring[1] * abs(ring) >= p.ring[0] and ring * v[n + 1] > 0
    out[: n + 2] = v
    out[n + 2] = along / p.mass
    for i in range(n):
        out[n + 3 + i] = load[i] - p.frequency[i] ** 2 * a[i] - 2 * p.damping * p.frequency[i] * rate[i]
    out[2 * n + 3] = on_plunger / mass
    out[2 * n + 4] = 0.0 if yielding else v[n + 1]
    return out, of_nut


@njit
def _run(p, forces, step, steps, every):  # type: ignore[no-untyped-def]
    """Instants and the nut's force, each of so many steps."""
    state = np.zeros(2 * p.frequency.size + 5)
    times, nut = np.empty(steps // every + 1), np.empty(steps // every + 1)
    for i in range(steps + 1):
        first, pressed = _rates(state, forces[2 * i], p)
        if i % every == 0:
            times[i // every], nut[i // every] = i * step, pressed
        if i == steps:
            break
        second, _ = _rates(state + step / 2 * first, forces[2 * i + 1], p)
        third, _ = _rates(state + step / 2 * second, forces[2 * i + 1], p)
        last, _ = _rates(state + step * third, forces[2 * i + 2], p)
        state = state + step / 6 * (first + 2 * second + 2 * third + last)
    return times, nut
