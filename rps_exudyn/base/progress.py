"""How far a run is: reported to a listener while it goes on, from wherever the solver is.

    with following(lambda progress: print(progress.sentence)):
        rps.run(...)

A run that takes less than `FIRST` seconds reports nothing.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from math import inf
from time import monotonic
from typing import NamedTuple

FIRST, INTERVAL = 2.0, 0.5  # [s] until the first word, and between words
LEAST = 0.01  # of the whole that must be done, until the time left follows from it


@dataclass(frozen=True)
class Progress:
    """Where a run is."""

    place: str  # angle or travel that is reached, for instance "123 deg"
    fraction: float  # of the whole run, 0 to 1
    elapsed: float  # since the run began [s]
    left: float  # expected until its end [s]

    @property
    def sentence(self) -> str:
        """Return what is reached and the time left, for instance "123 deg, 34 %, 5 s left"."""
        return f"{self.place}, {100 * self.fraction:.0f} %, {duration(self.left)} left"


Listener = Callable[[Progress], None]


@dataclass
class _Follower:
    """A listener, and which part of which run it follows."""

    listener: Listener
    began: float = field(default_factory=lambda: monotonic())
    reported: float = 0.0
    last: float = inf  # share of the whole that was done last
    first: tuple[float, float] = (0.0, 0.0)  # instant and share from which the rate is taken
    part: int = 0
    parts: int = 1
    stage: tuple[float, float] = (0.0, 1.0)  # shares of the whole between which the present run lies

    def reached(self, fraction: float, place: Callable[[], str]) -> None:
        """Report it, unless it is too early, or nothing is done from which the time left would follow."""
        begin, end = self.stage
        now, whole = monotonic(), begin + (end - begin) * min((self.part + fraction) / self.parts, 1.0)
        if whole < self.last:  # the first step, or another run or part begins
            self.first = now, whole
        self.last, (since, before) = whole, self.first
        if now - self.began < FIRST or now - self.reported < INTERVAL or whole - max(before, 0.0) < LEAST:
            return
        self.reported = now
        left = (now - since) * (1 - whole) / (whole - before)
        self.listener(Progress(place(), whole, now - self.began, left))


_following: ContextVar[_Follower | None] = ContextVar("following", default=None)


@contextmanager
def following(listener: Listener | None) -> Iterator[None]:
    """Report to a listener how far the runs of a block are; None leaves it to the listener there is."""
    if listener is None:
        yield
        return
    before = _following.set(_Follower(listener))
    try:
        yield
    finally:
        _following.reset(before)


def begin_part(part: int, parts: int) -> None:
    """Note that one part of a run of several begins, the first of them 0."""
    if (follower := _following.get()) is not None:
        follower.part, follower.parts = part, parts


def begin_stage(begin: float, end: float) -> None:
    """Note that one run of several begins, between two shares of the whole."""
    if (follower := _following.get()) is not None:
        follower.stage = begin, end


def reached(fraction: float, place: Callable[[], str]) -> None:
    """Note how much of the present part is done, and the place, which is asked for where it is reported."""
    if (follower := _following.get()) is not None:
        follower.reached(fraction, place)


def passed_on(progress: Progress) -> None:
    """Report to the listener the progress of a run in another process."""
    if (follower := _following.get()) is not None:
        follower.listener(progress)


# --- Code of kernels that is made before a run can go on, in any thread or process


class Making(NamedTuple):
    """Machine code is being made; "" when it is there."""

    sentence: str


makers: list[Callable[[Making], None]] = []
"""Listeners to it."""


@contextmanager
def listening(listener: Callable[[Making], None]) -> Iterator[None]:
    """Call a listener with each step of a block."""
    makers.append(listener)
    try:
        yield
    finally:
        makers.remove(listener)


def publish(step: Making) -> None:
    """Call all listeners with a step; another process may have made it."""
    for listener in tuple(makers):
        listener(step)


@contextmanager
def making(sentence: str) -> Iterator[None]:
    """Publish that a block makes machine code."""
    publish(Making(sentence))
    try:
        yield
    finally:
        publish(Making(""))


def duration(seconds: float) -> str:
    """A duration as text: "45 s", "12 min", "3.5 h"."""
    if seconds < 90:
        return f"{seconds:.2g} s" if seconds < 10 else f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
