"""studies/gears/paper.toml says, value by value, what the defaults are and where they come from."""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from rps_exudyn.parameters.declaration import read_toml
from rps_exudyn.parameters.gear import SteeringGear

PAPER = Path(__file__).parents[2] / "studies" / "gears" / "paper.toml"


def sources_in_comments() -> dict[str, str]:
    """Path of the parameter -> first word of the comment behind its value."""
    sources, table = {}, ""
    for line in PAPER.read_text(encoding="utf-8").splitlines():
        if header := re.fullmatch(r"\[([\w.]+)\]", line):
            table = header[1]
        elif entry := re.match(r"(\w+) = .*?# (\w+)", line):
            sources[f"{table}.{entry[1]}"] = entry[2]
    return sources


def paths_of(tables: Mapping[str, Any], above: str = "") -> Iterator[str]:
    """Yield the paths of the parameters of nested tables."""
    for name, value in tables.items():
        if isinstance(value, Mapping):
            yield from paths_of(value, f"{above}{name}.")
        else:
            yield f"{above}{name}"


def test_file_is_the_default_gear() -> None:
    assert SteeringGear.from_toml(PAPER) == SteeringGear()


def test_file_names_every_parameter() -> None:
    assert list(paths_of(read_toml(PAPER))) == [item.path for item in SteeringGear.declared()]


def test_comments_name_the_declared_source() -> None:
    assert sources_in_comments() == {item.path: item.source for item in SteeringGear.declared()}
