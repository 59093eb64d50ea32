"""A whole study in one table, as HDF5, CSV, Parquet or .mat: one row per case, in the order of the design.
Or as netCDF, over the study's axes.

    write_table(CaseTable.of(store), "table.h5")
    read_table("table.h5")["summary"]["torque_mean"]

Its columns are described in docs/hdf5-format.md: the axes, hash, status, message, times, and the summary's
numbers. Units are SI; a CSV has them in its header, for instance `torque_mean [N*m]`.
"""

import csv
import re
from collections.abc import Container
from itertools import count
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable, replacing, with_checksum
from rps_exudyn.base.hdf5 import file_image, opened, write_dataset
from rps_exudyn.study.table import CaseTable

FILETYPE = "rps_exudyn-table"
VERSION = (1, 2)
"""Major: old readers must refuse the file. Minor: something was added that they may leave unread."""

SUFFIXES = (".h5", ".hdf5", ".csv", ".parquet", ".mat", ".nc")

GROUPS = ("axes", "outcome", "summary")


def write_table(table: CaseTable, path: str | Path) -> None:
    """Write the study as one file, in the format of the path's suffix.

    Raises:
        InputError: another suffix than `SUFFIXES`, the file cannot be written, or pyarrow is not installed.
    """
    check_writable(path, SUFFIXES)
    write = _WRITERS.get(Path(path).suffix.lower(), _write_hdf5)
    with replacing(path) as partial:
        write(table, partial)


def read_table(path: str | Path) -> dict[str, dict[str, np.ndarray]]:
    """Group (axes, outcome, summary) -> column -> values, shape (cases,), of a table in HDF5.

    Raises:
        InputError: no such file, no table of this package, damaged, or of another format version.
    """
    with opened(path, FILETYPE, "table", VERSION) as file:
        return {group: {name: _read(dataset) for name, dataset in file[group].items()} for group in GROUPS}


def _write_hdf5(table: CaseTable, path: Path) -> None:
    path.write_bytes(with_checksum(file_image(lambda file: _fill(table, file))))


def _write_csv(table: CaseTable, path: Path) -> None:
    columns = table.columns()
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([column.header for column in columns])
        writer.writerows(
            zip(*([_cell(value) for value in column.values.tolist()] for column in columns), strict=True)
        )


def _write_parquet(table: CaseTable, path: Path) -> None:
    """One column of each name, its unit and meaning in the metadata of the field; unknown numbers are nan."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise InputError("Parquet needs pyarrow: pip install 'rps-exudyn[parquet]'.") from None
    columns = table.columns()
    fields = [
        pyarrow.field(
            column.name,
            pyarrow.string() if column.values.dtype.kind == "U" else pyarrow.float64(),
            metadata=column.quantity.attributes,
        )
        for column in columns
    ]
    arrays = [column.values.tolist() for column in columns]
    parquet.write_table(pyarrow.table(arrays, schema=pyarrow.schema(fields)), path)


def _write_mat(table: CaseTable, path: Path) -> None:
    """A structure for each group, columns of shape (cases, 1) as its fields, text in cells; and `units`."""
    from scipy.io import savemat

    groups: dict[str, dict[str, Any]] = {group: {} for group in (*GROUPS, "units")}
    for column in table.columns():
        name = _field_name(column.name, groups["units"])
        text = column.values.dtype.kind == "U"
        groups[column.group][name] = (column.values.astype(object) if text else column.values)[:, None]
        groups["units"][name] = column.quantity.unit
    savemat(path, groups, appendmat=False, long_field_names=True, do_compression=True)


def _field_name(name: str, taken: Container[str]) -> str:
    """A name as a field of MATLAB: letters, digits and underscores, at most 63."""
    plain = re.sub(r"\W", "_", name, flags=re.ASCII)[:60]
    plain = plain if plain[0].isalpha() else f"x{plain}"[:60]
    return next(each for at in count() if (each := f"{plain}_{at}" if at else plain) not in taken)


def _write_netcdf(table: CaseTable, path: Path) -> None:
    """The dataset of `rps.open_study` without signals: its dimensions are the axes of a grid."""
    from rps_exudyn.study.dataset import cube

    cube(table).to_netcdf(path, engine="h5netcdf")


_WRITERS = {".csv": _write_csv, ".parquet": _write_parquet, ".mat": _write_mat, ".nc": _write_netcdf}


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
        numbers, about = np.arange(len(table.cases)), "number of the case in the order of the design"
        write_dataset(
            file.create_group(group), "case", numbers, {"units": "", "long_name": about}
        ).make_scale("case")
    for column in table.columns():
        group = file[column.group]
        write_dataset(group, column.name, column.values, column.quantity.attributes, [group["case"]])


def _read(dataset: Any) -> np.ndarray:
    if not isinstance(dataset, h5py.Dataset) or len(dataset.shape or ()) != 1:
        raise ValueError(f"{dataset.name} is no column")
    if h5py.check_string_dtype(dataset.dtype):
        return np.array(dataset.asstr()[()], dtype=np.str_)
    if dataset.dtype.kind not in "iuf":
        raise ValueError(f"{dataset.name} holds neither numbers nor text")
    return np.asarray(dataset[()])
