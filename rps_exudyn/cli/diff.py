"""The command `diff`: two results compared."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rps_exudyn.base.files import PICTURES, check_writable
from rps_exudyn.cli.options import Json
from rps_exudyn.cli.output import DONE, present
from rps_exudyn.results.sheet import Block, Grid, Line, Sheet, Text

if TYPE_CHECKING:
    from rps_exudyn.analysis.result_comparison import ResultComparison


def diff(first: Path, second: Path, /, *, plot: Path | None = None, json: Json = False) -> int:
    """Compare two results: settings that differ, summary side by side, signals over the pinion angle.

    Args:
        first: HDF5 file that `run` wrote.
        second: HDF5 file to compare with it; differences are second minus first.
        plot: Picture (.png, .svg, .pdf) of both torques and their difference.
    """
    from rps_exudyn.analysis.result_comparison import compare
    from rps_exudyn.pages.charts.analyses import draw_comparison
    from rps_exudyn.study.case_blocks import load

    if plot:
        check_writable(plot, PICTURES)
    comparison = compare(load(first), load(second))
    names = (first.stem, second.stem) if first.stem != second.stem else (str(first), str(second))
    if plot:
        draw_comparison(comparison, names, plot)
    sheet = Sheet(text=_text(comparison, names), data=lambda: _as_dict(comparison))
    present(sheet, [plot] if plot else [], json=json)
    return DONE


def _text(comparison: "ResultComparison", names: tuple[str, str]) -> Iterator[Block]:
    from rps_exudyn.parameters.gear import Setup

    for name, scene, status in zip(names, comparison.scene, comparison.status, strict=True):
        yield Line(f"{name}: {scene} · status {status}", is_bold=True)
    known = {item.path: item for item in Setup.declared()}
    settings = []
    for path, pair in comparison.settings.items():
        show = known[path].show if path in known else str
        settings.append((path, *("-" if value is None else show(value) for value in pair)))
    yield Grid(("setting", *names), settings) if settings else Text("No setting differs.")
    yield Text("")
    yield Grid(("quantity", *names, "difference"), list(_summary_differences(comparison)))
    if bars := comparison.joint_bars:
        beyond = comparison.exceeding
        count = f"{len(beyond)} of {len(bars)} differences {'exceeds' if len(beyond) == 1 else 'exceed'}"
        yield Text(f"{count} the sum of both error bars{': ' * bool(beyond)}{', '.join(beyond)}.")
    yield Text("")
    if not comparison.signals:
        yield Text("The results share no range of the pinion angle: no signals are compared.")
        return
    angles = f"{_angle(comparison.angle[0])} to {_angle(comparison.angle[-1])}"
    rows = [
        (name, pair.shown(pair.rms), pair.shown(pair.largest), _angle(pair.angle))
        for name, pair in comparison.signals.items()
    ]
    caption = f"Signals over pinion angles of {angles}, the torque's in % of its mean:"
    yield Grid(("quantity", "RMS difference", "largest", "at"), rows, caption)


def _as_dict(comparison: "ResultComparison") -> dict[str, Any]:
    """A comparison without the curves, in SI units; pairs are [first, second]."""
    from rps_exudyn.pages.report.result_sheet import differences
    from rps_exudyn.results.quantities import SIGNALS

    return {
        "scene": comparison.scene,
        "status": comparison.status,
        "settings": comparison.settings,
        "summary": comparison.summary,
        "errors": comparison.errors,
        "joint_bars": comparison.joint_bars,
        "exceeding": comparison.exceeding,
        "common_angle": comparison.angle[[0, -1]].tolist() if comparison.angle.size else None,
        "signals": {
            name: {"unit": SIGNALS[name].unit, "mean": pair.mean, **differences(pair)}
            for name, pair in comparison.signals.items()
        },
    }


def _angle(angle: float) -> str:
    """A pinion angle [rad] as text, without rounding noise and negative zeros."""
    from rps_exudyn.results.quantities import SIGNALS

    return SIGNALS["pinion_angle"].show(round(float(angle), 9) + 0.0)


def _summary_differences(comparison: "ResultComparison") -> Iterable[tuple[str, ...]]:
    from rps_exudyn.results.quantities import SUMMARY
    from rps_exudyn.results.rounding import shown_with_bar

    joint = comparison.joint_bars
    for name, (first, second) in comparison.summary.items():
        pairs = zip((first, second), comparison.errors.get(name, (None, None)), strict=True)
        values = ["-" if value is None else shown_with_bar(SUMMARY[name], value, bar) for value, bar in pairs]
        known = first is not None and second is not None
        difference = shown_with_bar(SUMMARY[name], second - first, joint.get(name)) if known else "-"
        yield name, *values, difference
