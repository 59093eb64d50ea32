"""Verdicts on random plans, and a run that goes on where it was."""

from math import nan
from pathlib import Path

import pytest

from benchmarks.stability import random_plans
from benchmarks.stability.random_plans import (
    DATA,
    errors,
    mark_of,
    plan_of,
    verdict,
    write,
)
from benchmarks.topic import load_rows
from rps_exudyn.results.quantities import OTHER

RIGHT = {
    "scene": "free-pinion-torque",
    "status": "ok",
    "message": "",
    "error": 0.001,
    "metric_error": 0.01,
    "refused": "",
}
VERDICTS = {
    "right": {},
    "SILENTLY WRONG": {"error": 0.03},
    "SILENTLY WRONG METRIC": {"metric_error": -0.06},
    "ok, no reference": {"error": nan, "metric_error": nan},
    "by formula": {"model": "closed-form", "error": 0.1},
    "refused, was right": {"refused": "too coarse"},
    "refused": {"refused": "too coarse", "error": 0.1},
    "invalid, was right": {"status": "invalid"},
    "invalid": {"status": "invalid", "error": 0.1},
    "no-convergence": {"status": "no-convergence", "error": nan},
    "wrong input": {"status": "input-error"},
    "beyond the contact's law": {
        "status": "invalid",
        "codes": ("beyond-law",),
    },
}


@pytest.mark.parametrize("name", VERDICTS)
def test_verdict(name: str) -> None:
    assert verdict(RIGHT | VERDICTS[name]) == name


def test_metrics_that_nothing_judges_are_not_wrong() -> None:
    assert verdict(RIGHT | {"metric_error": nan}) == "right"
    assert verdict(RIGHT | {"error": nan}) == "right"


def test_a_small_metric_is_judged_by_itself_and_a_hundredth_of_the_largest() -> None:
    """A ripple of 21 for 9 mN m beside a mean of 600 is wrong, one of 9.5 is not; what its reference itself
    doubts is not judged."""
    plan = next(plan for n in range(99) if (plan := plan_of(n)).scene == "free-pinion-torque")
    right = {"torque_mean": (0.6, 0.0), "torque_peak_to_peak": (0.009, 0.0), "rack_lift_range": (3e-6, 1e-7)}
    summary = {"torque_mean": 0.6, "torque_peak_to_peak": 0.021, "rack_lift_range": 9e-6, "rack_gain": 0.04}
    found = errors(plan, summary, [right])
    assert (found["metric"], found["judged"]) == ("torque_peak_to_peak", 2)
    assert found["metric_error"] == pytest.approx(0.012 / 0.015)
    assert abs(errors(plan, summary | {"torque_peak_to_peak": 0.0095}, [right])["metric_error"]) < OTHER


def test_a_metric_by_which_two_references_differ_is_called_so() -> None:
    plan = next(plan for n in range(99) if (plan := plan_of(n)).scene == "free-pinion-torque")
    right = [{"torque_mean": (0.62, 0.0)}, {"torque_mean": (0.60, 0.0)}]
    of_one, of_none = (RIGHT | errors(plan, {"torque_mean": each}, right) for each in (0.605, 0.58))
    assert verdict(of_one) == random_plans.DISPUTED
    assert verdict(of_none) == "SILENTLY WRONG"
    ripples = [{"torque_peak_to_peak": (each, 0.0)} for each in (0.02, 0.01)]
    found = errors(plan, {"torque_peak_to_peak": 0.01}, ripples)
    assert verdict(RIGHT | found) == random_plans.DISPUTED
    unsure = [{"torque_mean": (0.62, 0.01)}, right[1]]
    assert verdict(RIGHT | errors(plan, {"torque_mean": 0.605}, unsure)) == "right"


def test_plans_that_were_run_are_kept_and_those_of_other_declarations_run_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Worker:
        def __init__(self, *_: object) -> None:
            pass

        def do(self, number: int, limit: float) -> dict[str, object]:
            return {**RIGHT, "message": "anew"}

    monkeypatch.setattr(random_plans, "Child", Worker)
    kept = {"number": 0, "verdict": "right", "plan": mark_of(plan_of(0)), "message": "kept"}
    write([kept, {**kept, "number": 1, "plan": "another"}], tmp_path / DATA)
    random_plans.run(tmp_path, plans=2)
    assert [row["message"] for row in load_rows(tmp_path / DATA)] == ["kept", "anew"]
