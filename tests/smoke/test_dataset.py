"""A study as Dataset, frame and table: numbers stand where their case is, failed ones are unknown."""

import csv
import dataclasses
import sys
import tomllib
from pathlib import Path
from pkgutil import resolve_name

import h5py
import numpy as np
import pandas
import pytest
import xarray
from scipy.io import loadmat

import rps_exudyn as rps
from made_up_study import description, grid_points, make_study, sampled, torque
from rps_exudyn.results.result import Result
from rps_exudyn.study.collected import read_table, write_table
from rps_exudyn.study.store import Store
from rps_exudyn.study.table import CaseTable
from rps_exudyn.study.xarray_backend import Backend
from shell import Command, refusal_of

POINTS = [{"preload": 110.0 + 7 * at, "friction": 0.1 + 0.01 * (at % 3)} for at in range(12)]


@pytest.mark.parametrize("step", [1, -1])
def test_grid_has_its_axes_as_dimensions(step: int, made_up_result: Result, tmp_path: Path) -> None:
    """Whatever the order of its cases."""
    study = rps.open_study(make_study(tmp_path / "s", made_up_result, description(grid_points()[::step])))
    assert study.torque_mean.dims == ("preload", "friction")
    for point in grid_points():
        assert study.torque_mean.sel(point).item() == pytest.approx(torque(point))
    assert study.preload.attrs["units"] == "N"
    assert all({"units", "long_name"} <= set(variable.attrs) for variable in study.variables.values())
    assert study.torque_mean.attrs == {
        "units": "N*m",
        "long_name": "mean of pinion_torque over the recorded pinion angle",
    }


def test_failed_and_pending_cases_are_unknown(made_up_result: Result, tmp_path: Path) -> None:
    study = rps.open_study(make_study(tmp_path / "s", made_up_result, failed={1: "no"}, pending=[4, 5]))
    assert study.status.values.tolist() == [["ok", "diverged"], ["ok", "ok"], ["pending", "pending"]]
    np.testing.assert_array_equal(np.isnan(study.torque_mean), study.status != "ok")
    assert np.isnan(study.pinion_torque.isel(preload=0, friction=1)).all()


def test_signals_are_read_only_where_they_are_looked_at(study: Path, made_up_result: Result) -> None:
    data = rps.open_study(study)
    wanted = data.hash.sel(preload=200, friction=0.2).item()
    for path in (study / "cases").glob("*.h5"):
        if path.stem != wanted:
            path.write_bytes(b"changed since: reading this would give other numbers than nan")
    curve = data.pinion_torque.sel(preload=200, friction=0.2)
    np.testing.assert_allclose(curve, made_up_result["pinion_torque"] - 0.6 + 0.4)
    with pytest.warns(UserWarning, match="damaged. Its signals are nan"):
        assert np.isnan(data.pinion_torque.sel(preload=100, friction=0.2)).all()
    with pytest.warns(UserWarning, match="damaged"):
        part = data.pinion_torque.isel(preload=[1, 2], sample=slice(0, 121, 40)).load()
    assert part.shape == (2, 2, 4)
    np.testing.assert_allclose(part.sel(preload=200, friction=0.2), curve[::40])


def test_sampled_design_has_the_dimension_case(made_up_result: Result, tmp_path: Path) -> None:
    study = rps.open_study(make_study(tmp_path / "s", made_up_result, sampled(POINTS)))
    assert study.torque_mean.dims == ("case",)
    np.testing.assert_allclose(study.torque_mean, study.preload * study.friction / 100)
    assert study.pinion_torque.dims == ("case", "sample")


def test_frame_has_a_row_for_each_case(made_up_result: Result, tmp_path: Path) -> None:
    frame = rps.study_frame(make_study(tmp_path / "s", made_up_result, failed={0: "no"}, pending=[5]))
    assert frame.status.tolist() == ["diverged", "ok", "ok", "ok", "ok", "pending"]
    assert frame.message.iloc[0] == "no"
    known = frame[frame.status == "ok"]
    np.testing.assert_allclose(known.torque_mean, known.preload * known.friction / 100)
    assert frame.torque_mean.isna().sum() == 2


def test_study_without_any_result_opens(made_up_result: Result, tmp_path: Path) -> None:
    study = rps.open_study(make_study(tmp_path / "s", made_up_result, pending=range(6)))
    assert set(study.status.values.ravel()) == {"pending"}
    assert "torque_mean" not in study


def test_damaged_file_counts_as_not_done(study: Path) -> None:
    next((study / "cases").glob("*.h5")).write_bytes(b"damaged")
    with pytest.warns(UserWarning, match="1 files of cases cannot be used"):
        assert (rps.open_study(study).status == "pending").sum() == 1


@pytest.mark.parametrize("name", ["table.h5", "table.csv", "table.parquet", "table.mat"])
def test_collected_table_has_every_case(
    name: str, made_up_result: Result, tmp_path: Path, command: Command
) -> None:
    if name.endswith("parquet"):
        pytest.importorskip("pyarrow")
    make_study(tmp_path / "s", made_up_result, failed={2: 'no, "quite"'}, pending=[3])
    answer = command(["collect", "s", "--out", name])
    cause = '  1 case diverged: no, "quite"\n'
    assert (answer.status, answer.out, answer.err) == (0, f"written: {name}\n{cause}", "")
    if name.endswith("csv"):
        with (tmp_path / name).open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        means = [float(row["torque_mean [N*m]"] or "nan") for row in rows]
        assert rows[0]["torque_mean_error [N*m]"] == "0.0012"
        statuses, messages = [row["status"] for row in rows], [row["message"] for row in rows]
    elif name.endswith("parquet"):
        frame = pandas.read_parquet(tmp_path / name)
        means, statuses, messages = frame.torque_mean, frame.status.tolist(), frame.message.tolist()
        assert frame.torque_mean_error[0] == 0.0012
    elif name.endswith("mat"):
        groups = loadmat(tmp_path / name, squeeze_me=True, struct_as_record=False)
        means, units = groups["summary"].torque_mean, groups["units"]
        assert (units.torque_mean, units.preload, groups["axes"].preload.shape) == ("N*m", "N", (6,))
        statuses, messages = (list(getattr(groups["outcome"], each)) for each in ("status", "message"))
    else:
        table = read_table(tmp_path / name)
        means = table["summary"]["torque_mean"]
        statuses, messages = (table["outcome"][column].tolist() for column in ("status", "message"))
    assert statuses == ["ok", "ok", "diverged", "pending", "ok", "ok"]
    assert messages[2] == 'no, "quite"'
    expected = [torque(point) for point in grid_points()]
    expected[2] = expected[3] = np.nan
    np.testing.assert_allclose(means, expected)


def test_columns_in_other_programs_have_units_and_names_that_they_allow(
    made_up_result: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command
) -> None:
    """An axis without a name has its parameter's path, with a dot in it; two such names may become one."""
    names = {"preload": "yoke.preload", "friction": "yoke_preload"}
    points = [{names[name]: value for name, value in point.items()} for point in POINTS]
    axes = tuple(dataclasses.replace(axis, name=names[axis.name]) for axis in sampled(POINTS).axes)
    make_study(tmp_path / "s", made_up_result, description(points, axes=axes, design="random", seed=1))
    assert command(["collect", "s", "--out", "t.mat"]).status == 0
    columns = loadmat(tmp_path / "t.mat", squeeze_me=True, struct_as_record=False)["axes"]
    assert columns._fieldnames == ["yoke_preload", "yoke_preload_1"]
    np.testing.assert_array_equal(columns.yoke_preload_1, [point["friction"] for point in POINTS])
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    assert "pip install 'rps-exudyn[parquet]'" in refusal_of(command(["collect", "s", "--out", "t.parquet"]))
    assert not Path("t.parquet").exists()


def test_parquet_has_the_units_of_its_columns(study: Path, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    write_table(CaseTable.of(Store.open(study)), tmp_path / "t.parquet")
    field = parquet.read_schema(tmp_path / "t.parquet").field("torque_mean")
    assert field.metadata[b"units"] == b"N*m"


def test_collected_table_opens_in_xarray(study: Path, command: Command) -> None:
    command(["collect", "s"])
    with xarray.open_dataset(study / "table.h5", group="summary", engine="h5netcdf") as table:
        assert table.torque_mean.dims == ("case",)
        assert table.torque_mean.attrs["units"] == "N*m"


def test_collected_cube_has_the_axes_as_dimensions(
    made_up_result: Result, tmp_path: Path, command: Command
) -> None:
    """Without an option of xarray; the table of columns, too, where the package is installed."""
    make_study(tmp_path / "s", made_up_result, pending=[5])
    assert command(["collect", "s", "--out", "cube.nc"]).status == 0
    with xarray.open_dataset("cube.nc") as cube:
        assert cube.torque_mean.dims == ("preload", "friction")
        assert cube.torque_mean.sel(preload=200, friction=0.2).item() == pytest.approx(0.4)
        assert cube.torque_mean_error.sel(preload=200, friction=0.2).item() == 0.0012
        assert (cube.preload.attrs["units"], cube.status.values[-1, -1]) == ("N", "pending")
    command(["collect", "s"])
    assert Backend().guess_can_open("s/table.h5")
    assert not Backend().guess_can_open("cube.nc")
    with xarray.open_dataset("s/table.h5", engine=Backend) as table:
        assert table.torque_mean.dims == table.preload.dims == ("case",)


def test_xarray_finds_the_backend_of_the_package() -> None:
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]
    (place,) = project["entry-points"]["xarray.backends"].values()
    assert resolve_name(place) is Backend


def test_collect_names_what_it_leaves_out(study: Path, command: Command) -> None:
    damaged = next((study / "cases").glob("*.h5"))
    damaged.write_bytes(b"damaged")
    answer = command(["collect", "s"])
    assert answer.status == 0
    assert answer.err.count("\n") == 1
    assert damaged.name in answer.err


def test_large_description_fits_in_the_table(
    made_up_result: Result, tmp_path: Path, command: Command
) -> None:
    """Attributes of HDF5 end at 64 KB."""
    points = [{"preload": 100 + at / 7, "friction": 0.1} for at in range(2000)]
    make_study(tmp_path / "s", made_up_result, sampled(points), pending=range(1, 2000))
    assert command(["collect", "s"]).status == 0
    with h5py.File(tmp_path / "s" / "table.h5") as file:
        assert len(file["study"][()]) > 65536
