"""A study as an xarray Dataset over its axes, or as a pandas frame with one row per case.

    study = rps.open_study("preload-study")
    study.torque_mean.sel(preload=300, method="nearest")
    study.pinion_torque.isel(preload=0)  # its file is read now

Signals are read from the cases' files on access. All values are SI; each variable has `units` and
`long_name`. Numbers and signals of a case that did not end ok, or is not finished, are nan; `status` states
which.
"""

import warnings
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from xarray import Coordinates, Dataset, Variable
from xarray.backends import BackendArray
from xarray.core.indexing import (
    ExplicitIndexer,
    IndexingSupport,
    LazilyIndexedArray,
    explicit_indexing_adapter,
)

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.hdf5 import opened
from rps_exudyn.results.block import Keep
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import FILETYPE, VERSION
from rps_exudyn.study.case_blocks import blocks_beside
from rps_exudyn.study.definition import axis_quantity
from rps_exudyn.study.store import Store
from rps_exudyn.study.table import CaseTable, TableColumn

if TYPE_CHECKING:
    from pandas import DataFrame

T = TypeVar("T")

CASE, SAMPLE = "case", "sample"


def open_study(path: str | Path) -> Dataset:
    """Open the study in a folder, also a half-finished one.

    Dimensions are the axes of a grid; a sampled design has the one dimension `case`, with the axes' values
    along it. Signals have `sample` as their last dimension, padded with nan to the longest record.

    Raises:
        InputError: no study there, a damaged one, or one of another format version.

    Examples:
        >>> rps.open_study("preload-study")["torque_mean"].dims
        ('preload', 'friction')
    """
    table = _table(path)
    return cube(table).assign(_signals(table, _Layout(table)))


def cube(table: CaseTable) -> Dataset:
    """Outcomes and numbers of a study over its axes, without signals; see `open_study`."""
    layout = _Layout(table)
    variables = {
        column.name: layout.variable(column)
        for column in table.columns()
        if column.group == "summary" or column.name in ("hash", "status", "cpu_s")
    }
    about = table.description
    origin = {"study": about.name, "scene": about.scene, "fidelity": str(about.fidelity.get("name", ""))}
    return Dataset(variables, coords=layout.coordinates(), attrs=origin | {"design": about.design})


def study_frame(path: str | Path) -> "DataFrame":
    """The study as a pandas frame: one row per case, indexed by its hash, in the order of the design.

    Columns are the axes, status, message, cpu_s and the summary's numbers (SI).

    Raises:
        InputError: as `open_study`.

    Examples:
        >>> len(rps.study_frame("preload-study"))
        6
    """
    from pandas import DataFrame

    columns = _table(path).columns()
    return DataFrame({each.name: each.values for each in columns if each.name != "wall_s"}).set_index("hash")


def _table(path: str | Path) -> CaseTable:
    """The cases of a folder, with a warning if some of its files cannot be used."""
    table = CaseTable.of(Store.open(path))
    if table.skipped:
        count, (_, first) = len(table.skipped), table.skipped[0]
        warnings.warn(
            f"{path}: {count} files of cases cannot be used and count as missing: {first}", stacklevel=3
        )
    return table


class _Layout:
    """The place of each case: over the axes of a grid, or along one dimension."""

    def __init__(self, table: CaseTable) -> None:
        self._table = table
        axes = table.description.axes
        self.is_grid = bool(axes) and all(axis.kind == "grid" and axis.values for axis in axes)
        if self.is_grid:
            self.dimensions = tuple(axis.name for axis in axes)
            self.shape = tuple(len(axis.values or ()) for axis in axes)
            places = [{value: at for at, value in enumerate(axis.values or ())} for axis in axes]
            self.places = tuple(
                np.array([place[case.values[axis.name]] for case in table.cases], dtype=int)
                for axis, place in zip(axes, places, strict=True)
            )
        else:
            self.dimensions, self.shape = (CASE,), (len(table.cases),)
            self.places = (np.arange(len(table.cases)),)

    def arranged(self, values: np.ndarray, absent: Any) -> np.ndarray:
        """Values of shape (cases,) in the shape of the dimensions."""
        array = np.full(self.shape, absent, dtype=np.result_type(values.dtype, np.asarray(absent).dtype))
        array[self.places] = values
        return array

    def variable(self, column: TableColumn) -> Variable:
        """A column over the dimensions; points of a grid without a case have the status "absent"."""
        absent = {"hash": "", "status": "absent"}.get(column.name, np.nan)
        return Variable(self.dimensions, self.arranged(column.values, absent), column.quantity.attributes)

    def coordinates(self) -> Coordinates:
        """The axes' values along their dimensions."""
        table, found = self._table, {}
        for axis in table.description.axes:
            values = np.array(axis.values) if self.is_grid else table.axes[axis.name]
            along = axis.name if self.is_grid else CASE
            attributes = axis_quantity(axis).attributes | {"paths": " ".join(axis.paths)}
            found[axis.name] = Variable((along,), values, attributes)
        return Coordinates(found)


class _Signal(BackendArray):
    """One signal of all cases, shape (axes..., sample): an access reads only the files that it needs."""

    def __init__(self, name: str, files: np.ndarray, samples: int) -> None:
        self._name, self._files = name, files
        self.shape = (*files.shape, samples)
        self.dtype = np.dtype(float)

    def __getitem__(self, key: ExplicitIndexer) -> np.ndarray:
        return explicit_indexing_adapter(key, self.shape, IndexingSupport.BASIC, self._read)

    def _read(self, key: tuple[int | slice, ...]) -> np.ndarray:
        *cases, samples = key
        files: Any = np.asarray(self._files[tuple(cases)], dtype=object)
        wanted = np.arange(self.shape[-1])[samples]
        values = np.full((*files.shape, *wanted.shape), np.nan)
        for place in (place for place in np.ndindex(files.shape) if files[place]):
            kept = _read_signals(files[place], [self._name], lambda dataset: dataset[()])
            record = kept.get(self._name, np.zeros(0))[: self.shape[-1]]  # removed since: nan
            padded = np.full(self.shape[-1], np.nan)
            padded[: record.size] = record
            values[place] = padded[samples]
        return values


def _signals(table: CaseTable, layout: _Layout) -> dict[str, Variable]:
    """Every signal that was kept, not read yet."""
    folder = table.path / "cases"
    usable = zip(table.cases, table.ok, strict=True)
    paths = np.array([folder / f"{case.hash}.h5" if ok else None for case, ok in usable], dtype=object)
    lengths = _lengths([path for path in dict.fromkeys(paths) if path], table.description.signals)
    if not lengths:
        return {}
    files, longest = layout.arranged(paths, None), max(lengths.values())
    return {
        name: Variable(
            (*layout.dimensions, SAMPLE),
            LazilyIndexedArray(_Signal(name, files, longest)),
            SIGNALS[name].attributes,
        )
        for name in SIGNALS
        if name in lengths
    }


def _lengths(paths: list[Path], keep: Keep) -> dict[str, int]:
    """Signal -> samples of the longest record, from the shapes of the files' datasets.

    No more files are opened once every signal that the study keeps has been found with all its samples.
    """
    longest: dict[str, int] = {}
    for path in paths:
        for name, length in _read_signals(path, SIGNALS, lambda dataset: dataset.shape[0]).items():
            longest[name] = max(longest.get(name, 0), length)
        samples = keep.samples or np.inf
        if keep.signals and all(longest.get(name, 0) >= samples for name in keep.signals):
            break
    return longest


def _read_signals(path: Path, names: Iterable[str], read: Callable[[Any], T]) -> dict[str, T]:
    """What `read` finds in signals of a case's file; nothing and a warning where it is gone or damaged."""
    try:
        if not path.exists() and (blocks := blocks_beside(path)).home_of(path.stem):
            signals = blocks.block_of(path.stem).signals(path.stem)
            return {name: read(signals[name]) for name in names if name in signals}
        with opened(path, FILETYPE, "result", VERSION) as file:
            group = file["signals"]
            return {name: read(group[name]) for name in names if name in group}
    except InputError as error:
        warnings.warn(f"{error} Its signals are nan.", stacklevel=2)
        return {}
