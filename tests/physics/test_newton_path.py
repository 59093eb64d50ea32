"""Equilibria by Newton's method are those of the follower, which knows no tangent; and its tangent is one."""

from dataclasses import replace

import numpy as np
import pytest

from rps_exudyn.forces.memory import NO_MEMORY
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import Maneuver, steady_maneuver
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS
from rps_exudyn.solvers.equilibrium import EquilibriumPath, equilibrium_path
from rps_exudyn.solvers.gear_forces import GearForces, gear_forces
from rps_exudyn.solvers.gear_kernel import along, stacked
from rps_exudyn.solvers.newton_tangent import OUTPUTS, add_fit_tangent, add_seat_tangent
from rps_exudyn.solvers.path_follower import TOLERANCE
from rps_exudyn.solvers.record import record_of_path

FIDELITY = Fidelity.preset("quasi-static")
ERRORS = {"pinion.runout": 15e-6, "pinion.runout_angle": 1.0, "pinion.profile_slope": 3e-6}
ASKEW = ERRORS | {"installation.angle_error": 3e-4, "installation.axis_offset": 60e-6}
GEARS = {
    "default": {},
    "errors": ASKEW | {"pinion.pitch_error": 4e-6},
    "area": ASKEW | {"mesh.law": "area"},
    "nut": {"pinion.runout": 40e-6, "yoke.clearance": 20e-6},
    "stribeck": {"mesh.friction": 0.15, "yoke.friction_law": "stribeck", "bush.friction_law": "stribeck"},
}


def course(name: str, body: str = "pinion") -> tuple[GearForces, GearPair, Maneuver]:
    gear = SteeringGear().replace({"test.turns": 0.5, **GEARS[name]})
    maneuver = steady_maneuver(gear, body, 0.0, np.pi, np.radians(3.0))  # type: ignore[arg-type]
    return gear_forces(gear, FIDELITY), GearPair.of(gear), maneuver


def both(name: str, body: str = "pinion") -> tuple[EquilibriumPath, EquilibriumPath]:
    """The same path by Newton's method, and by the follower."""
    forces, pair, maneuver = course(name, body)
    statics = forces.statics
    assert statics.newton is not None
    rest = pair, maneuver.drive, maneuver.time
    return equilibrium_path(statics, *rest), equilibrium_path(statics._replace(newton=None), *rest)


@pytest.mark.parametrize(
    ("name", "body"),
    [*((name, "pinion") for name in GEARS), ("errors", "rack")],
)
def test_equilibria_are_those_of_the_follower(name: str, body: str) -> None:
    """Both leave less than `TOLERANCE` unbalanced, 1e-3 N; the torque acts at the gain, about 6 mm."""
    ours, theirs = both(name, body)
    drive = 0 if body == "pinion" else 1
    assert len(ours.time) == len(theirs.time)
    assert ours.residual <= TOLERANCE
    lever = 6e-3 if body == "pinion" else 1.0
    assert np.abs(ours.forces - theirs.forces)[:, drive].max() < 5 * TOLERANCE * lever
    apart = np.abs(ours.coordinates - theirs.coordinates) * CHARACTERISTIC_LENGTHS
    assert apart.max() < 2e-9  # a few mN over the softest stiffness, of rolling


def test_it_evaluates_the_forces_half_as_often() -> None:
    ours, theirs = both("errors")
    assert ours.evaluations < 0.5 * theirs.evaluations
    assert ours.rescues == 0


def test_kept_outputs_are_those_of_the_force_elements() -> None:
    """They stand at the last place evaluated, where less than 0.05 N of 300 N were unbalanced."""
    forces, pair, maneuver = course("errors")
    path = equilibrium_path(forces.statics, pair, maneuver.drive, maneuver.time)
    kept = record_of_path(forces.elements, path, maneuver.drive)
    evaluated = replace(kept, known=None)
    assert kept.known is not None
    assert set(OUTPUTS) >= {element.name for element in forces.elements}
    for element in forces.elements:
        found, expected = kept.outputs(element), evaluated.outputs(element)
        assert np.abs(found - expected).max(axis=0) == pytest.approx(
            0, abs=2e-4 * np.abs(expected).max(axis=0).max()
        )


@pytest.mark.parametrize("gear", [*GEARS.values(), ASKEW | {"mesh.law": "teeth"}], ids=[*GEARS, "teeth"])
def test_outputs_together_are_those_of_each_element(gear: dict[str, object]) -> None:
    """To the last digits, also while the gear vibrates, and in loads and weight."""
    loaded = SteeringGear().replace({"installation.gravity": -9.81, **gear})
    forces, rng = gear_forces(loaded, FIDELITY, rack_load=500.0), np.random.default_rng(1)
    places = rng.normal(size=(20, 8)) * [0.02, 1e-4, 5e-6, 5e-6, 1e-4, 1e-4, 1e-4, 2e-4]
    rates = rng.normal(size=(20, 8)) * [1.0, 6e-3, 1e-4, 1e-4, 1e-2, 1e-3, 1e-3, 1e-4]
    together = forces.outputs(places, rates)
    assert together is not None
    assert {element.name for element in forces.elements} == set(OUTPUTS)
    for element in forces.elements:
        first, count = OUTPUTS[element.name]
        columns = stacked(element.bodies)
        each = along(element.kernel)(
            np.ascontiguousarray(places[:, columns]),
            np.ascontiguousarray(rates[:, columns]),
            element.data,
            np.zeros(20),
            np.zeros((20, 0)),
            NO_MEMORY,
        )
        largest = np.abs(each).max(axis=0)
        assert np.all(np.abs(together[:, first : first + count] - each) <= 1e-12 * largest)
        assert largest.any()


def test_what_newton_does_not_find_the_follower_does() -> None:
    forces, pair, maneuver = course("errors")
    statics = forces.statics
    assert statics.newton is not None
    follow = statics.newton.follow

    def gives_up(*arguments: object) -> tuple[int, int, int, float]:
        _, evaluations, iterations, residual = follow(*arguments)
        return 20, evaluations, iterations, residual

    part = statics._replace(newton=statics.newton._replace(follow=gives_up))
    path = equilibrium_path(part, pair, maneuver.drive, maneuver.time)
    whole = equilibrium_path(statics, pair, maneuver.drive, maneuver.time)
    assert path.converged
    assert path.outputs is None
    assert path.forces[:, 0] == pytest.approx(whole.forces[:, 0], abs=5 * TOLERANCE * 6e-3)


@pytest.mark.parametrize("per_time", [0.0, 500.0])
def test_tangents_of_seat_and_fit_are_derivatives_of_their_forces(per_time: float) -> None:
    """Along paths on which rates follow places; what turns with the bar's tilt of 1e-4 is left out: 1 %."""
    forces, pair, maneuver = course("errors")
    path = equilibrium_path(forces.statics, pair, maneuver.drive, maneuver.time[:8])
    q, v, scale = path.coordinates[5], path.rates[5], 1 / CHARACTERISTIC_LENGTHS[1:]
    seat, fit = np.zeros((8, 8)), np.zeros((8, 8))
    loads = np.zeros((2, 8))
    add_seat_tangent(q, v, forces.seat.data, per_time, seat, loads)
    add_fit_tangent(q, v, forces.fit.data, per_time, fit)
    for element, found, rows in ((forces.seat, seat[1:, 1:], 7), (forces.fit, fit[1:7, 1:], 6)):
        expected = np.empty((rows, rows))
        for j in range(rows):
            step = np.zeros(8)
            step[1 + j] = 1e-9 * scale[j]
            after, before = (
                element.evaluate((q + s * step)[1 : 1 + rows], (v + s * per_time * step)[1 : 1 + rows])
                for s in (1, -1)
            )
            expected[:, j] = (after - before)[:rows] / (2 * step[1 + j])
        lengths = np.outer(scale[:rows], scale[:rows])
        difference = (found[:, :rows] - expected) * lengths
        assert np.abs(difference).max() < 0.01 * np.abs(expected * lengths).max()
