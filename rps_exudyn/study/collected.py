"""A whole study in one table, as HDF5 or CSV: one row per case, in the order of the design.

    write_table(CaseTable.of(store), "table.h5")
    read_table("table.h5")["summary"]["torque_mean"]

Its columns are described in docs/hdf5-format.md: the axes, hash, status, message, times, and the summary's
numbers. Units are SI; a CSV has them in its header, for instance `torque_mean [N*m]`.
"""

import csv
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from rps_exudyn.base.files import check_writable, replacing, with_checksum
from rps_exudyn.base.hdf5 import file_image, opened
from rps_exudyn.study.table import CaseTable, TableColumn

FILETYPE = "rps_exudyn-table"
VERSION = (1, 1)
"""Major: old readers must refuse the file. Minor: something was added that they may leave unread."""

SUFFIXES = (".h5", ".hdf5", ".csv")

GROUPS = ("axes", "outcome", "summary")


def write_table(table: CaseTable, path: str | Path) -> None:
    """Write the study as one file, in the format of the path's suffix.

    Raises:
        InputError: another suffix than `SUFFIXES`, or the file cannot be written.
    """
    check_writable(path, SUFFIXES)
    with replacing(path) as partial:
        if Path(path).suffix.lower() == ".csv":
            _write_csv(table, partial)
        else:
            partial.write_bytes(with_checksum(file_image(lambda file: _fill(table, file))))


def read_table(path: str | Path) -> dict[str, dict[str, np.ndarray]]:
    """Group (axes, outcome, summary) -> column -> values, shape (cases,), of a table in HDF5.

    Raises:
        InputError: no such file, no table of this package, damaged, or of another format version.
    """
    with opened(path, FILETYPE, "table", VERSION) as file:
        return {group: {name: _read(dataset) for name, dataset in file[group].items()} for group in GROUPS}


def _write_csv(table: CaseTable, path: Path) -> None:
    columns = table.columns()
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([column.header for column in columns])
        writer.writerows(
            zip(*([_cell(value) for value in column.values.tolist()] for column in columns), strict=True)
        )


def _cell(value: Any) -> Any:
    """The value, or nothing for an unknown number."""
    return "" if isinstance(value, float) and np.isnan(value) else value


def _fill(table: CaseTable, file: h5py.File) -> None:
    description = table.description
    file.attrs.update(
        {
            "filetype": FILETYPE,
            "version": np.array(VERSION),
            "study": description.name,
            "scene": description.scene,
            "design": description.design,
        }
    )
    file["study"] = description.to_json()  # a dataset, for attributes end at 64 KB
    for group in GROUPS:
        number = file.create_group(group).create_dataset("case", data=np.arange(len(table.cases)))
        number.attrs.update({"units": "", "long_name": "number of the case in the order of the design"})
        number.make_scale("case")
    for column in table.columns():
        _put(file[column.group], column)


def _put(group: h5py.Group, column: TableColumn) -> None:
    values = column.values
    text = values.dtype.kind == "U"
    dataset = group.create_dataset(
        column.name,
        data=values.astype(object) if text else values,
        dtype=h5py.string_dtype() if text else None,
    )
    dataset.attrs.update({"units": column.quantity.unit, "long_name": column.quantity.long_name})
    dataset.dims[0].attach_scale(group["case"])


def _read(dataset: Any) -> np.ndarray:
    if not isinstance(dataset, h5py.Dataset) or len(dataset.shape or ()) != 1:
        raise ValueError(f"{dataset.name} is no column")
    if h5py.check_string_dtype(dataset.dtype):
        return np.array(dataset.asstr()[()], dtype=np.str_)
    if dataset.dtype.kind not in "iuf":
        raise ValueError(f"{dataset.name} holds neither numbers nor text")
    return np.asarray(dataset[()])
