"""A block of cases in one HDF5 file: numbers as columns, texts compressed, every chunk with a checksum.

    content = packed([CaseRecord.of("0123456789abcdef", result), ...])
    block = Block.read(path)
    block.summaries(), block.result("0123456789abcdef")

docs/hdf5-format.md describes the file. A case in it is the same result as in a file of its own.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from rps_exudyn.base.files import printable, read_json_tables, with_checksum
from rps_exudyn.base.hdf5 import file_image, named_damage, opened, write_dataset
from rps_exudyn.results.outcome import Status, codes_of
from rps_exudyn.results.quantities import COLUMNS, GROUPS, SUMMARY, Quantity
from rps_exudyn.results.result import TABLES, TEXTS, Result, attributes_of, result_of

FILETYPE = "rps_exudyn-block"
VERSION = (2, 0)
"""Major: old readers must refuse the file. Minor: something was added that they may leave unread."""

TIMES = {
    "cpu_s": Quantity("s", "s", "CPU time of the simulation"),
    "wall_s": Quantity("s", "s", "elapsed time of the simulation"),
}
FILTERS: dict[str, Any] = {"fletcher32": True, "shuffle": True, "compression": "gzip", "compression_opts": 1}


@dataclass(frozen=True)
class Keep:
    """Selection of what a study stores besides numbers: names of signals, thinned to at most `samples`."""

    signals: tuple[str, ...] | None = None  # None: all of them; (): none
    samples: int | None = None  # None: every one

    def of(self, result: Result) -> Result:
        """Return the result with only the signals to be kept, thinned evenly; first and last value stay."""
        if self.signals == () or not result.signals:
            return replace(result, signals={})
        names = self.signals or tuple(result.signals)
        signals = {name: result.signals[name] for name in names if name in result.signals}
        length = len(result.signals["time"])
        if self.samples and length > self.samples:
            chosen = np.unique(np.linspace(0, length - 1, self.samples).round().astype(int))
            signals = {name: values[chosen] for name, values in signals.items()}
        return replace(result, signals=signals)


@dataclass(frozen=True, eq=False)
class CaseRecord:
    """A result taken apart: what a process hands over, and a block holds."""

    hash: str
    attributes: Mapping[str, Any]
    tables: Mapping[str, Mapping[str, float]]  # of `COLUMNS`
    signals: Mapping[str, np.ndarray]

    @classmethod
    def of(cls, case_hash: str, result: Result) -> "CaseRecord":
        attributes = {
            name: value for name, value in attributes_of(result).items() if name in (*TEXTS, *TIMES)
        }
        tables = {group: dict(getattr(result, group)) for group in TABLES}
        tables["summary"] |= {f"{name}_error": error for name, error in result.errors.items()}
        return cls(case_hash, attributes, tables, result.signals)

    @property
    def codes(self) -> tuple[str, ...]:
        """What the message is about."""
        return codes_of(self.attributes["message"], self.attributes.get("codes"))

    @property
    def in_loop(self) -> bool:
        """Whether the gear was computed together with others."""
        return "together" in read_json_tables(self.attributes["findings"], "findings")

    def result(self, where: str = "") -> Result:
        """The whole result; `where` stands for it in messages."""
        numbers = self.tables["summary"]
        own = {name: number for name, number in numbers.items() if name in SUMMARY}
        errors = {name: numbers[error] for name in SUMMARY if (error := f"{name}_error") in numbers}
        parts = {**self.tables, "summary": own, "errors": errors, "signals": self.signals}
        return result_of(self.attributes, where, **parts)


@dataclass(frozen=True)
class CaseRow:
    """A finished case without its signals: its outcome, and its numbers (SI)."""

    hash: str
    status: Status
    message: str  # on one line
    cpu_s: float  # CPU time [s]
    wall_s: float  # elapsed time [s]
    summary: Mapping[str, float]  # with errors, see `quantities.COLUMNS`
    codes: tuple[str, ...] = ()  # of the message, see `outcome.Code`

    @classmethod
    def of(cls, record: CaseRecord) -> "CaseRow":
        about, summary = record.attributes, dict(record.tables["summary"])
        message = " ".join(about["message"].split())
        times = about["cpu_s"], about["wall_s"]
        return cls(record.hash, Status(about["status"]), message, *times, summary, record.codes)


AxisColumns = Mapping[str, tuple[np.ndarray, Quantity]]
"""Name of a study's axis -> its value in each case, and what it measures."""


def packed(records: Sequence[CaseRecord], axes: AxisColumns | None = None) -> bytes:
    """Return the bytes of the block's file with its checksum."""
    return with_checksum(file_image(lambda file: _fill(file, records, axes or {})))


def _fill(file: h5py.File, records: Sequence[CaseRecord], axes: AxisColumns) -> None:
    file.attrs.update({"filetype": FILETYPE, "version": np.array(VERSION)})
    samples = max((len(values) for record in records for values in record.signals.values()), default=0)
    for name, length, of in (("case", len(records), "case in this file"), ("sample", samples, "sample")):
        if length:
            _put(file, name, np.arange(length), Quantity("", "", f"number of the {of}"))
    _put(file, "hash", np.array([record.hash.encode() for record in records]))
    for name, (values, quantity) in axes.items():
        _put(file, f"axes/{name}", values, quantity)
    for name in TEXTS:
        texts = [str(record.attributes[name]).encode() for record in records]
        _put(file, f"attributes/{name}", np.array([text + b"." for text in texts]))  # HDF5 strips zeros
    for name, quantity in TIMES.items():
        times = [float(record.attributes[name]) for record in records]
        _put(file, f"attributes/{name}", np.array(times), quantity)
    for group in TABLES:
        file.create_group(group)
        _put_table(file, group, [record.tables[group] for record in records])
    file.create_group("signals")
    _put_signals(file, [record.signals for record in records], samples)


def _put(file: h5py.File, name: str, values: np.ndarray, quantity: Quantity | None = None) -> None:
    """A dataset over the cases, or cases and samples; of these dimensions the scales have the names."""
    filters = FILTERS | {"chunks": values.shape} if values.size else {}
    attributes = quantity.attributes if quantity else {}
    if name in ("case", "sample"):
        write_dataset(file, name, values, attributes, **filters).make_scale(name)
    else:
        scales = [file[scale] for scale in ("case", "sample")[: values.ndim]]
        write_dataset(file, name, values, attributes, scales, **filters)


def _put_table(file: h5py.File, group: str, rows: Sequence[Mapping[str, float]]) -> None:
    """One column for each name; whole numbers stay whole, and a case may lack a number."""
    for name in dict.fromkeys(name for row in rows for name in row):
        has = np.array([name in row for row in rows])
        whole = all(isinstance(row[name], int) for row in rows if name in row)
        column = [row.get(name, 0 if whole else np.nan) for row in rows]
        values = np.array(column, dtype=np.int64 if whole else float)
        _put(file, f"{group}/{name}", values, COLUMNS[group][name])
        if not has.all():
            _put(file, f"valid/{group}/{name}", has.astype(np.uint8))


def _put_signals(file: h5py.File, cases: Sequence[Mapping[str, np.ndarray]], samples: int) -> None:
    """One row for each case, padded with nan; `valid` is how many samples count, if not all do."""
    for name in dict.fromkeys(name for case in cases for name in case):
        counts = np.array([len(case.get(name, ())) for case in cases])
        rows = np.full((len(cases), samples), np.nan)
        for row, case in zip(rows, cases, strict=True):
            values = case.get(name, np.zeros(0))
            row[: len(values)] = values
        _put(file, f"signals/{name}", rows, GROUPS["signals"][name])
        if (counts < samples).any():
            _put(file, f"valid/signals/{name}", counts)


def _columns(file: h5py.File, group: str) -> dict[str, str]:
    """Name of a column -> its dataset; "NAME valid" is what `valid` holds of it. Version 1 has that beside
    it, as "NAME known" or "NAME length".
    """
    beside = {re.sub(" (known|length)$", " valid", name): f"{group}/{name}" for name in file[group]}
    return beside | {f"{name} valid": f"valid/{group}/{name}" for name in file.get(f"valid/{group}", ())}


@dataclass(frozen=True, eq=False)
class Block:
    """The content of a block's file, in memory."""

    path: Path
    places: Mapping[str, int]  # hash -> row
    columns: Mapping[str, Mapping[str, np.ndarray]]  # group -> name -> (cases,) or (cases, samples)

    @classmethod
    def read(cls, path: Path, groups: Sequence[str] = ("attributes", *TABLES, "signals")) -> "Block":
        """The block in a file, or only some groups of it.

        Raises:
            InputError: no such file, no block, damaged, or of another format version.
        """
        with opened(path, FILETYPE, "block of cases", VERSION) as file:
            places = {name.decode(): row for row, name in enumerate(file["hash"][()].tolist())}
            columns = {
                group: {name: file[place][()] for name, place in _columns(file, group).items()}
                for group in groups
            }
            for name, values in ((name, each) for group in columns.values() for name, each in group.items()):
                if len(values) != len(places):
                    raise ValueError(f"{name} has {len(values)} rows for {len(places)} cases")
            return cls(path, places, columns)

    def text(self, name: str, row: int) -> str:
        return printable(self.columns["attributes"][name][row][:-1].decode())

    def table(self, group: str, row: int) -> dict[str, float]:
        """The numbers of a case, by the names of `quantities`, in the order of their declaration."""
        columns = self.columns[group]
        return {
            name: columns[name][row].item()
            for name in COLUMNS[group]
            if name in columns and columns.get(f"{name} valid", {row: True})[row]
        }

    def signals(self, case_hash: str) -> dict[str, np.ndarray]:
        """The signals of a case, each of its own length."""
        row, columns = self.places[case_hash], self.columns["signals"]
        lengths = {
            name: int(columns.get(f"{name} valid", {row: columns[name].shape[1]})[row])
            for name in GROUPS["signals"]
            if name in columns
        }
        return {name: columns[name][row, :length].copy() for name, length in lengths.items() if length}

    def result(self, case_hash: str) -> Result:
        """The whole result of a case."""
        row = self.places[case_hash]
        with named_damage(self.path):
            known = self.columns["attributes"]
            texts = {name: self.text(name, row) for name in TEXTS if name in known}
            times = {name: float(known[name][row]) for name in TIMES}
            tables = {group: self.table(group, row) for group in TABLES}
            record = CaseRecord(case_hash, texts | times, tables, self.signals(case_hash))
            return record.result(str(self.path))


def summaries(path: Path) -> list[CaseRow]:
    """Return the outcome and the numbers of every case of a block, read column by column."""
    with opened(path, FILETYPE, "block of cases", VERSION) as file:
        hashes = [name.decode() for name in _column(file, "hash")]
        about = {name: _column(file, f"attributes/{name}") for name in ("status", "message", *TIMES)}
        columns = {name: _column(file, place) for name, place in _columns(file, "summary").items()}
        known_codes = (
            _column(file, "attributes/codes") if "codes" in file["attributes"] else [None] * len(hashes)
        )
        known_as = {text: Status(text[:-1].decode()) for text in set(about["status"])}
        said = {text: " ".join(text[:-1].decode().split()) for text in set(about["message"])}
        pairs = [(said[text], known) for text, known in zip(about["message"], known_codes, strict=True)]
        of_pair = {pair: codes_of(pair[0], pair[1] and pair[1][:-1].decode()) for pair in set(pairs)}
    statuses = [known_as[text] for text in about["status"]]
    messages = [message for message, _ in pairs]
    codes = [of_pair[pair] for pair in pairs]
    names = [name for name in COLUMNS["summary"] if name in columns]
    values = zip(*(columns[name] for name in names), strict=True) if names else [()] * len(hashes)
    numbers = [dict(zip(names, row, strict=True)) for row in values]
    for name in names:
        known = columns.get(f"{name} valid", ())
        for row in (row for row, has in zip(numbers, known, strict=False) if not has):
            del row[name]
    rows = zip(hashes, statuses, messages, about["cpu_s"], about["wall_s"], numbers, codes, strict=True)
    return [CaseRow(*row) for row in rows]


def _column(file: h5py.File, name: str) -> list[Any]:
    """Return a dataset's values by the library's lower interface, which costs a fifth of a short column."""
    dataset = h5py.h5d.open(file.id, name.encode())
    values = np.empty(dataset.shape, dataset.dtype)
    dataset.read(h5py.h5s.ALL, h5py.h5s.ALL, values)
    return list(values.tolist())
