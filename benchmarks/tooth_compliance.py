"""What one tooth of the rack yields: the law "teeth" against finite elements and against the closed form.

Loads press on patches of one flank (`rack_tooth_elements`); the law's yield is averaged over the same
patches (`rack_tooth_law`), and what elements give for an even load is freed of the flattening that the law
counts apart.
"""

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.optimize import brentq

from benchmarks.topic import Topic, markdown
from rps_exudyn.base.files import replacing
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.gear import SteeringGear
from verification.rack_tooth_elements import ROWS, Compliance, Section, rack_compliance
from verification.rack_tooth_law import PER_MM, even_load, flattening, law_compliance, plane_strain

DATA, CHART, SUPPORT = "rack_tooth.csv", "rack_tooth.png", "support.csv"
REFINEMENTS = (1, 2, 3)
NANO = 1e9
COLUMNS = (
    "load",  # even: on all patches of one height; middle, end: on the patch there
    "flank",  # same, opposite, or next: same side of the next tooth
    "height_mm",  # of load and yield above the reference line
    "place_mm",  # of the yield
    *(f"refined_{k}" for k in REFINEMENTS),  # nm/(N/mm) under an even load without flattening, else nm/N
    "extrapolated",
    "order",
    "law",
)
Row = dict[str, str | float]
SUPPORTS: dict[str, dict[str, float]] = {
    "three teeth, clamped 3 modules below the root": {},
    "clamped 2 modules below": {"depth": 2.0},
    "clamped 4 modules below": {"depth": 4.0},
    "five teeth": {"beside": 2},
    "seven teeth": {"beside": 3},
}
"""Model -> what differs in its section; the coarsest elements."""


def run(
    folder: Path, patches: int = 12, block_rows: int = 3, models: Sequence[str] = tuple(SUPPORTS)
) -> None:
    """Compare the default gear's rack tooth, with so many patches along it and cells below its root."""
    pair = GearPair.of(SteeringGear())
    section = Section(pair, block_rows=block_rows)
    found = [rack_compliance(section, patches, refinement) for refinement in REFINEMENTS]
    write(folder / DATA, COLUMNS, compared(section, patches, found))
    head = ("model", "height_mm", "even_same", "even_opposite", "even_next")
    write(folder / SUPPORT, head, supports(pair, patches, models))
    draw(read(folder), pair, folder / CHART)


def write(path: Path, head: Sequence[str], rows: Iterator[Sequence[str | float]]) -> None:
    """Write a file of comma-separated values, numbers with six digits."""
    cells = [[each if isinstance(each, str) else f"{each:.6g}" for each in row] for row in rows]
    with replacing(path) as partial, partial.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *cells])


# --- what is compared ----------------------------------------------------------------------------------
def compared(section: Section, patches: int, found: list[Compliance]) -> Iterator[Sequence[str | float]]:
    """Yield under an even load on each height, and under a patch in the middle and at the end of each."""
    same, opposite = law_compliance(section, patches)
    of_law = {"same": same, "opposite": opposite, "next": 0 * same}
    for row in range(ROWS):
        height, strip = float(section.row_height(row + 0.5)), slice(row * patches, (row + 1) * patches)
        places = 1e3 * section.half_length(height) * ((np.arange(patches) + 0.5) / patches * 2 - 1)
        for flank, expected in of_law.items():
            parts = [getattr(each, flank) for each in found]
            local = PER_MM * flattening(section, height) if flank == "same" else 0.0
            yields = [PER_MM * even_load(section, patches, part, row) - local for part in parts]
            there = PER_MM * even_load(section, patches, expected, row)
            yield from _rows("even", flank, 1e3 * height, places, yields, there)
            for load, patch in {"middle": patches // 2, "end": 0}.items():
                yields = [NANO * part[strip, strip][patch] for part in parts]
                there = NANO * expected[strip, strip][patch]
                yield from _rows(load, flank, 1e3 * height, places, yields, there)


def _rows(
    load: str,
    flank: str,
    height: float,
    places: np.ndarray,
    yields: list[np.ndarray],
    law: np.ndarray,
) -> Iterator[Sequence[str | float]]:
    """One row of the file for each place along the tooth."""
    for i, place in enumerate(places):
        values = [float(each[i]) for each in yields]
        limit, order = extrapolated(values)
        yield load, flank, height, place, *values, limit, order, float(law[i])


def extrapolated(values: list[float]) -> tuple[float, float]:
    """Return the limit of values v + c k^-p at k = 1, 2, 3, and p; the finest and nan where they have none.

    Richardson's extrapolation, with the order p between 1/2 and 8 that the three values show.
    """
    coarse, fine = values[0] - values[1], values[1] - values[2]

    def excess(p: float) -> float:
        return coarse * (2**-p - 3**-p) - fine * (1 - 2**-p)

    if not excess(0.5) * excess(8) < 0:
        return values[2], float("nan")
    p = float(brentq(excess, 0.5, 8))
    return values[2] - fine * 3**-p / (2**-p - 3**-p), p


# --- tables and chart ----------------------------------------------------------------------------------
def read(folder: Path) -> list[Row]:
    """Return the rows of the file."""
    words = ("load", "flank")
    return [
        {name: text if name in words else float(text) for name, text in row.items()}
        for row in _table(folder / DATA)
    ]


def _table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def chosen(rows: list[Row], load: str, flank: str) -> list[list[Row]]:
    """Return the rows of one load on one flank, by height from the fillet up, then by place."""
    found = [row for row in rows if (row["load"], row["flank"]) == (load, flank)]
    return [list(found[i : i + len(found) // ROWS]) for i in range(0, len(found), len(found) // ROWS)]


def convergence_table(folder: Path) -> str:
    """A sentence on what refinement changes."""
    rows = read(folder)
    even, other = chosen(rows, "even", "same"), chosen(rows, "even", "opposite")
    middle, across = chosen(rows, "middle", "same"), chosen(rows, "middle", "opposite")
    at = len(even[0]) // 2
    quantities = {
        "even load near the tip, middle of the tooth, nm/(N/mm)": even[-1][at],
        "even load near the tip, end of the tooth": even[-1][0],
        "even load at half height, middle": even[ROWS // 2][at],
        "even load near the fillet, middle": even[0][at],
        "even load near the tip, opposite flank": other[-1][at],
        "patch near the tip, under itself, nm/N": middle[-1][at],
        "two patches further": middle[-1][at - 2],
        "patch near the tip, opposite flank": across[-1][at],
    }
    orders = [float(row["order"]) for row in quantities.values()]
    finest = [
        abs(percent(row[f"refined_{REFINEMENTS[-1]}"], row["extrapolated"])) for row in quantities.values()
    ]
    return (
        f"In {len(quantities)} yields the finest mesh is within {max(finest):.1f} % of its extrapolation; "
        f"orders are "
        f"{min(orders):.1f} to {max(orders):.1f}."
    )


def even_table(folder: Path) -> str:
    """Yield under an even load: finite elements, closed form, law."""
    rows, section = read(folder), Section(GearPair.of(SteeringGear()))
    table = []
    pairs = zip(chosen(rows, "even", "same"), chosen(rows, "even", "opposite"), strict=True)
    for same, opposite in reversed(list(pairs)):
        middle, end, height = same[len(same) // 2], same[0], float(same[0]["height_mm"])
        closed = PER_MM * plane_strain(section, 1e-3 * height)
        coupled = float(opposite[len(same) // 2]["extrapolated"]) / float(middle["extrapolated"])
        table.append(
            (
                f"{height:+.2f}",
                f"{float(middle['extrapolated']):.1f}",
                f"{closed:.1f}",
                f"{float(middle['law']):.1f}",
                f"{percent(middle['law'], middle['extrapolated']):+.0f}",
                f"{percent(end['extrapolated'], middle['extrapolated']):+.0f}",
                f"{percent(end['law'], middle['law']):+.0f}",
                f"{-coupled:.2f}",
            )
        )
    head = (
        "height mm",
        "finite elements",
        "closed form, plane strain",
        "law",
        "law, difference %",
        "at the end of the tooth %",
        "the law there %",
        "opposite flank over same",
    )
    return markdown(head, table)


def supports(pair: GearPair, patches: int, models: Sequence[str]) -> Iterator[Sequence[str | float]]:
    """Yield in the middle of the tooth under an even load at each height, nm/(N/mm)."""
    for name in models:
        section = Section(pair, **SUPPORTS[name])  # type: ignore[arg-type]
        found = rack_compliance(section, patches, 1)
        for row in range(ROWS):
            height = float(section.row_height(row + 0.5))
            yields = [even_load(section, patches, each, row)[patches // 2] for each in found[:3]]
            yields[0] -= flattening(section, height)
            yield name, 1e3 * height, *(PER_MM * each for each in yields)


def support_table(folder: Path) -> str:
    """Difference from the first model, and the share of the next tooth, per height from the tip."""
    rows = _table(folder / SUPPORT)
    names = dict.fromkeys(row["model"] for row in rows)
    groups = {name: [row for row in rows if row["model"] == name][::-1] for name in names}
    first = next(iter(groups.values()))
    table = []
    for name, group in groups.items():
        pairs = list(zip(group, first, strict=True))
        change = [f"{100 * (float(a['even_same']) / float(b['even_same']) - 1):+.0f}" for a, b in pairs]
        table.append((name, *change))
    heights = [f"change at {float(row['height_mm']):+.2f} mm %" for row in first]
    return markdown(("model", *heights), table)


def percent(value: str | float, of: str | float) -> float:
    """Difference from another value in % of that."""
    return 100 * (float(value) / float(of) - 1)


def draw(rows: list[Row], pair: GearPair, path: Path) -> None:
    """Draw the yields along the tooth: under an even load at each height, and under one patch."""
    section = Section(pair)
    with mpl.rc_context({"font.size": 9.5}):
        figure = Figure(figsize=(8.5, 8.0), layout="constrained")
        even, patch = figure.subplots(2, 1)
    for colour, row in zip(style.SEVERAL, chosen(rows, "even", "same"), strict=False):
        height = float(row[0]["height_mm"])
        curves(even, row, colour, f"{height:+.2f} mm")
        closed = PER_MM * plane_strain(section, 1e-3 * height)
        even.axhline(closed, color=colour, linewidth=0.8, linestyle=":")
    kinds = {
        ("middle", "same"): "load in the middle, same flank",
        ("middle", "opposite"): "load in the middle, opposite flank",
        ("end", "same"): "load at the end, same flank",
    }
    for colour, (kind, name) in zip(style.SEVERAL, kinds.items(), strict=False):
        curves(patch, chosen(rows, *kind)[-1], colour, name)
    name_axes(even, "Even load, at three heights above the reference line; flattening apart", "nm/(N/mm)")
    name_axes(
        patch,
        "Load on one patch near the tip (marks there: with flattening)",
        "nm/N",
    )
    style.title(figure, "Rack tooth: finite elements (marks), law (lines), plane strain (dotted)")
    style.save(figure, path)


def curves(axes: Axes, row: list[Row], colour: str, name: str) -> None:
    """Draw marks of finite elements and the law's line."""
    place, law, limits = ([float(each[key]) for each in row] for key in ("place_mm", "law", "extrapolated"))
    axes.plot(place, law, color=colour, linewidth=1.2)
    axes.plot(place, limits, "o", color=colour, markersize=4, label=name)


def name_axes(axes: Axes, title: str, unit: str) -> None:
    """Say what is drawn over the place along the tooth."""
    axes.set_title(title, loc="left", fontsize=10)
    axes.set_xlabel("place along the tooth [mm]")
    axes.set_ylabel(f"yield [{unit}]")
    axes.set_ylim(bottom=min(0, axes.get_ylim()[0]))
    axes.grid(color="#e4e4e4")
    axes.legend(loc="upper left", bbox_to_anchor=(1, 1), frameon=False)


TOPIC = Topic(
    "the yield of one rack tooth: the law of elastic teeth against finite elements, and their convergence",
    "2 min",
    "tooth_compliance",
    run,
    {"patches": 2, "block_rows": 1, "models": tuple(SUPPORTS)[:1]},
    {
        "rack_tooth_convergence": convergence_table,
        "rack_tooth_even_load": even_table,
        "rack_tooth_support": support_table,
    },
)
