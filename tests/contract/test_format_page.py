"""docs/hdf5-format.md describes exactly what a result file holds."""

import json
import re
from pathlib import Path

import h5py
import pytest

from made_up_study import description, grid_points, make_study
from reader import filled
from rps_exudyn.gears.geometry_report import geometry_report
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import GROUPS, SIGNALS
from rps_exudyn.results.result import FILETYPE, MEASURED_SIGNALS, VERSION, Result
from rps_exudyn.study import collected
from rps_exudyn.study import definition as study
from rps_exudyn.study.store import Store
from rps_exudyn.study.table import OUTCOME, CaseTable

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "hdf5-format.md").read_text(encoding="utf-8")


def rows(section: str) -> list[tuple[str, ...]]:
    """The table of a section: cells of each row, without the two header rows."""
    text = re.split(r"\n#+ ", PAGE.split(f"## {section}\n")[1])[0]
    return [
        tuple(cell.strip() for cell in line.strip("|").split(" | "))
        for line in re.findall(r"^\| `.*\|$", text, re.M)
    ]


@pytest.mark.parametrize("group", GROUPS)
def test_site_lists_every_quantity(group: str) -> None:
    page = filled((ROOT / "docs" / "quantities.md").read_text(encoding="utf-8"))
    table = page.split(f"## {group}\n")[1].split("\n## ")[0]
    listed = [tuple(line.strip("| ").split(" | "))[:3] for line in re.findall(r"^\| `.*$", table, re.M)]
    expected = [(f"`{name}`", item.unit or "1", item.long_name) for name, item in GROUPS[group].items()]
    assert listed == expected
    assert f"`/{group}`" in [name for name, _ in rows("Groups")]


def test_page_lists_what_is_kept_of_a_measured_torque() -> None:
    expected = [(f"`{name}`", SIGNALS[name].unit, SIGNALS[name].long_name) for name in MEASURED_SIGNALS]
    assert rows("`/measured`") == expected


def test_page_lists_every_root_attribute(made_up_result: Result, tmp_path: Path) -> None:
    made_up_result.save(tmp_path / "r.h5")
    with h5py.File(tmp_path / "r.h5") as file:
        assert {name for name, *_ in rows("Root attributes")} == {f"`{name}`" for name in file.attrs}
        assert set(file) == set(GROUPS)


def test_page_names_filetype_version_and_every_status() -> None:
    meaning = {name: text for name, _, text in rows("Root attributes")}
    assert FILETYPE in meaning["`filetype`"]
    assert f"now {VERSION[0]}, {VERSION[1]}" in meaning["`version`"]
    assert re.findall(r"`([\w-]+)`", meaning["`status`"])[: len(Status)] == [
        status.value for status in Status
    ]


def test_geometry_quantities_are_those_of_the_report() -> None:
    assert list(geometry_report(SteeringGear()).numbers) == list(GROUPS["geometry"])


def test_page_lists_every_key_of_a_study() -> None:
    keys = json.loads(description(grid_points()).to_json())
    assert {name for name, *_ in rows("`study.json`")} == {f"`{name}`" for name in keys}
    assert {name for name, *_ in rows("Axes of `study.json`")} == {f"`{name}`" for name in keys["axes"][0]}
    meaning = {name: text for name, _, text in rows("`study.json`")}
    assert study.FILETYPE in meaning["`filetype`"]
    assert f"now {study.VERSION[0]}, {study.VERSION[1]}" in meaning["`version`"]
    assert re.findall(r"`([\w-]+)`", meaning["`design`"]) == list(study.DESIGNS)


def test_page_lists_everything_in_a_collected_table(made_up_result: Result, tmp_path: Path) -> None:
    folder = make_study(tmp_path / "s", made_up_result)
    collected.write_table(CaseTable.of(Store.open(folder)), tmp_path / "t.h5")
    with h5py.File(tmp_path / "t.h5") as file:
        assert {name for name, *_ in rows("Attributes of the table")} == {f"`{name}`" for name in file.attrs}
        contents = ["/study"] + [f"/{group}/{name}" for group in collected.GROUPS for name in file[group]]
    listed = [name for cells in rows("Contents of the table") for name in re.findall(r"`([^`]+)`", cells[0])]
    for name in contents:
        assert name in listed or f"{name.rpartition('/')[0]}/NAME" in listed
    outcome = {
        (name.strip("`").removeprefix("/outcome/"), unit, meaning)
        for name, unit, meaning in rows("Contents of the table")
        if name.startswith("`/outcome/")
    }
    assert outcome == {(name, item.unit or "text", item.long_name) for name, item in OUTCOME.items()}
    meaning = {name: text for name, _, text in rows("Attributes of the table")}
    assert collected.FILETYPE in meaning["`filetype`"]
    assert f"now {collected.VERSION[0]}, {collected.VERSION[1]}" in meaning["`version`"]
