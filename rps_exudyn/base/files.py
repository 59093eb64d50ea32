"""Files: written so that they are complete or absent, read as tables of JSON, checked by a checksum."""

import json
import math
import os
import stat
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path
from typing import Any

from rps_exudyn.base.errors import InputError, check_kind
from rps_exudyn.base.units import short

RESULT_FILES = (".h5", ".hdf5")
"""Suffixes of the files that hold a result."""

PICTURES = (".png", ".svg", ".pdf")
"""Suffixes of the files that a chart can be saved as, without loading the library that draws."""


LARGEST_FILE = 2**32
"""Bytes of the largest file that is read whole; a study of a million cases needs a tenth of it."""


def as_path(path: object) -> Path:
    """Return the path that a user names.

    Raises:
        InputError: it is neither text nor a path.
    """
    check_kind("path", path, str | os.PathLike, "text or a Path")
    return Path(path)  # type: ignore[arg-type]


def content_of(path: str | Path, largest: int = LARGEST_FILE) -> bytes:
    """Return the bytes of a file that a user names: a regular one of bounded size, for others may never end.

    Raises:
        InputError: it cannot be read.
    """
    as_path(path)
    try:
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        with os.fdopen(descriptor, "rb", closefd=True) as file:
            found = os.fstat(descriptor)
            if not stat.S_ISREG(found.st_mode):
                reason = "it is a device, a pipe or a socket"
            elif found.st_size > largest:
                reason = f"it has {found.st_size:.2g} bytes (limit {largest:.2g})"
            elif (content := file.read(found.st_size + 1)) is not None and len(content) <= found.st_size:
                return content
            else:
                reason = "it has no fixed size"
    except FileNotFoundError:
        reason = "there is no such file"
    except IsADirectoryError:
        reason = "it is a folder"
    except PermissionError:
        reason = "permission denied"
    except MemoryError:
        reason = "it needs more memory than there is"
    except (OSError, ValueError) as error:  # a name too long for a file, or with a zero in it
        reason = getattr(error, "strerror", None) or str(error)
    raise InputError(f"{short(str(path))} cannot be read: {reason}.")


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
        with partial.open("r+b") as written:
            os.fsync(written.fileno())
        partial.replace(target)
    except OSError as error:
        raise InputError(f"{path} cannot be written: {error.strerror or error}.") from error
    finally:
        partial.unlink(missing_ok=True)


def strict(value: Any) -> Any:
    """Return content for JSON, which has no numbers that are not finite: None stands for them."""
    if isinstance(value, Mapping):
        return {key: strict(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [strict(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def write_json(path: str | Path, content: Any) -> None:
    """Write content as strict JSON of one value a line.

    Raises:
        InputError: the file cannot be written.
    """
    with replacing(path) as partial:
        partial.write_text(json.dumps(strict(content), indent=1) + "\n", encoding="utf-8")


def check_writable(path: str | Path, suffixes: Sequence[str] = ()) -> Path:
    """Return the path if a file can be written there, checked before the work; nothing is modified.

    Raises:
        InputError: `path` cannot be written, or ends in none of the suffixes, if any are given.
    """
    suffix = as_path(path).suffix.lower()
    if suffixes and suffix not in suffixes:
        raise InputError(f"{path} cannot be written: its name must end in {' or '.join(suffixes)}.")
    target = Path(path).resolve()
    probe = _beside(target)
    try:
        if target.exists() and not target.is_file():
            raise InputError(f"{path} cannot be written: it is not a file.")
        if not target.parent.is_dir():
            raise InputError(f"{path} cannot be written: there is no folder {target.parent}.")
        if target.exists() and not os.access(target, os.W_OK):
            raise InputError(f"{path} cannot be written: the existing file is read-only.")
        probe.write_bytes(b"\0")
    except OSError as error:
        raise InputError(f"{short(str(path))} cannot be written: {error.strerror or error}.") from None
    finally:
        with suppress(OSError):  # of a name too long, reported above
            probe.unlink(missing_ok=True)
    return Path(path)


def number_existing(path: Path) -> Path | None:
    """Rename an existing file to the first free of NAME.1, NAME.2, ...; return that name, or None.

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


def _beside(target: Path) -> Path:
    """A hidden name in the same folder with the same suffix, by which writers choose their format."""
    return target.parent / f".{target.stem}.{os.getpid()}{target.suffix}"


# --- Tables written as JSON in files of others: read to a depth that all their readers can bear

DEEPEST = 50
"""Levels of lists and tables within each other; our own files have six. Python refuses some hundreds."""
_TOO_DEEP = f"{{}} is nested more than {DEEPEST} levels deep"


def printable(text: str) -> str:
    """Return a text of others with control characters, which a terminal would obey, as their escapes."""
    return "".join(sign if sign.isprintable() or sign in "\n\t\0" else ascii(sign)[1:-1] for sign in text)


def read_json_tables(text: str, what: str) -> dict[str, Any]:
    """Return the table that a text holds as JSON; `what` names the text in messages.

    Raises:
        ValueError: it is no JSON, no table, or nested too deep.
    """
    try:
        tables = json.loads(text)
    except RecursionError:
        raise ValueError(_TOO_DEEP.format(what)) from None
    if not isinstance(tables, dict):
        raise ValueError(f"{what} is no set of tables")
    check_depth(tables, what)
    return tables


def check_depth(tables: dict[str, Any], what: str) -> None:
    """Refuse tables that are nested deeper than `DEEPEST`; `what` names their text.

    Raises:
        ValueError: they are.
    """
    level: list[Any] = [tables]
    for _ in range(DEEPEST):
        containers = [each for each in level if isinstance(each, dict | list)]
        level = [item for each in containers for item in (each.values() if isinstance(each, dict) else each)]
        if not level:
            return
    raise ValueError(_TOO_DEEP.format(what))


# --- A checksum in front of an HDF5 file, by which any byte that was changed later is noticed
#
# HDF5 allows 512 bytes of any kind in front of its own, and all its readers skip them. Here they hold the
# SHA-256 of all bytes that follow, so that numbers, attributes and structure are covered alike:
#
#     rps-exudyn: sha256 of the bytes after the first 512
#     4f1c...
#
# Files of earlier versions begin with HDF5's own first bytes; they have no checksum and are read as they are.

HDF5_BEGIN = b"\x89HDF\r\n\x1a\n"
CHECKSUM_SIZE = 512
HEADING = b"rps-exudyn: sha256 of the bytes after the first 512\n"


def with_checksum(content: bytes) -> bytes:
    """Return the bytes of an HDF5 file with its checksum before them."""
    return _checksum(content) + content


def fits_checksum(content: bytes) -> bool:
    """Return whether the bytes of a file fit its checksum, or are those of an HDF5 file that has none."""
    if content.startswith(HDF5_BEGIN):
        return True
    return content[:CHECKSUM_SIZE] == _checksum(memoryview(content)[CHECKSUM_SIZE:])


def without_checksum(content: bytes) -> bytes:
    """Return the bytes of a file as HDF5 itself would have written them, without a checksum."""
    return content if content.startswith(HDF5_BEGIN) else content[CHECKSUM_SIZE:]


def _checksum(content: bytes | memoryview) -> bytes:
    import hashlib

    return (HEADING + hashlib.sha256(content).hexdigest().encode()).ljust(CHECKSUM_SIZE, b"\n")
