"""Kernels while they are compiled: a listener gets each step, and the work that the kernels are for.

    with listening(lambda step: print(step.what, step.name)):
        rps.run(...)

numba reports each function that it compiles, wherever the result is kept; `watch_numba` passes on all but
numba's own. A file beside the compiled kernels lists their names, so that the number of kernels that a work
still needs is known (`kernel_table`).
"""

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from time import perf_counter
from typing import Any, Literal, NamedTuple

PACKAGE = "rps_exudyn."
LIST = "kernels.txt"  # in the folder of the compiled kernels: a name each line


class Step(NamedTuple):
    """Compiling of a kernel begins or is done; or a work begins, whose kernels come next."""

    what: Literal["work", "begun", "done"]
    name: str  # of the work; of the kernel with its module
    seconds: float = 0.0  # for a kernel that is done, without the kernels that it calls


Listener = Callable[[Step], None]

listeners: list[Listener] = []


@contextmanager
def listening(listener: Listener) -> Iterator[None]:
    """Call a listener with each step of a block."""
    listeners.append(listener)
    try:
        yield
    finally:
        listeners.remove(listener)


def publish(step: Step) -> None:
    """Call all listeners with a step; another process may have made it."""
    for listener in tuple(listeners):
        listener(step)


def begin_work(name: str) -> None:
    """Publish that a work begins, by its name in the table of kernels."""
    publish(Step("work", name))


def compiled_names() -> Counter[str]:
    """Return how often each kernel was compiled into the cache, by their names."""
    with suppress(OSError):
        return Counter(_list().read_text(encoding="utf-8").split())
    return Counter()


@cache
def watch_numba() -> None:
    """Publish each kernel that numba compiles from now on, and list its name."""
    from numba.core import event

    class Watcher(event.Listener):
        def __init__(self) -> None:
            self.stack: list[list[float]] = []  # when each began, and seconds of the kernels that it calls

        def on_start(self, event: Any) -> None:
            if name := _name(event):
                self.stack.append([perf_counter(), 0.0])
                publish(Step("begun", name))

        def on_end(self, event: Any) -> None:
            if (name := _name(event)) and self.stack:  # an interrupt may have come before
                begun, within = self.stack.pop()
                whole = perf_counter() - begun
                if self.stack:
                    self.stack[-1][1] += whole
                _note(name)
                publish(Step("done", name, whole - within))

    event.register("numba:compile", Watcher())


def _name(event: Any) -> str:
    """The name of the kernel that an event of numba is about; "" for a function of numba itself."""
    function = getattr(event.data["dispatcher"], "py_func", None)
    module = getattr(function, "__module__", None)
    if function is None or module is None or module.partition(".")[0] == "numba":
        return ""
    return f"{module.removeprefix(PACKAGE)}.{function.__qualname__}"


def _note(name: str) -> None:
    with suppress(OSError):  # a cache that cannot be written
        _list().parent.mkdir(parents=True, exist_ok=True)
        with _list().open("a", encoding="utf-8") as file:
            file.write(f"{name}\n")


def _list() -> Path:
    from rps_exudyn.base.kernel_cache import cache_folder  # loads numba

    return cache_folder() / LIST
