"""A study in blocks is the same study: rows, results, table and Dataset as with one file per case."""

import dataclasses
import gzip
import os
import pickle
import warnings
from pathlib import Path

import numpy as np
import pytest
import xarray

import rps_exudyn as rps
from made_up_study import description, grid_points, make_study
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.hdf5 import READ_WITH
from rps_exudyn.results.block import TABLES, Block, CaseRecord, packed, summaries
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import COLUMNS
from rps_exudyn.results.result import Result
from rps_exudyn.study.case_blocks import Blocks
from rps_exudyn.study.collected import write_table
from rps_exudyn.study.store import Store
from rps_exudyn.study.table import CaseTable
from rps_exudyn.study.xarray_backend import Backend
from shell import Command
from study_files import write_grid, write_stand_in


def same(one: Result, other: Result) -> bool:
    """Whether two results hold the same, bit for bit."""
    names = [item.name for item in dataclasses.fields(Result) if item.name != "signals"]
    signals = [{name: values.tobytes() for name, values in each.signals.items()} for each in (one, other)]
    return all(getattr(one, name) == getattr(other, name) for name in names) and signals[0] == signals[1]


@pytest.fixture
def twins(tmp_path: Path, made_up_result: Result) -> tuple[Store, Store]:
    """A study with a failed case and one that is not done: in files, and the same in blocks of two."""
    described = description(grid_points())
    files = make_study(tmp_path / "files", made_up_result, described, failed={1: "no step"}, pending=[4])
    store = Store.of(tmp_path / "blocks", described)
    store.make_folders()
    store.write_description()
    blocks = Blocks(store.path / "blocks", cases=2)
    one_by_one = Store.open(files)
    for case, result in one_by_one.results():
        blocks.add(pickle.loads(pickle.dumps(CaseRecord.of(case.hash, result))))
    blocks.flush()
    return one_by_one, store


def test_results_and_rows_are_the_same_bit_for_bit(twins: tuple[Store, Store]) -> None:
    files, blocks = twins
    assert len(blocks.blocks.paths) == 3
    assert list(files.rows()) == list(blocks.rows())
    pairs = list(zip(files.results(), blocks.results(), strict=True))
    assert len(pairs) == 5
    assert all(one[0] == other[0] and same(one[1], other[1]) for one, other in pairs)
    assert not blocks.skipped


def unlike_results(made_up_result: Result) -> list[Result]:
    """Shorter records, other signals, missing and whole numbers, a text that ends in zeros, no signals."""
    short = {name: values[:7] for name, values in made_up_result.signals.items() if name != "rack_roll"}
    return [
        made_up_result,
        dataclasses.replace(made_up_result, signals=short, summary={"torque_mean": float("inf")}, errors={}),
        dataclasses.replace(made_up_result, signals={}, summary={}, errors={}, counters={}, message="µ\0\0"),
    ]


def test_results_of_unlike_shape_stand_in_one_block(made_up_result: Result, tmp_path: Path) -> None:
    unlike, path = unlike_results(made_up_result), tmp_path / "00000.h5"
    path.write_bytes(packed([CaseRecord.of(f"{at:016x}", result) for at, result in enumerate(unlike)]))
    block = Block.read(path)
    assert all(same(result, block.result(f"{at:016x}")) for at, result in enumerate(unlike))
    first, *others = unlike
    errors = {f"{name}_error": error for name, error in first.errors.items()}
    expected = [{**first.summary, **errors}, *(result.summary for result in others)]
    assert [row.summary for row in summaries(path)] == expected


def test_block_of_version_1_is_read(made_up_result: Result, tmp_path: Path) -> None:
    """The same results as rps-exudyn 1.0 wrote them: "NAME length" and "NAME known" beside the columns."""
    path = tmp_path / "00000.h5"
    path.write_bytes(gzip.decompress(Path(__file__).with_name("block_1_1.h5.gz").read_bytes()))
    origin = dict.fromkeys(made_up_result.provenance, "") | {"package_version": "1.0.0"}
    expected = unlike_results(dataclasses.replace(made_up_result, provenance=origin, errors={}))
    block = Block.read(path)
    assert all(same(result, block.result(f"{at:016x}")) for at, result in enumerate(expected))
    assert [row.summary for row in summaries(path)] == [result.summary for result in expected]


def test_block_is_labelled_for_other_programs(twins: tuple[Store, Store], made_up_result: Result) -> None:
    """Units, axes and named dimensions; a number that a case lacks is nan."""
    _, store = twins
    short = {name: values[:7] for name, values in made_up_result.signals.items()}
    short = dataclasses.replace(made_up_result, signals=short, summary={}, errors={})
    store.add(CaseRecord.of(store.description.cases[4].hash, short))
    store.add(CaseRecord.of(store.description.cases[5].hash, made_up_result))
    store.blocks.flush()
    with xarray.open_datatree(path := store.blocks.paths[-1], engine="h5netcdf") as tree:
        assert tree.attrs["read_with"] == READ_WITH
        assert tree["axes/preload"].attrs["units"] == "N"
        assert tree["axes/friction"].values.tolist() == [0.1, 0.2]
        assert tree["signals/pinion_torque"].dims == ("case", "sample")
        assert tree["signals/pinion_torque"].attrs["units"] == "N*m"
        assert np.isnan(tree["summary/torque_mean"].values).tolist() == [True, False]
        assert tree["valid/signals/time"].values.tolist() == [7, 121]
        for group in tree.subtree:
            assert set(group.dims) <= {"case", "sample"}
            assert all(name in COLUMNS[group.name] for name in group.data_vars if group.name in TABLES)
    with xarray.open_dataset(path, engine=Backend) as cases:
        assert {"preload", "torque_mean", "torque_mean_error", "pinion_torque"} < set(cases)


def test_table_and_dataset_are_the_same(twins: tuple[Store, Store], tmp_path: Path) -> None:
    tables = []
    for at, store in enumerate(twins):
        write_table(CaseTable.of(store), tmp_path / f"{at}.csv")
        tables.append((tmp_path / f"{at}.csv").read_text())
    assert tables[0] == tables[1]
    files, blocks = (rps.open_study(store.path).load() for store in twins)
    assert files.equals(blocks)
    assert np.isfinite(blocks.pinion_torque.values).any()


def test_path_of_a_case_means_the_one_in_the_block(
    twins: tuple[Store, Store], monkeypatch: pytest.MonkeyPatch
) -> None:
    """For Python and commands alike, absolute or from within the study; what is read is the reader's own."""
    files, blocks = twins
    monkeypatch.chdir(blocks.path)
    for case, result in files.results():
        for path in (blocks.path_of(case.hash), f"cases/{case.hash}.h5"):
            found = rps.load(path)
            assert same(found, result)
            for values in found.signals.values():
                values[:] = 0
    with pytest.raises(InputError, match="holds no case"):
        rps.load(blocks.path / "cases" / "0123456789abcdef.h5")


def test_page_about_a_case_in_a_block_has_a_place(command: Command, twins: tuple[Store, Store]) -> None:
    """There is no folder cases/ to put it in."""
    _, blocks = twins
    case, _ = next(blocks.results())
    answer = command(["report", str(blocks.path_of(case.hash))])
    assert answer.status == 0
    assert "cases/" not in answer.err
    assert Path(f"{case.hash}.html").exists()


def test_any_flipped_byte_is_named_and_its_block_done_again(twins: tuple[Store, Store]) -> None:
    """Fifty of them, anywhere in the file; the other blocks stay."""
    _, store = twins
    path, whole = store.blocks.paths[1], store.blocks.paths[1].read_bytes()
    others = [row for case, row in store.rows() if store.blocks.home_of(case.hash) != path]
    random = np.random.default_rng(4)
    for place in random.integers(0, len(whole), 50):
        damaged = bytearray(whole)
        damaged[place] ^= int(random.integers(1, 256))
        path.write_bytes(damaged)
        assert [row for _, row in store.rows()] == others
        assert [skipped for skipped, _ in store.skipped] == [path]
        assert "damaged" in store.skipped[0][1]
    store.set_aside()
    assert [row for _, row in store.rows()] == others
    assert not store.skipped
    with warnings.catch_warnings(action="error"):
        rps.open_study(store.path).load()


def test_case_done_again_counts_once_and_anew(twins: tuple[Store, Store]) -> None:
    _, store = twins
    failed = next(case for case, row in store.rows() if row.status is not Status.OK)
    mended = dataclasses.replace(store.result(failed), status=Status.OK, message="mended")
    store.blocks.flush()  # writes nothing
    store.blocks._written = float("inf")
    store.add(CaseRecord.of(failed.hash, mended))
    assert store.blocks.home_of(failed.hash) == store.blocks.paths[0]  # until it is written
    store.blocks.flush()
    rows = [row for _, row in Store.open(store.path).rows()]
    assert [row.hash for row in rows] == list(dict.fromkeys(row.hash for row in rows))
    assert [row.message for row in rows if row.hash == failed.hash] == ["mended"]


def test_a_block_that_fills_slowly_is_written_meanwhile(
    made_up_result: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In its own place, and readers that knew it before find what has come since."""
    monkeypatch.setattr("rps_exudyn.study.case_blocks.SECONDS", -1.0)
    (folder := tmp_path / "blocks").mkdir()
    blocks, reader = Blocks(folder, cases=3), Blocks(folder)
    hashes = [f"{at:016x}" for at in range(7)]
    for at, name in enumerate(hashes):
        blocks.add(CaseRecord.of(name, made_up_result))
        os.utime(folder, ns=(at + 1, at + 1))  # changes within one tick of the clock are told apart
        assert all(same(reader.block_of(each).result(each), made_up_result) for each in hashes[: at + 1])
    assert [len(Block.read(path).places) for path in blocks.paths] == [3, 3, 1]


@pytest.fixture
def stand_in(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """Worker processes simulate nothing."""
    folder = str(write_stand_in(tmp_path_factory.mktemp("stand_in")))
    monkeypatch.setenv("PYTHONPATH", folder, prepend=os.pathsep)


@pytest.mark.usefixtures("stand_in")
def test_study_file_asks_for_blocks_and_the_folder_stays_so(command: Command, tmp_path: Path) -> None:
    file = write_grid(tmp_path / "s.toml", 100, 200, 904)
    file.write_text(file.read_text() + "[keep]\nblocks = true\nsamples = 11\n")
    assert command(["study", str(file), "--jobs", "1"]).status == 1
    assert [path.name for path in (tmp_path / "s" / "blocks").iterdir()] == ["00000.h5"]
    assert not (tmp_path / "s" / "cases").exists()
    statuses = [row.status for _, row in Store.open(tmp_path / "s").rows()]
    assert statuses == [Status.OK, Status.OK, Status.DIVERGED]
    write_grid(file, 100, 150, 200, 904).write_text(file.read_text() + "[keep]\nsamples = 11\n")
    assert command(["study", str(file), "--jobs", "1", "--json"]).json["done_now"] == 1
    assert len(list((tmp_path / "s" / "blocks").iterdir())) == 2
    study = rps.open_study(tmp_path / "s")
    assert study.pinion_torque.sizes == {"yoke.preload": 4, "sample": 11}
    assert float(study.pinion_torque[1, 0]) == 150.0


def test_wrong_word_for_blocks_is_refused(command: Command, tmp_path: Path) -> None:
    file = write_grid(tmp_path / "s.toml", 100)
    file.write_text(file.read_text() + '[keep]\nblocks = "yes"\n')
    assert "keep.blocks is 'yes'; it must be true or false" in command(["study", str(file)]).err
