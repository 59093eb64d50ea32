"""A result file gives back what was saved, other tools read it, and it is replaced whole or not at all."""

import dataclasses
import os
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from edited import edited
from rps_exudyn import load
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable
from rps_exudyn.results.block import CaseRecord
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.provenance import FIELDS, git_hash, provenance
from rps_exudyn.results.quantities import GROUPS
from rps_exudyn.results.result import Result


@pytest.fixture
def saved(made_up_result: Result, tmp_path: Path) -> Path:
    path = tmp_path / "result.h5"
    made_up_result.save(path)
    return path


def as_plain(result: Result) -> dict[str, object]:
    """All fields, arrays as lists, so that two results can be compared with ==."""
    fields = {item.name: getattr(result, item.name) for item in dataclasses.fields(result)}
    return fields | {"signals": {name: values.tolist() for name, values in result.signals.items()}}


def test_load_gives_back_what_was_saved(saved: Path, made_up_result: Result) -> None:
    assert as_plain(load(saved)) == as_plain(made_up_result)


def test_files_of_version_1_0_have_no_errors(saved: Path, made_up_result: Result) -> None:
    with edited(saved) as file:
        file.attrs["version"] = (1, 4)
        for name in made_up_result.errors:
            del file["summary"][name].attrs["error"]
    assert load(saved).errors == {}


def test_bristles_of_earlier_versions_keep_their_reversal(made_up_result: Result, tmp_path: Path) -> None:
    """Files of a model without `friction_elements` are read with 0.687 times the travel and a remark, singly
    and from a block; others, and gears without bristles, as they are."""
    gear = made_up_result.gear.replace({"yoke.friction_law": "bristle", "yoke.bristle_travel": 8e-6})
    model = dict(made_up_result.fidelity) | {"friction_elements": 1}
    now = dataclasses.replace(made_up_result, gear=gear, fidelity=model, message="a remark")
    before = dataclasses.replace(now, fidelity={k: v for k, v in model.items() if k != "friction_elements"})
    before.save(tmp_path / "before.h5")
    for found in (load(tmp_path / "before.h5"), CaseRecord.of("a" * 16, before).result()):
        assert found.gear.yoke.bristle_travel == pytest.approx(0.687 * 8e-6)
        assert found.gear.mesh.bristle_travel == gear.mesh.bristle_travel
        assert found.message.startswith("a remark; the file is of an earlier version")
    now.save(tmp_path / "now.h5")
    assert load(tmp_path / "now.h5").gear.yoke.bristle_travel == 8e-6
    plain = dataclasses.replace(before, gear=made_up_result.gear)
    assert CaseRecord.of("a" * 16, plain).result().message == "a remark"


@pytest.mark.parametrize("status", list(Status))
def test_failed_result_without_signals_survives(
    status: Status, made_up_result: Result, tmp_path: Path
) -> None:
    failed = dataclasses.replace(
        made_up_result, status=status, message="because", signals={}, summary={}, errors={}
    )
    failed.save(tmp_path / "failed.h5")
    assert as_plain(load(tmp_path / "failed.h5")) == as_plain(failed)
    assert status.remedy.endswith(".")


def test_numpy_values_in_settings_are_stored_as_numbers(made_up_result: Result, tmp_path: Path) -> None:
    solver = {"weights": np.arange(3), "step": np.float64(0.5), "where": Path("x")}
    dataclasses.replace(made_up_result, solver=solver).save(tmp_path / "r.h5")
    assert load(tmp_path / "r.h5").solver == {"weights": [0, 1, 2], "step": 0.5, "where": "x"}


def test_xarray_reads_signals_over_time(saved: Path, made_up_result: Result) -> None:
    with xarray.open_dataset(saved, group="signals", engine="h5netcdf") as signals:
        assert signals["pinion_torque"].dims == ("time",)
        assert signals["pinion_torque"].attrs["units"] == "N*m"
        np.testing.assert_array_equal(signals["time"], made_up_result["time"])
        np.testing.assert_array_equal(signals["pinion_torque"], made_up_result["pinion_torque"])


def test_every_dataset_has_unit_and_definition(saved: Path) -> None:
    with h5py.File(saved) as file:
        for group, known in GROUPS.items():
            for name, dataset in file[group].items():
                assert dataset.attrs["units"] == known[name].unit
                assert dataset.attrs["long_name"] == known[name].long_name


def test_undeclared_name_is_refused(made_up_result: Result) -> None:
    with pytest.raises(ValueError, match="no summary named torque_maen"):
        dataclasses.replace(made_up_result, summary={"torque_maen": 1.0})


def test_signals_of_different_length_are_refused(made_up_result: Result) -> None:
    with pytest.raises(ValueError, match="of one length"):
        dataclasses.replace(made_up_result, signals=made_up_result.signals | {"rack_y": np.zeros(3)})


def test_provenance_has_the_declared_fields() -> None:
    assert tuple(provenance()) == FIELDS


def test_git_hash_is_the_checkouts() -> None:
    root = Path(__file__).parents[2]
    if not (root / ".git").exists():
        pytest.skip("no git checkout")
    head = subprocess.run(["git", "rev-parse", "HEAD"], cwd=root, capture_output=True, text=True, check=True)
    assert git_hash().removesuffix("-dirty") == head.stdout.strip()


# --- replaced whole or not at all ----------------------------------------------------------------


@pytest.mark.parametrize(
    ("owner", "name", "error", "becomes"),
    [
        (h5py.Dataset, "make_scale", OSError(28, "No space left on device"), InputError),
        (os, "fsync", KeyboardInterrupt(), KeyboardInterrupt),
    ],
    ids=["full disk", "interrupt"],
)
def test_write_that_ends_early_leaves_the_old_file_and_nothing_else(
    owner: object,
    name: str,
    error: BaseException,
    becomes: type[BaseException],
    saved: Path,
    made_up_result: Result,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    before = saved.read_bytes()

    def fail(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(owner, name, fail)
    with pytest.raises(becomes, match=r"result\.h5 cannot be written: No space left on device\.|^$"):
        made_up_result.save(saved)
    assert saved.read_bytes() == before
    assert os.listdir(saved.parent) == [saved.name]


def test_checking_leaves_no_trace(saved: Path, tmp_path: Path) -> None:
    before = saved.read_bytes()
    check_writable(saved)
    check_writable(tmp_path / "new.h5")
    assert saved.read_bytes() == before
    assert os.listdir(tmp_path) == [saved.name]


def test_folder_and_missing_folder_cannot_be_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="it is not a file"):
        check_writable(tmp_path)
    with pytest.raises(InputError, match="there is no folder"):
        check_writable(tmp_path / "missing" / "r.h5")


# --- what is refused when reading ------------------------------------------------------------------


def test_newer_minor_version_is_read_without_its_additions(saved: Path, made_up_result: Result) -> None:
    with edited(saved) as file:
        file.attrs["version"] = (1, 99)
        file["signals/added_later"] = [1.0, 2.0]
    assert as_plain(load(saved)) == as_plain(made_up_result)


def test_foreign_hdf5_is_refused(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "foreign.h5", "w") as file:
        file["signals/time"] = [0.0]
    with pytest.raises(InputError, match="is an HDF5 file, but not a result of rps-exudyn"):
        load(tmp_path / "foreign.h5")


WRONG_ATTRIBUTES = {
    "parameters": ["[1]", "3", "no JSON", 3, "null"],
    "fidelity": ["3", "{}", "[]", '{"name": 3}', "[" * 10_000],
    "solver": ["3"],
    "status": ["fine", 3],
    "scene": [3],
    "message": [3.5],
    "cpu_s": ["long", (1.0, 2.0)],
    "machine": [3],
}


@pytest.mark.parametrize(
    ("name", "value"), [(name, value) for name, values in WRONG_ATTRIBUTES.items() for value in values]
)
def test_wrong_attribute_is_damage(saved: Path, name: str, value: object) -> None:
    with edited(saved) as file:
        file.attrs[name] = value
    with pytest.raises(InputError, match=r"result\.h5 is damaged: .*[^.]\.$"):
        load(saved)


def replaced(file: h5py.File, name: str, value: object) -> None:
    del file[name]
    file.create_dataset(name, data=value)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            lambda file: file.attrs.create("version", (2, 0)),
            "has format version 2.0, and this rps-exudyn reads",
        ),
        *((lambda file, lost=lost: file.attrs.pop(lost), "is damaged") for lost in ("status", "cpu_s")),
        (lambda file: file.pop("summary"), "is damaged"),
        (lambda file: (file.pop("signals/rack_y"), file.create_group("signals/rack_y")), "holds no numbers"),
        *(
            (lambda file, value=value: replaced(file, "summary/torque_mean", value), "/summary/torque_mean")
            for value in ("text", [1.0, 2.0], h5py.Empty("f"), True)
        ),
    ],
)
def test_newer_or_damaged_file_is_refused(
    change: Callable[[h5py.File], object], said: str, saved: Path
) -> None:
    with edited(saved) as file:
        change(file)
    with pytest.raises(InputError, match=rf"result\.h5 .*{re.escape(said)}"):
        load(saved)


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(share=st.floats(0, 0.999))
def test_truncated_file_is_refused(share: float, saved: Path) -> None:
    whole = saved.read_bytes()
    cut = saved.with_name("cut.h5")
    cut.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(InputError, match=r"cut\.h5 is .*damaged"):
        load(cut)
