"""A time limit: when it began, and the alarm that interrupts a run from within when it is over.

The alarm comes as Ctrl-C does, so that a run keeps what it has recorded. It is heard between two steps, not
within compiled code: whoever started the process ends it for certain, `GRACE` later.
"""

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import monotonic
from traceback import walk_tb
from types import TracebackType

from rps_exudyn.base import units
from rps_exudyn.base.errors import InputError, unwrapped_interrupts

LATER = 0.01  # [s] after which an alarm rings again that was not heard
GRACE = 1.0  # [s] for a run to end by itself, before its process is ended

# Where an interrupted run was, by a piece of the innermost file's path
PLACES = {
    "/numba/": "while force laws were compiled",
    "/llvmlite/": "while force laws were compiled",
    "/rps_exudyn/solvers/": "while it approached its start",
    "/rps_exudyn/multibody/": "while its model was built",
    "/rps_exudyn/tooth_contact/": "while its contact was prepared",
    "/rps_exudyn/gears/": "while the gear's geometry was made",
    "/rps_exudyn/": "while it was prepared",
}


@dataclass(frozen=True)
class TimeLimit:
    """A limit that runs since `begun`, an instant of `time.monotonic`."""

    seconds: float
    begun: float = field(default_factory=monotonic)

    @classmethod
    def of(cls, limit: str | float) -> "TimeLimit":
        """Return the limit as the user writes it, beginning now; bare numbers are seconds.

        Raises:
            InputError: no time, or none that ends a run.
        """
        try:
            value = units.to_si(limit, "s")
        except ValueError as error:
            raise InputError(f"--time-limit: {error}.") from None
        if not 0 < value < float("inf"):
            raise InputError(f"--time-limit is {limit}; it must be more than 0 s and finite.")
        return cls(float(value))

    @property
    def remaining(self) -> float:
        """Time left [s], negative if it is over."""
        return self.begun + self.seconds - monotonic()


@contextmanager
def alarm(seconds: float) -> Iterator[None]:
    """Raise KeyboardInterrupt in the block after this time; where there is no such alarm, nothing.

    An interrupt leaves the block as one, also where compiled code has wrapped it.
    """
    can = hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread()
    if not can or seconds == float("inf"):
        with unwrapped_interrupts():
            yield
        return
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    end = monotonic() + seconds  # an interrupt before it was Ctrl-C
    again = dropped_rings_again(KeyboardInterrupt, signal.ITIMER_REAL, lambda: monotonic() >= end)
    with unwrapped_interrupts(), again:
        signal.setitimer(signal.ITIMER_REAL, max(seconds, 1e-6))
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, before)


@contextmanager
def dropped_rings_again(
    error: type[BaseException], timer: int, is_alarm: Callable[[], bool] = lambda: True
) -> Iterator[None]:
    """Ring a timer of `signal` a little later where Python dropped the error that its alarm raised.

    It drops errors in `__del__` and in callbacks of the garbage collector, of weak references and of ctypes.
    It reports them to `sys.unraisablehook`.
    """
    report = sys.unraisablehook

    def ring_again(dropped: "sys.UnraisableHookArgs") -> None:
        if issubclass(dropped.exc_type, error) and is_alarm():
            signal.setitimer(timer, LATER)
        else:
            report(dropped)

    sys.unraisablehook = ring_again
    try:
        yield
    finally:
        sys.unraisablehook = report


def sentence(seconds: float, where: str, cpu: float, wall: float) -> str:
    """Return a sentence: a run was ended by its limit, where it was, and what it cost; times in seconds."""
    spent = f"{cpu:.3g} s of CPU time in {wall:.3g} s"
    return f"the run took longer than its time limit of {seconds:g} s ({where}; {spent})"


def place_of(trace: TracebackType | None) -> str:
    """Return where a run was, from an interrupt's traceback."""
    files = [frame.f_code.co_filename.replace("\\", "/") for frame, _ in walk_tb(trace)]
    for file in reversed(files):
        for piece, place in PLACES.items():
            if piece in file and "/simulate/" not in file:
                return place
    return "before it began"
