"""The command `init`: a starter folder, from the gear and the studies that come with the package."""

import json
import os
import tomllib
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import replacing
from rps_exudyn.cli.output import DONE

if TYPE_CHECKING:
    from importlib.resources.abc import Traversable

MOST_NAMED = 4  # files of a folder
SUFFIXES = (".ply", ".toml", ".py", ".ipynb", ".csv", ".md")


def init(folder: Path = Path(), /) -> int:
    """Create a starter folder: the gear of the paper, studies, examples, and schemas for editors.

    Existing files are kept.

    Args:
        folder: Folder to fill; default: the current folder.
    """
    from rps_exudyn.optimisation.file_kinds import SCHEMAS

    made = {
        Path(f"{kind}.schema.json"): json.dumps(make(), indent=1).encode() for kind, make in SCHEMAS.items()
    }
    shipped = {name: _content(source, name) for source, name in _templates(files("rps_exudyn") / "templates")}
    written: list[Path] = []
    for name, content in (made | shipped).items():
        target = folder / name
        if target.exists():
            continue
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"{target.parent} cannot be written: {error.strerror}.") from None
        with replacing(target) as partial:
            partial.write_bytes(content)
        written.append(name)
    print(
        f"files written in {folder}: {len(written)}; kept as they were: {len(made | shipped) - len(written)}"
    )
    for place in dict.fromkeys(name.parent for name in written):
        names = [name.name for name in written if name.parent == place]
        names.sort(key=lambda name: (name.endswith(".json"), not name.endswith(".csv")))
        shown = ", ".join(names if len(names) <= MOST_NAMED else [*names[:MOST_NAMED], "..."])
        print(f"  {place}: {shown}" if place.parts else f"  {shown}")
    return DONE


def _content(source: "Traversable", name: Path) -> bytes:
    """A template's content; TOML begins with the place of its schema."""
    from rps_exudyn.optimisation.file_kinds import kind_of

    if name.suffix != ".toml":
        return source.read_bytes()
    text = source.read_text(encoding="utf-8")
    schema = os.path.relpath(f"{kind_of(tomllib.loads(text))}.schema.json", name.parent)
    return f"#:schema {Path(schema).as_posix()}\n{text}".encode()


def _templates(folder: "Traversable", below: Path = Path()) -> "list[tuple[Traversable, Path]]":
    """All files of a folder of the package that are for users, with their places in it."""
    found: list[tuple[Traversable, Path]] = []
    for item in sorted(folder.iterdir(), key=lambda each: each.name):
        if item.is_dir():
            found += _templates(item, below / item.name)
        elif item.name.endswith(SUFFIXES):
            found.append((item, below / item.name))
    return found
