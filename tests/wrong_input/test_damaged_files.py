"""Files in which a byte was changed: every reader notices, names the file, and keeps all the others."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.bad_inputs.damaged_files import COLUMNS, damaged_table, run, trial
from edited import edited
from rps_exudyn import load
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import CHECKSUM_SIZE, fits_checksum, with_checksum, without_checksum
from rps_exudyn.study.store import Store
from rps_exudyn.study.table import CaseTable
from shell import Command


def test_no_random_damage_goes_unnoticed_or_ends_in_a_traceback(study: Path) -> None:
    """A small version of the published 300."""
    from rps_exudyn.study.collected import write_table

    write_table(CaseTable.of(Store.open(study)), study / "table.h5")
    rng = np.random.default_rng(1)
    outcomes = [trial(study, rng) for _ in range(10)]
    assert [each for each in outcomes if not each[2] or each[3]] == []


def test_published_table_says_that_all_were_noticed(tmp_path: Path) -> None:
    lines = [COLUMNS, (0, "case file", "truncated", True, ""), (1, "table.h5", "truncated", False, "OSError")]
    (tmp_path / "damaged_files.csv").write_text("\n".join(",".join(map(str, line)) for line in lines))
    assert damaged_table(tmp_path).splitlines()[-1] == "| **all** | **2** | **1** | **1** |"
    assert callable(run)


@pytest.mark.parametrize("where", ["heading", "digest", "filling", "content"])
def test_any_changed_byte_breaks_the_seal(where: str) -> None:
    whole = with_checksum(b"some content")
    at = {"heading": 3, "digest": 60, "filling": CHECKSUM_SIZE - 1, "content": CHECKSUM_SIZE + 4}[where]
    assert fits_checksum(whole)
    assert not fits_checksum(whole[:at] + b"\0" + whole[at + 1 :])
    assert without_checksum(whole) == b"some content"


def test_files_without_a_checksum_are_read(study: Path) -> None:
    """As earlier versions wrote them; HDF5's own bytes are the same."""
    path = next((study / "cases").glob("*.h5"))
    new = load(path)
    path.write_bytes(without_checksum(path.read_bytes()))
    assert load(path).summary == new.summary


@pytest.mark.parametrize("levels", [900, 20000])  # of which Python's reader of JSON refuses the latter
@pytest.mark.parametrize("name", ["solver", "library_versions"])
def test_tables_nested_without_end_are_no_traceback(
    study: Path, command: Command, levels: int, name: str
) -> None:
    """A text of the origin is shown as it is; tables that belong to the result are refused."""
    path = next((study / "cases").glob("*.h5"))
    with edited(path) as file:
        del file.attrs[name]
        file.attrs[name] = '{"x": ' + "[" * levels + "]" * levels + "}"
    refused = name == "solver"
    for arguments in (["show", str(path), "--json"], ["report", str(path), "--out", "r.html"]):
        answer = command(arguments)
        assert answer.status == (2 if refused else 0)
        assert ("is nested more than 50 levels deep" in answer.err) is refused


def test_file_that_another_program_changed_is_refused(study: Path) -> None:
    import h5py

    path = next((study / "cases").glob("*.h5"))
    with h5py.File(path, "a") as file:
        file["summary/torque_mean"][()] = 7.0
    with pytest.raises(InputError, match="was changed by another program"):
        load(path)
    with edited(path) as file:
        file.attrs["note"] = "its checksum was taken off on purpose"
    assert load(path).summary["torque_mean"] == 7.0


def test_collect_names_a_few_damaged_files_and_counts_the_rest(study: Path, command: Command) -> None:
    for path in (study / "cases").glob("*.h5"):
        path.write_bytes(b"damaged")
    answer = command(["collect", "s"])
    assert answer.status == 0
    assert answer.err.count("left out: ") == 5
    assert "6 files are left out" in answer.err


def test_files_set_aside_earlier_stay(study: Path) -> None:
    store = Store.open(study)
    path = next((study / "cases").glob("*.h5"))
    for content in (b"first", b"second"):
        path.write_bytes(content)
        list(store.rows())
        store.set_aside()
    assert sorted(each.read_bytes() for each in path.parent.glob("*.set-aside")) == [b"first", b"second"]
