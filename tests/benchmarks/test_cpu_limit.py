"""A limit to the CPU time of a block: it ends the block, and inside another one leaves that one its rest."""

import signal
from time import process_time

import pytest

from verification.limited import cpu_limit


def work(seconds: float) -> None:
    """Use CPU time."""
    end = process_time() + seconds
    while process_time() < end:
        pass


def test_a_block_that_takes_too_long_is_ended_and_one_that_does_not_is_not() -> None:
    began = process_time()
    with pytest.raises(ArithmeticError, match=r"more than 0\.1 s of CPU time"), cpu_limit(0.1):
        work(5.0)
    assert process_time() - began < 1.0
    with cpu_limit(1.0):
        work(0.01)
    assert signal.getitimer(signal.ITIMER_PROF)[0] == 0


def test_an_inner_limit_leaves_the_outer_one_its_rest() -> None:
    """The inner block fails by itself after 0.05 s; the outer one goes on and ends by its own limit."""
    reached = []

    def in_turn() -> None:
        with pytest.raises(ArithmeticError, match=r"more than 0\.05 s"), cpu_limit(0.05):
            work(5.0)
        reached.append("after the inner one")
        work(5.0)

    with pytest.raises(ArithmeticError, match=r"more than 0\.3 s"), cpu_limit(0.3):
        in_turn()
    assert reached


def test_an_inner_limit_longer_than_the_outer_one_ends_with_it() -> None:
    began = process_time()
    with pytest.raises(ArithmeticError), cpu_limit(0.1), cpu_limit(5.0):
        work(5.0)
    assert process_time() - began < 1.0
