"""Reading tables of a TOML file key by key.

    keys = Keys(file)
    seed = keys.whole(told, "seed", 0, 0, 100)

A wrong value is replaced by its default to go on; `keys.problems` are the sentences about all of them.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import shown
from rps_exudyn.parameters.setup import Setup


class Keys:
    """Reads values and gathers what is wrong with them."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.problems: list[str] = []
        self.declared = {item.path: item for item in Setup.declared()}

    def wrong(self, where: str, sentence: str) -> None:
        self.problems.append(f"{self.file}: {where} {sentence}")

    @contextmanager
    def gathering(self) -> Iterator[None]:
        try:
            yield
        except InputError as error:
            self.problems += [
                problem if str(self.file) in problem else f"{self.file}: {problem}"
                for problem in error.problems
            ]

    def text(self, told: Mapping[str, Any], key: str, default: str) -> str:
        value = told.get(key, default)
        if isinstance(value, str):
            return value
        self.wrong(key, f"is {shown(value)}; it must be text.")
        return default

    def choice(self, told: Mapping[str, Any], key: str, allowed: tuple[str, ...], default: str) -> str:
        value = told.get(key, default)
        if value in allowed:
            return str(value)
        self.wrong(key, f"is {shown(value)}; it must be one of {', '.join(allowed)}.")
        return default

    def whole(self, told: Mapping[str, Any], key: str, default: int, least: int, most: int) -> int:
        value = told.get(key, default)
        if isinstance(value, int) and not isinstance(value, bool) and least <= value <= most:
            return value
        self.wrong(key, f"is {shown(value)}; it must be a whole number from {least} to {most}.")
        return default

    def table(self, told: Mapping[str, Any], key: str) -> Mapping[str, Any]:
        value = told.get(key, {})
        if isinstance(value, Mapping):
            return value
        self.wrong(key, f"is {shown(value)}; it must be a table.")
        return {}

    def flat(self, told: Mapping[str, Any], where: str, above: str = "") -> dict[str, Any]:
        """Path -> value of nested tables, for known parameters; others are told."""
        found: dict[str, Any] = {}
        for key, value in told.items():
            path = f"{above}{key}"
            if isinstance(value, Mapping):
                found |= self.flat(value, where, f"{path}.")
            elif self.is_parameter(path, where):
                found[path] = value
        return found

    def is_parameter(self, path: Any, where: str) -> bool:
        if isinstance(path, str) and path in self.declared:
            return True
        if path in ("fidelity.name", "fidelity.based_on"):
            self.wrong(where, f"cannot have {path}: it says what was chosen.")
            return False
        try:
            Setup.declared_at(str(path))
        except InputError as error:
            self.wrong(f"{where}:", str(error))
        else:
            self.wrong(f"{where}:", f"{path} is a table; name one of its parameters.")
        return False
