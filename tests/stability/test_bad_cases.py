"""No configuration of the corpus ends in a wrong number that is called ok: each has its known outcome."""

import pytest

from bad_cases import BadCase, bad_cases
from rps_exudyn.results.outcome import Status
from rps_exudyn.scenes.scene import DEFAULT_OPTIONS
from rps_exudyn.simulate.run import simulate
from verification.stability import error_of, reference

LARGEST_ERROR = 0.02
CASES = {name: case for name, case in bad_cases().items() if not case.slow}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES.keys())
def test_bad_case_is_right_or_refused_by_the_check_that_it_names(case: BadCase) -> None:
    plan = case.plan
    result = simulate(
        plan.scene, plan.gear, plan.fidelity, options=DEFAULT_OPTIONS
    )  # runs confirm each other
    assert result.status is case.status, result.message
    assert case.message in result.message
    if result.status is Status.OK:
        assert abs(error_of(plan.figure(result), reference(plan))) < LARGEST_ERROR
