"""Tables written as JSON in files of others: read to a depth that all their readers can bear."""

import json
from typing import Any

DEEPEST = 50
"""Levels of lists and tables within each other; our own files have six. Python refuses some hundreds."""


def read_json_tables(text: str, what: str) -> dict[str, Any]:
    """Return the table that a text holds as JSON; `what` names the text in messages.

    Raises:
        ValueError: it is no JSON, no table, or nested too deep.
    """
    too_deep = f"{what} is nested more than {DEEPEST} levels deep"
    try:
        tables = json.loads(text)
    except RecursionError:
        raise ValueError(too_deep) from None
    if not isinstance(tables, dict):
        raise ValueError(f"{what} is no set of tables")
    level: list[Any] = [tables]
    for _ in range(DEEPEST):
        containers = [each for each in level if isinstance(each, dict | list)]
        level = [item for each in containers for item in (each.values() if isinstance(each, dict) else each)]
        if not level:
            return tables
    raise ValueError(too_deep)
