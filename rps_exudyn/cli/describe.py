"""The command `describe`: parameters with their values, units, meanings and sources."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from rps_exudyn.cli.options import PAPER_SETUP, Json, SetupOptions
from rps_exudyn.cli.output import DONE, present
from rps_exudyn.results.sheet import Block, Grid, Sheet, Text

if TYPE_CHECKING:
    from rps_exudyn.parameters.declaration import Declared
    from rps_exudyn.parameters.gear import Setup


def describe(path: str = "", /, *, setup: SetupOptions = PAPER_SETUP, json: Json = False) -> int:
    """Print parameters of gear, test and fidelity: value, unit, meaning, source.

    Args:
        path: Parameter such as yoke.preload, or table such as yoke or fidelity; default: all.
    """
    from rps_exudyn.parameters.gear import Setup

    items = Setup.declared_at(path)
    table = setup.load()
    present(Sheet(text=_text(table, items), data=lambda: _as_dict(table, items)), json=json)
    return DONE


def _text(table: "Setup", items: "list[Declared]") -> Iterator[Block]:
    from rps_exudyn.results.law_error import law_error

    rows = [(item.path, item.show(table.value_at(item.path)), item.meaning, item.source) for item in items]
    yield Grid(("parameter", "value", "meaning", "source"), rows)
    for item in items:
        if (derived := _derived(table, item)) is not None and item.unit is not None:
            yield Text(f"{item.path} is {item.unit.show(derived)} for this gear.")
    law = law_error(table, table.fidelity.model_dump())
    if law and "mesh.law" in (item.path for item in items):
        yield Text(law.sentence)
    if len(items) == 1:
        yield Text(f"{items[0].path} must be {items[0].allowed}.")


def _derived(table: "Setup", item: "Declared") -> float | None:
    """The value that the gear has for a parameter which is not given (SI)."""
    if table.value_at(item.path):
        return None
    from rps_exudyn.gears.tooth_stiffness import DERIVED  # with what makes them

    return DERIVED[item.path](table) if item.path in DERIVED else None


def _as_dict(table: "Setup", items: "list[Declared]") -> dict[str, Any]:
    """Path -> value in SI, unit, and the rest of the declaration."""
    return {
        item.path: {
            "value": table.value_at(item.path),
            "unit": item.unit.si if item.unit else "",
            "shown": item.show(table.value_at(item.path)),
            **({} if (derived := _derived(table, item)) is None else {"derived": derived}),
            "meaning": item.meaning,
            "allowed": item.allowed,
            "source": item.source,
        }
        for item in items
    }
