"""Clauses made sentences, and counts and lines in them."""

from collections.abc import Sequence

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
