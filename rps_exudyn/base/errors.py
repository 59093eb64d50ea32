"""The exception for wrong input and the sentences in it; interrupts that arrive as other exceptions."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from types import UnionType

from rps_exudyn.base.units import shown


class InputError(ValueError):
    """Wrong input by the user: parameters, files, options.

    Each of `problems` is one sentence that names what, where, which value, and what is allowed.
    The command line prints them and exits with status 2; nothing has been computed by then.

    Examples:
        >>> rps.SteeringGear().replace({"pinion.teeth": "seven"})
        Traceback (most recent call last):
            ...
        rps_exudyn.base.errors.InputError: pinion.teeth is 'seven'; ...
    """

    def __init__(self, problems: str | Iterable[str]) -> None:
        self.problems = [problems] if isinstance(problems, str) else list(problems)
        super().__init__("\n".join(self.problems))


def check_kind(name: str, value: object, kinds: type | UnionType, allowed: str) -> None:
    """Check that an argument is of the kinds that are allowed.

    Raises:
        InputError: it is another one.
    """
    if not isinstance(value, kinds):
        raise InputError(f"{name} is {shown(value)}; it must be {allowed}.")


# --- Clauses made sentences, and counts and lines in them

SHOWN = 5  # lines, or ranges of lines, in a sentence


def as_sentence(clause: str) -> str:
    """Return a clause with a capital letter and a full stop."""
    return f"{clause[0].upper()}{clause[1:]}."


def are(number: int, noun: str, which: str = "") -> str:
    """Return subject and verb, for instance "1 row without a value is" or "6 rows without a value are"."""
    return f"{number} {noun}{which} is" if number == 1 else f"{number} {noun}s{which} are"


def lines_in_words(numbers: Sequence[int]) -> str:
    """Return which lines these rising numbers are, for instance "lines 2 to 41, 50, 60 ..."."""
    ranges: list[list[int]] = []
    for number in numbers:
        if ranges and number == ranges[-1][-1] + 1:
            ranges[-1][1:] = [number]
        else:
            ranges.append([number])
    shown = ", ".join(" to ".join(map(str, each)) for each in ranges[:SHOWN])
    name = "line" if len(numbers) == 1 else "lines"
    return f"{name} {shown}" + (" ..." if len(ranges) > SHOWN else "")


# --- Interrupts (Ctrl-C, the alarm of a time limit) that compiled code wraps into another exception.
#
# An interrupt that comes while numba or another extension calls Python arrives as a
# `SystemError: ... returned a result with an exception set`, caused by the KeyboardInterrupt.
# Whoever catches every `Exception` must let it through, or an interrupted run is called a crashed one.


def raise_wrapped(error: BaseException | None) -> None:
    """Raise the interrupt behind an exception, if there is one; what it carries stays with it.

    Raises:
        KeyboardInterrupt: it is the exception, or among its causes.
    """
    while error is not None:
        if isinstance(error, KeyboardInterrupt):
            raise error from None
        error = error.__cause__ or (None if error.__suppress_context__ else error.__context__)


@contextmanager
def unwrapped_interrupts() -> Iterator[None]:
    """Let an interrupt out of the block as it came; other exceptions pass.

    Raises:
        KeyboardInterrupt: behind whatever exception leaves the block.
    """
    try:
        yield
    except Exception as error:
        raise_wrapped(error)
        raise
