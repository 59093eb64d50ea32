"""The follower of equilibria: what it finds balances, whatever leads there, and costs few evaluations."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import root

from rps_exudyn.forces.friction import TIME
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import Maneuver, steady_maneuver
from rps_exudyn.solvers.equilibrium import EquilibriumPath, equilibrium_path
from rps_exudyn.solvers.follower import extrapolated
from rps_exudyn.solvers.gear_forces import GearForces, gear_forces
from rps_exudyn.solvers.record import record_of_path
from rps_exudyn.solvers.rescue import JUMP, Settling, search
from rps_exudyn.solvers.settling import TOLERANCE
from verification.law_area import replaced

FIDELITY = Fidelity.preset("quasi-static")
ERRORS = {"pinion.runout": 15e-6, "pinion.runout_angle": 1.0, "pinion.profile_slope": 3e-6}
ASKEW = ERRORS | {"installation.angle_error": 3e-4, "installation.axis_offset": 60e-6}
ON_BRISTLES = {f"{part}.friction_law": "bristle" for part in ("mesh", "yoke", "bush", "bearing")}
GEARS = {
    "default": {},
    "errors": ASKEW | {"pinion.pitch_error": 4e-6},
    "area": ASKEW | {"mesh.law": "area"},
    "teeth": ASKEW | {"mesh.law": "teeth"},
    "nut": {"pinion.runout": 40e-6, "yoke.clearance": 20e-6},
    "stribeck": {"mesh.friction": 0.15, "yoke.friction_law": "stribeck", "bush.friction_law": "stribeck"},
    "bristle": ASKEW | ON_BRISTLES,
    "bow": ASKEW | {"rack.bow": 0.2e-3},
    "flexible": ASKEW,
    "guided": ASKEW,
    "spheres": ERRORS,
}
MODELS = {
    "flexible": FIDELITY.replace({"rack": "flexible"}),
    "guided": FIDELITY.replace({"rack": "guided"}),
    "spheres": FIDELITY.replace({"mesh": "general-contact", "profile_samples": 27, "axial_samples": 18}),
}


def course(name: str, body: str = "pinion") -> tuple[GearForces, GearPair, Maneuver]:
    gear = replaced(SteeringGear(), {"test.turns": 0.5, **GEARS[name]})
    maneuver = steady_maneuver(gear, body, 0.0, np.pi, np.radians(3.0))  # type: ignore[arg-type]
    return gear_forces(gear, MODELS.get(name, FIDELITY)), GearPair.of(gear), maneuver


def followed(name: str, body: str = "pinion") -> tuple[GearForces, EquilibriumPath, Maneuver]:
    forces, pair, maneuver = course(name, body)
    path = equilibrium_path(forces.statics, pair, maneuver.drive, maneuver.time)
    assert path.converged
    return forces, path, maneuver


# law "area" is compiled in each process that needs it
NAMES = [pytest.param(name, marks=pytest.mark.long if name == "area" else ()) for name in GEARS]
COURSES = [*(pytest.param(*each.values, "pinion", marks=each.marks) for each in NAMES), ("errors", "rack")]


@pytest.mark.parametrize(("name", "body"), COURSES)
def test_forces_balance_where_it_ends(name: str, body: str) -> None:
    """At most `TOLERANCE`, 1e-3 N with moments over a centimetre, is left at each instant, and the torque is
    that of an evaluation there, to round-off in the coordinates."""
    forces, path, maneuver = followed(name, body)
    balance, driven = forces.statics, maneuver.drive.coordinate
    free = balance.free(driven)
    assert path.residual <= TOLERANCE
    for k in range(1, len(path.time)):
        if balance.has_bristles:
            balance.memory[0], balance.memory[1, TIME] = path.kept[k, 0], path.time[k]
        total = balance.force(path.coordinates[k], path.rates[k])
        assert np.abs(total[free] / balance.lengths[free]).max() <= 1.01 * TOLERANCE
        assert total[driven] == pytest.approx(path.forces[k, driven], rel=1e-6)


@pytest.mark.parametrize(("name", "body"), COURSES)
def test_rates_are_those_of_the_path(name: str, body: str) -> None:
    """Those of rigid bodies and of the parabola through three deviations from them, at the mesh; against
    backward differences of the coordinates. A part in five hundred of the speeds, by the bends of the path.
    """
    forces, path, _ = followed(name, body)
    step = path.time[1] - path.time[0]
    q, k = path.coordinates, np.arange(2, len(path.time))
    differences = (1.5 * q[k] - 2 * q[k - 1] + 0.5 * q[k - 2]) / step
    lengths = forces.statics.lengths
    apart = np.abs(differences - path.rates[k]) * lengths
    assert apart.max() < 2e-3 * np.abs(path.rates * lengths).max()


@pytest.mark.parametrize("name", ["default", "errors", "teeth", "bristle", "bow"])
def test_another_method_finds_the_same_place(name: str) -> None:
    """Powell's method from 0.1 um off, with differences for its tangent: both within 2e-9 m, a few mN over
    the softest stiffness, of rolling."""
    forces, path, maneuver = followed(name)
    balance, free = forces.statics, forces.statics.free(maneuver.drive.coordinate)
    lengths, rng = balance.lengths[free], np.random.default_rng(3)
    per_time = 1.5 / (path.time[1] - path.time[0])  # of the rates, by the parabola through three instants
    for k in (5, 30, 50):
        q, v = path.coordinates[k].copy(), path.rates[k].copy()

        def left(moved: np.ndarray, k: int = k, q: np.ndarray = q, v: np.ndarray = v) -> np.ndarray:
            if balance.has_bristles:
                balance.memory[0], balance.memory[1, TIME] = path.kept[k, 0], path.time[k]
            place, rate = q.copy(), v.copy()
            place[free] += moved / lengths
            rate[free] += per_time * moved / lengths
            return balance.force(place, rate)[free] / lengths

        found = root(left, 1e-7 * rng.normal(size=free.size), tol=1e-13)
        assert np.abs(left(found.x)).max() < TOLERANCE
        assert np.abs(found.x).max() < 2e-9


def test_it_evaluates_few_forces() -> None:
    """Newton's method, an old tangent where it serves: about four evaluations per instant, 257 for 62; of
    teeth a third softer 228."""
    _, path, _ = followed("errors")
    assert path.evaluations < 4.5 * len(path.time)
    assert path.tangents < 1.5 * len(path.time)
    assert path.rescues == 0


@pytest.mark.parametrize("name", NAMES)
def test_kept_outputs_are_those_of_the_parts(name: str) -> None:
    """They stand at the last place evaluated, where less than 0.05 N of 300 N were unbalanced."""
    forces, path, maneuver = followed(name)
    kept = record_of_path(forces, path, maneuver.drive)
    evaluated = replace(kept, known=None)
    assert kept.known is not None
    for part in forces.parts:
        found, expected = kept.outputs(part), evaluated.outputs(part)
        assert np.abs(found - expected).max(axis=0) == pytest.approx(
            0, abs=2e-4 * np.abs(expected).max(axis=0).max()
        )


def test_a_parabola_leads_on_from_uneven_instants() -> None:
    time = np.array([0.0, 0.3, 0.4, 1.0])
    found, guess = np.outer(time**2 - 2 * time, [1.0, -3.0]), np.empty(2)
    extrapolated.py_func(3, 0, time, found, guess)
    assert guess == pytest.approx(found[3])


def test_a_rescue_goes_on_from_where_the_hybrid_method_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    """It has left less than contact's jumps do: no other start is tried, and the gear creeps a last bit."""
    starts, tried = [np.zeros(1), np.ones(1)], []

    def creeping(_: Settling, start: np.ndarray) -> tuple[np.ndarray, float]:
        tried.append(start)
        return start, 0.0

    near = np.full(1, 2.0)
    monkeypatch.setattr("rps_exudyn.solvers.rescue.by_hybrid_method", lambda *_: (near, JUMP / 2))
    monkeypatch.setattr(Settling, "settled", creeping)
    settling = Settling(lambda q, v, _: (q, v), np.zeros(1, int), np.ones(1), near, near, near, 0.0)
    assert search(settling, starts) == (near, 0.0)
    assert tried == [near]
