"""The cache of compiled kernels: numba's own, in its own place, with a stamp that keeps it true.

numba stores a kernel beside its source file, or in the user's cache folder where that cannot be written to.
It does not notice a change in another file that the kernel calls, and takes damaged or foreign bytes as they
are. So each of its files has a stamp beside it: the sha256 of its bytes and of the sources of all kernels.
What has no stamp, or not this one, is removed before it is read, and compiled again. A folder that others
can write to holds no cache.
"""

import atexit
import hashlib
import os
import stat
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numba
import numpy as np

PACKAGE = Path(__file__).parents[1]
KERNEL_SOURCES = (
    "base/*.py",
    "forces/*.py",
    "gears/tooth_stiffness.py",
    "tooth_contact/*.py",
    "solvers/*.py",
    "pages/animation/drawn.py",
)
"""What compiled code is made of: the kernels, and the records and constants that they read."""
STAMP = ".sha256"
KINDS = (".nbi", ".nbc")  # of numba: its index of a function, and the code for some types

_folders: set[Path] = set()  # with kernels of this process


@cache
def fingerprint(package: Path = PACKAGE) -> str:
    """Return the hash of all that compiled kernels depend on, the versions of their compiler included."""
    digest = hashlib.sha256(f"numba {numba.__version__}, numpy {np.__version__}".encode())
    for pattern in KERNEL_SOURCES:
        for source in sorted(package.glob(pattern)):
            digest.update(source.relative_to(package).as_posix().encode() + b"\0" + source.read_bytes())
    return digest.hexdigest()


def compiled(function: Callable[..., Any], **options: Any) -> Any:
    """Return a function as a kernel, with numba's cache if its folder can be trusted.

    What is written elsewhere has no cache: a change of the kernels that it calls would go unnoticed.
    """
    if not _is_source(Path(function.__code__.co_filename)):
        return numba.njit(function, **options)
    try:
        made = numba.njit(function, cache=True, **options)
        folder = Path(made.stats.cache_path)
        if not _trusted(folder):
            made = numba.njit(function, **options)
    except RuntimeError:  # numba finds no folder that it can write to
        made = numba.njit(function, **options)
    return made


def _is_source(file: Path) -> bool:
    return file.is_relative_to(PACKAGE) and any(
        file.relative_to(PACKAGE).match(each) for each in KERNEL_SOURCES
    )


@cache
def _trusted(folder: Path) -> bool:
    """Check a folder of kernels once: whether it is the user's own; what has no stamp of today goes."""
    if not _is_own(folder):
        return False
    for file in files_of(folder):
        if not _has_stamp(file):
            file.unlink(missing_ok=True)
            file.with_name(file.name + STAMP).unlink(missing_ok=True)
    if not _folders:
        atexit.register(stamp)
    _folders.add(folder)
    return True


def _is_own(folder: Path) -> bool:
    """Return whether nobody else can write to a folder but the superuser; true where owners are unknown."""
    if not hasattr(os, "geteuid"):
        return True
    about = folder.stat()
    return about.st_uid in (os.geteuid(), 0) and not about.st_mode & stat.S_IWOTH


def cache_folders() -> list[Path]:
    """Return the folders in which numba keeps the package's kernels, of the modules loaded so far."""
    return sorted(_folders)


def clear(folder: Path) -> int:
    """Remove the package's kernels from a folder; return how many files they were."""
    files = list(files_of(folder))
    for file in files:
        file.unlink(missing_ok=True)
        file.with_name(file.name + STAMP).unlink(missing_ok=True)
    return len(files)


def files_of(folder: Path) -> Iterator[Path]:
    """Yield numba's files of the package's kernels in a folder."""
    names = {source.stem for pattern in KERNEL_SOURCES for source in PACKAGE.glob(pattern)}
    for file in sorted(folder.glob("*.nb[ci]")):
        if file.name.partition(".")[0] in names:
            yield file


def _stamp_of(file: Path) -> str:
    return f"{fingerprint()} {hashlib.sha256(file.read_bytes()).hexdigest()}"


def _has_stamp(file: Path) -> bool:
    try:
        return file.with_name(file.name + STAMP).read_text(encoding="ascii") == _stamp_of(file)
    except (OSError, UnicodeDecodeError):
        return False


def stamp() -> None:
    """Stamp what numba has written since."""
    for folder in _folders:
        for file in files_of(folder):
            mark = file.with_name(file.name + STAMP)
            try:
                if not mark.exists() or mark.stat().st_mtime_ns < file.stat().st_mtime_ns:
                    mark.write_text(_stamp_of(file), encoding="ascii")
            except OSError:  # a full disk, or another process that clears the cache
                continue
