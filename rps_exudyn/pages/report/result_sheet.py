"""The sheet of a run: a few rows, which the terminal prints and a page begins with; every number; JSON.

sheet = sheet_of(result)
sheet.title, [(row.value, row.words) for row in sheet.rows]
"""

from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import replace
from math import isclose
from typing import TYPE_CHECKING, Any

from rps_exudyn.base.units import words
from rps_exudyn.parameters.derived import derived_values
from rps_exudyn.parameters.display_names import named
from rps_exudyn.parameters.gear import BY_SCENE, SteeringGear
from rps_exudyn.results import rounding
from rps_exudyn.results.law_error import error_of_law, law_error
from rps_exudyn.results.outcome import Status, sentences
from rps_exudyn.results.quantities import COUNTERS, LABELS, PARTS, SIGNALS, SUMMARY
from rps_exudyn.results.result import Result
from rps_exudyn.results.sheet import Block, Grid, Line, Row, Sheet, Text
from rps_exudyn.scenes import is_scene, scene_named

if TYPE_CHECKING:
    from rps_exudyn.analysis.measured import AgainstMeasured
    from rps_exudyn.analysis.result_comparison import SignalPair
    from rps_exudyn.inference.uncertainty.band import Band
    from rps_exudyn.inference.uncertainty.statistics import Contributions

MANY_CHANGES = 3  # parameters that are not named
MOST_METRICS = 3  # of a scene
WITH_SCATTER = 2  # of them, whose inputs are named
MOST_ROWS = 6  # with title and files a sheet has 8 lines
REPEATED = ("torque_on_centre",)  # the mean again, over fewer angles
REMARK, WORK_LOST = "remark", "work lost"
LEAST_SHARE = 0.005  # of the work lost, or of a variance, below which a part is not named


def sheet_of(
    result: Result, compared: "Sequence[AgainstMeasured] | None" = None, band: "Band | None" = None
) -> Sheet:
    """Return the sheet of a result, with its comparison with a measured torque, and with the band of
    uncertain inputs of which it is the nominal run."""
    title = scene_named(result.scene).title if is_scene(result.scene) else result.scene
    gear, medians = result.gear.replace({"mesh.law": BY_SCENE}), band.inputs if band is not None else {}
    shown = gear_shown(gear, medians) + (f"; {len(medians)} inputs at their medians" if medians else "")
    law = law_error(result.gear, result.fidelity)
    model = f"{result.fidelity['name']}; law {law.law}" if law else result.fidelity["name"]
    state = "" if result.status is Status.OK else f" ({result.status})"
    rows = [*_measured(result, compared), *_band(band, _printed(result)[:WITH_SCATTER])]
    remarks = sentences(result.message) if result.message else []
    room = (
        MOST_ROWS - bool(remarks) - (band is not None)
    )  # of a band, two metrics are shown with their inputs
    if (shares := loss_shares(result)) and len(rows) + 1 < room:
        lost = ", ".join(f"{PARTS[part]} {100 * share:.0f} %" for part, share in shares.items())
        rows.append(Row(WORK_LOST, lost))
    if remarks:
        others = f"; and {len(remarks) - 1} more: --all" * (len(remarks) > 1)
        rows.append(Row(REMARK, remarks[0] + others))
    metrics = tuple(_metrics(result, band))[: max(1, MOST_ROWS - len(rows))]
    return Sheet(
        f"{title}{state}",
        f"{shown}; {model}",
        (*metrics, *rows),
        text=result_text(result, compared),
        more=f"{len(result.summary)} quantities",
        data=lambda: result_as_dict(result) | measured_as_dict(compared),
    )


def gear_shown(gear: SteeringGear, but_for: Container[str] = ()) -> str:
    """The gear in a line: its size, and what differs from the default gear but for some paths."""
    size = repr(gear).strip("<>").removeprefix("SteeringGear: ").partition("; ")[0]
    return f"{size}; {changes_shown(gear, but_for)}"


def changes_shown(gear: SteeringGear, but_for: Container[str] = ()) -> str:
    """What differs from the default gear but for some paths; what follows from other parameters is counted
    apart."""
    follows = derived_values(gear.model_dump())
    shown, derived = [], 0
    for (path, value), text in zip(gear.changes().items(), gear.changes_shown(), strict=True):
        if path in follows and isclose(value, follows[path]):
            derived += 1
        elif path not in but_for:
            shown.append(text)
    text = f"default but for {', '.join(shown)}" if shown else "default"
    if len(shown) >= MANY_CHANGES:
        text = f"{len(shown)} parameters changed"
    return text + (f", {derived} derived" if derived else "")


def _printed(result: Result) -> list[str]:
    """The scene's own number and others that have a label."""
    summary, first = result.summary, scene_named(result.scene).main_metric if is_scene(result.scene) else ""
    others = [name for name in LABELS if name not in (first, *REPEATED)]
    names = [name for name in (first, *others) if name in summary]
    shown = {name: rounding.rounded(SUMMARY[name], summary[name]) for name in names[1:]}
    return [*names[:1], *(name for name in shown if not shown[name].startswith("0 "))][:MOST_METRICS]


def _metrics(result: Result, band: "Band | None") -> Iterable[Row]:
    """These numbers with their error bars; the error of the contact law beside them."""
    names, summary, law = _printed(result), result.summary, law_error(result.gear, result.fidelity)
    largest: dict[str, float] = {}  # unit -> number whose unit all others of it have
    for name in names:
        unit = SUMMARY[name].unit
        largest[unit] = max(abs(summary[name]), largest.get(unit, 0.0))
    for name in names:
        quantity, value, like = SUMMARY[name], summary[name], largest[SUMMARY[name].unit]
        about = LABELS.get(name, quantity.long_name)
        if law is not None and (wide := rounding.law_bar(result, name)):
            about += f"; contact law {law.law} {rounding.half_width(quantity, wide, like)}"
        if band is not None and name in band.metrics:
            found = band.metrics[name]
            about += f"; {rounding.rounded_range(quantity, found.low, found.high, like)} in 90 % of gears"
        vague = rounding.is_vague(value, result.errors.get(name))
        yield Row(rounding.rounded_metric(result, name, like), about, vague)


def loss_shares(result: Result) -> dict[str, float]:
    """Parts where work is lost -> share of all work lost, as far as it is not negligible."""
    shares = {part: result.summary.get(f"loss_share_{part}", 0.0) for part in PARTS}
    return {part: share for part, share in shares.items() if share >= LEAST_SHARE}


def _measured(result: Result, compared: "Sequence[AgainstMeasured] | None") -> Iterable[Row]:
    for each in compared or ():
        found, ours = each.measured.get("torque_mean"), each.simulated.get("torque_mean")
        if found is None or ours is None or result.measured is None:
            continue
        side, sign = "above" if abs(found) > abs(ours) else "below", "+" if each.direction > 0 else "−"
        apart = f": {100 * abs(found / ours - 1):.2g} % {side} the simulated one" if ours else ""
        about = f"measured mean towards {sign}X, {result.measured.name}{apart}"
        yield Row(rounding.rounded(SUMMARY["torque_mean"], found), about)


def _band(band: "Band | None", printed: Sequence[str]) -> Iterable[Row]:
    if band is None:
        return
    count, failed = len(band.drawn.samples), band.drawn.failed
    for name in printed:
        if (shares := band.contributions.get(name)) is not None:
            yield Row("scatter", f"of the {LABELS.get(name, name)}: {shown_effects(shares, 2)}")
    state = f", {failed} failed" * (failed > 0) + ", interrupted" * band.interrupted
    yield Row("band", f"{count} gears{state}; {band.method}")


def shown_effects(shares: "Contributions", most: int) -> str:
    """The inputs with the largest shares of a metric's variance, each with its effect in brackets."""
    named_shares = [each for each in shares.fractions.items() if each[1] >= LEAST_SHARE]
    largest = named_shares[:most]
    effects = [f" ({effect})" if (effect := shares.effect_of(group)) else "" for group, _ in largest]
    each = zip(largest, effects, strict=True)
    return ", ".join(f"{named(group)} {100 * share:.0f} %{effect}" for (group, share), effect in each)


# --- Every number of a result, as blocks and for JSON


def result_text(result: Result, compared: "Sequence[AgainstMeasured] | None" = None) -> Iterator[Block]:
    """Scene, fidelity, level and status, every summary value with its bar and definition, the comparison with
    a measured torque."""
    level = f" · level {result.findings['level']}" if "level" in result.findings else ""
    head = f"{result.scene} · fidelity {result.fidelity['name']}{level} · status {result.status}"
    yield Line(head, is_bold=True)
    if result.message:
        yield Text(result.message)
    summary = summary_grid(result)
    rows = list(summary.rows)
    for name in ("mesh_normal_force_drive", "mesh_normal_force_coast"):
        if name in result.signals and result[name].size:
            shown = SIGNALS[name].show(float(result[name].mean()))
            rows.append((f"mean of {name}", shown, SIGNALS[name].long_name))
    yield replace(summary, rows=rows)
    if error := error_of_law(result):
        yield Text(error.sentence)
    counts = {name: f"{value} {words(name)}" for name, value in result.counters.items()}
    if "solver_cpu" in counts:
        solver = COUNTERS["solver_cpu"].show(result.counters["solver_cpu"])
        counts["solver_cpu"] = f"{solver} of it in the solver"
    yield Text(", ".join([f"{result.cpu_s:.3g} s of CPU time", *counts.values()]))
    yield from measured_text(compared)


def summary_grid(result: Result) -> Grid:
    """Every summary value with its bar and definition."""
    rows = [(name, rounding.shown_metric(result, name), SUMMARY[name].long_name) for name in result.summary]
    values, errors = result.summary.items(), result.errors
    vague = [k for k, (name, each) in enumerate(values) if rounding.is_vague(each, errors.get(name))]
    return Grid(("quantity", "value", "definition"), rows, vague=vague)


def measured_text(compared: "Sequence[AgainstMeasured] | None") -> Iterator[Block]:
    """Metrics of the measured and the simulated torque, and how far the curves lie apart."""
    from rps_exudyn.analysis.measured import NOTHING_TO_COMPARE

    if compared is None:
        return
    yield Text("")
    if not compared:
        yield Text(NOTHING_TO_COMPARE)
    for each in compared:
        yield Grid(("quantity", "measured", "simulated"), each.rows, f"{each.heading}:")
        yield Text(each.difference)


DATA = (
    *("scene", "status", "message", "codes", "fidelity", "summary", "errors", "counters", "geometry"),
    *("cpu_s", "wall_s", "solver", "findings", "provenance"),
)


def result_as_dict(result: Result) -> dict[str, Any]:
    """A result without its signals, in SI units."""
    return {name: getattr(result, name) for name in DATA} | {"parameters": result.gear.model_dump()}


def measured_as_dict(compared: "Sequence[AgainstMeasured] | None") -> dict[str, Any]:
    """The comparisons with a measured torque, in SI units; {} if nothing was measured."""
    if compared is None:
        return {}
    rows = [
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
    return {"measured": rows}


def differences(pair: "SignalPair") -> dict[str, float]:
    """RMS and largest difference of two curves, and where it is."""
    return {"rms": pair.rms, "largest": pair.largest, "pinion_angle": pair.angle}


LINE = 66  # letters of a line of the terminal beside its heading


def listed(names: Sequence[str]) -> str:
    """Names in a line of the terminal; those without room as a number."""
    shown = list(names)
    while len(shown) > 1 and len(_joined(shown, len(names))) > LINE:
        shown.pop()
    return _joined(shown, len(names))


def _joined(shown: Sequence[str], count: int) -> str:
    more = f" and {count - len(shown)} more" if len(shown) < count else ""
    return ", ".join(shown) + more
