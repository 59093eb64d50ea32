"""Reading tables of a TOML file key by key.

    keys = Keys(file)
    seed = keys.whole(table, "seed", 0, 0, 100)

A wrong value is replaced by its default to go on; `keys.problems` are the sentences about all of them.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import shown
from rps_exudyn.parameters.gear import Setup


class Keys:
    """Reads values of one TOML file and gathers what is wrong with them."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.problems: list[str] = []
        self.declared = {item.path: item for item in Setup.declared()}

    def wrong(self, where: str, sentence: str) -> None:
        """Add a problem: the file's name, `where` in it, and the rest of the sentence."""
        self.problems.append(f"{self.file}: {where} {sentence}")

    @contextmanager
    def gathering(self) -> Iterator[None]:
        """Add the problems of an InputError that the block raises."""
        try:
            yield
        except InputError as error:
            self.problems += [
                problem if str(self.file) in problem else f"{self.file}: {problem}"
                for problem in error.problems
            ]

    def text(self, table: Mapping[str, Any], key: str, default: str) -> str:
        """The text under a key."""
        return self._value(table, key, default, lambda value: isinstance(value, str), "text")

    def choice(self, table: Mapping[str, Any], key: str, allowed: tuple[str, ...], default: str) -> str:
        """The word under a key, one of those allowed."""
        return self._value(table, key, default, allowed.__contains__, f"one of {', '.join(allowed)}")

    def whole(self, table: Mapping[str, Any], key: str, default: int, least: int, most: int) -> int:
        """The whole number under a key, from `least` to `most`."""
        return self._value(
            table,
            key,
            default,
            lambda value: type(value) is int and least <= value <= most,
            f"a whole number from {least} to {most}",
        )

    def table(self, table: Mapping[str, Any], key: str) -> Mapping[str, Any]:
        """The table under a key; {} without it."""
        return self._value(table, key, {}, lambda value: isinstance(value, Mapping), "a table")

    def _value(
        self, table: Mapping[str, Any], key: str, default: Any, fits: Callable[[Any], bool], allowed: str
    ) -> Any:
        value = table.get(key, default)
        if fits(value):
            return value
        self.wrong(key, f"is {shown(value)}; it must be {allowed}.")
        return default

    def flat(self, table: Mapping[str, Any], where: str, above: str = "") -> dict[str, Any]:
        """Path -> value of nested tables, for known parameters; unknown ones are problems."""
        found: dict[str, Any] = {}
        for key, value in table.items():
            path = f"{above}{key}"
            if isinstance(value, Mapping):
                found |= self.flat(value, where, f"{path}.")
            elif self.is_parameter(path, where):
                found[path] = value
        return found

    def is_parameter(self, path: Any, where: str) -> bool:
        """Return whether the path is that of one parameter; if not, that is a problem."""
        if isinstance(path, str) and path in self.declared:
            return True
        if path in ("fidelity.name", "fidelity.based_on"):
            self.wrong(where, f"cannot have {path}: it names what was chosen.")
            return False
        try:
            Setup.declared_at(str(path))
        except InputError as error:
            self.wrong(f"{where}:", str(error))
        else:
            self.wrong(f"{where}:", f"{path} is a table; name one of its parameters.")
        return False
