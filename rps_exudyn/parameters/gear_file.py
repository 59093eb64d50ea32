"""The gear of a state as a TOML file, each parameter with its unit, that `--gear` reads again."""

from typing import Any

from rps_exudyn.parameters.gear import SteeringGear


def gear_file(gear: SteeringGear) -> str:
    """The text of the file: only what differs from the default gear is written."""
    tables: dict[str, list[str]] = {}
    for item in gear.declared():
        table, _, name = item.path.rpartition(".")
        value: Any = gear.value_at(item.path)
        if value == SteeringGear().value_at(item.path):
            continue
        tables.setdefault(table, []).append(f"{name} = {_toml(value, item)}  # {item.meaning}")
    heads = (f"[{table}]\n" + "\n".join(lines) for table, lines in tables.items())
    body = "\n\n".join(heads) or "# every parameter is that of the default gear"
    return f"# A gear for rps-exudyn run --gear FILE; what is not here is as in the default gear.\n\n{body}\n"


def _toml(value: Any, item: Any) -> str:
    """A value as TOML; with a unit as text that reads back to the same number."""
    if isinstance(value, str):
        return f'"{value}"'
    if item.unit is None or not item.unit.si:
        return repr(value)
    return f'"{value!r} {item.unit.si}"'
