"""The package's own processes: their environment, and those that read files of others within bounds.

A library that reads a file may allocate what some bytes state, crash on them, or never end. So it reads in a
process of its own with bounded memory and time, from whose answer only plain bytes come back.
"""

import os
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from rps_exudyn.base.errors import InputError

PINNED = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "NUMEXPR_NUM_THREADS",
    "NUMBA_NUM_THREADS",
)
MOST_MEMORY = 2**32  # of a reading process [bytes]
OWN_SENTENCE = 3  # exit status of the process whose error is one


def child_environment() -> dict[str, str]:
    """One thread per process, and the very package that started it."""
    home = str(Path(__file__).parents[2])
    paths = [home, *filter(None, [os.environ.get("PYTHONPATH")])]
    return {**os.environ, **dict.fromkeys(PINNED, "1"), "PYTHONPATH": os.pathsep.join(paths)}


def read_within_bounds(module: str, content: bytes, *arguments: str) -> bytes | None:
    """Return what a module makes of the bytes of a file by `answer`; None where its process is ended.

    Raises:
        InputError: what is wrong with the bytes.
    """
    command = [sys.executable, "-P", "-m", module, *arguments]
    done = subprocess.run(command, input=content, capture_output=True, check=False, env=child_environment())
    if done.returncode == OWN_SENTENCE:
        raise InputError(done.stderr.decode(errors="replace").strip().splitlines()[-1])
    return None if done.returncode else done.stdout


def answer(read: Callable[..., bytes], most_time: int) -> int:
    """Write what `read` makes of standard input and the arguments within bounds, the CPU time's in seconds;
    return the exit status."""
    with suppress(ImportError):  # of Windows
        import resource

        for kind, most in (("AS", MOST_MEMORY), ("CPU", most_time), ("CORE", 0)):
            resource.setrlimit(getattr(resource, f"RLIMIT_{kind}"), (most, most))
    channel = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # libraries print there
    try:
        made = read(sys.stdin.buffer.read(), *sys.argv[1:])
    except InputError as error:
        print(f"\n{error}", file=sys.stderr)
        return OWN_SENTENCE
    with channel:
        channel.write(made)
    return 0
