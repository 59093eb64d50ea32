"""A limit to the CPU time of a block, which ends as Ctrl-C would end it."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def cpu_limit(seconds: float) -> Iterator[None]:
    """Interrupt the block after so much CPU time of this process.

    Raises:
        ArithmeticError: the block was interrupted.
    """

    def interrupt(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGPROF, interrupt)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    except KeyboardInterrupt:
        if signal.getitimer(signal.ITIMER_PROF)[0] > 0:  # it came from outside
            raise
        raise ArithmeticError(f"it takes more than {seconds:g} s of CPU time") from None
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)
