"""Judged rows of checks and validations on scales: mark, number, band, and the range that is asked for."""

from collections.abc import Callable, Sequence
from math import inf, isfinite

from rps_exudyn.results.judged_row import JudgedRow, Verdict
from rps_exudyn.results.page_blocks import Judgement, Mark
from rps_exudyn.results.rounding import interval

MARKS = {
    Verdict.PASS: Mark.KEPT,
    Verdict.AGREES: Mark.KEPT,
    Verdict.NOISE: Mark.KEPT,
    Verdict.FAIL: Mark.NOT_KEPT,
    Verdict.DISAGREES: Mark.NOT_KEPT,
}
"""Verdict -> its mark; that of all others is open."""
ORDER = (Mark.NOT_KEPT, Mark.OPEN, Mark.KEPT)
PAD = 0.12  # beyond the outermost number, of the scale
FAR_FROM_ZERO = 0.7  # smallest over largest number


def mark_of(row: JudgedRow) -> Mark:
    """The mark of a row by its verdict."""
    return MARKS.get(row.verdict, Mark.OPEN)


def judgement(
    row: JudgedRow,
    name: str,
    note: str,
    show: Callable[[float], str],
    ends: tuple[float, float],
    verdict: str,
    remark: str,
    is_published: bool = False,
) -> Judgement:
    """Place a judged number on a scale; `show` makes text of a number in SI.

    `ends` are the least and most that are asked for, SI, infinite without a limit. Grey is what lies beyond
    them, or the range between them where it `is_published`.
    """
    limits = list(filter(isfinite, ends))
    known = list(filter(isfinite, (row.value, row.low, row.high, *limits)))
    low, high = _scale(known, is_close_up=len(set(limits)) > 1)

    def at(value: float) -> float:
        return 100 * (min(max(value, low), high) - low) / (high - low)

    inner = (at(ends[0]), at(ends[1]))
    beyond = [inner] if is_published else [(0.0, inner[0]), (inner[1], 100.0)]
    has_band = isfinite(row.low) and isfinite(row.high) and row.low != row.high
    return Judgement(
        mark=mark_of(row),
        name=name,
        note=note,
        value=show(row.value) if row.is_known else "",
        interval=interval(show(row.low), show(row.high)) if has_band else "",
        verdict=verdict,
        remark=remark,
        at=at(row.value) if row.is_known else None,
        band=(at(row.low), at(row.high)) if has_band else None,
        limits=[at(each) for each in limits],
        beyond=[each for each in beyond if each[0] < each[1]] if limits else [],
    )


def _scale(known: Sequence[float], is_close_up: bool) -> tuple[float, float]:
    """Ends of a scale that holds all numbers; from 0 on, unless a close-up is far from it."""
    low, high = min(known, default=0.0), max(known, default=1.0)
    if low >= 0 and not (is_close_up and low > FAR_FROM_ZERO * high):
        low = 0.0
    pad = PAD * ((high - low) or abs(high) or 1.0)
    return (low if low == 0.0 else low - pad), high + pad


def limits_of(side: int, value: float, ends: tuple[float, float] | None) -> tuple[float, float]:
    """Least and most of data that are a range, a limit (`side` +1: at most, -1: at least) or a number."""
    if ends is not None:
        return ends
    return {1: (-inf, value), -1: (value, inf)}.get(side, (value, value))
