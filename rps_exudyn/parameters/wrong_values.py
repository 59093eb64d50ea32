"""What validation finds wrong with the values of parameters, as sentences that state what is allowed."""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic import ValidationError

from rps_exudyn.base import units
from rps_exudyn.parameters.derived import value_in
from rps_exudyn.parameters.retired import choice_instead, parameter_instead

if TYPE_CHECKING:
    from rps_exudyn.parameters.declaration import Table

PATH = re.compile(r"\b[a-z_]+\.[a-z][a-z_0-9]*")
"""Of a parameter, in a text."""


class WrongValue(NamedTuple):
    """One thing that is wrong: the parameters' paths, and a sentence that states what is allowed."""

    paths: tuple[str, ...]
    sentence: str

    def concerns(self, settings: Iterable[str]) -> bool:
        """Return whether one of its parameters (or a table of theirs) is among the paths `settings`."""
        return any(f"{setting}.".startswith(f"{path}.") for setting in settings for path in self.paths)


def conflict(sentence: str, *others: str) -> WrongValue:
    """Return what is wrong between the parameters that a sentence names, and others."""
    return WrongValue((*PATH.findall(sentence), *others), sentence)


class ConflictError(ValueError):
    """Raised where parameters that are each fine alone do not fit each other."""

    def __init__(self, problems: list[WrongValue]) -> None:
        self.problems = problems
        super().__init__("\n".join(problem.sentence for problem in problems))


MOST_NAMED = 50  # problems, each in a sentence
MUCH_LESS_ALIKE = 0.2  # than the nearest name: what is so is not offered beside it


def problems_of(
    table: "type[Table]", error: ValidationError, given: Mapping[str, Any], settings: Iterable[str] = ()
) -> list[WrongValue]:
    """Everything that is wrong: single parameters first, then what does not fit between right ones.

    Validation stops at wrong single values; they are left out (their defaults stand in) to go on, and a
    conflict that involves one of them is not reported, because it may vanish with the first correction.
    """
    found: list[WrongValue] = []
    wrong: list[tuple[int | str, ...]] = []
    remaining: ValidationError | None = error
    while remaining:
        items = remaining.errors()
        for number, item in enumerate(items):
            if len(found) >= MOST_NAMED:
                return [*found, WrongValue((), f"{len(items) - number} more values are wrong.")]
            problems = [_problem(table, item, given, settings)]
            if isinstance(meant := item.get("ctx", {}).get("error"), ConflictError):
                problems = meant.problems
            found += [problem for problem in problems if not problem.concerns(_paths(wrong))]
        new = [item["loc"] for item in items if item["loc"] not in wrong]
        wrong += new
        # nothing new: a default itself is wrong, and no value left out mends that
        remaining = _error_of(table, _without(given, wrong)) if new and () not in wrong else None
    return found


def _error_of(table: "type[Table]", given: Mapping[str, Any]) -> ValidationError | None:
    try:
        table.model_validate(given)
    except ValidationError as error:
        return error
    return None


def _paths(places: Iterable[tuple[int | str, ...]]) -> list[str]:
    return [".".join(map(str, loc)) for loc in places]


def _problem(
    table: "type[Table]", item: Any, given: Mapping[str, Any], settings: Iterable[str]
) -> WrongValue:
    path = ".".join(str(part) for part in item["loc"])
    value = value_in(given, path)
    shown = units.shown(value)
    if item["type"] == "extra_forbidden" and any("." in str(part) for part in item["loc"]):
        sentence = f'"{units.short(path)}" is one key; write it without quotes, or as a table in a table.'
    elif item["type"] == "extra_forbidden":
        kind = "table of parameters" if isinstance(value, Mapping) else "parameter"
        from_file = not WrongValue((path,), "").concerns(settings)
        meant = nearest(table, path, table.not_in_files if from_file else ())
        sentence = f"{units.short(path)} is no {kind}; {meant}."
    elif item["type"] == "model_type":
        sentence = f"{path} is {shown}; it must be a table of parameters."
    elif item["type"] == "value_error":  # from units.to_si: with the value and how to write it
        sentence = f"{path} {item['ctx']['error']}."
    elif item["type"] == "finite_number":
        sentence = f"{path} is {shown}; it must be finite."
    elif instead := choice_instead(path, value):
        sentence = f"{path} is {shown}, which only earlier versions have: {instead}."
    else:
        sentence = f"{path} is {shown}; it must be {table.declared_at(path)[0].allowed}."
    return WrongValue((path,), sentence)


def _without(given: Mapping[str, Any], wrong: list[tuple[int | str, ...]]) -> dict[str, Any]:
    kept = {name: item for name, item in given.items() if (name,) not in wrong}
    for name, item in kept.items():
        if isinstance(item, Mapping):
            kept[name] = _without(item, [loc[1:] for loc in wrong if loc[0] == name])
    return kept


def nearest(table: "type[Table]", path: str, left_out: tuple[str, ...] = ()) -> str:
    """Return what replaces a retired parameter, or what may have been meant but for tables left out."""
    if instead := parameter_instead(path):
        return instead
    offered = [item.path for item in table.declared() if item.path.partition(".")[0] not in left_out]
    return nearest_names(path, offered, dict.fromkeys(name.partition(".")[0] for name in offered))


def nearest_names(name: str, offered: Sequence[str], otherwise: Iterable[str]) -> str:
    """Return which names that are offered may have been meant; where none is near, those `otherwise`."""
    import difflib

    close = difflib.get_close_matches(name, offered, n=3, cutoff=0.6)
    likeness = [difflib.SequenceMatcher(None, each, name).ratio() for each in close]
    close = [
        each for each, alike in zip(close, likeness, strict=True) if alike > likeness[0] - MUCH_LESS_ALIKE
    ]
    if close:
        return f"the nearest {'one is' if len(close) == 1 else 'ones are'} {', '.join(close)}"
    return f"there are {', '.join(otherwise)}"
