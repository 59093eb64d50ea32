"""Interrupts (Ctrl-C, the alarm of a time limit) that compiled code wraps into another exception.

An interrupt that comes while numba or another extension calls Python arrives as a
`SystemError: ... returned a result with an exception set`, caused by the KeyboardInterrupt.
Whoever catches every `Exception` must let it through, or an interrupted run is called a crashed one.
"""

from collections.abc import Iterator
from contextlib import contextmanager


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
