"""The sheet: what a run found, in a few rows; the terminal prints them, and a page begins with them.

sheet = sheet_of(result)
sheet.title, [(row.value, row.words) for row in sheet.rows]
"""

from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass
from math import isclose
from typing import TYPE_CHECKING

from rps_exudyn.parameters.derived import derived_values
from rps_exudyn.parameters.gear import BY_SCENE, SteeringGear
from rps_exudyn.parameters.names import named
from rps_exudyn.results.law_error import law_error
from rps_exudyn.results.outcome import Status, sentences
from rps_exudyn.results.quantities import LABELS, PARTS, SUMMARY
from rps_exudyn.results.result import Result
from rps_exudyn.results.rounding import half_width, is_vague, law_bar, rounded, rounded_metric, rounded_range
from rps_exudyn.scenes import is_scene, scene_named

if TYPE_CHECKING:
    from rps_exudyn.analysis.measured import AgainstMeasured
    from rps_exudyn.inference.uncertainty.band import Band

MANY_CHANGES = 3  # parameters that are not named
MOST_METRICS = 3  # of a scene
MOST_ROWS = 6  # with title and files a sheet has 8 lines
INDENT = 2  # blanks before a row
REPEATED = ("torque_on_centre",)  # the mean again, over fewer angles
REMARK, WORK_LOST = "remark", "work lost"
LEAST_SHARE = 0.005  # of the work lost, below which a part is not named


@dataclass(frozen=True)
class Row:
    """A row of a sheet: a value or a heading, words about it, and whether its error bar is wide."""

    value: str
    words: str
    is_vague: bool = False


@dataclass(frozen=True)
class Sheet:
    """What was simulated, and what was found."""

    title: str
    rows: tuple[Row, ...]

    @property
    def width(self) -> int:
        """Letters of the first column."""
        return max((len(row.value) for row in self.rows), default=0)

    def lines(self) -> list[str]:
        """The sheet as lines of text."""
        return [self.title, *(f"{'':{INDENT}}{row.value:{self.width}}  {row.words}" for row in self.rows)]


def sheet_of(
    result: Result, compared: "Sequence[AgainstMeasured] | None" = None, band: "Band | None" = None
) -> Sheet:
    """Return the sheet of a result.

    Args:
        result: what was simulated.
        compared: its comparison with a measured torque, where it has one.
        band: of uncertain inputs, of which `result` is the nominal run.
    """
    title = scene_named(result.scene).title if is_scene(result.scene) else result.scene
    gear, medians = result.gear.replace({"mesh.law": BY_SCENE}), band.inputs if band is not None else {}
    shown = gear_shown(gear, medians) + (f"; {len(medians)} inputs at their medians" if medians else "")
    law = law_error(result.gear, result.fidelity)
    model = f"{result.fidelity['name']}; law {law.law}" if law else result.fidelity["name"]
    state = "" if result.status is Status.OK else f" ({result.status})"
    first, last = (*_measured(result, compared), *_band(band)), tuple(_remark(result))
    losses = tuple(_losses(result)) if len(first) + len(last) + 1 < MOST_ROWS else ()
    rows = (*first, *losses, *last)
    metrics = tuple(_metrics(result, band))[: max(1, MOST_ROWS - len(rows))]
    return Sheet(f"{title}{state}: {shown}; {model}", (*metrics, *rows))


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


def _metrics(result: Result, band: "Band | None") -> Iterable[Row]:
    """The scene's own number and others that have a label, with their error bars; the error of the contact
    law beside them."""
    summary, first = result.summary, scene_named(result.scene).figure if is_scene(result.scene) else ""
    others = [name for name in LABELS if name not in (first, *REPEATED)]
    names = [name for name in (first, *others) if name in summary]
    names = names[:1] + [name for name in names[1:] if rounded(SUMMARY[name], summary[name])[:2] != "0 "]
    law, names = law_error(result.gear, result.fidelity), names[:MOST_METRICS]
    largest: dict[str, float] = {}  # unit -> number whose unit all others of it have
    for name in names:
        unit = SUMMARY[name].unit
        largest[unit] = max(abs(summary[name]), largest.get(unit, 0.0))
    for name in names:
        quantity, value, like = SUMMARY[name], summary[name], largest[SUMMARY[name].unit]
        words = LABELS.get(name, quantity.long_name)
        if law is not None and (wide := law_bar(result, name)):
            words += f"; contact law {law.law} {half_width(quantity, wide, like)}"
        if band is not None and name in band.figures:
            found = band.figures[name]
            words += f"; {rounded_range(quantity, found.low, found.high, like)} in 90 % of gears"
        yield Row(rounded_metric(result, name, like), words, is_vague(value, result.errors.get(name)))


def loss_shares(result: Result) -> dict[str, float]:
    """Parts where work is lost -> share of all work lost, as far as it is not negligible."""
    shares = {part: result.summary.get(f"loss_share_{part}", 0.0) for part in PARTS}
    return {part: share for part, share in shares.items() if share >= LEAST_SHARE}


def _losses(result: Result) -> Iterable[Row]:
    if shares := loss_shares(result):
        text = ", ".join(f"{PARTS[part]} {100 * share:.0f} %" for part, share in shares.items())
        yield Row(WORK_LOST, text)


def _measured(result: Result, compared: "Sequence[AgainstMeasured] | None") -> Iterable[Row]:
    for each in compared or ():
        found, ours = each.measured.get("torque_mean"), each.simulated.get("torque_mean")
        if found is None or ours is None or result.measured is None:
            continue
        side, sign = "above" if abs(found) > abs(ours) else "below", "+" if each.direction > 0 else "−"
        apart = f": {100 * abs(found / ours - 1):.2g} % {side} the simulated one" if ours else ""
        words = f"measured mean towards {sign}X, {result.measured.name}{apart}"
        yield Row(rounded(SUMMARY["torque_mean"], found), words)


def _band(band: "Band | None") -> Iterable[Row]:
    if band is None:
        return
    count, failed = len(band.drawn.samples), band.drawn.failed
    name = scene_named(band.nominal.scene).figure
    if (shares := band.contributions.get(name)) is not None:
        largest = [f"{named(path)} {100 * share:.0f} %" for path, share in list(shares.fractions.items())[:2]]
        yield Row("scatter", f"of the {LABELS.get(name, name)}: {', '.join(largest)}")
    state = f", {failed} failed" * (failed > 0) + ", interrupted" * band.interrupted
    yield Row("band", f"{count} gears{state}; {band.method}")


def _remark(result: Result) -> Iterable[Row]:
    """The first remark as a whole, and how many there are beside it."""
    if result.message:
        first, *others = sentences(result.message)
        yield Row(REMARK, first + f"; and {len(others)} more: --all" * bool(others))


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
