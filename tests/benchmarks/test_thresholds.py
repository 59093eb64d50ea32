"""Thresholds stay few, and the published list is that of the sources."""

from benchmarks.thresholds import DATA, ELSEWHERE, MOST, constants, thresholds
from benchmarks.topic import RESULTS, load_data


def test_thresholds_are_few_and_each_has_a_meaning() -> None:
    found = thresholds()
    assert 20 < len(found) <= MOST
    assert all(each["meaning"] for each in found)
    assert {each["name"] for each in constants()} >= ELSEWHERE


def test_published_list_is_that_of_the_sources() -> None:
    """After a change: `python benchmarks/make.py thresholds`."""
    assert load_data(RESULTS / "stability" / DATA)["rows"] == thresholds()
