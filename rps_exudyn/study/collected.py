"""A whole study in one table, as HDF5 or CSV: one row per case, in the order of the design.

    write_table(CaseTable.of(store), "table.h5")
    read_table("table.h5")["summary"]["torque_mean"]

The columns of docs/hdf5-format.md: the axes, hash, status, message, times, and the summary's numbers. SI
units; in a CSV they stand in the header, for instance `torque_mean [N*m]`.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from rps_exudyn.base.atomic import replacing
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.hdf5 import opened
from rps_exudyn.results.quantities import SUMMARY, Quantity
from rps_exudyn.study.table import CaseTable, axis_quantity

FILETYPE = "rps_exudyn-table"
VERSION = (1, 0)
"""Major: old readers must refuse the file. Minor: something was added that they may leave unread."""

SUFFIXES = (".h5", ".hdf5", ".csv")

OUTCOME = {
    "hash": Quantity("", "", "name of the case's file in cases/, without .h5"),
    "status": Quantity("", "", "how the case ended, or pending"),
    "message": Quantity("", "", "why, if the status is not ok"),
    "cpu_s": Quantity("s", "s", "CPU time of the simulation"),
    "wall_s": Quantity("s", "s", "elapsed time of the simulation"),
}
"""What every table has beside its axes and numbers."""

GROUPS = ("axes", "outcome", "summary")


@dataclass(frozen=True, eq=False)
class Column:
    """One column, shape (cases,), with what it is."""

    group: str  # one of GROUPS
    name: str
    values: np.ndarray
    quantity: Quantity

    @property
    def header(self) -> str:
        """Its name with its unit, for instance "torque_mean [N*m]"."""
        return f"{self.name} [{self.quantity.unit}]" if self.quantity.unit else self.name


def columns_of(table: CaseTable) -> list[Column]:
    """The table's columns, in order."""
    outcome: dict[str, np.ndarray] = {
        "hash": np.array([case.hash for case in table.cases], dtype=np.str_),
        "status": table.status,
        "message": np.array([row.message if row else "" for row in table.rows], dtype=np.str_),
        "cpu_s": table.times("cpu_s"),
        "wall_s": table.times("wall_s"),
    }
    return [
        *(
            Column("axes", axis.name, table.axes[axis.name], axis_quantity(axis))
            for axis in table.description.axes
        ),
        *(Column("outcome", name, outcome[name], quantity) for name, quantity in OUTCOME.items()),
        *(Column("summary", name, values, SUMMARY[name]) for name, values in table.numbers.items()),
    ]


def write_table(table: CaseTable, path: str | Path) -> None:
    """The study as one file, in the format of the path's suffix, whole or not at all.

    Raises:
        InputError: another suffix than `SUFFIXES`, or the file cannot be written.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(f"{path} cannot be written: its name must end in {' or '.join(SUFFIXES)}.")
    write = _write_csv if suffix == ".csv" else _write_hdf5
    with replacing(path) as partial:
        write(table, partial)


def read_table(path: str | Path) -> dict[str, dict[str, np.ndarray]]:
    """Group (axes, outcome, summary) -> column -> values, shape (cases,), of a table in HDF5.

    Raises:
        InputError: no such file, no table of this package, damaged, or of a newer format.
    """
    with opened(path, FILETYPE, "table", VERSION) as file:
        try:
            return {
                group: {name: _read(dataset) for name, dataset in file[group].items()} for group in GROUPS
            }
        except (KeyError, ValueError, TypeError, AttributeError, OSError, RuntimeError) as error:
            raise InputError(f"{path} is damaged: {error}.") from None


def _write_csv(table: CaseTable, path: Path) -> None:
    columns = columns_of(table)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([column.header for column in columns])
        writer.writerows(
            zip(*([_cell(value) for value in column.values.tolist()] for column in columns), strict=True)
        )


def _cell(value: Any) -> Any:
    """Unknown numbers are left empty."""
    return "" if isinstance(value, float) and np.isnan(value) else value


def _write_hdf5(table: CaseTable, path: Path) -> None:
    description = table.description
    with h5py.File(path, "w") as file:
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
        for column in columns_of(table):
            _put(file[column.group], column)


def _put(group: h5py.Group, column: Column) -> None:
    values = column.values
    text = values.dtype.kind == "U"
    dataset = group.create_dataset(
        column.name,
        data=values.astype(object) if text else values,
        dtype=h5py.string_dtype() if text else None,
    )
    attributes: Mapping[str, str] = {"units": column.quantity.unit, "long_name": column.quantity.long_name}
    dataset.attrs.update(attributes)
    dataset.dims[0].attach_scale(group["case"])


def _read(dataset: Any) -> np.ndarray:
    if not isinstance(dataset, h5py.Dataset) or len(dataset.shape or ()) != 1:
        raise ValueError(f"{dataset.name} is no column")
    if h5py.check_string_dtype(dataset.dtype):
        return np.array(dataset.asstr()[()], dtype=np.str_)
    if dataset.dtype.kind not in "iuf":
        raise ValueError(f"{dataset.name} holds neither numbers nor text")
    return np.asarray(dataset[()])
