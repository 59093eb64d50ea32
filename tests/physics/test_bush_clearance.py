"""Clearance of the bar in its bush: nothing within it, beyond it the fit; energy, tangent, a gear with it."""

import numpy as np
import pytest

import rps_exudyn as rps
from part_law import PartLaw, alone
from rps_exudyn.forces.force_element import ELASTIC_ENERGY
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.solvers.gear_forces import gear_forces
from verification.difference_tangent import difference_tangent

QUASI_STATIC, FLANK = (Fidelity.preset(name) for name in ("quasi-static", "flank"))
TIGHT = rps.SteeringGear().replace({"bush.drag": 0.0})
LOOSE = TIGHT.replace({"bush.clearance": "40 um"})
GAP = 20e-6  # radial


def bush(gear: rps.SteeringGear) -> PartLaw:
    return PartLaw.of(gear_forces(gear, QUASI_STATIC), "bush")


def shifted(y: float, z: float) -> np.ndarray:
    return np.array([0.0, y, z, 0.0, 0.0, 0.0])


def test_a_bar_within_the_clearance_is_free() -> None:
    """But for the centring of both ends."""
    law = bush(LOOSE)
    force = law.evaluate(shifted(0.6 * GAP, -0.7 * GAP), np.zeros(6))[:6]
    assert np.abs(force[1:3]).max() < 2.1 * law.forces.gear.fit.centring * GAP


@pytest.mark.parametrize("angle", [0.0, 1.0, 2.5])
def test_beyond_the_clearance_the_fit_presses(angle: float) -> None:
    """A bar that is shifted by r is pressed as one without clearance by r - g."""
    way = np.array([np.cos(angle), np.sin(angle)])
    loose = bush(LOOSE).evaluate(shifted(*(3 * GAP * way)), np.zeros(6))[:6]
    tight = bush(TIGHT).evaluate(shifted(*(2 * GAP * way)), np.zeros(6))[:6]
    assert np.abs(loose - tight).max() < 0.01 * np.abs(tight).max()


def test_a_bar_that_tilts_touches_at_both_ends_of_the_bush() -> None:
    """About the middle of the bush it is free up to clearance over length."""
    law = bush(LOOSE)
    fit, length = law.forces.gear.fit, LOOSE.bush.length
    for tilt, is_free in ((0.9 * 2 * GAP / length, True), (1.1 * 2 * GAP / length, False)):
        pitch = shifted(-tilt * (fit.station + length / 2), 0.0)  # the middle of the bush stays
        pitch[5] = tilt
        force = law.evaluate(pitch, np.zeros(6))[:6]
        assert (np.abs(force[1:3]).max() < 2.1 * fit.centring * GAP) == is_free


@pytest.mark.parametrize("rack", ["free", "flexible"])
def test_forces_are_the_slope_of_the_energy_and_have_their_tangent(rack: str) -> None:
    """Small tilts, to what the bar's rotations add."""
    forces = alone(gear_forces(LOOSE, QUASI_STATIC.replace({"rack": rack})), "bush")
    balance, rng = forces.statics, np.random.default_rng(3)
    for _ in range(5):
        q = np.zeros(balance.size)
        q[2:4], q[5:7] = rng.uniform(-60e-6, 60e-6, 2), rng.uniform(-2e-3, 2e-3, 2) / 20
        tangent = balance.tangent(q, np.zeros(q.size), 1.0, 0.0)
        differences = difference_tangent(balance, q, np.zeros(q.size), 1.0, 0.0)
        scale = np.outer(balance.lengths, balance.lengths)
        ours, theirs = tangent / scale, differences / scale
        assert np.abs(ours - theirs).max() < 0.01 * np.abs(theirs).max()
    law = bush(LOOSE)
    for _ in range(20):
        q = np.array([0.0, *rng.uniform(-60e-6, 60e-6, 2), 0.0, *rng.uniform(-1e-4, 1e-4, 2)])
        out, energy = law.evaluate(q, np.zeros(6)), law.size + ELASTIC_ENERGY
        for i, step in ((1, 1e-9), (2, 1e-9), (4, 1e-8), (5, 1e-8)):
            moved = step * np.eye(6)[i]
            ahead, behind = (law.evaluate(q + way * moved, np.zeros(6))[energy] for way in (1, -1))
            assert -(ahead - behind) / (2 * step) == pytest.approx(out[i], rel=2e-3, abs=0.05)


@pytest.mark.parametrize("changes", [{}, {"fidelity.bush": "chain"}, {"fidelity.rack": "flexible"}])
def test_dynamics_turn_a_loose_bar_as_equilibria_do(changes: dict[str, object]) -> None:
    choices = {path.removeprefix("fidelity."): value for path, value in changes.items()}
    gear = LOOSE.replace({"bush.drag": 20.0, "test.turns": 0.25})
    still = QUASI_STATIC.replace({} if "bush" in choices else choices)
    fast, slow = (
        rps.run("free-pinion-torque", gear, fidelity=each) for each in (FLANK.replace(choices), still)
    )
    assert fast.status.value == slow.status.value == "ok"
    assert fast.summary["torque_mean"] == pytest.approx(slow.summary["torque_mean"], rel=1e-3)
    assert abs(slow.summary["energy_residual"]) < 1e-4
