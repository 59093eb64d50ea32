"""A case's result as the bytes of its HDF5 file, several times faster than writing it.

Files of a study are alike but for their numbers and a few attributes. So one is written as `Result.save`
does and becomes a form: the numbers of the next results of the same shape are laid into a copy of its
bytes, where HDF5 says they are, and the attributes that differ are set. Read, it is the same result.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import h5py
import numpy as np

from rps_exudyn.base.files import with_checksum
from rps_exudyn.results.quantities import GROUPS
from rps_exudyn.results.result import Result, attributes_of, content_of

READ_WRITE = 1  # H5LT_FILE_IMAGE_OPEN_RW: HDF5's own constant, which h5py does not name


@dataclass(frozen=True)
class Keep:
    """Selection of what a study stores besides numbers: names of signals, thinned to at most `samples`."""

    signals: tuple[str, ...] | None = None  # None: all of them; (): none
    samples: int | None = None  # None: every one


def kept(result: Result, keep: Keep) -> Result:
    """Return the result with only the signals to be kept, thinned evenly; first and last value stay."""
    if keep.signals == () or not result.signals:
        return replace(result, signals={})
    names = keep.signals or tuple(result.signals)
    signals = {name: result.signals[name] for name in names if name in result.signals}
    length = len(result.signals["time"])
    if keep.samples and length > keep.samples:
        chosen = np.unique(np.linspace(0, length - 1, keep.samples).round().astype(int))
        signals = {name: values[chosen] for name, values in signals.items()}
    return replace(result, signals=signals)


class FileForms:
    """Makes file contents from results; keeps one form for each shape of results it has met."""

    def __init__(self) -> None:
        self._forms: dict[tuple[Any, ...], _Form] = {}

    def content(self, result: Result) -> bytes:
        """Return the bytes of the result's HDF5 file with its checksum."""
        shape = _shape(result)
        if shape not in self._forms:
            self._forms[shape] = _Form(result)
            return with_checksum(self._forms[shape].bytes)
        return with_checksum(self._forms[shape].filled(result))


class _Form:
    """The bytes of one result's file, and where its numbers are in them."""

    def __init__(self, result: Result) -> None:
        self.bytes = content_of(result)
        with h5py.File(h5py.h5f.open_file_image(self.bytes)) as file:
            self._places = {
                (group, name): (file[group][name].id.get_offset(), file[group][name].dtype)
                for group, name, _ in _numbers(result)
            }
        self._attributes = attributes_of(result)

    def filled(self, result: Result) -> bytes:
        content = bytearray(self.bytes)
        for group, name, values in _numbers(result):
            offset, dtype = self._places[group, name]
            raw = np.ascontiguousarray(values, dtype=dtype).tobytes()
            content[offset : offset + len(raw)] = raw
        return self._with_attributes(bytes(content), result)

    def _with_attributes(self, content: bytes, result: Result) -> bytes:
        """HDF5 itself sets them: texts have lengths of their own."""
        differing = {
            name: value
            for name, value in attributes_of(result).items()
            if not np.array_equal(value, self._attributes[name])
        }
        with h5py.File(h5py.h5f.open_file_image(content, READ_WRITE)) as file:
            file.attrs.update(differing)
            file.flush()
            return bytes(file.id.get_file_image())


def _numbers(result: Result) -> Iterator[tuple[str, str, Any]]:
    for group in GROUPS:
        for name, values in getattr(result, group).items():
            yield group, name, values


def _shape(result: Result) -> tuple[Any, ...]:
    """Return what must agree for two files to differ in numbers and attributes only."""
    counters = tuple((name, np.asarray(value).dtype.kind) for name, value in result.counters.items())
    others = (tuple(result.summary), tuple(result.geometry), tuple(result.signals))
    return len(result.signals.get("time", ())), counters, *others
