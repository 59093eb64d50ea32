"""docs/hdf5-format.md describes exactly what a result file holds."""

import dataclasses
import re
from pathlib import Path

import h5py
import pytest

from rps_exudyn.gears.checks import GeometryReport
from rps_exudyn.outcome import Status
from rps_exudyn.quantities import GROUPS
from rps_exudyn.result import FILETYPE, VERSION, Result

PAGE = (Path(__file__).parents[2] / "docs" / "hdf5-format.md").read_text(encoding="utf-8")


def rows(section: str) -> list[tuple[str, ...]]:
    """The table of a section: cells of each row, without the two header rows."""
    text = PAGE.split(f"## {section}\n")[1].split("\n## ")[0]
    return [
        tuple(cell.strip() for cell in line.strip("|").split(" | "))
        for line in re.findall(r"^\| `.*\|$", text, re.M)
    ]


@pytest.mark.parametrize("group", GROUPS)
def test_page_lists_every_quantity(group: str) -> None:
    expected = [(f"`{name}`", item.unit or "1", item.long_name) for name, item in GROUPS[group].items()]
    assert rows(f"`/{group}`") == expected


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
    fields = [item.name for item in dataclasses.fields(GeometryReport)]
    assert fields == [*GROUPS["geometry"], "mass_properties", "warnings"]
