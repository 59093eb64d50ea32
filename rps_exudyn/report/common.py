"""Blocks that pages about studies and about results have in common."""

import json
from collections.abc import Iterable, Mapping
from typing import Any

from rps_exudyn.base.units import words
from rps_exudyn.parameters.setup import Setup
from rps_exudyn.report.blocks import Facts, Fold, Grid

PROVENANCE = {
    "package_version": "rps-exudyn",
    "git_hash": "commit",
    "date": "made",
    "machine": "machine",
    "library_versions": "libraries",
}


GEAR = {
    "pinion.teeth": "teeth",
    "pinion.normal_module": "normal module",
    "pinion.pressure_angle": "pressure angle",
    "pinion.helix_angle": "helix angle",
    "pinion.profile_shift": "profile shift",
    "rack.tooth_angle": "angle of the rack's teeth",
    "rack.bar_diameter": "bar's diameter",
    "yoke.preload": "yoke's preload",
    "yoke.clearance": "yoke's clearance",
    "mesh.friction": "friction of the teeth",
    "yoke.friction": "friction of the plunger",
    "pinion.runout": "runout",
    "test.speed": "test speed",
}
"""Parameters that tell one gear from another -> their names."""


def provenance_facts(provenance: Mapping[str, Any]) -> Facts:
    """Versions, commit, date, machine; other entries under their own names."""
    items = [(PROVENANCE.get(name, words(name)), as_text(value)) for name, value in provenance.items()]
    return Facts([(name, text) for name, text in items if text])


def as_text(value: Any) -> str:
    """The value as text; a table, or JSON of one, as "name value, name value"."""
    if isinstance(value, str) and value.startswith("{"):
        try:
            return as_text(json.loads(value))
        except (ValueError, RecursionError):  # no JSON, or nested too deep
            return value
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {as_text(item)}" for name, item in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(map(as_text, value))
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def gear_facts(values: Mapping[str, Any]) -> Facts:
    """What tells one gear from another; `values` are path -> value, and those of `GEAR` are shown."""
    rows = {path: text for path, text, *_ in parameter_rows({p: values[p] for p in GEAR if p in values})}
    return Facts([(GEAR[path], text) for path, text in rows.items()])


def parameter_rows(values: Mapping[str, Any]) -> Iterable[tuple[str, str, str, str]]:
    """Path, value, meaning and source of parameters; `values` are path -> value."""
    known = {item.path: item for item in Setup.declared()}
    for path, value in values.items():
        if (item := known.get(path)) is None:
            yield path, as_text(value), "", ""
        else:
            text = item.show(value) if isinstance(value, int | float) else str(value)
            yield path, text, item.meaning, item.source


def parameter_grid(values: Mapping[str, Any], caption: str = "") -> Grid:
    """A table of parameters; `values` are path -> value."""
    return Grid(("parameter", "value", "meaning", "source"), list(parameter_rows(values)), caption)


def fidelity_facts(fidelity: Mapping[str, Any]) -> Fold:
    """Every choice of the model, folded under the fidelity's name."""
    choices = {
        f"fidelity.{name}": value for name, value in fidelity.items() if name not in ("name", "based_on")
    }
    return Fold(f"Model: fidelity {fidelity.get('name', '')}", [parameter_grid(choices)])
