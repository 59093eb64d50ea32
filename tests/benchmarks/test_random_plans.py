"""Verdicts on random plans, and a run that goes on where it was."""

from math import nan
from pathlib import Path

import pytest

from benchmarks.stability import random_plans
from benchmarks.stability.random_plans import DATA, mark_of, plan_of, read, verdict, write

RIGHT = {"status": "ok", "message": "", "error": 0.001, "ripple_error": 0.01, "refused": ""}
VERDICTS = {
    "right": {},
    "SILENTLY WRONG": {"error": 0.03},
    "SILENTLY WRONG RIPPLE": {"ripple_error": -0.06},
    "ok, no reference": {"error": nan},
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


def test_a_ripple_that_is_left_out_is_not_wrong() -> None:
    assert verdict(RIGHT | {"ripple_error": nan}) == "right"


def test_plans_that_were_run_are_kept_and_those_of_other_declarations_run_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Worker:
        def do(self, number: int, limit: float) -> dict[str, object]:
            return {**RIGHT, "message": "anew"}

    monkeypatch.setattr(random_plans, "Child", Worker)
    kept = {"number": 0, "kind": "plan", "verdict": "right", "plan": mark_of(plan_of(0)), "message": "kept"}
    write([kept, {**kept, "number": 1, "plan": "another"}], tmp_path / DATA)
    random_plans.run(tmp_path, plans=2, gears=0)
    assert [row["message"] for row in read(tmp_path / DATA)] == ["kept", "anew"]
