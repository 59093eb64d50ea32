"""What a command says while it works: how far its run is, and that kernels are compiled.

In a terminal it is one line that is written over; elsewhere, where asked for, one line after the other.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from time import monotonic

CLEAR = "\r\x1b[K"
EVERY = 2.0  # [s] between lines where they stay


class _Line:
    """The line of progress on standard error."""

    def __init__(self) -> None:
        self._over = sys.stderr.isatty()
        self._written, self._shown = -EVERY, False

    def write(self, text: str) -> None:
        """Show a text in place of the one before."""
        if self._over:
            print(f"{CLEAR}{text}", end="", file=sys.stderr, flush=True)
            self._shown = True
        elif monotonic() - self._written >= EVERY:
            self._written = monotonic()
            print(f"rps-exudyn: {text}", file=sys.stderr, flush=True)

    def end(self) -> None:
        """Leave an empty line where texts were written over each other."""
        if self._shown:
            print(CLEAR, end="", file=sys.stderr, flush=True)


@contextmanager
def shown_progress(asked: bool) -> Iterator[None]:
    """Show how far the run of a block is, in a terminal or where asked for."""
    from rps_exudyn.base.progress import following

    line = _Line()
    wanted = asked or sys.stderr.isatty()
    listener = (lambda progress: line.write(progress.sentence)) if wanted else None
    with following(listener), _compiling_told(line) if wanted else nullcontext():
        try:
            yield
        finally:
            line.end()


@contextmanager
def _compiling_told(line: _Line) -> Iterator[None]:
    """Say once that kernels are compiled and where they are kept, then count them."""
    from rps_exudyn.base.kernel_cache import before_compiling, cache_folder

    begun, done = monotonic(), 0

    def tell(name: str) -> None:
        nonlocal done
        if done == 0:
            sentence = "the first run compiles its kernels, which takes a while; later ones load them from"
            print(f"rps-exudyn: {sentence} {cache_folder()}.", file=sys.stderr, flush=True)
        done += 1
        line.write(f"{done} functions compiled in {monotonic() - begun:.0f} s")

    before_compiling.append(tell)
    try:
        yield
    finally:
        before_compiling.remove(tell)
