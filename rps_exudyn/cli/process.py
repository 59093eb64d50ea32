"""What holds for the whole process of a command."""

import atexit
import gc
import os
import sys
from io import TextIOWrapper

SELDOM = (500_000, 100, 1000)
"""Thresholds of the search for unused objects: as often as Python's own it is a fourteenth of a short run."""


def prepare_process() -> None:
    """Set what must be set before a command loads anything."""
    gc.set_threshold(*SELDOM)
    atexit.register(gc.freeze)  # the system takes all memory back: to free each object takes a quarter second
    sys.modules.setdefault("coverage", None)  # type: ignore[arg-type] # numba would load it for kernels' lines
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")  # of a terminal that knows no Greek letters
    # As in the processes of studies, so that numbers are the same; a thread that waits costs CPU time
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    os.environ["MPLBACKEND"] = "agg"  # pictures are files; a user's own choice may not exist here
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # to look for some opens every package
