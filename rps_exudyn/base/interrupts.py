"""Ctrl-C that is raised wherever Python would lose it or another library would turn it into something else.

Python drops what is raised in a finalizer and in a callback of a weak reference, of the garbage collector or
of ctypes: it is raised again. Extension modules print what is raised while they are imported, and raise
ImportError: until imports are over, it waits.
"""

import _thread
import signal
import sys
from threading import main_thread
from time import sleep
from types import FrameType

LATER = 0.01  # [s] between attempts

_postponed = False


def arm() -> None:
    """Raise KeyboardInterrupt for Ctrl-C until the process ends; for the main thread of a program."""
    signal.signal(signal.SIGINT, _interrupt)
    sys.unraisablehook = _raise_again


def disarm() -> None:
    """Ignore Ctrl-C from now on: all is done.

    Raises:
        KeyboardInterrupt: one that was to be raised again.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if _postponed:
        raise KeyboardInterrupt("interrupted at the end, when all was done.")


def _interrupt(number: int, frame: FrameType | None) -> None:
    global _postponed
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            _postpone()
            return
        frame = frame.f_back
    _postponed = False
    raise KeyboardInterrupt


def _raise_again(dropped: "sys.UnraisableHookArgs") -> None:
    if issubclass(dropped.exc_type, KeyboardInterrupt):
        _postpone()
    else:
        sys.__unraisablehook__(dropped)


def _postpone() -> None:
    global _postponed
    _postponed = True
    _thread.start_new_thread(_ring, ())  # a `threading.Thread` takes locks that the main thread may hold


def _ring() -> None:
    """Interrupt the main thread again, which may be waiting."""
    sleep(LATER)
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(main_thread().ident or 0, signal.SIGINT)
    else:
        signal.raise_signal(signal.SIGINT)
