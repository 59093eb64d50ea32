"""A limit to the CPU time of a block, which ends as Ctrl-C would end it."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from time import process_time
from types import FrameType

from rps_exudyn.base.errors import unwrapped_interrupts

LEAST = 1e-3  # of what is left of an outer limit, which a timer of zero would switch off [s]


@contextmanager
def cpu_limit(seconds: float) -> Iterator[None]:
    """Interrupt the block after so much CPU time of this process; blocks may stand in each other.

    Raises:
        ArithmeticError: the block was interrupted.
    """

    def interrupt(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before, began = signal.signal(signal.SIGPROF, interrupt), process_time()
    outer = signal.getitimer(signal.ITIMER_PROF)[0]
    allowed = min(seconds, outer) if outer else seconds
    signal.setitimer(signal.ITIMER_PROF, allowed)
    try:
        with unwrapped_interrupts():
            yield
    except KeyboardInterrupt:
        if signal.getitimer(signal.ITIMER_PROF)[0] > 0:  # it came from outside
            raise
        raise ArithmeticError(f"it takes more than {allowed:.3g} s of CPU time") from None
    finally:
        left = max(LEAST, outer - (process_time() - began)) if outer else 0.0
        signal.signal(signal.SIGPROF, before)
        signal.setitimer(signal.ITIMER_PROF, left)
