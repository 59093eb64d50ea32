"""The pinion on bearings: beam, float and lost motion by closed form, work, a rigid pinion as before."""

from itertools import pairwise

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.pinion_support import (
    Overhang,
    ShaftLoad,
    at_rest,
    bearing_stiffnesses,
    held,
    shaft_end,
)
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.tooth_stiffness import POISSON_RATIO, YOUNGS_MODULUS
from rps_exudyn.solvers.gear_forces import GearForces, gear_forces
from rps_exudyn.solvers.gear_model import COLUMNS, PARTS
from verification.difference_tangent import difference_tangent

GEAR = rps.SteeringGear().replace({"test.amplitude": "60 deg"})
QUASI_STATIC = rps.Fidelity.preset("quasi-static")
SUPPORTED = QUASI_STATIC.replace({"pinion": "supported"})
GUIDED = QUASI_STATIC.replace({"rack": "guided"})
PAIR = GearPair.of(GEAR)
FLOAT = 1e-4
LOOSE = GEAR.replace({"pinion.axial_float": FLOAT})
LOST = FLOAT * np.tan(PAIR.beta_b) / PAIR.base_radius  # 7.70 mrad
CLEARANCES = {"bearing.upper_clearance": "20 um", "bearing.lower_clearance": "30 um"}
YIELDING = {"housing.seat_stiffness": [1e8, 2e8, 1e8, 5e4, 7e4, 1e5]}
FRICTIONLESS = {"mesh.friction": 0.0, "yoke.friction": 0.0, "bush.drag": 0.0, "bearing.friction_torque": 0.0}


def supports(gear: rps.SteeringGear) -> GearForces:
    return gear_forces(gear, SUPPORTED)


def frame_of_beam(force: float) -> np.ndarray:
    """Deflection and tilt of the toothed part by finite elements of Timoshenko's beam on two springs, the
    toothed part a thousand times as stiff, (2,)."""
    bearing, radius, half = GEAR.bearing, GEAR.pinion.shaft_diameter / 2, GEAR.pinion.face_width / 2
    x = np.unique(
        np.concatenate(
            [
                np.linspace(bearing.lower_position, -half, 9),
                np.linspace(-half, half, 9),
                np.linspace(half, bearing.upper_position, 9),
            ]
        )
    )
    area, second = np.pi * radius**2, np.pi * radius**4 / 4
    shear = (
        YOUNGS_MODULUS / (2 * (1 + POISSON_RATIO)) * area * 6 * (1 + POISSON_RATIO) / (7 + 6 * POISSON_RATIO)
    )
    whole = np.zeros((2 * x.size, 2 * x.size))
    for i, (a, b) in enumerate(pairwise(x)):
        length, stiff = b - a, 1e6 if abs(a + b) / 2 < half else 1.0
        bending, phi = stiff * YOUNGS_MODULUS * second, 12 * YOUNGS_MODULUS * second / (shear * (b - a) ** 2)
        k = bending / (length**3 * (1 + phi))
        element = k * np.array(
            [
                [12, 6 * length, -12, 6 * length],
                [6 * length, (4 + phi) * length**2, -6 * length, (2 - phi) * length**2],
                [-12, -6 * length, 12, -6 * length],
                [6 * length, (2 - phi) * length**2, -6 * length, (4 + phi) * length**2],
            ]
        )
        whole[2 * i : 2 * i + 4, 2 * i : 2 * i + 4] += element
    whole[0, 0] += bearing.lower_stiffness
    whole[-2, -2] += bearing.upper_stiffness
    load, middle = np.zeros(2 * x.size), int(np.argmin(np.abs(x)))
    load[2 * middle] = force
    found = np.linalg.solve(whole, load)
    return found[2 * middle : 2 * middle + 2]


def test_shaft_on_two_bearings_is_the_beam() -> None:
    """300 N at the mesh; the values were computed elsewhere too: 3.8982 um, 0.04532 mrad."""
    place = -at_rest(supports(GEAR).gear.support, 300.0)[0]
    deflection, slope = frame_of_beam(300.0)
    assert place[1] == pytest.approx(deflection, rel=1e-3)
    assert -place[3] == pytest.approx(slope, rel=1e-3)
    assert place[[1, 3]] == pytest.approx([3.8982e-6, -0.04532e-3], rel=1e-3)


def test_clearance_and_float_stand_before_the_bearings() -> None:
    loose, tight = (supports(each).gear.support for each in (LOOSE.replace(CLEARANCES), GEAR))
    place, force, slope = at_rest(loose, 300.0)[0], np.empty(5), np.empty((5, 5))
    moved = -place - -at_rest(tight, 300.0)[0]
    upper, lower = 10e-6, 15e-6  # half the clearances, 25 and 22 mm from the mesh
    assert moved[1] == pytest.approx((22 * upper + 25 * lower) / 47, rel=1e-3)
    place[2] = FLOAT / 2 + 50 / GEAR.bearing.axial_stiffness
    held.py_func(place, loose, force, slope)
    assert force == pytest.approx([0.0, -300.0, 50.0, 0.0, 0.0], rel=2e-3, abs=1e-9)


@pytest.mark.parametrize("law", ["line", "teeth"])
def test_forces_are_the_slope_of_the_energy(law: str) -> None:
    """Of teeth, seat of the housing, bearings, without friction; to what material over the rack's edges
    takes, 1 % of the largest force."""
    forces = supports(GEAR.replace({**FRICTIONLESS, **YIELDING, **CLEARANCES, "mesh.law": law}))
    balance, q = forces.statics, np.zeros(13)
    q[0], q[1], q[2] = -0.3, PAIR.gain * 0.3, -forces.approach - 1e-5
    q[3:7] = 1e-6, 2e-3, -1e-3, 3e-4
    q[-5:] = forces.supported + np.array([8e-6, -2e-6, 5e-6, 2e-4, -1e-4])

    def energy(q: np.ndarray) -> float:
        balance.force(q, np.zeros(13))
        out = balance.works[0]["out"]
        return float(sum(out[COLUMNS[part.name]][part.size] for part in PARTS if part in forces.parts))

    force, lengths = balance.force(q, np.zeros(13)), balance.lengths
    steps = 1e-8 / lengths
    slope = [(energy(q - h) - energy(q + h)) / (2 * h.sum()) for h in np.diag(steps)]
    assert np.abs((force - slope) / lengths).max() < 0.01 * np.abs(force / lengths).max()


@pytest.mark.parametrize("changes", [{}, CLEARANCES, YIELDING])
def test_tangent_is_that_of_differences(changes: dict[str, object]) -> None:
    forces = supports(LOOSE.replace({**changes, "pinion.axial_friction": 0.0}))
    balance, q, v = forces.statics, np.zeros(13), np.zeros(13)
    q[0], q[1], q[2], v[0], v[1] = -0.3, PAIR.gain * 0.3, -forces.approach - 1e-5, -1.5, PAIR.gain * 1.5
    q[-5:] = forces.supported + np.array([8e-6, -2e-6, 60e-6, 2e-4, -1e-4])
    lengths = np.outer(balance.lengths, balance.lengths)
    for factors in ((1.0, 0.0), (0.0, 1.0)):
        ours = balance.tangent(q, v, *factors) / lengths
        theirs = difference_tangent(balance, q, v, *factors) / lengths
        assert np.abs(ours - theirs).max() < 0.01 * np.abs(theirs).max()


def test_a_rigid_pinion_is_that_of_stiff_bearings() -> None:
    """Without the change of stiffness, what is left are the tilts of the teeth's own penalty."""
    stiff = dict.fromkeys(
        ("bearing.upper_stiffness", "bearing.lower_stiffness", "bearing.axial_stiffness"), 1e14
    )
    gear = GEAR.replace({**stiff, "bearing.upper_position": "7 mm", "bearing.lower_position": "-7 mm"})
    rigid, supported = (
        rps.run("free-pinion-torque", gear, fidelity=each).summary["torque_mean"]
        for each in (QUASI_STATIC, SUPPORTED)
    )
    assert supported == pytest.approx(rigid, rel=1e-6)


def test_by_scene_is_rigid_without_float_or_clearance() -> None:
    ours, rigid = (
        rps.run("reversal", GEAR, fidelity=each)
        for each in (QUASI_STATIC, QUASI_STATIC.replace({"pinion": "rigid"}))
    )
    assert ours.summary == rigid.summary
    assert "pinion_axial" not in ours.signals


def test_the_float_shuttles_at_each_reversal_and_the_rack_leads() -> None:
    """By closed form the float turns the pinion by a tan(beta_b) / r_b; beside it stands the lost motion
    without float. Friction along the crossed axes carries the shaft: the rack leads."""
    free, held_axially = (rps.run("reversal", each, fidelity=GUIDED) for each in (LOOSE, GEAR))
    moved = free.summary["lost_motion_angle"] - held_axially.summary["lost_motion_angle"]
    assert moved == pytest.approx(-LOST, rel=0.02)
    assert np.ptp(free.signals["pinion_axial"]) == pytest.approx(FLOAT, rel=0.05)
    assert abs(free.summary["energy_residual"]) < 1e-3
    assert abs(free.signals["axial_bearing_force"]).max() == pytest.approx(38, rel=0.05)


def test_more_drag_turns_the_sign() -> None:
    """At 104 N the normal forces' axial part equals that of friction; at 300 N the rack lags by 9.9 mrad
    (computed elsewhere)."""

    def axial(drag: float) -> float:
        gear = GEAR.replace({"bush.drag": drag})
        turned = rps.run("free-pinion-torque", gear, fidelity=GUIDED.replace({"pinion": "supported"}))
        return float(np.mean(turned.signals["axial_bearing_force"][:-1]))

    low, high = axial(80.0), axial(130.0)
    assert low * high < 0
    assert 80 + 50 * low / (low - high) == pytest.approx(104, rel=0.05)
    lagging = rps.run("reversal", LOOSE.replace({"bush.drag": 300.0}), fidelity=GUIDED)
    assert lagging.summary["lost_motion_angle"] == pytest.approx(9.9e-3, rel=0.02)


def test_axial_friction_holds_the_shaft() -> None:
    """40 N are more than the teeth's 39 N."""
    stuck = rps.run("reversal", LOOSE.replace({"pinion.axial_friction": 40.0}), fidelity=GUIDED)
    assert np.ptp(stuck.signals["pinion_axial"]) < 0.2 * FLOAT
    slipping = rps.run("reversal", LOOSE.replace({"pinion.axial_friction": 20.0}), fidelity=QUASI_STATIC)
    assert np.ptp(slipping.signals["pinion_axial"]) > 0.9 * FLOAT
    lost = slipping.signals["work_support_friction"][-1]
    turning = 4 * GEAR.bearing.bristle_travel  # over which the element's force turns about
    assert lost == pytest.approx(20 * 2 * (FLOAT - turning), rel=0.05)  # there and back once in the cycle
    assert abs(slipping.summary["energy_residual"]) < 1e-3


@pytest.mark.parametrize("law", ["coulomb", "bristle"])
def test_bearings_rub_under_their_load(law: str) -> None:
    """The torque grows by mu r times the radial forces; of a rigid pinion, which has none, not at all."""
    gear = GEAR.replace({"bearing.friction_law": law, "test.turns": 0.5})
    rubbed = gear.replace({"bearing.friction": 0.05})
    without, by_load = (rps.run("free-pinion-torque", each, fidelity=SUPPORTED) for each in (gear, rubbed))
    radial = by_load["upper_bearing_force"] + by_load["lower_bearing_force"]
    more = 0.05 * GEAR.pinion.shaft_diameter / 2 * float(radial.mean())
    assert by_load.summary["torque_mean"] - without.summary["torque_mean"] == pytest.approx(more, rel=0.01)
    assert abs(by_load.summary["energy_residual"]) < 1e-3
    rigid = [rps.run("free-pinion-torque", each, fidelity=QUASI_STATIC).summary for each in (gear, rubbed)]
    assert rigid[0] == pytest.approx(rigid[1], rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("changes", [{}, CLEARANCES, YIELDING])
def test_gears_together_are_single_runs(changes: dict[str, object]) -> None:
    """A table of gears whose pinions stand on bearings: in the loop, with the metrics of single runs."""
    rng, count = np.random.default_rng(5), 30
    table = {
        "yoke.preload": rng.uniform(280, 320, count),
        "mesh.friction": rng.uniform(0.09, 0.11, count),
        "bearing.upper_stiffness": rng.uniform(4e7, 6e7, count),
    }
    gear = LOOSE.replace({**changes, "test.turns": 0.5})
    found = rps.batch("free-pinion-torque", gear, table, fidelity=SUPPORTED)
    assert found.in_loop.mean() > 0.9
    for row in np.flatnonzero(found.in_loop)[[0, 11, 23]].tolist():
        one = gear.replace({path: float(values[row]) for path, values in table.items()})
        alone = rps.run("free-pinion-torque", one, fidelity=SUPPORTED).summary
        assert found.summary["torque_mean"][row] == pytest.approx(alone["torque_mean"], rel=1e-5)
        assert found.summary["rack_lift_range"][row] == pytest.approx(alone["rack_lift_range"], rel=5e-3)
        assert abs(found.summary["energy_residual"][row]) < 1e-4


@pytest.mark.parametrize("scene", ["reversal", "steering-feel"])
def test_equilibria_are_the_limit_of_dynamics(scene: str) -> None:
    slow, fast = (rps.run(scene, LOOSE, fidelity=each).summary for each in ("quasi-static", "flank"))
    assert fast["lost_motion_angle"] == pytest.approx(slow["lost_motion_angle"], rel=0.01)
    assert fast["lost_motion_angle"] < -0.9 * LOST
    assert abs(fast["energy_residual"]) < 1e-3


@pytest.mark.parametrize(
    "changes", [{"fidelity.bush": "chain"}, {"fidelity.rack": "flexible"}, {"rack.bow": "0.1 mm"}]
)
def test_supports_stand_behind_all_other_coordinates(changes: dict[str, object]) -> None:
    """With a chain of segments, modes of bending or a bow, dynamics give the torque of equilibria."""
    choices = {path.removeprefix("fidelity."): each for path, each in changes.items() if "fidelity" in path}
    gear = GEAR.replace({"test.turns": 0.25, **{p: v for p, v in changes.items() if "fidelity" not in p}})
    flank = rps.Fidelity.preset("flank").replace({"pinion": "supported", **choices})
    still = SUPPORTED.replace({} if "bush" in choices else choices)
    torques = [rps.run("free-pinion-torque", gear, fidelity=each) for each in (flank, still)]
    assert torques[0].status.value == "ok"
    assert torques[0].summary["torque_mean"] == pytest.approx(torques[1].summary["torque_mean"], rel=2e-4)


def test_play_of_the_input_shaft_is_that_of_the_beam() -> None:
    """Without the mesh the end of a shaft on two bearings gives way by the overhang and both bearings."""
    end, force = shaft_end(GEAR), np.array([0.0, 98.0, 0.0])
    support = supports(GEAR).gear.support.copy()
    load = ShaftLoad.of(GEAR, force)
    load.on(support)
    u, slope, elastic = np.zeros(5), np.empty((5, 5)), np.empty(5)
    for _ in range(3):
        held.py_func(u, support, elastic, slope)
        u = u + np.linalg.solve(slope, support.pressed - elastic)
    moved, _ = load.end(support, u)
    upper, lower = GEAR.bearing.upper_position, GEAR.bearing.lower_position
    k_upper, k_lower = bearing_stiffnesses(GEAR)
    over, span = Overhang.of(GEAR, upper, end), upper - lower
    on_upper, on_lower = 98 * (end - lower) / span, -98 * (end - upper) / span
    at_upper = on_upper / k_upper - 98 * over.between
    at_lower = on_lower / k_lower
    tip = at_lower + (at_upper - at_lower) * (end - lower) / span
    tip += 98 * over.at_end - on_upper * over.between
    assert moved[1] == pytest.approx(tip, rel=1e-9)


def test_input_shaft_play_as_manuals_measure_it() -> None:
    tight, loose = (rps.run("input-shaft-play", each, fidelity="quasi-static") for each in (GEAR, LOOSE))
    assert tight.summary["input_shaft_play_axial"] == pytest.approx(2 * 49 / 3e7, rel=1e-3)
    assert loose.summary["input_shaft_play_axial"] == pytest.approx(FLOAT + 2 * 49 / 3e7, rel=1e-3)
    wide = rps.run("input-shaft-play", GEAR.replace(CLEARANCES), fidelity="quasi-static")
    more = wide.summary["input_shaft_play_radial"] - tight.summary["input_shaft_play_radial"]
    # of 20 um above and 30 um below, seen at the end; under the preload the shaft uses a part of them
    end, upper, lower = shaft_end(GEAR), 25e-3, -22e-3
    whole = 20e-6 * (end - lower) / (upper - lower) + 30e-6 * (end - upper) / (upper - lower)
    assert 0.5 * whole < more < 1.02 * whole
    for result in (tight, loose, wide):
        assert abs(result.summary["energy_residual"]) < 1e-3


def test_supports_that_no_model_has_are_one_sentence() -> None:
    with pytest.raises(InputError, match="beside its teeth, 7 mm and more"):
        gear_forces(GEAR.replace({"bearing.upper_position": "5 mm"}), SUPPORTED)
    with pytest.raises(InputError, match="resist every motion"):
        gear_forces(GEAR.replace({"housing.seat_stiffness": [1e8, 1e8, 0, 1e5, 1e5, 1e5]}), SUPPORTED)
    with pytest.raises(InputError, match="formulas let the pinion only turn"):
        rps.Fidelity.preset("closed-form").replace({"pinion": "supported"})
    with pytest.raises(InputError, match="general contact does not offer"):
        rps.Fidelity.preset("full").replace({"pinion": "supported"})
