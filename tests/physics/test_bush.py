"""The bush chain against beam theory, in algebra and in Exudyn."""

import exudyn as exu
import numpy as np
import pytest
from exudyn.itemInterface import Force, MarkerBodyRigid

from part_law import PartLaw
from rps_exudyn.forces.bush import Chain, Tube, resting_segments, stored_in_chain
from rps_exudyn.multibody.bodies import add_chain
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.gear_forces import gear_forces

GEAR = SteeringGear()
TUBE, LENGTH = Tube.of(GEAR), GEAR.bush.length
LATERAL = (1, 1)


def tip_compliance(tube: Tube) -> np.ndarray:
    """Exact static compliance of the cantilever's free end, shape (6, 6): x y z, about x y z."""
    c = np.diag(LENGTH / np.array([tube.axial, np.inf, np.inf, tube.torsion, tube.bending, tube.bending]))
    c[1, 1] = c[2, 2] = LENGTH**3 / (3 * tube.bending) + LENGTH / tube.shear
    c[1, 5] = c[5, 1] = LENGTH**2 / (2 * tube.bending)  # a force along y turns about +z
    c[2, 4] = c[4, 2] = -c[1, 5]  # a force along z turns about -y
    return c


def test_a_thin_tube_has_the_stiffness_of_its_section() -> None:
    """E I / G J = 1 + nu of round sections; E A / G A_s = 4 (1 + nu) of thin tubes, half of which shears."""
    ratio = 1 + GEAR.bush.poisson_ratio
    assert (TUBE.bending / TUBE.torsion, TUBE.axial / TUBE.shear) == pytest.approx((ratio, 4 * ratio))


def static_tip_deflection(chain: Chain, load: float) -> float:
    """Deflection along Y of the last segment at the end face under a load there, by Exudyn's SolveStatic."""
    SC = exu.SystemContainer()
    mbs = SC.AddSystem()
    rest = np.zeros((len(chain.centres), 6))
    _, bodies = add_chain(mbs, GEAR, chain, rest, mass=1e-3, inertia=1e-7 * np.eye(3), axis_height=0.0)
    to_tip = -(chain.length - chain.centres[-1])
    tip = mbs.AddMarker(MarkerBodyRigid(bodyNumber=bodies[-1], localPosition=[to_tip, 0, 0]))
    mbs.AddLoad(Force(markerNumber=tip, loadVector=[0, load, 0]))
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.staticSolver.verboseMode = 0
    # below the round-off floor of so stiff a chain Newton stalls; the system is nearly linear, so that the
    # two steps this takes leave an error far below it
    settings.staticSolver.newton.relativeTolerance = 1e-5
    mbs.SolveStatic(settings)
    return float(mbs.GetObjectOutputBody(bodies[-1], exu.OutputVariableType.Displacement, [to_tip, 0, 0])[1])


@pytest.mark.parametrize("n", [1, 3, 25])
def test_chain_with_half_pieces_is_a_timoshenko_beam(n: int) -> None:
    """Exact for loads at the tip, whatever N: its pieces tile the beam, the last half piece is the fit's."""
    chain = Chain.of(TUBE, LENGTH, n)
    to_tip = np.eye(6)
    to_tip[1, 5] = chain.length - chain.end_station
    to_tip[2, 4] = -to_tip[1, 5]
    compliance = chain.compliance_at(LENGTH) + to_tip @ np.diag(1 / chain.end) @ to_tip.T
    assert compliance == pytest.approx(tip_compliance(TUBE), rel=1e-12, abs=1e-18)


def test_exudyn_chain_of_25_is_a_timoshenko_beam() -> None:
    """The last segment is rigid to its end, which without the last half piece costs 1.3 %."""
    chain = Chain.of(TUBE, LENGTH, 25)
    deflection = static_tip_deflection(chain, load := 10.0)
    assert deflection / (load * tip_compliance(TUBE)[LATERAL]) == pytest.approx(1, abs=0.015)
    assert deflection == pytest.approx(load * chain.compliance_at(LENGTH)[LATERAL], rel=1e-6)


@pytest.mark.parametrize("place", [(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)])
def test_a_bar_in_the_bush_is_held_as_by_a_cantilever(place: tuple[int, ...]) -> None:
    """A bar moved by y, z and turned about Y, Z bends a cantilever that is held at X = d + L and free at
    X = d: a force there along Y turns the end by -L^2 / 2EI about Z, one along Z by +L^2 / 2EI about Y."""
    law = PartLaw.of(gear_forces(GEAR.replace({"bush.drag": 0.0}), Fidelity.preset("quasi-static")), "bush")
    y, z, b, c = 1e-7 * np.array(place)
    d, lateral = GEAR.bush.distance, tip_compliance(TUBE)[LATERAL]
    swing, turn = LENGTH**2 / (2 * TUBE.bending), LENGTH / TUBE.bending
    f_y, m_z = np.linalg.solve([[lateral, -swing], [-swing, turn]], [y + d * c, c])
    f_z, m_y = np.linalg.solve([[lateral, swing], [swing, turn]], [z - d * b, b])
    expected = -np.array([0, f_y, f_z, 0, m_y - d * f_z, m_z + d * f_y])
    force = law.evaluate(np.array([0, y, z, 0, b, c]), np.zeros(6))[:6]
    assert force == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())


def test_resting_segments_agree_with_the_compliance_and_the_energy() -> None:
    """Clapeyron: twice the stored energy is force times displacement."""
    chain = Chain.of(TUBE, LENGTH, 25)
    wrench = np.array([5.0, 10.0, -7.0, 0.02, 0.05, 0.03])
    rest = resting_segments(GEAR, chain, wrench, chain.centres[-1])
    stored = stored_in_chain(GEAR, chain, rest[None])[0]
    assert 2 * stored == pytest.approx(wrench @ rest[-1], rel=1e-12)
