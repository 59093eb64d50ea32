"""Ctrl-C that is raised wherever Python would lose it or another library would turn it into something else.

Python drops what is raised in a finalizer and in a callback of a weak reference, of the garbage collector or
of ctypes: it is raised again. Extension modules print what is raised while they are imported, and raise
ImportError: until imports are over, it waits. Some clear it where they look for an attribute: the command
ends regularly then, and states at its end that it was interrupted.
"""

import _thread
import signal
import sys
from threading import main_thread
from time import sleep
from types import FrameType

LATER = 0.01  # [s] between attempts
INTERRUPTED = 130  # status of a command that Ctrl-C ends, as shells have it

_pressed = False


def arm() -> None:
    """Raise KeyboardInterrupt for Ctrl-C until the process ends; for the main thread of a program."""
    signal.signal(signal.SIGINT, _interrupt)
    sys.unraisablehook = _raise_again


def disarm() -> bool:
    """Ignore Ctrl-C from now on: all is done. Return whether Ctrl-C was pressed before."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    return _pressed


def took() -> None:
    """Note that Ctrl-C had its effect: a command that it ends regularly was not interrupted."""
    global _pressed
    _pressed = False


def _interrupt(number: int, frame: FrameType | None) -> None:
    global _pressed
    _pressed = True
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            _postpone()
            return
        frame = frame.f_back
    raise KeyboardInterrupt


def _raise_again(dropped: "sys.UnraisableHookArgs") -> None:
    if issubclass(dropped.exc_type, KeyboardInterrupt):
        _postpone()
    else:
        sys.__unraisablehook__(dropped)


def _postpone() -> None:
    _thread.start_new_thread(_ring, ())  # a `threading.Thread` takes locks that the main thread may hold


def _ring() -> None:
    """Interrupt the main thread again, which may be waiting."""
    sleep(LATER)
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(main_thread().ident or 0, signal.SIGINT)
    else:
        signal.raise_signal(signal.SIGINT)
