"""`refine`: estimate, confirm, halve. Runs are numbers here, wrong by a quarter of the error before."""

import pytest

from rps_exudyn.scenes.refine import refine

pytestmark = pytest.mark.quick


def halved(error: float, times: int) -> float:
    assert error == pytest.approx(4.0 ** (1 - times))
    return error / 4


def difference(coarse: float, fine: float) -> float:
    return abs(coarse - fine)


def test_a_record_that_asks_for_nothing_is_not_made_again() -> None:
    refined = refine(1.0, halved, 5, asks=lambda error: error > 2)
    assert (refined.runs, refined.times, refined.confirmed) == ((1.0,), 0, False)


def test_a_run_is_refined_until_its_record_asks_for_no_more() -> None:
    refined = refine(1.0, halved, 5, asks=lambda error: error > 0.05)
    assert (refined.finest, refined.times) == (1 / 64, 3)


def test_a_finer_run_that_changes_little_confirms() -> None:
    """1 -> 1/4 changes 3/4, 1/4 -> 1/16 changes 3/16."""
    refined = refine(1.0, halved, 5, change=difference, allowed=0.2)
    assert (refined.runs, refined.confirmed) == ((1.0, 1 / 4, 1 / 16), True)
    assert refined.change == pytest.approx(3 / 16)


def test_too_few_refinements_confirm_nothing_and_say_what_is_left() -> None:
    refined = refine(1.0, halved, 2, change=difference, allowed=0.01)
    assert (refined.times, refined.confirmed, refined.change) == (2, False, pytest.approx(3 / 16))


def test_a_finer_run_that_fails_ends_it_beside_the_last_that_did_not() -> None:
    refined = refine(1.0, halved, 5, usable=lambda error: error > 0.1, change=difference)
    assert (refined.runs, refined.failed) == ((1.0, 1 / 4), 1 / 16)


def test_a_run_that_cannot_be_used_is_not_refined() -> None:
    refined = refine(1.0, halved, 5, usable=lambda error: False)
    assert (refined.runs, refined.failed) == ((1.0,), None)
