"""Observed orders of convergence, fitted on live runs over a tooth pitch."""

from collections.abc import Sequence

import numpy as np
import pytest

from rps_exudyn.analysis.curve import Curve
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes import scene_named
from verification.law_area import by_law
from verification.references import as_run, by_strips, over_generators
from verification.runs import run_scene
from verification.work_precision import Reference, curve_errors, power_law

SCENE = "free-pinion-torque"
GEAR = by_law(SteeringGear().replace({"test.turns": 1 / 6}), "area")
STEPS = (1.25, 2.5, 5.0)  # [deg]
FINE = {"strip_stations": 6, "strip_points": 3}  # whose error is far below that of the steps


def curve(fidelity: Fidelity) -> Curve:
    run = run_scene(SCENE, GEAR, fidelity)
    assert run.ok, run.outcome.message
    return scene_named(SCENE).curve(run.signals, GEAR, fidelity)


@pytest.fixture(scope="module")
def reference() -> Reference:
    return Reference(curve(by_strips("0.25 deg")), 0.0, {})


def order(size: Sequence[float], errors: Sequence[float]) -> float:
    return power_law(np.array(size), np.array(errors))[0]


@pytest.mark.parametrize("preset", ["quasi-static", "flank"])
def test_steps_converge_with_order_two_by_lines_and_more_by_splines(
    preset: str, reference: Reference
) -> None:
    """Chords of a smooth curve have order 2, cubics 4; each kink where a tooth enters costs some of it.

    Law "area", whose load fades out at a line's ends. By law "line" it ends there at once: the kinks are
    larger, and chords have order 1.6.
    """
    models = [Fidelity.preset(preset).replace({"step_angle": f"{step} deg", **FINE}) for step in STEPS]
    errors = [curve_errors(curve(model), reference) for model in models]
    assert order(STEPS, [error.rms_linear for error in errors]) == pytest.approx(2.0, abs=0.3)
    assert 2.5 < order(STEPS, [error.rms for error in errors]) < 4.8


def test_generators_converge_with_order_two_or_more(reference: Reference) -> None:
    """The midpoint rule over an area with corners has order 2."""
    numbers = (10, 20, 40)
    model = Fidelity.preset("quasi-static").replace(FINE)
    errors = []
    for number in numbers:
        signals, _ = over_generators(number, as_run(model))(SCENE, GEAR)
        errors.append(curve_errors(scene_named(SCENE).curve(signals, GEAR, model), reference).rms)
    assert 1.7 < order([1 / n for n in numbers], errors) < 3.5
