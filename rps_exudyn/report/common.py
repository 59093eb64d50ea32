"""What pages about studies and about results have in common."""

import json
from collections.abc import Iterable, Mapping
from typing import Any

from rps_exudyn.parameters.declaration import Declared
from rps_exudyn.parameters.setup import Setup
from rps_exudyn.report.blocks import Facts, Fold, Grid

PROVENANCE = {
    "package_version": "rps-exudyn",
    "git_hash": "commit",
    "date": "made",
    "machine": "machine",
    "library_versions": "libraries",
}


def provenance_facts(provenance: Mapping[str, Any]) -> Facts:
    """Versions, commit, date, machine; what else there is under its own name."""
    items = [
        (PROVENANCE.get(name, name.replace("_", " ")), told(value)) for name, value in provenance.items()
    ]
    return Facts([(name, text) for name, text in items if text])


def told(value: Any) -> str:
    """Text as it is; a table, or JSON of one, as "name value, name value"."""
    if isinstance(value, str) and value.startswith("{"):
        try:
            value = json.loads(value)
        except ValueError:
            return value
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {told(item)}" for name, item in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(told(item) for item in value)
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def parameter_rows(values: Mapping[str, Any]) -> Iterable[tuple[str, str, str, str]]:
    """Path, value, meaning and source of parameters at these paths."""
    known = {item.path: item for item in Setup.declared()}
    for path, value in values.items():
        item = known.get(path)
        if item is None:
            yield path, told(value), "", ""
        else:
            yield path, _shown(item, value), item.meaning, item.source


def parameter_grid(values: Mapping[str, Any], caption: str = "") -> Grid:
    """The parameters at these paths as a table."""
    return Grid(("parameter", "value", "meaning", "source"), list(parameter_rows(values)), caption)


def fidelity_facts(fidelity: Mapping[str, Any]) -> Fold:
    """Every choice of the model, folded under its name."""
    choices = {
        f"fidelity.{name}": value for name, value in fidelity.items() if name not in ("name", "based_on")
    }
    return Fold(f"Model: fidelity {fidelity.get('name', '')}", [parameter_grid(choices)])


def _shown(item: Declared, value: Any) -> str:
    return item.show(value) if isinstance(value, int | float) or item.unit is None else str(value)
