"""HDF5 files of this package opened for reading, after a check of their type and format version."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import short


@contextmanager
def opened(path: str | Path, filetype: str, what: str, version: tuple[int, int]) -> Iterator[h5py.File]:
    """The file, if it is of this type and its major version is known.

    Args:
        filetype: the file's attribute of that name.
        what: the type's name in messages, for instance "result".
        version: major and minor version that this package writes.

    Raises:
        InputError: no such file, no HDF5, of another type, or of another format version.
    """
    with _open(path) as file:
        if file.attrs.get("filetype") != filetype:
            raise InputError(f"{path} is an HDF5 file, but not a {what} of rps-exudyn.")
        check_version(np.ravel(file.attrs.get("version", ())), path, version)
        yield file


def _open(path: str | Path) -> h5py.File:
    try:
        is_file, is_folder = Path(path).is_file(), Path(path).is_dir()
    except OSError as error:  # a name too long for a file
        raise InputError(f"{short(str(path))} cannot be read: {error.strerror or error}.") from None
    if not is_file:
        reason = "it is a folder" if is_folder else "there is no such file"
        raise InputError(f"{path} cannot be read: {reason}.")
    try:
        return h5py.File(path, "r")
    except PermissionError:
        raise InputError(f"{path} cannot be read: permission denied.") from None
    except OSError:
        raise InputError(f"{path} is no HDF5 file, or it is damaged.") from None


def check_version(version: Iterable[object], path: str | Path, known: tuple[int, int]) -> None:
    """Check the major number of the version in a file against the one that is known.

    Raises:
        InputError: it is another one, or missing.
    """
    numbers = list(version)
    if numbers[:1] != [known[0]]:
        found = ".".join(map(str, numbers)) or "missing"
        raise InputError(
            f"{path} has format version {found}, and this rps-exudyn reads {known[0]}.x; "
            "use the rps-exudyn that wrote it, or a newer one."
        )
