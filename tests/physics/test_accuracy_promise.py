"""What `--accuracy` promises holds on random gears and tests other than those its table was made of.

The wide ranges, all scenes and what the runs say of their scope are in the benchmark `promise_check`.
"""

import numpy as np
import pytest

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.simulate.accuracy_check import SLOW, error_between
from rps_exudyn.simulate.by_accuracy import beyond_in_run, beyond_promise, choose
from verification.references import STRIPS
from verification.runs import run_scene
from verification.scene_truth import by_model, impact_in_parts, truth_of
from verification.wide_tests import gears_under_tests

SCENE = "free-pinion-torque"
SIGNAL = "pinion_torque"
SEED = 7  # fixed before the table was made
GEARS, ALLOWED_MISSES = 20, 1
REFERENCE = Fidelity.preset("quasi-static").replace({"step_angle": "0.1 deg", **STRIPS})
SWING_WANTED = 0.2
IMPACT_WANTED, SHORT_PERIOD = 1.0, 13e-3  # [%], [s]
SWINGS = {
    "equilibria": by_model(Fidelity.preset("quasi-static").replace({"step_angle": "0.1 deg"})),
    "dynamics": by_model(Fidelity.preset("flank").replace({"step_angle": "0.05 deg"})),
}


@pytest.fixture(scope="module")
def measured() -> list[tuple[SteeringGear, object]]:
    """The first twenty gears and slow tests that run within the promise's scope, and what is right."""
    found = []
    for gear in gears_under_tests(SEED, SCENE, 4 * GEARS):
        if len(found) == GEARS:
            break
        if gear.test.speed > SLOW or gear.test.path == "lock-to-lock":
            continue
        run = run_scene(SCENE, gear, REFERENCE)
        if run.ok and not (beyond_promise(gear) or beyond_in_run(SCENE, run.signals)):
            found.append((gear, run))
    assert len(found) == GEARS
    return found


@pytest.mark.parametrize("wanted", [1.0, 0.1])
def test_at_least_nineteen_of_twenty_gears_are_as_exact_as_promised(
    measured: list[tuple[SteeringGear, object]], wanted: float
) -> None:
    errors = []
    for gear, reference in measured:
        fidelity = choose(SCENE, gear, wanted).fidelity
        run = run_scene(SCENE, gear, fidelity)
        error = (
            error_between(SIGNAL, SCENE, gear, (run, fidelity), (reference, REFERENCE)) if run.ok else np.inf
        )
        errors.append(error)
    assert sum(error > wanted for error in errors) <= ALLOWED_MISSES, np.round(errors, 3)
    assert np.median(errors) < wanted / 2


def test_a_reversals_promise_holds_as_well() -> None:
    """Of the area of the loop, on which dynamics and equilibria with the swing's inertia agree."""
    errors = []
    for gear in gears_under_tests(SEED, "reversal", 16):
        choice = choose("reversal", gear, SWING_WANTED, "flank")
        if gear.test.speed > SLOW or gear.test.cycles > 1 or len(errors) == 3:
            continue
        try:
            truth = truth_of("reversal", gear, SWINGS, (choice.quantity,), {choice.quantity: 0.03})
        except ArithmeticError:
            continue
        run = run_scene("reversal", gear, choice.fidelity)
        errors.append(truth.errors_of(run, choice.fidelity)[choice.quantity] if run.ok else np.inf)
    assert len(errors) == 3
    assert max(errors) <= SWING_WANTED, np.round(errors, 3)


def test_an_impacts_promise_holds_as_well() -> None:
    """Of the peak on the yokenut, without the confirmation on the gear; the reference has 40 steps per swing
    of the plunger, finer strips and a hundredth of the tolerance."""
    errors = []
    for gear in gears_under_tests(SEED, "yoke-impact", 30):
        if gear.test.pulses > 1 or gear.test.pulse_period > SHORT_PERIOD or len(errors) == 2:
            continue
        true, model = impact_in_parts(2)("yoke-impact", gear)
        if not true.summary.get("impact_peak_force"):
            continue
        choice = choose("yoke-impact", gear, IMPACT_WANTED)
        run = run_scene("yoke-impact", gear, choice.fidelity)
        both = (run, choice.fidelity), (true, model)
        errors.append(error_between(choice.quantity, "yoke-impact", gear, *both) if run.ok else np.inf)
    assert len(errors) == 2
    assert max(errors) <= IMPACT_WANTED, np.round(errors, 3)
