"""Output of the commands: results and parameters as tables in the terminal, or as JSON."""

import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rps_exudyn.base.units import words
from rps_exudyn.cli.text_table import put, put_table
from rps_exudyn.parameters.declaration import Declared
from rps_exudyn.parameters.setup import Setup
from rps_exudyn.results.law_error import law_error
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import COUNTERS, GEOMETRY, SIGNALS, SUMMARY

if TYPE_CHECKING:
    from rps_exudyn.analysis.comparison import Comparison, SignalPair
    from rps_exudyn.analysis.measured import AgainstMeasured
    from rps_exudyn.gears.report import GeometryReport
    from rps_exudyn.results.result import Result


def print_result(result: "Result", files: Iterable[Path] = ()) -> None:
    """Print scene, fidelity and status, then every summary value with its unit and definition."""
    put(f"{result.scene} · fidelity {result.fidelity['name']} · status {result.status}", "bold")
    if result.message:
        put(result.message)
    put_table(("quantity", "value", "definition"), _summary_rows(result))
    if result.status is Status.OK and (error := law_error(result.gear, result.fidelity)):
        put(error.sentence)
    put(", ".join([f"{result.cpu_s:.3g} s of CPU time", *_counts(result)]))
    _print_files(files)


def result_as_dict(result: "Result", files: Iterable[Path] = ()) -> dict[str, Any]:
    """A result without its signals, in SI units."""
    names = (
        "scene",
        "status",
        "message",
        "codes",
        "fidelity",
        "summary",
        "counters",
        "geometry",
        "cpu_s",
        "wall_s",
    )
    content = {name: getattr(result, name) for name in (*names, "solver", "findings", "provenance")}
    return content | {"parameters": result.gear.model_dump(), "files": [str(file) for file in files]}


def print_comparison(comparison: "Comparison", names: tuple[str, str], files: Iterable[Path] = ()) -> None:
    """Print the settings that differ, both summaries, and how far the curves of each signal lie apart."""
    for name, scene, status in zip(names, comparison.scene, comparison.status, strict=True):
        put(f"{name}: {scene} · status {status}", "bold")
    settings = [(path, *_both_shown(path, pair)) for path, pair in comparison.settings.items()]
    if settings:
        put_table(("setting", *names), settings)
    else:
        put("No setting differs.")
    put()
    put_table(("quantity", *names, "difference"), _summary_differences(comparison))
    put()
    if comparison.signals:
        angles = f"{_angle(comparison.angle[0])} to {_angle(comparison.angle[-1])}"
        put(f"Signals over pinion angles of {angles}, the torque's in % of its mean:")
        rows = (
            (name, pair.shown(pair.rms), pair.shown(pair.largest), _angle(pair.angle))
            for name, pair in comparison.signals.items()
        )
        put_table(("quantity", "RMS difference", "largest", "at"), rows)
    else:
        put("The results share no range of the pinion angle: no signals are compared.")
    _print_files(files)


def comparison_as_dict(comparison: "Comparison", files: Iterable[Path] = ()) -> dict[str, Any]:
    """A comparison without the curves, in SI units; pairs are [first, second]."""
    return {
        "scene": comparison.scene,
        "status": comparison.status,
        "settings": comparison.settings,
        "summary": comparison.summary,
        "common_angle": comparison.angle[[0, -1]].tolist() if comparison.angle.size else None,
        "signals": {
            name: {"unit": SIGNALS[name].unit, "mean": pair.mean, **_differences(pair)}
            for name, pair in comparison.signals.items()
        },
        "files": [str(file) for file in files],
    }


def _differences(pair: "SignalPair") -> dict[str, float]:
    return {"rms": pair.rms, "largest": pair.largest, "pinion_angle": pair.angle}


def _angle(angle: float) -> str:
    """A pinion angle [rad] as text, without rounding noise and negative zeros."""
    return SIGNALS["pinion_angle"].show(round(float(angle), 9) + 0.0)


def print_measured(compared: "list[AgainstMeasured] | None") -> None:
    """Print figures of the measured and the simulated torque, and how far the curves lie apart."""
    from rps_exudyn.analysis.measured import NOTHING_TO_COMPARE

    if compared is None:
        return
    put()
    if not compared:
        put(NOTHING_TO_COMPARE)
    for each in compared:
        put(f"{each.heading}:")
        put_table(("quantity", "measured", "simulated"), each.rows)
        put(each.difference)


def measured_as_dict(compared: "list[AgainstMeasured] | None") -> dict[str, Any]:
    """The comparisons with a measured torque, in SI units; {} if nothing was measured."""
    if compared is None:
        return {}
    return {
        "measured": [
            {
                "direction": each.direction,
                "common_angle": list(each.angle_range),
                "simulated_angle": list(each.simulated_range),
                "measured": each.measured,
                "simulated": each.simulated,
                **_differences(each.torque),
            }
            for each in compared
        ]
    }


def print_differing(differing: Mapping[str, tuple[Any, Any]], largest: tuple[str, float], name: str) -> None:
    """Print the numbers of a repeated simulation that differ from the file `name`, and the `largest`
    difference."""
    if not differing:
        put(f"Every number is that of {name}, bit for bit.")
        return
    rows = [(what, *map(str, pair)) for what, pair in differing.items()]
    put_table(("differs", name, "now"), rows)
    quantity, size = largest
    put(f"The largest relative difference is {size:.2g}{f', of {quantity}' if quantity else ''}.")


def print_geometry(report: "GeometryReport", files: Iterable[Path] = ()) -> None:
    """Print every number with its unit and definition, masses, and warnings to the designer."""
    rows = [(name, item.show(getattr(report, name)), item.long_name) for name, item in GEOMETRY.items()]
    rows += [
        (f"mass of {part}", f"{properties.mass:.4g} kg", "")
        for part, properties in report.mass_properties.items()
    ]
    put_table(("quantity", "value", "definition"), rows)
    for warning in report.warnings:
        put(f"warning: {warning}")
    _print_files(files)


def print_parameters(table: Setup, items: list[Declared]) -> None:
    """Print value, meaning and source of parameters; of a single one its allowed values, too."""
    rows = [(item.path, item.show(table.value_at(item.path)), item.meaning, item.source) for item in items]
    put_table(("parameter", "value", "meaning", "source"), rows)
    for item in items:
        if (derived := _derived(table, item)) is not None and item.unit is not None:
            put(f"{item.path} is {item.unit.show(derived)} for this gear.")
    law = law_error(table, table.fidelity.model_dump())
    if law and "mesh.law" in (item.path for item in items):
        put(law.sentence)
    if len(items) == 1:
        put(f"{items[0].path} must be {items[0].allowed}.")


def _derived(table: Setup, item: Declared) -> float | None:
    """The value that the gear has for a parameter which is not given (SI)."""
    if table.value_at(item.path):
        return None
    from rps_exudyn.gears.tooth_stiffness import DERIVED  # with what makes them

    return DERIVED[item.path](table) if item.path in DERIVED else None


def parameters_as_dict(table: Setup, items: list[Declared]) -> dict[str, Any]:
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


def print_json(content: Mapping[str, Any]) -> None:
    """Print strict JSON on standard output; numbers that are not finite become null."""
    print(json.dumps(_finite(content), indent=2, default=str))


def _summary_rows(result: "Result") -> Iterable[tuple[str, str, str]]:
    for name, value in result.summary.items():
        yield name, SUMMARY[name].show(value), SUMMARY[name].long_name
    for name in ("mesh_normal_force_drive", "mesh_normal_force_coast"):
        if name in result.signals and result[name].size:
            yield f"mean of {name}", SIGNALS[name].show(float(result[name].mean())), SIGNALS[name].long_name


def _both_shown(path: str, pair: tuple[Any, Any]) -> tuple[str, str]:
    """Two values of a setting as text; those of a parameter in its unit."""
    item = {item.path: item for item in Setup.declared()}.get(path)
    first, second = ("-" if value is None else item.show(value) if item else str(value) for value in pair)
    return first, second


def _summary_differences(comparison: "Comparison") -> Iterable[tuple[str, ...]]:
    for name, (first, second) in comparison.summary.items():
        values = ["-" if value is None else SUMMARY[name].show(value) for value in (first, second)]
        known = first is not None and second is not None
        yield name, *values, SUMMARY[name].show(second - first) if known else "-"


def _counts(result: "Result") -> Iterable[str]:
    """The solver's counters and its part of the CPU time, as text."""
    for name, value in result.counters.items():
        if name == "solver_cpu":
            yield f"{COUNTERS[name].show(value)} of it in the solver"
        else:
            yield f"{value} {words(name)}"


def _print_files(files: Iterable[Path]) -> None:
    for file in files:
        put(f"written: {file}")


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
