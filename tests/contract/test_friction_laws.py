"""A friction law: name, facts and parameters in one file, its formula in another; its name in no third."""

from typing import get_args

import pytest

from package_strings import texts
from rps_exudyn.forces.friction import KINDS
from rps_exudyn.parameters.friction_law import LAWS, PLAIN_LAW, LawName

OWN = "parameters/friction_law.py"


def test_every_name_has_facts_and_a_number_of_its_own() -> None:
    assert tuple(LAWS) == get_args(LawName) == tuple(KINDS)
    assert KINDS[PLAIN_LAW] == 0


@pytest.mark.parametrize("law", LAWS)
def test_a_law_in_steady_sliding_has_no_state(law: LawName) -> None:
    assert not LAWS[LAWS[law].at_speed].has_state


@pytest.mark.parametrize("law", LAWS)
def test_a_laws_name_stands_in_the_file_of_laws_alone(law: LawName) -> None:
    found = [name for name, strings in texts().items() if law in strings]
    assert found == [OWN]
