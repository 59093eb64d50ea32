"""Results as tables in the terminal, or as JSON."""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rps_exudyn.base.units import words
from rps_exudyn.cli.output import DONE, FAILED, GAP, note, print_files, print_json, put, put_table, say
from rps_exudyn.pages.report.sheet import INDENT, Sheet, sheet_of
from rps_exudyn.results.law_error import error_of_law
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import COUNTERS, SIGNALS, SUMMARY
from rps_exudyn.results.rounding import shown_metric, vague_rows

if TYPE_CHECKING:
    from rps_exudyn.analysis.measured import AgainstMeasured
    from rps_exudyn.analysis.result_comparison import SignalPair
    from rps_exudyn.results.result import Result


def put_result(result: "Result", json: bool, files: Iterable[Path] = (), every: bool = True) -> None:
    """Print a result and its comparison with a measured torque, if any: `every` number, or its sheet."""
    from rps_exudyn.analysis.measured import compared_with_own

    compared = compared_with_own(result)
    if json:
        print_json(result_as_dict(result, files) | measured_as_dict(compared))
    elif every:
        print_result(result, files)
        print_measured(compared)
    else:
        print_sheet(sheet_of(result, compared), files, f"{len(result.summary)} quantities")


def print_sheet(sheet: Sheet, files: Iterable[Path], more: str) -> None:
    """Print a sheet, the names of the files, and what --all prints more."""
    title, *lines = sheet.lines()
    put(title, "bold", indent=INDENT)
    for line, row in zip(lines, sheet.rows, strict=True):
        put(line, "dim" if row.is_vague else "", indent=INDENT + sheet.width + GAP)
    names = ", ".join(map(str, files))
    put(f"{f'written: {names}' if names else 'nothing written'}  (--all: {more})")


def put_accuracy(result: "Result") -> None:
    """Print on standard error what --accuracy has reached and what the next level would cost."""
    if text := result.findings.get("accuracy"):
        note(f"{text}.")


def verdict(result: "Result") -> int:
    """Return the exit status of a simulation; of a failed one, print on standard error what to do."""
    if result.status is Status.OK:
        return DONE
    say(f"the simulation failed ({result.status}): {result.message.rstrip('.')}. {result.status.remedy}")
    return FAILED


def print_result(result: "Result", files: Iterable[Path] = ()) -> None:
    """Print scene, fidelity, level and status, then every summary value with its bar and definition."""
    level = f" · level {result.findings['level']}" if "level" in result.findings else ""
    put(f"{result.scene} · fidelity {result.fidelity['name']}{level} · status {result.status}", "bold")
    if result.message:
        put(result.message)
    put_table(("quantity", "value", "definition"), _summary_rows(result), vague_rows(result))
    if error := error_of_law(result):
        put(error.sentence)
    put(", ".join([f"{result.cpu_s:.3g} s of CPU time", *_counts(result)]))
    print_files(files)


def result_as_dict(result: "Result", files: Iterable[Path] = ()) -> dict[str, Any]:
    """A result without its signals, in SI units."""
    names = (
        "scene",
        "status",
        "message",
        "codes",
        "fidelity",
        "summary",
        "errors",
        "counters",
        "geometry",
        "cpu_s",
        "wall_s",
    )
    content = {name: getattr(result, name) for name in (*names, "solver", "findings", "provenance")}
    return content | {"parameters": result.gear.model_dump(), "files": [str(file) for file in files]}


def _summary_rows(result: "Result") -> Iterable[tuple[str, str, str]]:
    for name in result.summary:
        yield name, shown_metric(result, name), SUMMARY[name].long_name
    for name in ("mesh_normal_force_drive", "mesh_normal_force_coast"):
        if name in result.signals and result[name].size:
            yield f"mean of {name}", SIGNALS[name].show(float(result[name].mean())), SIGNALS[name].long_name


def _counts(result: "Result") -> Iterable[str]:
    """The solver's counters and its part of the CPU time, as text."""
    for name, value in result.counters.items():
        if name == "solver_cpu":
            yield f"{COUNTERS[name].show(value)} of it in the solver"
        else:
            yield f"{value} {words(name)}"


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
                **differences(each.torque),
            }
            for each in compared
        ]
    }


def differences(pair: "SignalPair") -> dict[str, float]:
    """RMS and largest difference of two curves, and where it is."""
    return {"rms": pair.rms, "largest": pair.largest, "pinion_angle": pair.angle}
