"""No configuration of the corpus ends in a wrong number that is called ok."""

import pytest

from bad_cases import bad_cases
from rps_exudyn.results.outcome import Status
from rps_exudyn.simulate.run import run
from rps_exudyn.verification.stability import Plan, error_of, reference

LARGEST_ERROR = 0.02
CASES = bad_cases()


def test_corpus_is_large_enough() -> None:
    assert len(CASES) >= 60


@pytest.mark.parametrize("plan", CASES.values(), ids=CASES.keys())
def test_bad_case_is_right_or_says_what_is_wrong(plan: Plan) -> None:
    result = run(plan.scene, plan.gear, fidelity=plan.fidelity)
    if result.status is Status.OK:
        value = plan.figure(result)
        assert abs(error_of(value, reference(plan, value))) < LARGEST_ERROR
    else:
        assert result.message
