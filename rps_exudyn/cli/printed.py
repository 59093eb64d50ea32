"""What the terminal shows: results and parameters as tables for a reader, or as JSON for a program."""

import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table as Grid

from rps_exudyn.parameters.declaration import Declared, Table
from rps_exudyn.parameters.setup import Setup
from rps_exudyn.results.quantities import COUNTERS, GEOMETRY, SIGNALS, SUMMARY

if TYPE_CHECKING:
    from rps_exudyn.analysis.comparison import Comparison
    from rps_exudyn.analysis.measured import AgainstMeasured
    from rps_exudyn.gears.report import GeometryReport
    from rps_exudyn.results.result import Result


def print_result(result: "Result", files: Iterable[Path] = ()) -> None:
    """Scene, fidelity and status, then every summary value with its unit and definition."""
    console = _console()
    console.print(
        f"{result.scene} · fidelity {result.fidelity['name']} · status {result.status}", style="bold"
    )
    if result.message:
        console.print(result.message)
    console.print(_grid(("quantity", "value", "definition"), _summary_rows(result)))
    console.print(", ".join([f"{result.cpu_s:.3g} s of CPU time", *_counts(result)]))
    _print_files(console, files)


def result_as_dict(result: "Result", files: Iterable[Path] = ()) -> dict[str, Any]:
    """All of a result but its signals, in SI units."""
    return {
        "scene": result.scene,
        "status": result.status.value,
        "message": result.message,
        "fidelity": result.fidelity,
        "summary": result.summary,
        "counters": result.counters,
        "geometry": result.geometry,
        "cpu_s": result.cpu_s,
        "wall_s": result.wall_s,
        "parameters": result.gear.model_dump(),
        "solver": result.solver,
        "findings": result.findings,
        "provenance": result.provenance,
        "files": [str(file) for file in files],
    }


def print_comparison(comparison: "Comparison", names: tuple[str, str], files: Iterable[Path] = ()) -> None:
    """Settings that differ, summaries side by side, and how far each signal's curves lie apart."""
    console = _console()
    for name, *told in zip(names, comparison.scene, comparison.status, strict=True):
        console.print(f"{name}: {' · status '.join(told)}", style="bold")
    settings = [(path, *_both_shown(path, pair)) for path, pair in comparison.settings.items()]
    if settings:
        console.print(_grid(("setting", *names), settings))
    else:
        console.print("No setting differs.")
    console.print()
    console.print(_grid(("quantity", *names, "difference"), _summary_differences(comparison)))
    console.print()
    if comparison.signals:
        low, high = (SIGNALS["pinion_angle"].show(round(comparison.angle[end], 9)) for end in (0, -1))
        console.print(f"Signals over pinion angles of {low} to {high}, the torque's in % of its mean:")
        rows = (
            (
                name,
                pair.shown(pair.rms),
                pair.shown(pair.largest),
                SIGNALS["pinion_angle"].show(round(pair.angle, 9) + 0.0),
            )
            for name, pair in comparison.signals.items()
        )
        console.print(_grid(("quantity", "RMS difference", "largest", "at"), rows))
    else:
        console.print("The results share no range of the pinion angle: no signals are compared.")
    _print_files(console, files)


def comparison_as_dict(comparison: "Comparison", files: Iterable[Path] = ()) -> dict[str, Any]:
    """All of a comparison but the curves, in SI units; pairs are [first, second]."""
    return {
        "scene": comparison.scene,
        "status": comparison.status,
        "settings": comparison.settings,
        "summary": comparison.summary,
        "common_angle": comparison.angle[[0, -1]].tolist() if comparison.angle.size else None,
        "signals": {
            name: {
                "unit": SIGNALS[name].unit,
                "mean": pair.mean,
                "rms": pair.rms,
                "largest": pair.largest,
                "pinion_angle": pair.angle,
            }
            for name, pair in comparison.signals.items()
        },
        "files": [str(file) for file in files],
    }


def print_measured(compared: "list[AgainstMeasured] | None") -> None:
    """Figures of the measured and the simulated torque side by side, and how far the curves lie apart."""
    if compared is None:
        return
    console = _console()
    console.print()
    if not compared:
        console.print("Nothing to compare: at no pinion angle is there a measured and a simulated torque.")
    for each in compared:
        low, high = (SIGNALS["pinion_angle"].show(round(angle, 9)) for angle in each.angle_range)
        console.print(
            f"Torque towards {'+' if each.direction > 0 else '-'}X, pinion angles of {low} to {high}:"
        )
        rows = [
            (name, SUMMARY[name].show(value), SUMMARY[name].show(each.simulated[name]))
            for name, value in each.measured.items()
            if name in each.simulated
        ]
        console.print(_grid(("quantity", "measured", "simulated"), rows))
        pair = each.torque
        console.print(
            f"difference: RMS {pair.shown(pair.rms)}, largest {pair.shown(pair.largest)} of the measured mean"
        )


def measured_as_dict(compared: "list[AgainstMeasured] | None") -> dict[str, Any]:
    """The comparisons with a measured torque, in SI units; {} if nothing was measured."""
    if compared is None:
        return {}
    return {
        "measured": [
            {
                "direction": each.direction,
                "common_angle": list(each.angle_range),
                "measured": each.measured,
                "simulated": each.simulated,
                "rms": each.torque.rms,
                "largest": each.torque.largest,
                "pinion_angle": each.torque.angle,
            }
            for each in compared
        ]
    }


def print_differing(differing: Mapping[str, tuple[Any, Any]], name: str) -> None:
    """What a repeated simulation found otherwise than the file."""
    console = _console()
    if not differing:
        console.print(f"Every number is that of {name}, bit for bit.", soft_wrap=True)
        return
    rows = [(what, *map(str, pair)) for what, pair in differing.items()]
    console.print(_grid(("differs", name, "now"), rows))


def print_geometry(report: "GeometryReport", files: Iterable[Path] = ()) -> None:
    """Every number with its unit and definition, masses, and what the designer should be told."""
    rows = [(name, item.show(getattr(report, name)), item.long_name) for name, item in GEOMETRY.items()]
    rows += [
        (f"mass of {part}", f"{properties.mass:.4g} kg", "")
        for part, properties in report.mass_properties.items()
    ]
    console = _console()
    console.print(_grid(("quantity", "value", "definition"), rows))
    for warning in report.warnings:
        console.print(f"warning: {warning}", soft_wrap=True)
    _print_files(console, files)


def print_parameters(table: Table, items: list[Declared]) -> None:
    """Value, meaning and source of each; what is allowed too if it is only one."""
    rows = [(item.path, item.show(table.value_at(item.path)), item.meaning, item.source) for item in items]
    console = _console()
    console.print(_grid(("parameter", "value", "meaning", "source"), rows))
    if len(items) == 1:
        console.print(f"{items[0].path} must be {items[0].allowed}.")


def parameters_as_dict(table: Table, items: list[Declared]) -> dict[str, Any]:
    """Path -> value in SI, unit, and what else is declared."""
    return {
        item.path: {
            "value": table.value_at(item.path),
            "unit": item.unit.si if item.unit else "",
            "shown": item.show(table.value_at(item.path)),
            "meaning": item.meaning,
            "allowed": item.allowed,
            "source": item.source,
        }
        for item in items
    }


def print_json(content: Mapping[str, Any]) -> None:
    """Strict JSON on standard output; what is not finite becomes null."""
    print(json.dumps(_finite(content), indent=2, default=str))


def _summary_rows(result: "Result") -> Iterable[tuple[str, str, str]]:
    for name, value in result.summary.items():
        yield name, SUMMARY[name].show(value), SUMMARY[name].long_name
    for name in ("mesh_normal_force_drive", "mesh_normal_force_coast"):
        if name in result.signals and result[name].size:
            yield f"mean of {name}", SIGNALS[name].show(float(result[name].mean())), SIGNALS[name].long_name


def _both_shown(path: str, pair: tuple[Any, Any]) -> tuple[str, str]:
    """Two values of a setting for a reader; those of a parameter in its unit."""
    item = {item.path: item for item in Setup.declared()}.get(path)
    first, second = ("-" if value is None else item.show(value) if item else str(value) for value in pair)
    return first, second


def _summary_differences(comparison: "Comparison") -> Iterable[tuple[str, ...]]:
    for name, (first, second) in comparison.summary.items():
        values = ["-" if value is None else SUMMARY[name].show(value) for value in (first, second)]
        known = first is not None and second is not None
        yield name, *values, SUMMARY[name].show(second - first) if known else "-"


def _counts(result: "Result") -> Iterable[str]:
    """What the solver had to do, and its own share of the time."""
    for name, value in result.counters.items():
        if name == "solver_cpu":
            yield f"{COUNTERS[name].show(value)} of it in the solver"
        else:
            yield f"{value} {name.replace('_', ' ')}"


def _print_files(console: Console, files: Iterable[Path]) -> None:
    for file in files:
        console.print(f"written: {file}", soft_wrap=True)


def _grid(columns: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Grid:
    grid = Grid(box=None, header_style="dim", pad_edge=False, padding=(0, 2, 0, 0))
    for column in columns:
        grid.add_column(column, no_wrap=column in ("quantity", "parameter", "value"))
    for row in rows:
        grid.add_row(*row)
    return grid


def _console() -> Console:
    """Plain text; lines are not broken when they go to a file or a pipe."""
    console = Console(highlight=False, markup=False, emoji=False)
    return console if console.is_terminal else Console(highlight=False, markup=False, emoji=False, width=200)


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
