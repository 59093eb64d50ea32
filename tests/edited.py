"""Files changed by other programs: what tests of readers change in them."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from rps_exudyn.base.files import without_checksum


@contextmanager
def edited(path: Path) -> Iterator[h5py.File]:
    """The HDF5 file for writing, without its checksum, as files of earlier versions are."""
    path.write_bytes(without_checksum(path.read_bytes()))
    with h5py.File(path, "a") as file:
        yield file


def rewrite_study(folder: Path, **changes: object) -> None:
    """Change these keys of study.json and leave out its checksum, as in format version 1.0."""
    path = folder / "study.json"
    content = json.loads(path.read_text()) | {"version": [1, 0]} | changes
    content.pop("sha256", None)
    path.write_text(json.dumps(content))
