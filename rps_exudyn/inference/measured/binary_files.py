"""Channels of a bench's binary files: MDF 4 (asammdf), TDMS (npTDMS) and MAT up to version 7.2 (scipy).

Each channel has a name, a unit as far as the file states it, values, and the instants of its values where
they are recorded. Channels of other rates are brought onto the instants of the driven one. asammdf and
npTDMS come with the extra `[bench]`. These files come from others: they are read in a process of their own
with bounded memory and time (`base.child_process`), and every error of a reader is a refusal.
"""

import json
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path

import numpy as np

from rps_exudyn.base.child_process import MOST_MEMORY, answer, read_within_bounds
from rps_exudyn.base.errors import InputError
from rps_exudyn.inference.measured.columns import Table

MOST_TIME = 30  # of the reading process [s of CPU time]
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
    if not content.startswith((*_MDF, b"TDSm", b"MATLAB 5.0 MAT-file")):
        return None
    what, library, _ = READERS[content[:4]]
    if find_spec(library) is None:
        raise InputError(
            f"{path} is in {what}, which needs {library}: pip install 'rps-exudyn[bench]', or write "
            "its curve as CSV."
        )
    try:
        read = read_within_bounds("rps_exudyn.inference.measured.binary_files", content)
    except InputError as error:
        raise InputError(f"{path} {error.problems[0]}") from None
    if read is None:
        raise InputError(
            f"{path} is a damaged file of {what}, or takes more than {MOST_TIME} s or "
            f"{MOST_MEMORY / 2**30:.0f} GB to read; export its curve as CSV."
        )
    found = list(_taken_apart(read))
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


def _taken_apart(read: bytes) -> Iterator[Channel]:
    """Channels from the reading process's answer, see `_channels`."""
    head, _, numbers = read.partition(b"\n")
    place = 0
    for name, unit, size, has_clock in json.loads(head):
        count = size * (1 + has_clock)
        values, *clock = np.frombuffer(numbers, count=count, offset=8 * place).reshape(-1, size)
        yield Channel(name, unit, values, *clock)
        place += count


# --- The process that reads: bytes in; names, units and numbers of the channels out


def _channels(content: bytes) -> bytes:
    what, _, read = READERS[content[:4]]
    try:
        found = [each for each in read(content) if each.values.size > 1]
        head = [(each.name, each.unit, each.values.size, each.clock is not None) for each in found]
        arrays = [array for each in found for array in (each.values, each.clock) if array is not None]
        return json.dumps(head).encode() + b"\n" + b"".join(array.tobytes() for array in arrays)
    except MemoryError:
        raise InputError("needs more memory than there is; export its curve as CSV.") from None
    except Exception as error:
        why = type(error).__name__
        raise InputError(f"is a damaged file of {what} ({why}); export its curve as CSV.") from None


def _numbers(values: object) -> np.ndarray | None:
    """Values as a vector of floating point numbers; None of texts, matrices, complex numbers."""
    array = np.ma.filled(np.ma.asarray(values), np.nan) if np.ma.isMA(values) else np.asarray(values)
    if array.dtype.kind not in "iuf" or (array.ndim > 1 and max(array.shape) != array.size):
        return None
    return array.reshape(-1).astype(float)


def _mdf(content: bytes) -> Iterator[Channel]:
    from asammdf import MDF

    with MDF(BytesIO(content)) as file:
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


def _tdms(content: bytes) -> Iterator[Channel]:
    from nptdms import TdmsFile

    with TdmsFile.open(BytesIO(content)) as file:
        for channel in (channel for group in file.groups() for channel in group.channels()):
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


READERS: dict[bytes, tuple[str, str, Callable[[bytes], Iterator[Channel]]]] = {
    b"MDF ": ("MDF 4", "asammdf", _mdf),
    b"UnFi": ("MDF 4", "asammdf", _mdf),
    b"TDSm": ("TDMS", "nptdms", _tdms),
    b"MATL": ("MAT", "scipy", _mat),
}
"""Beginning of a file -> its kind for a reader, the library that reads it, the channels in it."""


if __name__ == "__main__":
    sys.exit(answer(_channels, MOST_TIME))
