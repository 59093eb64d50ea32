"""What else one tooth of the rack tells: how its support moves its yields, and which constants suit it."""

import csv
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

from benchmarks.rack_tooth_elements import ROWS, Compliance, Section, rack_compliance
from benchmarks.rack_tooth_law import PER_MM, bending_compliance, even_load, flattening, law_compliance
from benchmarks.topic import markdown
from rps_exudyn.base.files import replacing
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.tooth_contact.tooth_compliance import RACK, Spread, rack_tooth, tooth_data

SUPPORT, CONSTANTS = "support.csv", "constants.csv"
SUPPORTS: dict[str, dict[str, float]] = {
    "three teeth, clamped 3 modules below the root": {},
    "clamped 2 modules below": {"depth": 2.0},
    "clamped 4 modules below": {"depth": 4.0},
    "five teeth": {"beside": 2},
    "seven teeth": {"beside": 3},
}
"""Model -> what differs in its section; the coarsest elements."""
FITS = {"near the tip": (2,), "upper two heights": (1, 2), "all heights": (0, 1, 2)}
"""Name -> rows of patches that constants are fitted to."""
Form = Callable[[Section, int, np.record], np.ndarray]
FORMS: dict[str, Form] = {
    "fitted": law_compliance,
    "fitted, with bending and shear of the tooth": bending_compliance,
}
APART = 2  # patches between load and yield on one flank, from which on the flattening is out
SHARE = 0.3  # of single patches in a fit, of which there are many, beside the even loads


def write(path: Path, head: Sequence[str], rows: Iterator[Sequence[str | float]]) -> None:
    """Write a file of comma-separated values, numbers with five digits."""
    cells = [[each if isinstance(each, str) else f"{each:.5g}" for each in row] for row in rows]
    with replacing(path) as partial, partial.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *cells])


def vary(
    folder: Path,
    section: Section,
    patches: int,
    finest: Compliance,
    models: Sequence[str],
    fits: Sequence[str],
) -> None:
    """Write both files, of these models and fits."""
    head = ("model", "height_mm", "even_same", "even_opposite", "even_next")
    write(folder / SUPPORT, head, supports(section.pair, patches, models))
    names = (
        "constants",
        "heights",
        "strength",
        "length",
        "ends",
        "coupling",
        "even_same_rms",
        "even_opposite_rms",
    )
    write(folder / CONSTANTS, names, constants(section, patches, finest, fits))


# --- support -------------------------------------------------------------------------------------------
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
    rows = _read(folder / SUPPORT)
    names = dict.fromkeys(row["model"] for row in rows)
    groups = {name: [row for row in rows if row["model"] == name][::-1] for name in names}
    first = next(iter(groups.values()))
    table = []
    for name, group in groups.items():
        pairs = list(zip(group, first, strict=True))
        change = [f"{100 * (float(a['even_same']) / float(b['even_same']) - 1):+.0f}" for a, b in pairs]
        beside = [f"{100 * float(a['even_next']) / float(a['even_same']):.0f}" for a in group]
        table.append((name, *change, *beside))
    heights = [f"{float(row['height_mm']):+.2f} mm" for row in first]
    changes, shares = ([f"{what} at {each} %" for each in heights] for what in ("change", "next tooth"))
    return markdown(("model", *changes, *shares), table)


# --- constants -----------------------------------------------------------------------------------------
def constants(
    section: Section, patches: int, found: Compliance, fits: Sequence[str]
) -> Iterator[Sequence[str | float]]:
    """The law's constants and those that suit the tooth best, with the RMS differences of even loads, %."""
    for name in fits:
        tries: dict[str, tuple[Form, np.ndarray]] = {"of the law": (law_compliance, np.array(RACK))}
        for kind, law in FORMS.items():
            fit = least_squares(
                lambda x, r=FITS[name], f=law: np.concatenate(misfits(x, section, patches, found, r, f)), RACK
            )
            tries[kind] = (law, fit.x)
        for kind, (law, spread) in tries.items():
            same, opposite, *_ = misfits(spread, section, patches, found, FITS[name], law)
            left = (100 * float(np.sqrt(np.mean(each**2))) for each in (same, opposite))
            yield kind, name, *spread, *left


def misfits(
    spread: np.ndarray,
    section: Section,
    patches: int,
    found: Compliance,
    rows: Sequence[int],
    form: Form,
) -> list[np.ndarray]:
    """Differences of the law with these constants: even loads on both flanks over their yields, and patches.

    Single patches count over the largest yield among them, times `SHARE`.
    """
    given = rack_tooth(section.pair)
    width = np.sqrt(18 / np.pi / given.bending)
    tooth = tooth_data(Spread(*spread), section.pair.module, given.root, width)
    law = form(section, patches, tooth)
    same, opposite = [], []
    for row in rows:
        local = flattening(section, float(section.row_height(row + 0.5)))
        yields = even_load(section, patches, law, row)
        same.append(yields / (even_load(section, patches, found.same, row) - local) - 1)
        opposite.append(-tooth.coupling * yields / even_load(section, patches, found.opposite, row) - 1)
    chosen = np.concatenate([np.arange(row * patches, (row + 1) * patches) for row in rows])
    block, place = np.ix_(chosen, chosen), chosen % patches
    far = np.abs(place[:, None] - place) >= APART
    law, near, across = law[block], found.same[block], found.opposite[block]
    singles = SHARE * (law - near)[far] / near.max()
    return [
        np.concatenate(same),
        np.concatenate(opposite),
        singles,
        SHARE * (-tooth.coupling * law - across).ravel() / abs(across).max(),
    ]


def constants_table(folder: Path) -> str:
    """Every set of constants."""
    rows = _read(folder / CONSTANTS)
    table = [
        (row["constants"], row["heights"], *(f"{float(row[name]):.3g}" for name in list(row)[2:]))
        for row in rows
    ]
    head = ("constants", "heights", "s", "l, modules", "r", "c", "even load, RMS %", "opposite flank, RMS %")
    return markdown(head, table)


def _read(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))
