"""References of random plans: their own seat, beginning, periods and steps, and the same physics."""

from dataclasses import dataclass
from typing import cast

import numpy as np
import pytest

from part_law import PartLaw
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import Result
from rps_exudyn.solvers.gear_forces import gear_forces
from verification import stability
from verification.approach_paths import passes_of, pitches_before, room_before
from verification.plan_reference import expected, explicit, reference_forces
from verification.refined_steps import NotFiniteError, NotFoundError, confirmed
from verification.runge_kutta import FreeMotion
from verification.runs import run_scene
from verification.seat_cells import by_cells
from verification.stability import ScenePlan

GEAR = SteeringGear().replace({"mesh.law": "line", "test.turns": 1 / 6})
SLIDING = np.array([0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("aside", [0.0, 2e-6, 1e-5])
@pytest.mark.parametrize("tilt", [0.0, 2e-4, 1e-3])
@pytest.mark.parametrize("play", [0.0, 15e-6])
def test_seat_by_cells_is_the_seat(aside: float, tilt: float, play: float) -> None:
    """Touching everywhere, at one edge, or at a corner, by a plunger that follows the bar as far as its play
    lets it; cells end within half a cell: 1 % of what touches."""
    gear = GEAR.replace({"yoke.bore_clearance": play})
    exact = gear_forces(gear, Fidelity())
    place = np.array([0.01, 0.0, aside, 0.0, tilt, tilt, 0.0])
    ours, theirs = (PartLaw.of(each, "seat").evaluate(place, SLIDING) for each in (by_cells(exact), exact))
    scale = np.array([1, 1, 1, 0.01, 0.01, 0.01, 1]) * np.abs(theirs[:3]).max()
    assert np.abs((ours - theirs)[:7] / scale).max() < 0.01


def test_the_default_gear_is_what_its_reference_says() -> None:
    """Equilibria in steps of 1 degree, a settled start and one period against many fine steps: 1e-3."""
    right = expected(ScenePlan("free-pinion-torque", GEAR, Fidelity.preset("quasi-static")))
    run = run_scene("free-pinion-torque", GEAR, Fidelity.preset("quasi-static"))
    assert right.method == "equilibria"
    assert run.summary["torque_mean"] == pytest.approx(right.main_metric, rel=1e-3)
    assert run.summary["torque_peak_to_peak"] == pytest.approx(right.ripple, abs=5e-3 * right.main_metric)


def test_fast_motion_has_a_reference_with_inertia() -> None:
    """Runge-Kutta at 300 rpm against Exudyn in steps of 1 degree."""
    gear = GEAR.replace({"test.speed": "300 rpm"})
    right = expected(ScenePlan("free-pinion-torque", gear, Fidelity()))
    run = run_scene("free-pinion-torque", gear, Fidelity())
    assert right.method == "Runge-Kutta"
    assert run.summary["torque_mean"] == pytest.approx(right.main_metric, rel=5e-3)


@dataclass
class Oscillator:
    """A unit mass on a spring of 1e4 N/m, as Runge-Kutta sees a motion."""

    place: np.ndarray
    rate: np.ndarray

    def moving_mass(self, q: np.ndarray) -> np.ndarray:
        return np.eye(1)

    def acceleration(self, t: float, q: np.ndarray, v: np.ndarray, inverse: np.ndarray) -> np.ndarray:
        return -1e4 * q


def test_explicit_motion_says_where_its_steps_are_too_long() -> None:
    """Runge-Kutta is stable to 2.8 over the frequency, 100 rad/s: 5 is not, 2.5 in halves of the step is."""
    motion = cast(FreeMotion, Oscillator(np.array([1.0]), np.array([0.0])))
    with pytest.raises(NotFiniteError):
        explicit(motion, 0.05, 2000, 1)
    times, places, _ = explicit(motion, 0.05, 2000, 2)
    assert times[-1] == pytest.approx(2000 * 0.05)
    assert len(times) == 2001
    assert np.abs(places).max() <= 1.0


def test_metrics_stand_once_half_the_steps_say_the_same() -> None:
    """An error in proportion to the step moves by less than half a percent from quarters to eighths; what
    depends on the steps at random never does; steps too long for a motion are left behind."""

    def in_proportion(parts: int) -> tuple[float, float]:
        if parts == 1:
            raise NotFiniteError("too long")
        return 1 + 0.03 / parts, float("nan")

    assert confirmed(in_proportion).main_metric == pytest.approx(1.00375)
    with pytest.raises(NotFoundError, match=r"still moves by 1\.98%"):
        confirmed(lambda parts: (1 + 0.01 * (-1) ** parts.bit_length(), 0.0))
    with pytest.raises(NotFoundError, match="ripple by 10"):
        confirmed(lambda parts: (1.0, 0.1 * parts.bit_length()))


def test_load_test_reference_takes_whole_pitches() -> None:
    """The mean of 1.7 pitches is that of the first one, as in the standard's evaluation: 1e-3."""
    gear = GEAR.replace({"test.turns": 1.7 / GEAR.pinion.teeth, "pinion.runout": 3e-5, "test.direction": -1})
    fidelity = Fidelity.preset("quasi-static")
    right = expected(ScenePlan("load-test", gear, fidelity))
    run = run_scene("load-test", gear, fidelity)
    assert run.summary["torque_forward"] == pytest.approx(right.main_metric, rel=1e-3)


def approach_from(changes: dict[str, object]) -> tuple[float, float]:
    """Pitches from which a reference comes, and pitches of teeth before its record."""
    gear = GEAR.replace(changes)
    plan = ScenePlan("free-pinion-torque", gear, Fidelity.preset("quasi-static"))
    course = passes_of(plan)[0]
    room = room_before(gear, course) * gear.pinion.teeth / (2 * np.pi)
    return pitches_before(gear, reference_forces(plan), course), room


def test_a_reference_comes_from_where_its_beginning_does_not_matter() -> None:
    """The default gear forgets within four pitches, so that eight lead to the same force. In a seat of 6
    degrees the rack settles slowly: the force after four and after eight differs fourfold, and all teeth
    before the record are used; so they are where there are few."""
    assert approach_from({})[0] == 8
    slow, room = approach_from({"yoke.seat_angle": 0.1})
    assert slow == room > 8
    few, room = approach_from({"test.start_angle": "-20 deg", "rack.travel": "20 mm"})
    assert few == room < 4


def test_a_reference_keeps_a_rigid_bush_and_condenses_a_chain(monkeypatch: pytest.MonkeyPatch) -> None:
    """A chain at rest is its condensed stiffness; a rigid bush is another gear, 2.7 % off in one reversal."""
    bushes: list[str] = []

    def asked(scene: str, gear: SteeringGear, fidelity: Fidelity) -> Result:
        bushes.append(fidelity.bush)
        raise InputError("no run is needed")

    monkeypatch.setattr(stability, "run_unchecked", asked)
    for bush, expected_bush in (("rigid", "rigid"), ("condensed", "condensed"), ("chain", "condensed")):
        plan = ScenePlan("reversal", GEAR, Fidelity.preset("flank").replace({"bush": bush}))
        assert np.isnan(stability.reference(plan))
        assert bushes.pop() == expected_bush
