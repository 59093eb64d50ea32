"""Calculations that rows of validation name: numbers of the package that no scene and no geometry report has.

Each takes its arguments in SI, angles in degrees, and returns SI.
"""

from collections.abc import Callable

import numpy as np

from rps_exudyn.analysis.efficiency import LoadTest
from rps_exudyn.forces.bush import bush_chain
from rps_exudyn.gears.rack_beam import RackBeam
from rps_exudyn.gears.tooth_stiffness import (
    basic_rack_factor,
    mesh_stiffness_transverse,
    single_stiffness,
    theoretical_stiffness,
    virtual_teeth,
)
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.free_pinion_torque import SCENE as FREE_PINION_TORQUE
from rps_exudyn.scenes.load_test import SCENE as LOAD_TEST
from rps_exudyn.scenes.rack_lift import SCENE as RACK_LIFT
from rps_exudyn.simulate.run import simulate
from rps_exudyn.solvers.yoke_stop import lift_of_torque

LATERAL = (1, 1)  # displacement along y by a force along y


def iso_single_stiffness(
    teeth_1: float,
    teeth_2: float,
    shift_1: float,
    shift_2: float,
    helix_deg: float,
    pressure_deg: float,
    dedendum: float,
) -> float:
    """Return c' of two gears by ISO 6336-1, method B [N/m^2]."""
    helix, alpha = np.deg2rad(helix_deg), np.deg2rad(pressure_deg)
    base = float(np.arcsin(np.sin(helix) * np.cos(alpha)))
    z_n1, z_n2 = (virtual_teeth(z, helix, base) for z in (teeth_1, teeth_2))
    theoretical = theoretical_stiffness(z_n1, z_n2, shift_1, shift_2)
    return single_stiffness(theoretical, basic_rack_factor(dedendum, alpha), helix)


def iso_mesh_stiffness(contact_ratio: float, **gears: float) -> float:
    """Return c_gamma_alpha of two gears by ISO 6336-1, method B [N/m^2]."""
    return mesh_stiffness_transverse(iso_single_stiffness(**gears), contact_ratio)


def single_pair_stiffness(face_width: float, **gears: float) -> float:
    """Return c' b of two gears [N/m]."""
    return face_width * iso_single_stiffness(**gears)


def default_approach() -> float:
    """Return by how much the yoke presses the default rack, guided, into its pinion, mean over a pitch by
    equilibria, law line [m]."""
    test = {"test.turns": 1 / SteeringGear().pinion.teeth, "test.start_angle": 0.0, "mesh.law": "line"}
    guided = Fidelity.preset("quasi-static").replace({"rack": "guided"})
    result = simulate(FREE_PINION_TORQUE.name, SteeringGear().replace(test), guided)
    return -float(result["rack_y"].mean())


def bush_stiffness(outer: float, inner: float, length: float) -> float:
    """Return force over deflection at the free end of a bush of POM [N/m]."""
    sizes = {"bush.outer_diameter": outer, "bush.inner_diameter": inner, "bush.length": length}
    gear = SteeringGear().replace({**sizes, "rack.bar_diameter": inner - 1e-3})
    return float(1 / bush_chain(gear).compliance_at(length)[LATERAL])


def bar_frequency(plane: float, number: float) -> float:
    """Return a free-free frequency of the default bar [Hz]; plane 0 bends along Y, 1 along Z."""
    modes = RackBeam.of(SteeringGear()).modes(3)
    return float(np.sort(modes.frequencies[modes.plane == int(plane)])[int(number) - 1] / (2 * np.pi))


def load_test_half_sum(mass: float, guided: float = 0) -> float:
    """Return (torque raising + torque holding) / 2 of the default gear by equilibria [N m], law line, whose
    forces are those of the closed form; its rack is free, or `guided` (1)."""
    test = _load_test(mass, guided)
    return (test.torque_forward + test.torque_reverse) / 2


def load_test_half_difference(mass: float, guided: float = 0) -> float:
    """Return (torque raising - torque holding) / 2 over the free torque, by equilibria, likewise."""
    test = _load_test(mass, guided)
    return (test.torque_forward - test.torque_reverse) / 2 / test.free_torque


def rack_lift_over_closed_form(torque: float) -> float:
    """Return the lift of the default rack by equilibria over its closed form."""
    gear = SteeringGear().replace({"test.lift_torque": torque})
    result = simulate(RACK_LIFT.name, gear, Fidelity.preset("quasi-static"))
    return result.summary["rack_lift"] / lift_of_torque(gear, torque)


def dynamics_over_equilibria() -> float:
    """Return the default gear's mean free torque in motion over that by equilibria."""
    moving, still = (
        simulate(FREE_PINION_TORQUE.name, SteeringGear(), Fidelity.preset(name)).summary["torque_mean"]
        for name in ("flank", "quasi-static")
    )
    return moving / still


def _load_test(mass: float, guided: float) -> LoadTest:
    gear = SteeringGear().replace({"test.load_mass": mass, "test.turns": 1 / 3, "mesh.law": "line"})
    fidelity = Fidelity.preset("quasi-static").replace({"rack": "guided"} if guided else {})
    found = simulate(LOAD_TEST.name, gear, fidelity).summary
    return LoadTest(1.0, 1.0, found["torque_forward"], found["torque_reverse"], found["free_torque"])


CALCULATIONS: dict[str, Callable[..., float]] = {
    each.__name__: each
    for each in (
        *(iso_single_stiffness, iso_mesh_stiffness, single_pair_stiffness, default_approach),
        *(bush_stiffness, bar_frequency, load_test_half_sum, load_test_half_difference),
        *(rack_lift_over_closed_form, dynamics_over_equilibria),
    )
}
"""Name in a row -> calculation."""
