"""Writing files so that they are complete or absent: beside the target, then renamed onto it."""

import json
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import short


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """A temporary file in the same folder that becomes `path` when the block succeeds.

    An existing `path` is replaced by the finished file or stays unmodified.

    Raises:
        InputError: the file cannot be written.
    """
    check_writable(path)
    target = Path(path).resolve()
    partial = _beside(target)
    try:
        yield partial
        _flush_to_disk(partial)
        partial.replace(target)
    except OSError as error:
        raise InputError(f"{path} cannot be written: {error.strerror or error}.") from error
    finally:
        partial.unlink(missing_ok=True)


def write_json(path: str | Path, content: Any) -> None:
    """Write content as JSON of one value a line.

    Raises:
        InputError: the file cannot be written.
    """
    with replacing(path) as partial:
        partial.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def check_writable(path: str | Path, suffixes: Sequence[str] = ()) -> Path:
    """Return the path if a file can be written there, checked before the work; nothing is modified.

    Raises:
        InputError: `path` cannot be written, or ends in none of the suffixes, if any are given.
    """
    if suffixes and Path(path).suffix.lower() not in suffixes:
        raise InputError(f"{path} cannot be written: its name must end in {' or '.join(suffixes)}.")
    target = _resolved(path)
    if target.exists() and not target.is_file():
        raise InputError(f"{path} cannot be written: it is not a file.")
    if not target.parent.is_dir():
        raise InputError(f"{path} cannot be written: there is no folder {target.parent}.")
    if target.exists() and not os.access(target, os.W_OK):
        raise InputError(f"{path} cannot be written: the existing file is read-only.")
    probe = _beside(target)
    try:
        probe.write_bytes(b"\0")
    except OSError as error:
        raise InputError(f"{short(str(path))} cannot be written: {error.strerror or error}.") from None
    finally:
        with suppress(OSError):  # of a name too long, reported above
            probe.unlink(missing_ok=True)
    return Path(path)


def number_existing(path: Path) -> Path | None:
    """Rename an existing file to the first free of NAME.1, NAME.2, ... and return that name; None without
    one.

    Raises:
        InputError: it cannot be renamed.
    """
    if not path.exists():
        return None
    numbered = (path.with_suffix(f".{number}{path.suffix}") for number in count(1))
    older = next(name for name in numbered if not name.exists())
    try:
        return path.rename(older)
    except OSError as error:
        raise InputError(f"{path} cannot be kept as {older}: {error.strerror or error}.") from error


def append(path: Path, text: str) -> None:
    """Append to a file in one write, so that several writers cannot mix their lines.

    Raises:
        OSError: the file cannot be written.
    """
    descriptor = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o666)
    try:
        os.write(descriptor, text.encode())
    finally:
        os.close(descriptor)


def _resolved(path: str | Path) -> Path:
    target = Path(path).resolve()
    try:
        target.exists()
    except OSError as error:  # a name too long for a file
        raise InputError(f"{short(str(path))} cannot be written: {error.strerror or error}.") from None
    return target


def _beside(target: Path) -> Path:
    """A hidden name in the same folder with the same suffix, by which writers choose their format."""
    return target.with_name(f".{target.stem}.{os.getpid()}{target.suffix}")


def _flush_to_disk(path: Path) -> None:
    descriptor = os.open(path, os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
