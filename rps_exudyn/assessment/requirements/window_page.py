"""The sheet of a window: its ends, what limits them, the shares over the parameter."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from rps_exudyn.assessment.requirements.window import End, Window, window
from rps_exudyn.inference.uncertainty.band import OnProgress
from rps_exudyn.pages.charts import style
from rps_exudyn.pages.report.html import make_again
from rps_exudyn.pages.report.pictures import at_widths
from rps_exudyn.pages.report.result_sheet import gear_shown
from rps_exudyn.parameters.display_names import named
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.limit import Limit
from rps_exudyn.results.page_blocks import Fold, Pictures
from rps_exudyn.results.provenance import provenance
from rps_exudyn.results.quantities import Quantity
from rps_exudyn.results.requirements import label_of, quantity_of
from rps_exudyn.results.rounding import half_width, interval, rounded
from rps_exudyn.results.sheet import Block, Grid, Row, Section, Sheet, Text

ROWS, ROWS_OF_MAP = 21, 7  # places of the table
MOST_CURVES = 5  # limits that are drawn


def window_page(found: Window, gear: SteeringGear, inputs: str, command: str) -> Sheet:
    """Return the sheet of a window of the gear, by the inputs of that name; `command` makes it again."""
    names = " and ".join(named(path) for path in found.paths)
    caption = f"Share of the gears that keep the limits over the {names}"
    pictures = Pictures(at_widths(partial(window_figure, found), caption))
    table = list(_text(found))
    details = [Fold("Shares", table), make_again(provenance(), command)]
    return Sheet(
        title=f"Window of the {names}",
        lead=f"{gear_shown(gear)} · {found.samples} gears at each of {found.computed} values · {inputs}",
        rows=list(_rows(found)),
        text=table,
        more="shares over the parameter",
        data=lambda: as_dict(found),
        sections=[Section("Shares", [pictures]), Section("Details", details)],
        gear=gear,
    )


def _quantity(path: str) -> Quantity:
    item = SteeringGear.declared_at(path)[0]
    assert item.unit is not None
    return Quantity(item.unit.si, item.unit.display, item.meaning)


def _rows(found: Window) -> Iterator[Row]:
    wanted = f"{100 * found.share:g} %"
    best = " and ".join(f"{named(path)} {_shown(found, path, value)}" for path, value in found.best.items())
    if found.ends:
        low, high = (_shown(found, found.paths[0], end.value) for end in found.ends)
        yield Row(interval(low, high), f"{wanted} of the gears keep the limits")
        for word, end in zip(("low end", "high end"), found.ends, strict=True):
            yield Row(word, _limited(end, found))
    elif found.best_share >= found.share:
        yield Row(wanted, "of the gears keep the limits in the marked part of the map")
    else:
        yield Row("none", f"no value at which {wanted} of the gears keep the limits")
        missed = ", ".join(_limit(name, found.limits[name]) for name in found.forbidden_by)
        yield Row("forbidden", f"by {missed}")
    where = "in the middle" if found.ends else "best" if found.best_share >= found.share else "nearest"
    yield Row(where, f"{best}: kept by {100 * found.best_share:.1f} % of the gears")


def _shown(found: Window, path: str, value: float) -> str:
    """Return a value of a parameter, as finely as the window, or else the places, lie apart."""
    places = found.places[found.paths.index(path)]
    width = found.ends[1].value - found.ends[0].value if found.ends else np.ptp(places)
    quantity = _quantity(path)
    text, _, unit = rounded(quantity, value, width / 50 or None, like=value or places[-1]).partition(" ± ")
    return f"{text} {unit.partition(' ')[2]}".strip() if unit else text


def _limit(name: str, limit: Limit) -> str:
    return f"{label_of(name)[0]}, {limit.show(quantity_of(name))}"


def _limited(end: End, found: Window) -> str:
    if not end.limits:
        return f"no gear beyond: {end.cause}" if end.cause else "the search ended here, no limit does"
    quantity = _quantity(found.paths[0])
    limited = "; ".join(_limit(name, limit) for name, limit in end.limits.items())
    if not end.error:
        return limited
    errors = [half_width(quantity, each, end.value) for each in (end.error, end.sampling, end.numerical)]
    return f"{errors[0]}: {limited} ({errors[1]} by the number of gears, {errors[2]} numerical)"


def _text(found: Window) -> Iterator[Block]:
    first = partial(_shown, found, found.paths[0])
    if len(found.paths) == 1:
        places = found.places[0].tolist()
        shares = found.shares, *found.each.values()
        cells = [
            [first(places[i]), *(f"{100 * each[i]:.1f} %" for each in shares)] for i in _some(places, ROWS)
        ]
        yield Grid((found.paths[0], "all limits", *found.each), cells, "Share of the gears that keep a limit")
    else:
        rows, columns = (_some(each) for each in found.places)
        head = [_shown(found, found.paths[1], float(found.places[1][j])) for j in columns]
        cells = [
            [first(float(found.places[0][i])), *(f"{100 * found.shares[i, j]:.1f} %" for j in columns)]
            for i in rows
        ]
        title = f"Share of the gears that keep the limits, by {named(found.paths[1])}"
        yield Grid((named(found.paths[0]), *head), cells, title)
    for row in _rows(found):
        yield Text(f"{row.value}: {row.words}.")


def _some(places: Sequence[float] | np.ndarray, count: int = ROWS_OF_MAP) -> list[int]:
    """Return numbers of places spread evenly."""
    return [int(each) for each in np.linspace(0, len(places) - 1, count).round()]


def as_dict(found: Window) -> dict[str, Any]:
    """Return a window for JSON, SI."""
    return {
        "parameters": list(found.paths),
        "share": found.share,
        "ends": [
            {"value": end.value, "error": end.error, "sampling": end.sampling, "numerical": end.numerical}
            | {"limited_by": list(end.limited_by), "cause": end.cause}
            for end in found.ends
        ],
        "best": dict(found.best),
        "best_share": found.best_share,
        "forbidden_by": [] if found.best_share >= found.share else list(found.forbidden_by),
        "places": [each.tolist() for each in found.places],
        "shares": found.shares.tolist(),
        "each": {name: each.tolist() for name, each in found.each.items()},
        "samples": found.samples,
    }


def window_figure(found: Window, width: float = 8.0) -> Figure:
    """The share over the parameter with the window, or the map over two with the line of the share."""
    figure, (axes,) = style.panels([3.6], width)
    quantities = [_quantity(path) for path in found.paths]
    places = [each.displayed(values) for each, values in zip(quantities, found.places, strict=True)]
    labels = [each.axis_label(named(path)) for each, path in zip(quantities, found.paths, strict=True)]
    axes.set_xlabel(labels[0])
    if len(places) == 2:
        shades = axes.contourf(*places, 100 * found.shares.T, levels=np.linspace(0, 100, 21), cmap="cividis")
        if found.best_share > found.share > found.shares.min():
            line = axes.contour(*places, 100 * found.shares.T, levels=[100 * found.share], colors="white")
            axes.clabel(line, fmt="%g %%")
        figure.colorbar(shades, ax=axes, label="gears that keep the limits [%]")
        axes.set_ylabel(labels[1])
        return figure
    if found.ends:
        low, high = (quantities[0].displayed(end.value) for end in found.ends)
        axes.axvspan(low, high, label=f"{100 * found.share:g} % and more", **style.BAND)
    axes.axhline(100 * found.share, **style.REFERENCE_LINE)
    colours = [style.COLOURS[name] for name in ("lift", "failure", "other", "reference")]
    for (name, each), colour in zip(list(found.each.items())[:MOST_CURVES], colours, strict=False):
        axes.plot(places[0], 100 * each, color=colour, linewidth=1.2, label=label_of(name)[0])
    axes.plot(places[0], 100 * found.shares, color=style.COLOURS["torque"], label="all limits")
    axes.set_ylabel("gears that keep the limits [%]")
    axes.set_ylim(0, 105)
    style.name_curves(axes)
    return figure


def window_sheet(gear: SteeringGear, path: str, limits: Mapping[str, Any], on_progress: OnProgress) -> Sheet:
    """Find the window of a parameter for a series about the gear, and return its sheet."""
    found = window(gear, path, limits, inputs="series", on_progress=on_progress)
    return window_page(found, gear, "series", "rps-exudyn explore")
