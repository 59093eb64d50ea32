"""Files that a parameter names: kept as text, the path and a mark of the content.

    "worn.csv"  ->  "worn.csv sha256:9f2c51d08a7be634"

The mark makes a gear with other content another gear; a file that has changed since is refused.
"""

import re
from collections.abc import Iterable, Mapping
from hashlib import sha256
from pathlib import Path
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema
from pydantic_core.core_schema import no_info_before_validator_function

from rps_exudyn.base import units
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import content_of

LARGEST_NAMED = 2**28
"""Bytes of the largest file that a parameter names: five million triangles as STL."""
_MARKED = re.compile(r"(?P<path>.*\S) sha256:(?P<mark>[0-9a-f]{16})")


class NamedFile:
    """Reads the parameter: path of a file, or "none"."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """A path gets the mark of its file's content."""
        return no_info_before_validator_function(self._marked, handler(source))

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Text."""
        return handler(core)

    @staticmethod
    def _marked(value: object) -> str:
        if not isinstance(value, str | Path):
            raise ValueError(f'is {units.shown(value)}; it must be the path of a file, or "none"')
        path = str(value).strip()
        if path in ("", "none") or _MARKED.fullmatch(path):
            return "" if path == "none" else path
        try:
            return f"{path} sha256:{_mark(content_of(path, LARGEST_NAMED))}"
        except InputError as error:
            raise ValueError(f"names a file that cannot be read: {error}".rstrip(".")) from None


FilePath = Annotated[str, NamedFile()]


def named_content(text: str, parameter: str) -> tuple[Path, bytes]:
    """Return path and content of the file that a parameter names.

    Raises:
        InputError: it cannot be read, or has other content now.
    """
    found = _MARKED.fullmatch(text)
    assert found is not None
    path = Path(found["path"])
    try:
        content = content_of(path, LARGEST_NAMED)
    except InputError as error:
        raise InputError(f"{parameter}: {error}") from None
    if _mark(content) != found["mark"]:
        raise InputError(
            f"{parameter} names {path} with the content {found['mark']}; the file has the content "
            f"{_mark(content)} now: set {parameter} again."
        )
    return path, content


def beside(tables: Mapping[str, Any], folder: Path, paths: Iterable[str]) -> dict[str, Any]:
    """Return tables of a file in this folder with the named files of these parameters sought beside it."""
    moved: dict[str, Any] = dict(tables)
    for path in paths:
        table, _, name = path.partition(".")
        of_table = moved.get(table)
        if not isinstance(of_table, Mapping):
            continue
        value = of_table.get(name)
        if isinstance(value, str) and value.strip() not in ("", "none") and not _MARKED.fullmatch(value):
            moved[table] = {**of_table, name: str(folder / value.strip())}
    return moved


def _mark(content: bytes) -> str:
    return sha256(content).hexdigest()[:16]
