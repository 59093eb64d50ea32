"""No configuration of the corpus ends in a wrong number that is called ok: each has its known outcome."""

import pytest

import rps_exudyn as rps
from bad_cases import BadCase, bad_cases
from rps_exudyn.results.outcome import Status
from verification.stability import error_of, reference

LARGEST_ERROR = 0.02
CASES = {name: case for name, case in bad_cases().items() if not case.slow}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES.keys())
def test_bad_case_is_right_or_refused_by_the_check_that_it_names(case: BadCase) -> None:
    plan = case.plan
    result = rps.run(plan.scene, plan.gear, fidelity=plan.fidelity)
    assert result.status is case.status, result.message
    assert case.message in result.message
    if result.status is Status.OK:
        assert abs(error_of(plan.figure(result), reference(plan))) < LARGEST_ERROR
