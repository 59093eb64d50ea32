"""HDF5 files of this package, read after a check of their checksum, type and format version."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import CHECKSUM_SIZE, HDF5_BEGIN, content_of, fits_checksum

READ_WITH = 'xarray.open_datatree(FILE, engine="h5netcdf")'
"""How a program without this package reads all groups of a file; every file states it."""

MOST_EXPANSION = 1100
"""Most bytes of data for a byte of file: deflate stores 1032 zeros in one."""


def file_image(fill: Callable[[h5py.File], None]) -> bytes:
    """Return the bytes of the HDF5 file that `fill` fills, without a checksum.

    It is made in memory: HDF5 itself does not recover from a full disk.
    """
    with h5py.File("in memory", "w", driver="core", backing_store=False) as file:
        file.attrs["read_with"] = READ_WITH
        fill(file)
        file.flush()
        return bytes(file.id.get_file_image())


def write_dataset(
    group: h5py.Group,
    name: str,
    values: Any,
    about: Mapping[str, str],
    scales: Iterable[Any] = (),
    **how: Any,
) -> h5py.Dataset:
    """Write a dataset, numbers or texts of the kind "U", with attributes and scales of its dimensions."""
    if isinstance(values, np.ndarray) and values.dtype.kind == "U":
        values, how = values.astype(object), {"dtype": h5py.string_dtype()}
    dataset = group.create_dataset(name, data=values, **how)
    dataset.attrs.update(about)
    for dimension, scale in zip(dataset.dims, scales, strict=False):
        dimension.attach_scale(scale)
    return dataset


@contextmanager
def opened(path: str | Path, filetype: str, what: str, version: tuple[int, int]) -> Iterator[h5py.File]:
    """The file, if it is undamaged, of this type, and its major version is not newer than ours.

    Whatever goes wrong while it is read in the `with` block is the damage of a file without a checksum.

    `what` names the type in messages; `version` is the one that this package writes.

    Raises:
        InputError: no such file, no HDF5, damaged, of another type, or of another format version.
    """
    content = content_of(path)
    if not (intact := fits_checksum(content)) and content[CHECKSUM_SIZE:].startswith(HDF5_BEGIN):
        raise InputError(f"{path} is damaged, or was changed by another program: its checksum does not fit.")
    try:
        image = h5py.File(h5py.h5f.open_file_image(content if intact else b""))
    except (OSError, ValueError, RuntimeError):
        raise InputError(f"{path} is no HDF5 file, or it is damaged.") from None
    with named_damage(path), image as file:
        if file.attrs.get("filetype") != filetype:
            raise InputError(f"{path} is an HDF5 file, but not a {what} of rps-exudyn.")
        check_version(np.ravel(file.attrs.get("version", ())), path, version)
        _check_self_contained(file, len(content), path)
        yield file


@contextmanager
def named_damage(path: str | Path) -> Iterator[None]:
    """Report whatever goes wrong in a block as the damage of a file.

    Raises:
        InputError: something goes wrong.
    """
    try:
        yield
    except InputError:
        raise
    except MemoryError:
        raise InputError(f"{path} is damaged, or needs more memory than there is.") from None
    except Exception as error:  # whatever HDF5 and JSON make of damaged bytes
        reason = str(error.args[0] if isinstance(error, KeyError) and error.args else error)
        raise InputError(f"{path} is damaged: {reason.rstrip('.')}.") from None


def _check_self_contained(file: h5py.File, size: int, name: str | Path) -> None:
    """Refuse data that lie in other files, and more data than a file of this size [bytes] can hold."""
    declared = 0

    def reason(path: str, link: object) -> str | None:
        nonlocal declared
        if not isinstance(link, h5py.HardLink):
            return f"/{path} is a link, no data"
        if isinstance(each := file[path], h5py.Dataset):
            if each.external or each.is_virtual:
                return f"the data of /{path} lie in other files"
            declared += each.nbytes
        return None

    refused = file.visititems_links(reason)  # each group once; ends at the first reason
    if refused is None and declared > MOST_EXPANSION * size:
        refused = f"it declares {declared:.2g} bytes of data in {size:.2g}"
    if refused is not None:
        raise InputError(f"{name} is refused: {refused}.")


def check_version(version: Iterable[object], path: str | Path, known: tuple[int, int]) -> None:
    """Check that the major number of the version in a file is not above the one that is known.

    Raises:
        InputError: it is, or it is missing.
    """
    numbers = list(version)
    majors = [[major] for major in range(1, known[0] + 1)]
    if numbers[:1] not in majors:
        found = ".".join(map(str, numbers)) or "missing"
        readable = " and ".join(f"{major}.x" for (major,) in majors)
        raise InputError(
            f"{path} has format version {found}, and this rps-exudyn reads {readable}; "
            "use the rps-exudyn that wrote it, or a newer one."
        )
