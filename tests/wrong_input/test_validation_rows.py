"""Rows of validation that cannot be read: one sentence for each mistake, with its file."""

from pathlib import Path

import pytest

from rps_exudyn.assessment.validation.row import read_rows
from rps_exudyn.base.errors import InputError
from shell import Command, refusal_of

RIGHT = """\
title = "A"
kind = "verification"
source = "B"
[data]
quantity = "travel_per_turn"
value = "35 mm"
uncertainty = "1 mm"
[procedure]
geometry = true
[criterion]
agreement = "1 %"
"""


def problems_of(folder: Path, text: str) -> list[str]:
    (folder / "row").mkdir(parents=True, exist_ok=True)
    (folder / "row" / "row.toml").write_text(text)
    with pytest.raises(InputError) as refused:
        read_rows(folder)
    return refused.value.problems


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('kind = "verification"', 'kind = "proof"', "kind is 'proof'; it must be one of validation"),
        ('title = "A"', 'titel = "A"', "titel is no key; there are title, kind"),
        ('title = "A"', "title = 3", "title is 3; it must be text"),
        ('"travel_per_turn"', '"travel"', "data.quantity is 'travel', which no result has"),
        ('value = "35 mm"', 'value = "35 N"', "data.value is '35 N', which is no quantity in m"),
        ('uncertainty = "1 mm"', 'uncertainty = "-1 mm"', "data.uncertainty must be at least 0"),
        ('uncertainty = "1 mm"', "", "needs value and uncertainty, or low and high, or most, or least"),
        ('uncertainty = "1 mm"', 'uncertainty = "1 mm"\nmost = "1 mm"', "needs value and uncertainty"),
        ("geometry = true", 'geometry = true\nscene = "reversal"', "needs one of scene, geometry"),
        ("geometry = true", 'scene = "race"', "procedure.scene is 'race'".replace("procedure.", "")),
        ("geometry = true", 'calculation = "guess"', "calculation is 'guess'; it must be one of iso"),
        ("geometry = true", 'scene = "reversal"\ninputs = "any"', "inputs is 'any'"),
        ("geometry = true", "geometry = true\nsamples = 3", "samples is 3"),
        ('agreement = "1 %"', "", "criterion.agreement is missing"),
        ("[criterion]", "[data.more]\na = 1\n[criterion]", "data.more is no key"),
    ],
)
def test_mistake_in_a_row(tmp_path: Path, old: str, new: str, said: str) -> None:
    assert old in RIGHT
    problems = problems_of(tmp_path, RIGHT.replace(old, new))
    assert all("row.toml" in problem for problem in problems)
    assert any(said in problem for problem in problems)


def test_range_upside_down(tmp_path: Path) -> None:
    text = RIGHT.replace('value = "35 mm"\nuncertainty = "1 mm"', 'low = "3 mm"\nhigh = "2 mm"')
    assert "data.low must be below high" in problems_of(tmp_path, text)[0]


def test_folder_without_rows_and_row_that_does_not_exist(tmp_path: Path, command: Command) -> None:
    assert "holds no row" in refusal_of(command(["validate", str(tmp_path)]))
    assert "there is no row moon" in refusal_of(command(["validate", "--only", "moon"]))
