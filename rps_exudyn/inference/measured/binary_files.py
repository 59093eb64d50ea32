"""Channels of a bench's binary files: MDF 4 (asammdf), TDMS (npTDMS) and MAT up to version 7.2 (scipy).

Each channel has a name, a unit as far as the file states it, values, and the instants of its values where
they are recorded. Channels of other rates are brought onto the instants of the driven one. asammdf and
npTDMS come with the extra `[bench]`. These files come from others: every error of a reader is a refusal, and
what a file would unpack to is bounded.
"""

import gc
import logging
import struct
import sys
import warnings
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from graphlib import CycleError, TopologicalSorter
from io import BytesIO
from itertools import chain, islice, repeat
from math import prod
from pathlib import Path
from typing import Literal

import numpy as np

from rps_exudyn.base.errors import InputError, raise_wrapped
from rps_exudyn.base.files import DEEPEST
from rps_exudyn.inference.measured.columns import Table

LARGEST = 2_000_000_000  # bytes that a file may unpack to
_MDF = (b"MDF     ", b"UnFinMF ")
_UNITS = ("unit_string", "unit", "units", "NI_UnitDescription", "Unit", "Units", "Einheit")
_VALUES = ("values", "value", "data", "signal", "y")
_CLOCKS = ("time", "t", "x")


@dataclass(frozen=True, eq=False)
class Channel:
    name: str
    unit: str  # "" where the file states none
    values: np.ndarray  # shape (n,)
    clock: np.ndarray | None = None  # [s], shape (n,)


@dataclass(frozen=True, eq=False)
class Channels:
    path: str | Path
    what: str  # kind of file, for a reader
    channels: tuple[Channel, ...]

    @property
    def table(self) -> Table:
        """Names and units of the channels as those of a table without rows."""
        names, units = ([getattr(each, text) for each in self.channels] for text in ("name", "unit"))
        return Table("", (0, names), (0, units), [])

    def column(self, index: int, driven: int) -> np.ndarray:
        """Return the values of a channel at the instants of the driven one, shape (n,); NaN outside its own.

        Raises:
            InputError: it has another number of values, and no instants.
        """
        channel, other = self.channels[index], self.channels[driven]
        same_clock = (channel.clock is None) == (other.clock is None) and (
            channel.clock is None or other.clock is None or np.array_equal(channel.clock, other.clock)
        )
        if channel.values.size == other.values.size and same_clock:
            return channel.values
        if channel.clock is None or other.clock is None or not (np.diff(channel.clock) > 0).all():
            raise InputError(
                f"{self.path}: its channels {other.name} and {channel.name} have {other.values.size} and "
                f"{channel.values.size} values and no common time; export them at one rate."
            )
        return np.interp(other.clock, channel.clock, channel.values, left=np.nan, right=np.nan)


def channels_of(path: str | Path, content: bytes) -> Channels | None:
    """Return the channels of a binary file of a bench; None of any other content.

    Raises:
        InputError: the file is damaged or of a version that is not read, or its library is not installed.
    """
    if content.startswith(_MDF) and content[8:9] != b"4":
        version = content[8:12].decode("latin-1").strip()
        raise InputError(f"{path} is an MDF file of version {version}; save it as MDF 4.")
    if content.startswith(b"MATLAB 7.3 MAT-file"):
        raise InputError(f"{path} is a MAT file of version 7.3; save it by save(..., '-v7').")
    readers = {
        b"MDF ": ("MDF 4", _mdf),
        b"UnFi": ("MDF 4", _mdf),
        b"TDSm": ("TDMS", _tdms),
        b"MATL": ("MAT", _mat),
    }
    if not content.startswith((*_MDF, b"TDSm", b"MATLAB 5.0 MAT-file")):
        return None
    what, read = readers[content[:4]]
    refused = ""
    found: list[Channel] = []
    with _quiet():
        try:
            found = [each for each in read(content) if each.values.size > 1]
        except ImportError as error:
            refused = (
                f"{path} is in {what}, which needs {error.name}: pip install 'rps-exudyn[bench]', or write "
                "its curve as CSV."
            )
        except MemoryError:
            refused = f"{path} needs more memory than there is; export its curve as CSV."
        except Exception as error:
            raise_wrapped(error)
            why = type(error).__name__
            refused = f"{path} is a damaged file of {what} ({why}); export its curve as CSV."
        if refused and read is _mdf:
            gc.collect()  # what was half made is deleted while nothing is printed
    if refused:
        raise InputError(refused)
    if not found:
        raise InputError(
            f"{path} is a file of {what} without a channel of numbers; save angle and torque as a vector "
            "each, with its unit: as a property of the channel, or in its name (torque_Nm)."
        )
    short = [each.name.rpartition("/")[2] for each in found]  # "group/name" where several have one name
    named = [
        each if short.count(name) > 1 else replace(each, name=name)
        for each, name in zip(found, short, strict=True)
    ]
    return Channels(path, f"channels of {what}", tuple(named))


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep what the libraries print of damaged files from the screen: warnings, messages of their loggers and
    errors of objects that are deleted half made."""
    hook, disabled = sys.unraisablehook, logging.root.manager.disable
    logging.disable()
    sys.unraisablehook = lambda _: None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logging.disable(disabled)
        sys.unraisablehook = hook


def _numbers(values: object) -> np.ndarray | None:
    """Values as a vector of floating point numbers; None of texts, matrices, complex numbers."""
    array = np.ma.filled(np.ma.asarray(values), np.nan) if np.ma.isMA(values) else np.asarray(values)
    if array.dtype.kind not in "iuf" or (array.ndim > 1 and max(array.shape) != array.size):
        return None
    return array.reshape(-1).astype(float)


def _mdf(content: bytes) -> Iterator[Channel]:
    from asammdf import MDF

    _check_blocks(content)
    with MDF(BytesIO(content)) as file:
        groups = [each.channel_group for each in file.groups]
        _check_size(sum(each.cycles_nr * (each.samples_byte_nr + 1) for each in groups))
        for group, records in enumerate(file.groups):
            master = file.masters_db.get(group)
            for index, channel in enumerate(records.channels):
                if index == master:
                    continue
                signal = file.get(group=group, index=index, ignore_invalidation_bits=False)
                values = _numbers(signal.samples)
                if values is None:
                    continue
                if signal.invalidation_bits is not None:
                    values[np.asarray(signal.invalidation_bits, dtype=bool)] = np.nan
                clock = np.asarray(signal.timestamps, dtype=float) if master is not None else None
                yield Channel(f"{group}/{channel.name}", signal.unit or "", values, clock)


_HEADER_BLOCK = 64  # address of an MDF file's header block
_REFERRING = (b"##CA", b"##CH", b"##EV", b"##AT")  # blocks that may refer back to channels
_BLOCK = struct.Struct("<4s4xQQ")
_PACKED = b"##DZ"  # block of compressed data, which follow its own head
_PACKED_HEAD = struct.Struct("<2sB13xQ")


def _check_blocks(content: bytes) -> None:
    """Refuse an MDF file whose blocks lead back to themselves, for its reader would follow them for ever, or
    unpack to more than `LARGEST`.

    Raises:
        ValueError: they lead back.
        MemoryError: they unpack to more.
    """
    size, left = 0, [_HEADER_BLOCK]
    links: dict[int, Sequence[int]] = {}  # address of a block -> addresses of those that it refers to
    while left:
        place = left.pop()
        if place in links or not 0 < place <= len(content) - _BLOCK.size:
            continue
        links[place] = ()
        name, _, count = _BLOCK.unpack_from(content, place)
        begin = place + _BLOCK.size
        if name == _PACKED:
            _, kind, length = _PACKED_HEAD.unpack_from(content, begin)
            if kind > 1:
                raise ValueError("a compression that is not zlib's")
            size += len(_unpacked(memoryview(content)[begin + _PACKED_HEAD.size :][:length], size))
        if name[:2] == b"##" and name not in _REFERRING and begin + 8 * count <= len(content):
            links[place] = struct.unpack_from(f"<{count}Q", content, begin)
            left += links[place]
    try:
        TopologicalSorter(links).prepare()
    except CycleError:
        raise ValueError("blocks that refer to themselves") from None


def _unpacked(data: memoryview, size: int) -> memoryview:
    """What compressed data unpack to; MemoryError if that and so many bytes else are more than `LARGEST`."""
    unpacked = memoryview(zlib.decompressobj().decompress(data, max(1, LARGEST + 1 - size)))
    _check_size(size + len(unpacked))
    return unpacked


def _check_size(size: int) -> None:
    """Raise a MemoryError for a file that would unpack to more than `LARGEST`."""
    if not 0 <= size <= LARGEST:
        raise MemoryError


def _tdms(content: bytes) -> Iterator[Channel]:
    from nptdms import TdmsFile

    with TdmsFile.open(BytesIO(content)) as file:
        each_channel = [channel for group in file.groups() for channel in group.channels()]
        _check_size(8 * sum(len(channel) for channel in each_channel))
        for channel in each_channel:
            values = _numbers(channel[:])
            if values is None:
                continue
            stated = next((channel.properties[key] for key in _UNITS if key in channel.properties), "")
            step = channel.properties.get("wf_increment", 0.0)
            clock = None
            if isinstance(step, (int, float)) and step > 0:
                clock = float(channel.properties.get("wf_start_offset", 0.0)) + step * np.arange(values.size)
            yield Channel(f"{channel.group_name}/{channel.name}", str(stated), values, clock)


def _mat(content: bytes) -> Iterator[Channel]:
    from scipy.io import loadmat

    _check_matrices(content)
    held = loadmat(BytesIO(content), simplify_cells=True)
    tables = {name: value for name, value in held.items() if not name.startswith("__")}
    yield from _variables("", tables)


def _variables(group: str, table: Mapping[str, object]) -> Iterator[Channel]:
    """Vectors of a table of variables; structures hold further ones, or one channel with its unit."""
    units = next((table[key] for key in _UNITS if isinstance(table.get(key), Mapping)), {})
    clock = next((found for key in _CLOCKS if (found := _numbers(table.get(key, ""))) is not None), None)
    for name, value in table.items():
        if isinstance(value, Mapping):
            key = next((key for key in _VALUES if key in value), None)
            values = None if key is None else _numbers(value[key])
            if values is None:
                yield from _variables(f"{group}{name}/", value)
                continue
            stated = next((value[key] for key in _UNITS if isinstance(value.get(key), str)), "")
            instants = next(
                (each for key in _CLOCKS if (each := _numbers(value.get(key, ""))) is not None), None
            )
            instants = instants if instants is not None and instants.size == values.size else None
            yield Channel(f"{group}{name}", str(stated), values, instants)
        elif (values := _numbers(value)) is not None:
            stated = units.get(name, "") if isinstance(units, Mapping) else ""
            instants = clock if clock is not None and clock.size == values.size else None
            yield Channel(f"{group}{name}", stated if isinstance(stated, str) else "", values, instants)


_MATRIX, _COMPRESSED = 14, 15  # kinds of elements in MAT files that hold further ones
_SPARSE, _WITHOUT_SIZES = 5, (16, 17)  # classes of matrices


def _check_matrices(content: bytes) -> None:
    """Refuse a MAT file on which its reader crashes, or that unpacks to more than `LARGEST`.

    Raises:
        ValueError: matrices within matrices are nested deeper than `DEEPEST`, or one declares more than it
            can hold.
        MemoryError: they unpack to more.
    """
    order: Literal["little", "big"] = "little" if content[126:128] == b"IM" else "big"
    size, level = len(content), [memoryview(content)[128:]]
    for _ in range(DEEPEST):
        inner = []
        for kind, part in [element for data in level for element in _elements(data, order)]:
            if kind == _COMPRESSED:
                part = _unpacked(part, size)
                size += len(part)
            elif kind != _MATRIX:
                continue
            elif _declared(part, order) > len(part):
                raise ValueError("a matrix of more numbers than its bytes")
            inner.append(part)
        if not inner:
            return
        level = inner
    raise ValueError(f"matrices nested more than {DEEPEST} levels deep")


def _declared(matrix: memoryview, order: Literal["little", "big"]) -> int:
    """Return of how many numbers or cells a matrix declares to be; 0 of a sparse one, which holds fewer."""
    (_, flags), (_, sizes) = islice(chain(_elements(matrix, order), repeat((0, memoryview(b"")))), 2)
    kind = int.from_bytes(flags[:4], order) % 256
    if kind == _SPARSE or kind in _WITHOUT_SIZES or not sizes:
        return 0
    sign = "<" if order == "little" else ">"
    return prod(np.frombuffer(sizes[: len(sizes) // 4 * 4], f"{sign}i4").tolist())


def _elements(data: memoryview, order: Literal["little", "big"]) -> Iterator[tuple[int, memoryview]]:
    """Yield kind and content of the elements in a row but those whose content stands beside their kind."""
    place = 0
    while place + 8 <= len(data):
        kind = int.from_bytes(data[place : place + 4], order)
        count = int.from_bytes(data[place + 4 : place + 8], order)
        place += 8
        if kind < 1 << 16:
            yield kind, data[place : place + count]
            place += count if kind == _COMPRESSED else count + -count % 8
