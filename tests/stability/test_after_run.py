"""Wrong runs end with success flags and plausible torques: each kind of wrongness is named.

Each test takes a sound record and spoils one thing in it, as the failure would.
"""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Status
from rps_exudyn.scenes.checks import rules
from rps_exudyn.scenes.checks.rules import IN_RECORD, OF_BARS, OF_GENERAL_CONTACT, Breach, RuleInput, breaches
from rps_exudyn.scenes.scene_run import Signals

DEEPEST = 50e-6
GEAR = SteeringGear()


@pytest.fixture
def signals() -> Signals:
    n = 50
    return {
        "time": np.linspace(0, 2, n),
        "pinion_angle": np.linspace(0, 1, n),
        "pinion_torque": np.full(n, 0.6),
        "rack_y": np.full(n, -16e-6),
        "mesh_normal_force": np.full(n, 880.0),
        "mesh_penetration": np.full(n, 8e-6),
        "seat_force": np.full(n, 300.0),
        "yokenut_force": np.zeros(n),
    }


def broken(signals: Signals, **given: Any) -> list[Breach]:
    return list(
        breaches(IN_RECORD, RuleInput(GEAR, signals=signals, valid_to={"mesh_penetration": DEEPEST}, **given))
    )


def cause(signals: Signals) -> tuple[Status, Code, str]:
    (breach,) = broken(signals)
    return breach.rule.status, breach.rule.code, breach.sentence


def test_sound_signals_pass(signals: Signals) -> None:
    assert not broken(signals)


def test_not_a_number(signals: Signals) -> None:
    signals["pinion_torque"][7] = np.nan
    assert cause(signals) == (Status.DIVERGED, Code.NOT_FINITE, "pinion_torque is not finite")


def test_rack_out_of_mesh(signals: Signals) -> None:
    signals["rack_y"][20:] = 9e-3
    status, code, message = cause(signals)
    assert (status, code) == (Status.CONTACT_LOST, Code.RACK_OUT_OF_MESH)
    assert f"{np.degrees(signals['pinion_angle'][20]):.4g} deg" in message


def test_teeth_without_load(signals: Signals) -> None:
    """Which a pulse may bring about."""
    signals["mesh_normal_force"][30] = 0.0
    assert cause(signals)[:2] == (Status.CONTACT_LOST, Code.TEETH_UNLOADED)
    assert not broken(signals, record=SimpleNamespace(pulse_power=np.zeros(50)))


def test_teeth_deeper_than_their_law_allows(signals: Signals) -> None:
    signals["mesh_penetration"][3] = 1.1 * DEEPEST
    status, code, message = cause(signals)
    assert (status, code) == (Status.INVALID, Code.BEYOND_LAW)
    assert "µm" in message


def test_many_gears_are_judged_by_the_rules_of_one(signals: Signals) -> None:
    """Each well within its limits, as single runs beyond a share of them judge."""
    many = {name: np.stack([values] * 4) if name != "time" else values for name, values in signals.items()}
    many["mesh_normal_force"][1, 7] = 0.0
    many["mesh_penetration"][2, 9] = 0.98 * DEEPEST
    many["rack_y"][3, 9] = np.nan
    given = RuleInput(
        GEAR, signals=many, axis_offset=np.zeros((4, 1)), valid_to={"mesh_penetration": DEEPEST}
    )
    within = np.logical_and.reduce([rule.within(given, 0.95) for rule in IN_RECORD])
    assert within.tolist() == [True, False, False, False]


@pytest.mark.parametrize("disagreement", [0.5, float("nan")])
def test_two_evaluations_that_differ(disagreement: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rules, "contact_disagreement", lambda record: disagreement)
    record = SimpleNamespace(forces=SimpleNamespace(spheres=None))
    (breach,) = breaches(OF_GENERAL_CONTACT, RuleInput(GEAR, record=record))  # type: ignore[arg-type]
    assert (breach.rule.status, breach.rule.code) == (Status.INVALID, Code.CONTACT_DISAGREES)


def of_spheres(code: Code, signals: Signals, spheres: str | None = "some") -> Breach | None:
    record = SimpleNamespace(forces=SimpleNamespace(spheres=spheres), pulse_power=None)
    rule = next(rule for rule in OF_GENERAL_CONTACT if rule.code == code)
    return rule.breach(RuleInput(GEAR, signals=signals, record=record))  # type: ignore[arg-type]


def test_spheres_on_a_rack_that_stands_elsewhere(signals: Signals) -> None:
    """The path of contact is 1.9 mm high: 16 um of preload's approach are 0.8 % of it, 200 um above 11 %."""
    assert not of_spheres(Code.SPHERES_OUT_OF_PLACE, signals)
    signals["rack_y"] += 200e-6
    breach = of_spheres(Code.SPHERES_OUT_OF_PLACE, signals)
    assert breach is not None
    assert "of the path of contact" in breach.sentence
    assert not of_spheres(
        Code.SPHERES_OUT_OF_PLACE, signals, spheres=None
    )  # whose ends are where the rack is


def test_spheres_under_a_yoke_at_its_nut(signals: Signals) -> None:
    """A gear of 5 um clearance and 20 um runout: its nut carries 27 % of the force, the mean is 3 % off."""
    assert not of_spheres(Code.SPHERES_AT_NUT, signals)
    signals["yokenut_force"][20:30] = 50.0  # for a short way
    assert not of_spheres(Code.SPHERES_AT_NUT, signals)
    signals["yokenut_force"][:] = 80.0
    breach = of_spheres(Code.SPHERES_AT_NUT, signals)
    assert breach is not None
    assert "carries 27%" in breach.sentence
    assert not of_spheres(Code.SPHERES_AT_NUT, signals, spheres=None)  # lines of contact follow the flank


@pytest.mark.parametrize(
    ("numbers", "codes"),
    [
        ({"work_missing": 0.04}, []),
        ({"work_missing": 0.06}, [Code.WORK_MISSING]),
        ({"work_missing": float("nan")}, [Code.WORK_MISSING]),
        ({"work_missing": 0.0, "moved_by_inertia": 0.3}, [Code.TURN_TOO_FAST]),
    ],
)
def test_a_run_that_shows_another_motion(numbers: dict[str, float], codes: list[Code]) -> None:
    assert [breach.rule.code for breach in breaches(OF_BARS, RuleInput(GEAR, numbers=numbers))] == codes
