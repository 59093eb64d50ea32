"""Mean torques of the steering gear by formula: no angle, no ripple, no dynamics.

A rack pressed by P into the mesh rests on both flanks of the teeth, N_1 + N_2 ~ P / sin(alpha_n). Rubbing
costs mu N |v_s|, with the sliding speed over the pinion speed as the friction's lever
(`GearPair.friction_lever`). Two levels, s' being the rack's travel per radian:

`first_order_torque`  the sum of the losses, flanks equally loaded and friction small:
    T_0 = mu P / sin(alpha_n) * mean lever + s' (D_bush + kappa mu_p P) + T_bearing
`mean_state`          the rack's balance along X and Y with the mean forces of both flanks, friction included,
                      and the torque from the power they take; the means weighted as the contact law
                      distributes the load along a line (derived here).

Of a variable ratio they are means of `gears.local_gear` over the test's travel.
The plunger's seat multiplies its friction by kappa (`seat_under`). The rack is taken as guided: what
friction across the rack does to its guides is left out, as is the installation's offset.
"""

from dataclasses import astuple, dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.polynomial.legendre import leggauss

from rps_exudyn.analysis.efficiency import LoadTest
from rps_exudyn.analysis.friction_oscillator import Rubbing
from rps_exudyn.forces.bush import bush_chain, housing_station
from rps_exudyn.forces.yoke import seat_under
from rps_exudyn.gears.bar_section import mass_and_moments
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.local_gear import ALONG, LocalGears, local_gear_at, mean_over_travel, turn_of_test
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.friction_law import FrictionLaw, largest_surplus
from rps_exudyn.parameters.gear import FLANK_DEVIATIONS, SteeringGear

GRAVITY = 9.80665  # [m/s^2]
_RULE = leggauss(24)  # over each side of the pitch point
Y = np.array([0.0, 1.0, 0.0])
LEVERS = 5  # Gauss points along the path of contact, of its friction's levers
LEFT_OUT = (
    *("installation.angle_error", "installation.axis_offset", "installation.gravity"),
    *("rack.bow", "rack.side_force", "rack.back_parallelism", *FLANK_DEVIATIONS),
)
"""Parameters that the formulas do not have."""
LEAST_SURPLUS = 0.01  # of the torque, that friction which is larger at rest adds


@dataclass(frozen=True)
class MeanState:
    """Mean forces and torque while the rack slides one way against a load."""

    torque: float  # on the pinion, positive towards +X [N m]
    normal_drive: float  # on the flanks that push the rack towards +X [N]
    normal_coast: float  # on the others; 0 where they have lifted [N]
    side_force: float  # of the teeth on the rack, along Z [N]
    plunger_force: float  # along Y [N]
    mesh_loss: float  # losses per radian of pinion [N m]
    plunger_loss: float
    bush_loss: float
    bearing_loss: float


def free_torque(gear: SteeringGear) -> float:
    """Return the mean free pinion torque towards +X [N m]."""
    return mean_state(gear, +1, 0.0).torque


def load_test(gear: SteeringGear, mass: float | None = None) -> LoadTest:
    """Return the load test with `mass` [kg], default `test.load_mass`; up to `unloading_force`."""
    load = GRAVITY * (gear.test.load_mass if mass is None else mass)
    return LoadTest(
        load=load,
        ideal_torque=load * mean_gain(gear),
        torque_forward=mean_state(gear, +1, load).torque,
        torque_reverse=mean_state(gear, -1, load).torque,
        free_torque=free_torque(gear),
    )


def beyond_formulas(gear: SteeringGear) -> str:
    """Return why the formulas do not hold for this gear, in words; empty where they do."""
    lift = gear.pinion.runout
    if lift >= gear.yoke.clearance:
        return (
            f"the formulas have no yokenut, but a runout of {1e6 * lift:.4g} um exceeds yoke.clearance = "
            f"{1e6 * gear.yoke.clearance:.4g} um"
        )
    if given := gear.set_among(LEFT_OUT):
        return f"the formulas leave out {', '.join(given)}"
    if (surplus := static_surplus(gear)) > LEAST_SURPLUS:
        return (
            f"the formulas leave out that friction is larger at rest: at the sliding speeds of the test that "
            f"adds {surplus:.1%} to the torque"
        )
    return ""


# --- parts ---------------------------------------------------------------------------------------
def mean_lever(pair: GearPair) -> float:
    """Return the mean friction lever over the path of contact, in closed form [m].

    l^2 = (q + b)^2 + a^2 with b = l_s sin(alpha_t) sin(beta_p), a^2 = l_s^2 - b^2; a = 0 for parallel axes.
    """
    l_s = -pair.reference_radius * np.sin(pair.delta) / np.cos(pair.beta_r)
    b = l_s * np.sin(pair.alpha_t) * np.sin(pair.beta_p)
    a = np.sqrt(max(l_s**2 - b**2, 0.0))

    def integral(q: float) -> float:
        x = q + b
        return float(x * np.hypot(x, a) + (a**2 * np.arcsinh(x / a) if a > 0 else 0.0)) / 2

    q_0, q_a = pair.active_path
    return (integral(q_a) - integral(q_0)) / (q_a - q_0)


def first_order_torque(gear: SteeringGear) -> float:
    """Mean free torque as the sum of the losses, friction small [N m]."""
    rubbing, gain = torque_per_preload(gear) * gear.yoke.preload, GearPair.of(gear).gain
    return float(rubbing + gain * bush_drag(gear, gain) + gear.bearing.friction_torque)


def mean_gain(gear: SteeringGear) -> float:
    """Return the rack's travel per radian of the pinion over the test's turn [m/rad]."""
    pair, turn = GearPair.of(gear), np.array(turn_of_test(gear))
    return float(pair.gain if pair.course is None else np.ptp(pair.travel_at(turn)) / np.ptp(turn))


def bush_drag(gear: SteeringGear, gain: float) -> float:
    """Return the bush's drag on the rack, with its viscous part at the speed of the test and a gain [N]."""
    return float(gear.bush.drag + gear.bush.viscous_drag * gear.test.speed * abs(gain))


def torque_per_preload(gear: SteeringGear) -> float:
    """Return dT_0 / dP = mu mean lever / sin(alpha_n) + kappa mu_p s' [m]."""
    if not gear.rack.ratio.is_constant:
        return mean_over_travel(gear, lambda local: [torque_per_preload(local)])[0]
    yoke = gear.yoke
    at_seat = seat_under(gear).wedge * yoke.friction * GearPair.of(gear).gain
    return float(mesh_torque_per_force(gear) + at_seat)


def mesh_torque_per_force(gear: SteeringGear) -> float:
    """Return the teeth's part of it, mu mean lever / sin(alpha_n) [m]."""
    pair = GearPair.of(gear)
    return float(gear.mesh.friction * mean_lever(pair) / np.sin(pair.alpha_n))


def runout_harmonics(gear: SteeringGear) -> tuple[float, float]:
    """Return the once-per-revolution amplitudes of cos and sin of phi + runout_angle [N m], first order in e.

    The eccentric gear lifts the rack by e cos(phi), against the yoke's spring k and what holds the rack
    straight (`tilting_stiffness` k_t, which loads the teeth alone), and shifts it by
    x = e sin(phi) cos(beta_p) / cos(beta_r), which takes work of the drag D and, at the speed w of the test,
    accelerates the mass m of the rack:
    T = T_0 + (dT_0/dP k e + dT_mesh/dP k_t e) cos(phi) + D dx/dphi - P e sin(phi) - s' m w^2 x.
    """
    if not gear.rack.ratio.is_constant:
        cosine, sine = mean_over_travel(gear, runout_harmonics)
        return cosine, sine
    pair, yoke, e = GearPair.of(gear), gear.yoke, gear.pinion.runout
    drag = bush_drag(gear, pair.gain) + seat_under(gear).wedge * yoke.friction * yoke.preload
    by_lift = torque_per_preload(gear) * yoke.spring_rate * e
    by_tilt = mesh_torque_per_force(gear) * tilting_stiffness(gear) * e if e else 0.0
    shift = e * np.cos(pair.beta_p) / np.cos(pair.beta_r)
    mass = mass_and_moments(RackBar.of(gear), gear.rack.density)[0] if e else 0.0
    by_inertia = pair.gain * mass * gear.test.speed**2 * shift
    return float(by_lift + by_tilt + drag * shift), float(-yoke.preload * e - by_inertia)


def tilting_stiffness(gear: SteeringGear) -> float:
    """Return force over the rack's lift at the mesh [N/m], of bush and seat, which hold it straight."""
    bush = bush_chain(gear)
    to_fit = housing_station(gear, bush.end_station)
    k = bush.lateral_stiffness[np.ix_([0, 3], [0, 3])]  # along y, about z
    seat = seat_under(gear).stiffness * gear.yoke.seat_length**2 / 12
    lift, tilt = np.array([1.0, 0.0]), np.array([to_fit, 1.0])  # what the fit sees of both
    along, both, about = lift @ k @ lift, lift @ k @ tilt, tilt @ k @ tilt + seat
    return float(along - both**2 / about)


def unloading_force(gear: SteeringGear, direction: int = +1) -> float:
    """Return the load on the rack above which the coast flanks carry nothing [N], raised (1) or lowered (-1).

    Without friction P cot(alpha_n) cos(beta_r) -+ D. Of a variable ratio, the least along the test's travel.
    """
    if not gear.rack.ratio.is_constant:
        ends = LocalGears.between(gear, np.linspace(*turn_of_test(gear), ALONG)).gears
        return min(unloading_force(each, direction) for each in ends)
    pair = GearPair.of(gear)
    drive = _mean_force(gear, pair, -1, direction).force
    plunger = seat_under(gear).wedge * gear.yoke.friction * gear.yoke.preload
    return float(gear.yoke.preload * drive[0] / drive[1] - direction * (bush_drag(gear, pair.gain) + plunger))


# --- what slides ---------------------------------------------------------------------------------
# Each part slides with its lever times the pinion's speed: the teeth with the levers of their friction along
# the path of contact, evenly loaded, plunger and bush with the rack, the bearing with the shaft.


def sliding_parts(gear: SteeringGear) -> list[tuple[FrictionLaw, float, float]]:
    """Return law, torque [N m] and lever [m] of what rubs, free of load towards the test's direction."""
    gear = local_gear_at(gear, gear.test.start_angle)
    pair = GearPair.of(gear)
    mean, gain = mean_state(gear, gear.test.direction, 0.0), float(pair.gain)
    node, weight = leggauss(LEVERS)
    first, last = pair.active_path
    levers = pair.friction_lever(first + (last - first) * (1 + node) / 2)
    shares = weight * levers / (weight @ levers)
    return [
        *(
            (gear.mesh, mean.mesh_loss * float(f), float(lever))
            for f, lever in zip(shares, levers, strict=True)
        ),
        (gear.yoke, mean.plunger_loss, gain),
        (gear.bush, mean.bush_loss, gain),
        (gear.bearing, mean.bearing_loss, gear.pinion.shaft_diameter / 2),
    ]


def friction_over_speed(law: FrictionLaw, torque: float, lever: float) -> Rubbing:
    """Return the friction of a sliding part over the pinion's speed."""
    ratio = law.static_ratio if law.facts.falls else 1.0
    return Rubbing(max(torque, 0.0), ratio, law.stribeck_speed / max(lever, 1e-9), law.stribeck_exponent)


def static_surplus(gear: SteeringGear) -> float:
    """Return what friction that falls from rest on adds to the torque at the test's speed, as a share."""
    if not largest_surplus(gear):
        return 0.0
    parts = [friction_over_speed(*part) for part in sliding_parts(gear)]
    whole = sum(part.torque for part in parts)
    return float(sum(part.at(gear.test.speed) for part in parts) / whole - 1) if whole else 0.0


# --- balance of the rack -------------------------------------------------------------------------
def mean_state(gear: SteeringGear, direction: int, load: float) -> MeanState:
    """Return the mean forces while the rack moves along `direction` (+1 or -1) X, the load pulling to -X [N].

    Where the balance would need a flank to pull, that flank has lifted; the yoke then yields until
    the other flank alone carries the load.
    """
    pair, yoke = GearPair.of(gear), gear.yoke
    if pair.course is not None:
        return MeanState(*mean_over_travel(gear, lambda local: astuple(mean_state(local, direction, load))))
    seat_friction = seat_under(gear).wedge * yoke.friction
    drive, coast = (_mean_force(gear, pair, side, direction) for side in (-1, +1))
    press = yoke.preload
    drag = bush_drag(gear, pair.gain)
    along_x = load + direction * (drag + seat_friction * press)
    balance = np.array([[drive.force[0], coast.force[0]], [drive.force[1], coast.force[1]]])
    normal = np.linalg.solve(balance, [along_x, press])
    if normal.min() < 0:  # along_x grows with the press, which is normal * f_y now
        f = drive if normal[1] < 0 else coast
        alone = (load + direction * drag) / (f.force[0] - direction * seat_friction * f.force[1])
        normal = np.where(normal < 0, 0.0, alone)
        press = alone * f.force[1]
    forces = normal[0] * drive.force + normal[1] * coast.force
    return MeanState(
        torque=float(
            normal[0] * drive.moment + normal[1] * coast.moment + direction * gear.bearing.friction_torque
        ),
        normal_drive=float(normal[0]),
        normal_coast=float(normal[1]),
        side_force=float(forces[2]),
        plunger_force=float(press),
        mesh_loss=float(gear.mesh.friction * (normal[0] * drive.lever + normal[1] * coast.lever)),
        plunger_loss=float(seat_friction * press * pair.gain),
        bush_loss=float(drag * pair.gain),
        bearing_loss=gear.bearing.friction_torque,
    )


def pushing_force(gear: SteeringGear, direction: int, load: float = 0.0) -> float:
    """Return the force on the rack along X that moves it along `direction` with the pinion following freely
    [N]; infinite where the gear locks itself.

    The gear is driven back: no torque acts on the pinion but that of its bearings. `load` pulls towards -X.
    """
    from scipy.optimize import brentq  # loads in a third of a second

    gain = GearPair.of(gear).gain

    def torque(force: float) -> float:
        return mean_state(gear, direction, load - force).torque

    scale = (1.0 + abs(mean_state(gear, direction, load).torque)) / gain
    far = scale / 16  # the first of two places: far beyond it no teeth would slide
    while torque(load - far) * torque(load + far) > 0:
        far *= 1.25
        if far > 10 * scale:
            return direction * np.inf
    return float(brentq(torque, load - far, load + far, xtol=1e-9))


@dataclass(frozen=True)
class _MeanForce:
    """Mean force of one side's teeth on the rack, per unit of normal force."""

    force: np.ndarray  # n + mu v_s / |v_s|, shape (3,)
    moment: float  # the pinion's torque towards +X that it takes [m]
    lever: float  # |v_s| over pinion speed [m]


def _mean_force(gear: SteeringGear, pair: GearPair, side: int, direction: int) -> _MeanForce:
    """Mean over the active path of contact, weighted by the law: load per length ~ sqrt(rho) or constant."""
    smooth, rubbing = _mean_parts(pair.centred, gear.mesh.contact_law == "area", side, direction)
    mu = gear.mesh.friction
    return _MeanForce(smooth.force + mu * rubbing.force, smooth.moment + mu * rubbing.moment, smooth.lever)


@lru_cache(maxsize=64)
def _mean_parts(pair: GearPair, by_depth: bool, side: int, direction: int) -> tuple[_MeanForce, _MeanForce]:
    """Mean force without friction, and what a coefficient of 1 adds to it: the force is linear in it."""
    q, weight = _field_rule(pair, side)
    if by_depth:
        weight = weight * np.sqrt(q + pair.reference_radius * np.sin(pair.alpha_t))
    weight = weight / weight.sum()
    n, k = -pair.rack_flank_normal(side), pair.pinion_frame[:, 2]
    points = pair.reference_radius * Y + q[:, None] * _transverse(pair, side)
    of_pinion = -np.cross(k, points)  # per pinion speed, towards +X
    slip = of_pinion - [pair.gain, 0, 0]
    slip -= (slip @ n)[:, None] * n
    lever = np.linalg.norm(slip, axis=1)
    rubbing = direction * slip / np.where(lever > 0, lever, 1.0)[:, None]
    mean_lever = float(weight @ lever)
    return (
        _MeanForce(n, float(weight @ (of_pinion @ n)), mean_lever),
        _MeanForce(weight @ rubbing, float(weight @ np.sum(rubbing * of_pinion, axis=1)), mean_lever),
    )


def _transverse(pair: GearPair, side: int) -> np.ndarray:
    """Direction of the path of contact in the pinion's transverse section, upwards, shape (3,)."""
    e, _, _ = pair.pinion_frame.T
    return -side * np.cos(pair.alpha_t) * e + np.sin(pair.alpha_t) * Y


def _field_rule(pair: GearPair, side: int) -> tuple[np.ndarray, np.ndarray]:
    """Points q on the path of contact, and weights by the length of the face that the bar leaves there [m].

    Gauss-Legendre on both sides of the pitch point, where sliding may turn about.
    """
    x, w = _RULE
    q_0, q_a = pair.active_path
    ends = sorted({q_0, q_a, min(max(0.0, q_0), q_a)})
    q = np.concatenate([(b + a) / 2 + (b - a) / 2 * x for a, b in pairwise(ends)])
    weight = np.concatenate([(b - a) / 2 * w for a, b in pairwise(ends)])
    height = pair.reference_radius + q * np.sin(pair.alpha_t) - pair.bar_axis_height
    chord = np.sqrt(np.maximum(pair.bar_radius**2 - height**2, 0.0))
    shift, cos_delta, b = q * _transverse(pair, side)[2], np.cos(pair.delta), pair.face_width
    low = np.maximum((-chord - shift) / cos_delta, -b / 2)
    high = np.minimum((chord - shift) / cos_delta, b / 2)
    return q, weight * np.maximum(high - low, 0.0)
