"""What one tooth of the rack yields: the law "teeth" against finite elements and against the closed form.

Loads press on patches of one flank (`rack_tooth_elements`); the law's yield is averaged over the same patches. An
*even load* presses on all patches of one height: what the finite elements give for it contains the flattening near
the load, which the law counts apart, so that the flattening of a half-plane under that strip, down to the middle
of the tooth, is taken off.

    flattening = K f' [(1 - 2 nu) / (1 - nu) h / (2 a) atan(a / h) + ln(1 + h^2 / a^2) / 2 - ln 2 + 1 / 2]

is the mean over a strip of half width a under f' per length relative to the depth h, K = 2 (1 - nu^2) / (pi E); it
follows from the stresses below an evenly pressed strip in plane strain (Timoshenko and Goodier, section 37).

In plane strain an even load has a closed form (Weber and Banaschek 1953), for a load whose direction meets the
middle of the tooth y above the root's section, where the tooth is d(x) thick at x above it:

    cos^2 alpha (1 - nu^2) / E [12 I(0..y, (y - x)^2 / d^3) + (2.4 / (1 - nu) + tan^2 alpha) I(0..y, 1 / d)] + kappa

with I the integral over x and kappa of `tooth_compliance`.
"""

import csv
from collections.abc import Iterator
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.optimize import brentq

from benchmarks.rack_tooth_elements import ROWS, Compliance, Section, rack_compliance
from benchmarks.topic import Topic, markdown
from rps_exudyn.base.atomic import replacing
from rps_exudyn.charts import style
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.mesh_contact.tooth_compliance import (
    FOUNDATION,
    FOUNDATION_ANGLE,
    PLACE_SIZE,
    POISSON_RATIO,
    YOUNGS_MODULUS,
    ToothData,
    add_block,
    fill_place,
    rack_tooth,
)
from rps_exudyn.parameters.gear import SteeringGear

DATA, CHART = "rack_tooth.csv", "rack_tooth.png"
REFINEMENTS = (1, 2, 3)
ACROSS, ALONG = 4, 6  # points of the law in a patch
NANO = 1e9
PER_MM = 1e12  # from m/(N/m) to nm/(N/mm)
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


def run(folder: Path, patches: int = 12, block_rows: int = 3) -> None:
    """Compare the default gear's rack tooth with that many patches along it, and cells below its root."""
    pair = GearPair.of(SteeringGear())
    section = Section(pair, block_rows=block_rows)
    found = [rack_compliance(section, patches, refinement) for refinement in REFINEMENTS]
    rows = list(compared(section, patches, found))
    with replacing(folder / DATA) as partial, partial.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows({name: shown(value) for name, value in row.items()} for row in rows)
    draw(read(folder), pair, folder / CHART)


def shown(value: str | float) -> str:
    """A value in the file."""
    return value if isinstance(value, str) else f"{value:.6g}"


# --- what is compared ----------------------------------------------------------------------------------
def compared(section: Section, patches: int, found: list[Compliance]) -> Iterator[Row]:
    """Yield under an even load on each height, and under a patch in the middle and at the end of each."""
    tooth = rack_tooth(section.pair)
    law = law_compliance(section, patches, tooth)
    of_law = {"same": law, "opposite": -tooth.coupling * law, "next": 0 * law}
    for row in range(ROWS):
        height, strip = section.row_height(row + 0.5), slice(row * patches, (row + 1) * patches)
        half = section.half_length(height)
        places = 1e3 * half * ((np.arange(patches) + 0.5) / patches * 2 - 1)
        for flank, expected in of_law.items():
            parts = [getattr(each, flank)[strip, strip] for each in found]
            local = PER_MM * flattening(section, height) if flank == "same" else 0.0
            even = PER_MM * 2 * half / patches
            yields = [even * part.sum(axis=0) - local for part in parts]
            there = even * expected[strip, strip].sum(axis=0)
            yield from _rows("even", flank, 1e3 * height, places, yields, there)
            for load, patch in {"middle": patches // 2, "end": 0}.items():
                yields = [NANO * part[patch] for part in parts]
                there = NANO * expected[strip, strip][patch]
                yield from _rows(load, flank, 1e3 * height, places, yields, there)


def _rows(
    load: str,
    flank: str,
    height: float,
    places: np.ndarray,
    yields: list[np.ndarray],
    law: np.ndarray,
) -> Iterator[Row]:
    """One row of the file for each place along the tooth."""
    for i, place in enumerate(places):
        values = [float(each[i]) for each in yields]
        limit, order = extrapolated(values)
        cells = (load, flank, height, place, *values, limit, order, float(law[i]))
        yield dict(zip(COLUMNS, cells, strict=True))


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


def law_compliance(section: Section, patches: int, tooth: ToothData) -> np.ndarray:
    """Return the law's compliance between the patches of one flank, without flattening [m/N]."""
    pair, tan = section.pair, np.tan(section.pair.alpha_n)
    rows = (np.arange(ROWS * ACROSS) + 0.5) / ACROSS
    along = (np.arange(patches * ALONG) + 0.5) / (patches * ALONG) * 2 - 1
    height, zeta = (each.ravel() for each in np.meshgrid(section.row_height(rows), along, indexing="ij"))
    lever = height - half_thickness(pair, height) * tan + tooth.root
    half = section.half_length(height)
    cos, sin = np.cos(pair.alpha_n), np.sin(pair.alpha_n)
    places = np.empty((PLACE_SIZE, height.size))
    for i in range(height.size):
        fill_place(places, i, cos, cos * lever[i], sin, zeta[i] * half[i], half[i], tooth)
    matrix = np.zeros((height.size,) * 2)
    add_block(matrix, places, 0, 0, height.size, 1.0, tooth)
    shape = (ROWS, ACROSS, patches, ALONG)
    return matrix.reshape(shape + shape).mean(axis=(1, 3, 5, 7)).reshape((ROWS * patches,) * 2)


def half_thickness(pair: GearPair, height: float | np.ndarray) -> float | np.ndarray:
    """Half the tooth's thickness at a height of its plane flanks [m]."""
    return np.pi * pair.module / 4 - height * np.tan(pair.alpha_n)


def flattening(section: Section, height: float) -> float:
    """Return the mean yield of an evenly pressed strip of the flank relative to the tooth's middle [m/(N/m)]."""
    pair, nu = section.pair, POISSON_RATIO
    width = (section.row_height(1) - section.row_height(0)) / np.cos(pair.alpha_n)
    depth = half_thickness(pair, height) / np.cos(pair.alpha_n) / (width / 2)  # over the half width
    hertz = 2 * (1 - nu**2) / (np.pi * YOUNGS_MODULUS)
    straight = (1 - 2 * nu) / (1 - nu) * depth * np.arctan(1 / depth) / 2
    return float(hertz * (straight + np.log1p(depth**2) / 2 - np.log(2) + 0.5))


def plane_strain(section: Section, height: float) -> float:
    """Return the closed form for an even load on a long tooth, without flattening [m/(N/m)]."""
    pair, tooth, nu = section.pair, rack_tooth(section.pair), POISSON_RATIO
    tan = np.tan(pair.alpha_n)
    lever = height - half_thickness(pair, height) * tan + tooth.root
    nodes, weights = np.polynomial.legendre.leggauss(40)
    x = lever * (nodes + 1) / 2
    thickness = 2 * section.half_width(x - tooth.root)
    bending, shear = (lever / 2 * weights @ each for each in ((lever - x) ** 2 / thickness**3, 1 / thickness))
    kappa = tooth.bending * lever**2 + 2 * tooth.shear * lever + FOUNDATION * (1 + FOUNDATION_ANGLE * tan**2)
    beam = 12 * bending + (2.4 / (1 - nu) + tan**2) * shear
    return float(np.cos(pair.alpha_n) ** 2 * (1 - nu**2) / YOUNGS_MODULUS * (beam + kappa))


# --- tables and chart ----------------------------------------------------------------------------------
def read(folder: Path) -> list[Row]:
    """Return the rows of the file."""
    with (folder / DATA).open(newline="", encoding="utf-8") as file:
        words = ("load", "flank")
        return [
            {name: text if name in words else float(text) for name, text in row.items()}
            for row in csv.DictReader(file)
        ]


def chosen(rows: list[Row], load: str, flank: str) -> list[list[Row]]:
    """Return the rows of one load on one flank, by height from the fillet up, then by place along the tooth."""
    found = [row for row in rows if (row["load"], row["flank"]) == (load, flank)]
    return [list(found[i : i + len(found) // ROWS]) for i in range(0, len(found), len(found) // ROWS)]


def convergence_table(folder: Path) -> str:
    """What refinement changes."""
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
    table = [
        (
            name,
            *(f"{float(row[f'refined_{k}']):.4g}" for k in REFINEMENTS),
            f"{float(row['extrapolated']):.4g}",
            f"{float(row['order']):.1f}",
            f"{percent(row[f'refined_{REFINEMENTS[-1]}'], row['extrapolated']):+.1f}",
        )
        for name, row in quantities.items()
    ]
    cells = [f"cells divided by {k}" for k in REFINEMENTS]
    return markdown(("yield", *cells, "extrapolated", "order", "finest, error %"), table)


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


def spread_table(folder: Path) -> str:
    """How the yield falls along the tooth on both flanks: over its value on the next patch."""
    table = []
    for flank in ("same", "opposite"):
        for row in reversed(chosen(read(folder), "middle", flank)):
            at = len(row) // 2
            for name in ("extrapolated", "law"):
                shares = [float(each[name]) / float(row[at - 1][name]) for each in row[: at - 1][::-1]]
                who = "law" if name == "law" else "finite elements"
                height = float(row[0]["height_mm"])
                table.append((flank, f"{height:+.2f}", who, *(f"{share:.2f}" for share in shares)))
    distances = range(2, len(table[0]) - 1)
    return markdown(("flank", "height mm", "", *(f"{each} patches away" for each in distances)), table)


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
            curves(even, row, colour, f"{height:+.2f} mm", 0)
            even.axhline(PER_MM * plane_strain(section, 1e-3 * height), color=colour, linewidth=0.8, linestyle=":")
        kinds = [("middle", "same"), ("middle", "opposite"), ("end", "same")]
        for colour, (load, flank) in zip(style.SEVERAL, kinds, strict=False):
            row, name = chosen(rows, load, flank)[-1], f"{load} of the tooth, {flank} flank"
            curves(patch, row, colour, name, {"middle": len(row) // 2, "end": 0}[load] if flank == "same" else None)
        even.set_ylabel("yield, flattening apart [nm/(N/mm)]")
        even.set_title("Even load along the tooth, at three heights above the reference line", loc="left", fontsize=10)
        patch.set_ylabel("yield [nm/N]")
        patch.set_title("Load on one patch near the tip", loc="left", fontsize=10)
        for axes in (even, patch):
            axes.set_xlabel("place along the tooth [mm]")
            axes.set_ylim(bottom=min(0, axes.get_ylim()[0]))
            axes.grid(color="#e4e4e4")
            axes.legend(loc="upper left", bbox_to_anchor=(1, 1), frameon=False)
        style.title(figure, "Rack tooth: finite elements (marks), law (lines), plane strain in closed form (dots)")
    style.save(figure, path)


def curves(axes: Axes, row: list[Row], colour: str, name: str, loaded: int | None) -> None:
    """Draw marks of finite elements and the law's line."""
    place = [float(each["place_mm"]) for each in row]
    axes.plot(place, [float(each["law"]) for each in row], color=colour, linewidth=1.2)
    axes.plot(place, [float(each["extrapolated"]) for each in row], "o", color=colour, markersize=4, label=name)


TOPIC = Topic(
    "the yield of one rack tooth: the law of elastic teeth against finite elements, and their convergence",
    "2 min",
    "tooth_compliance",
    run,
    {"patches": 2, "block_rows": 1},
    {
        "rack_tooth_convergence": convergence_table,
        "rack_tooth_even_load": even_table,
        "rack_tooth_spread": spread_table,
    },
)
