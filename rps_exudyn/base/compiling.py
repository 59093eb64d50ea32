"""Kernels while they are compiled: a listener gets how many there are, and the time left.

    with listening(lambda step: print(step.done, step.total)):
        rps.run(...)

What a kernel calls is read from its code: the kernels among its names. Those that are compiled have
signatures; a thread counts them.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Thread
from time import perf_counter
from typing import Any, NamedTuple

from rps_exudyn.base.progress import duration

EVERY = 0.25  # [s] between counts
USUAL_BYTES, USUAL_SECONDS = 1.5e5, 20.0  # of code: what a gear with law "line" needs, in double
OWN_SHARE = 0.5  # of the time, for the kernel itself behind those that it calls: all of them are in its code


class CompileStep(NamedTuple):
    """How many kernels are compiled, of those that are needed as far as counted."""

    done: int
    total: int
    seconds: float  # since the first one began
    left: float  # [s]


Listener = Callable[[CompileStep], None]

listeners: list[Listener] = []


@contextmanager
def listening(listener: Listener) -> Iterator[None]:
    """Call a listener with each step of a block."""
    listeners.append(listener)
    try:
        yield
    finally:
        listeners.remove(listener)


def publish(step: CompileStep) -> None:
    """Call all listeners with a step; another process may have made it."""
    for listener in tuple(listeners):
        listener(step)


def called(kernel: Any) -> dict[str, Any]:
    """Return a kernel and all kernels that it calls, by module and name."""
    found: dict[str, Any] = {}
    ahead = [kernel]
    while ahead:
        function = (each := ahead.pop()).py_func
        name = f"{function.__module__}.{function.__qualname__}"
        if name not in found:
            found[name] = each
            names = (function.__globals__.get(one) for one in function.__code__.co_names)
            ahead += [one for one in names if hasattr(one, "py_func")]
    return found


def time_left(ahead: float, ready: float, seconds: float) -> float:
    """Time [s] for bytes of code that are ahead, where some are ready after so many seconds; until much is
    ready, the usual rate counts more."""
    return ahead * (USUAL_SECONDS + seconds) / (USUAL_BYTES + ready)


class _Count:
    """Kernels that this process compiles."""

    def __init__(self) -> None:
        self._needed: dict[str, Any] = {}
        self._seconds = 0.0  # of earlier kernels

    @contextmanager
    def running(self, kernel: Any) -> Iterator[None]:
        """Publish steps while a kernel is compiled; none where a cache holds it."""
        own, begun, ended = called(kernel), perf_counter(), Event()
        new = {name: each for name, each in own.items() if name not in self._needed}
        self._needed |= new
        weights = {name: len(each.py_func.__code__.co_code) for name, each in new.items()}
        whole = sum(weights.values()) or 1  # none is new after an interrupted compilation

        def step() -> CompileStep:
            seconds = perf_counter() - begun
            there = [bool(each.stats.cache_misses) for each in self._needed.values() if each.signatures]
            ready = sum(weight for name, weight in weights.items() if new[name].signatures)
            ahead = 0.0 if kernel.signatures else whole / (1 - OWN_SHARE) - ready
            done, total = sum(there), len(self._needed) - there.count(False)  # some are only loaded
            return CompileStep(done, total, self._seconds + seconds, time_left(ahead, ready, seconds))

        def count() -> None:
            while not ended.wait(EVERY):
                if kernel.stats.cache_misses:
                    publish(step())

        thread = Thread(target=count, daemon=True)
        thread.start()
        try:
            yield
        finally:
            ended.set()
            thread.join()
            if kernel.stats.cache_misses:
                last = step()
                self._seconds = last.seconds
                publish(last._replace(done=last.total) if kernel.signatures else last)
            else:
                for name in new:  # loaded with all that it calls
                    del self._needed[name]


compiling = _Count().running


# --- How many of the kernels that a work needs are compiled, as a row of the screen


class CompilingProgress:
    """The latest count; its total never is less than the count."""

    def __init__(self) -> None:
        self.step = CompileStep(0, 0, 0.0, 0.0)

    def take(self, step: CompileStep) -> None:
        """Take a step."""
        self.step = step

    @property
    def is_done(self) -> bool:
        """Whether all kernels counted so far are compiled."""
        return self.step.done >= self.step.total

    @property
    def fraction(self) -> float:
        """Share of the time that is over."""
        whole = self.step.seconds + self.step.left
        return self.step.seconds / whole if whole else 0.0

    @property
    def text(self) -> str:
        """For instance "Compiling force laws, once: 46 of 146, 18 s left"."""
        left = duration(round(self.step.left))
        return f"Compiling force laws, once: {self.step.done} of {self.step.total}, {left} left"
