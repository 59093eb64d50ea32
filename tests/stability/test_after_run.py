"""Wrong runs end with success flags and plausible torques: each kind of wrongness is named.

Each test takes a sound record and spoils one thing in it, as the failure would.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Status
from rps_exudyn.scenes.checks import after_run

DEEPEST = 50e-6
VALID_TO = {"mesh_penetration": DEEPEST}


@pytest.fixture
def signals() -> dict[str, np.ndarray]:
    n = 50
    return {
        "time": np.linspace(0, 2, n),
        "pinion_angle": np.linspace(0, 1, n),
        "pinion_torque": np.full(n, 0.6),
        "rack_y": np.full(n, -16e-6),
        "mesh_normal_force": np.full(n, 880.0),
        "mesh_penetration": np.full(n, 8e-6),
        "work_drive": np.linspace(0, 0.6, n),
        "work_mesh_friction": np.linspace(0, 0.6, n),
        "stored_energy": np.zeros(n),
    }


def test_sound_signals_pass(signals: dict[str, np.ndarray]) -> None:
    assert not list(after_run.finite(signals))
    assert not list(after_run.rack_in_mesh(signals, 0.0, 1e-3))
    assert not list(after_run.teeth_loaded(signals))
    assert not list(after_run.law_valid(VALID_TO, signals))
    assert not list(after_run.contact_agreed(1e-9))
    assert not list(after_run.work_balanced(signals, 2e-3))


def test_not_a_number(signals: dict[str, np.ndarray]) -> None:
    signals["pinion_torque"][7] = np.nan
    ((status, code, message),) = after_run.finite(signals)
    assert (status, code) == (Status.DIVERGED, Code.NOT_FINITE)
    assert "pinion_torque" in message


def test_rack_out_of_mesh(signals: dict[str, np.ndarray]) -> None:
    signals["rack_y"][20:] = 9e-3
    ((status, code, message),) = after_run.rack_in_mesh(signals, 0.0, 0.9e-3)
    assert (status, code) == (Status.CONTACT_LOST, Code.RACK_OUT_OF_MESH)
    assert f"{np.degrees(signals['pinion_angle'][20]):.4g} deg" in message


def test_teeth_without_load(signals: dict[str, np.ndarray]) -> None:
    signals["mesh_normal_force"][30] = 0.0
    ((status, code, _),) = after_run.teeth_loaded(signals)
    assert (status, code) == (Status.CONTACT_LOST, Code.TEETH_UNLOADED)


def test_teeth_deeper_than_their_law_allows(signals: dict[str, np.ndarray]) -> None:
    signals["mesh_penetration"][3] = 1.1 * DEEPEST
    ((status, code, message),) = after_run.law_valid(VALID_TO, signals)
    assert (status, code) == (Status.INVALID, Code.BEYOND_LAW)
    assert "µm" in message


@pytest.mark.parametrize("residual", [0.003, -0.003, float("nan")])
def test_work_that_does_not_add_up(signals: dict[str, np.ndarray], residual: float) -> None:
    signals["work_mesh_friction"] *= 1 - residual
    ((status, code, _),) = after_run.work_balanced(signals, 2e-3)
    assert (status, code) == (Status.INVALID, Code.WORK_MISSING)


def test_a_gear_without_friction_may_miss_a_large_share_of_nothing(signals: dict[str, np.ndarray]) -> None:
    signals["work_drive"], signals["work_mesh_friction"] = 1e-3 * signals["work_drive"], np.zeros(50)
    assert not list(after_run.work_balanced(signals, 2e-3))


def test_work_that_goes_over_the_edges(signals: dict[str, np.ndarray]) -> None:
    signals["work_mesh_edges"] = 0.02 * signals["work_drive"]
    ((status, code, message),) = after_run.edges_spared(signals, 1.5e-2)
    assert (status, code) == (Status.INVALID, Code.EDGES_LOADED)
    assert "2.00%" in message
    assert not list(after_run.edges_spared(signals, 2.5e-2))


@pytest.mark.parametrize("disagreement", [0.5, float("nan")])
def test_two_evaluations_that_differ(disagreement: float) -> None:
    ((status, code, _),) = after_run.contact_agreed(disagreement)
    assert (status, code) == (Status.INVALID, Code.CONTACT_DISAGREES)


@pytest.mark.parametrize(("ripple", "reported"), [(0.5, True), (0.01, False)])
def test_rolling_that_equilibria_follow_too_coarsely(
    signals: dict[str, np.ndarray], ripple: float, reported: bool
) -> None:
    """Rolling to and fro within few steps matters where the torque varies with it."""
    angle = signals["pinion_angle"]
    signals["rack_displacement"] = 8e-3 * angle
    signals["rack_roll"] = 0.05 * np.sin(20 * angle)
    signals["pinion_torque"] = 0.6 * (1 + ripple * np.sin(20 * angle))
    assert bool(list(after_run.rolling_followed(signals, SteeringGear()))) is reported


def test_rack_that_hardly_rolls_is_followed(signals: dict[str, np.ndarray]) -> None:
    signals["rack_displacement"], signals["rack_roll"] = 8e-3 * signals["pinion_angle"], np.zeros(50)
    assert not list(after_run.rolling_followed(signals, SteeringGear()))


def test_spheres_on_a_rack_that_stands_elsewhere(signals: dict[str, np.ndarray]) -> None:
    """The path of contact is 1.9 mm high: 16 um of preload's approach are 0.8 % of it, 200 um above 11 %."""
    record, gear = SimpleNamespace(forces=SimpleNamespace(spheres="some")), SteeringGear()
    assert not list(after_run.spheres_in_place(record, gear, signals))
    signals["rack_y"] += 200e-6
    ((status, code, message),) = after_run.spheres_in_place(record, gear, signals)
    assert (status, code) == (Status.INVALID, Code.SPHERES_OUT_OF_PLACE)
    assert "of the path of contact" in message
    record.forces.spheres = None  # other contacts have their ends where the rack is
    assert not list(after_run.spheres_in_place(record, gear, signals))


def test_spheres_under_a_yoke_at_its_nut(signals: dict[str, np.ndarray]) -> None:
    """A gear of 5 um clearance and 20 um runout: its nut carries 27 % of the force, the mean is 3 % off."""
    record = SimpleNamespace(forces=SimpleNamespace(spheres="some"))
    signals |= {"seat_force": np.full(50, 300.0), "yokenut_force": np.zeros(50)}
    assert not list(after_run.yoke_off_nut(record, signals))
    signals["yokenut_force"][20:30] = 50.0  # for a short way
    assert not list(after_run.yoke_off_nut(record, signals))
    signals["yokenut_force"][:] = 80.0
    ((status, code, message),) = after_run.yoke_off_nut(record, signals)
    assert (status, code) == (Status.INVALID, Code.SPHERES_AT_NUT)
    assert "carries 27%" in message
    record.forces.spheres = None  # lines of contact follow the flank
    assert not list(after_run.yoke_off_nut(record, signals))
