"""The pinion angle over which bristles turn about after a turn: a guided rack, and one that rolls over."""

from functools import cache

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.analysis.passes import Pass, passes
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result

PARTS = ("mesh", "yoke", "bush", "bearing")
GEAR, TURNED = SteeringGear(), 0.8  # of the running torque, from and to which it turns about
PAIR, POINTS = GearPair.of(GEAR), 5  # along the path of contact
SHAFT, BAR = GEAR.pinion.shaft_diameter / 2, GEAR.rack.bar_diameter / 2


@cache
def reversal(law: str, presliding: float = 10e-6, rack: str = "free") -> Result:
    laws = {"friction_law": law, "bristle_travel": presliding}
    gear = GEAR.replace({f"{part}.{name}": value for part in PARTS for name, value in laws.items()})
    result = rps.run("reversal", gear, fidelity=Fidelity.preset("quasi-static").replace({"rack": rack}))
    assert result.status is Status.OK, result.message
    return result


def after_a_turn(result: Result) -> tuple[Pass, np.ndarray, np.ndarray]:
    """The pass after the first turn, the angles turned, and the torque over the running one."""
    before, after = passes(result.signals)[:2]
    torque = after.direction * after.signals["pinion_torque"]
    return after, np.abs(after.angle - before.angle[-1]), torque / np.median(torque)


def turning_angle(turned: np.ndarray, torque: np.ndarray) -> float:
    """Pinion angle over which the torque goes from -80 to +80 % of the running one."""
    end = int(np.argmax(torque > TURNED)) + 1
    return float(np.ptp(np.interp([-TURNED, TURNED], torque[:end], turned[:end])))


def torques(after: Pass) -> dict[str, float]:
    """What friction takes of the pinion's torque over a pass, by part [N m]."""
    names = ("mesh", "seat", "bush", "bearing")
    return {name: np.ptp(after.signals[f"work_{name}_friction"]) / np.ptp(after.angle) for name in names}


def anchor(after: Pass, presliding: float) -> float:
    """Angle over which sum(T min(2 x - 1, 1)), x = arm angle / (4 delta), goes from -80 to +80 % of sum T
    [rad]; T / arm is the force that rubs."""
    taken = torques(after)
    rubs = {"mesh": GEAR.mesh.friction * np.mean(after.signals["mesh_normal_force"])}
    rubs |= {"bearing": taken["bearing"] / SHAFT}
    rubs |= {name: taken[name] / float(PAIR.gain) for name in ("seat", "bush")}
    angle, whole = np.linspace(0, 40 * presliding / SHAFT, 20001), sum(taken.values())
    turned = [
        taken[name] * np.minimum(taken[name] / rubs[name] * angle / (2 * presliding) - 1, 1) for name in taken
    ]
    return float(np.ptp(np.interp([-TURNED, TURNED], sum(turned) / whole, angle)))


def bent(slips: np.ndarray, presliding: float) -> np.ndarray:
    """Forces of bristles over their limit (n + 1, 2) along slips (n, 2) [m] that follow long sliding the
    other way: a first loading ends after twice the travel."""
    found = [-slips[-1] / np.linalg.norm(slips[-1])]
    for slip in slips:
        trial = found[-1] + slip / (2 * presliding)
        found.append(trial / max(1.0, float(np.linalg.norm(trial))))
    return np.array(found)


def along_the_record(after: Pass, turned: np.ndarray, presliding: float, aside: bool = True) -> np.ndarray:
    """Torque over the running one with slips from the recorded motion of the rack, integrated apart.

    A rack whose travel X runs ahead of the pinion's while both flanks touch slides along its teeth by
    (X - gain turned) / sin(tooth angle); with `aside` false it is taken to follow the pinion.
    """
    step, taken, gain = np.diff(turned)[:, None], torques(after), float(PAIR.gain)
    travel = np.abs(after.signals["rack_displacement"] - after.signals["rack_displacement"][0])
    ahead = np.diff(travel - gain * turned) / np.sin(PAIR.beta_r) * aside
    rolled = BAR * np.diff(after.signals["rack_roll"]) * aside
    # slip of the teeth for one radian of the pinion, along the tooth and up the profile
    first, last = PAIR.active_path
    place = first + (last - first) * (np.arange(POINTS) + 0.5) / POINTS
    lean = np.sin(PAIR.alpha_t) * np.sin(PAIR.beta_p)
    along = -PAIR.reference_radius * np.sin(PAIR.delta) / np.cos(PAIR.beta_r)
    lever = np.stack([along + lean * place, np.sqrt(1 - lean**2) * place], axis=-1)
    slips = lever * step[..., None] - np.stack([ahead, 0 * ahead], axis=-1)[:, None]
    way = lever / np.linalg.norm(lever, axis=-1, keepdims=True)  # of steady rolling, at each point
    beside = np.stack([-way[:, 1], way[:, 0]], axis=-1)
    mean = np.stack([(slips * each).sum(axis=-1).mean(axis=-1) for each in (way, beside)], axis=-1)
    carried = bent(mean, presliding)[:, 0]
    guides = np.stack([np.diff(travel) if aside else gain * step[:, 0], rolled], axis=-1)
    shaft = np.stack([SHAFT * step[:, 0], 0 * rolled], axis=-1)
    torque = taken["mesh"] * carried + taken["bearing"] * bent(shaft, presliding)[:, 0]
    torque = torque + (taken["seat"] + taken["bush"]) * bent(guides, presliding)[:, 0]
    return np.asarray(torque / sum(taken.values()))


def test_reversal_angle_of_a_guided_rack() -> None:
    """That of all parts side by side, to 5 %, beyond the angle by which the gear yields elastically, as it
    does with Coulomb's law. One bristle takes 3.2 delta from -0.8 to 0.8 and 4 delta from -1 to 1."""
    found = {law: after_a_turn(reversal(law, rack="guided")) for law in ("bristle", "coulomb")}
    beyond = turning_angle(*found["bristle"][1:]) - turning_angle(*found["coulomb"][1:])
    assert beyond == pytest.approx(anchor(found["bristle"][0], 10e-6), rel=0.05)


@pytest.mark.parametrize("presliding", [5e-6, 10e-6])
def test_a_free_rack_slides_along_its_teeth_as_it_rolls_over(presliding: float) -> None:
    """A free rack rolls to its other side and slides along its teeth meanwhile, so that these slip less and
    in another direction. Bristles integrated along that slip turn about over the same angle, to 5 %; along
    the slip of a rack that follows the pinion they do so 16 and 6 % earlier."""
    after, turned, torque = after_a_turn(reversal("bristle", presliding))
    found = turning_angle(turned, torque)
    aside, following = (along_the_record(after, turned, presliding, each) for each in (True, False))
    assert turning_angle(turned, aside) == pytest.approx(found, rel=0.05)
    assert turning_angle(turned, following) < 0.95 * found


def test_coulomb_shows_the_rolling_over_alone() -> None:
    """Without bristles the torque of a free rack is 3 to 20 % short over the first 3 mrad after a turn, that
    of a guided one not at all; what the slip along the teeth makes of it, to 8 % of the torque."""
    after, turned, torque = after_a_turn(reversal("coulomb"))
    predicted = along_the_record(after, turned, 1e-9)
    _, other, guided = after_a_turn(reversal("coulomb", rack="guided"))
    for angle in (0.1e-3, 0.3e-3, 1e-3, 3e-3):
        found = float(np.interp(angle, turned, torque))
        assert 0.80 < found < 0.97
        assert float(np.interp(angle, turned, predicted)) == pytest.approx(found, abs=0.08)
        assert float(np.interp(angle, other, guided)) == pytest.approx(1.0, abs=2e-3)
