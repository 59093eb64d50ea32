"""Tables about the peers, from the stored rows: errors, times, ratios at equal error, versions."""

from collections.abc import Callable, Sequence
from operator import attrgetter
from pathlib import Path

import numpy as np

from benchmarks.peers.rounds import Row, from_data
from benchmarks.topic import digits, load_data, markdown
from verification.work_precision import pareto_front

DATA = "peers.json"
PACKAGE = "quasi-static", "flank", "full"
ASKED = {"quasi-static": 10.0, "flank": 10.0, "full": 1.0}
"""How many times faster than each peer at equal error a preset is meant to be, whole runs."""

Time = Callable[[Row], float]


whole: Time = attrgetter("whole_s")
loop: Time = attrgetter("loop_s")
"""Times of a whole run, and of the solver's loop [s]."""


def peers_of(rows: Sequence[Row]) -> list[str]:
    """Programs that are not the package."""
    return list(dict.fromkeys(row.program for row in rows if row.program not in PACKAGE))


def fastest(rows: Sequence[Row], program: str, error: float, time: Time) -> float | None:
    """Return the least time of a program within an error [%]; None if it never is."""
    keeps = [time(row) for row in rows if row.ok and row.program == program and row.error <= error]
    return min(keeps, default=None)


def ratios(rows: Sequence[Row], preset: str, peer: str, time: Time) -> list[float]:
    """Return by how much a preset is faster, at each error that the peer reaches and the preset keeps too."""
    found = []
    for row in rows:
        if row.ok and row.program == peer:
            own = fastest(rows, preset, row.error, time)
            if own is not None:
                found.append(time(row) / own)
    return found


def peers_table(folder: Path) -> str:
    """Errors and times of each program's most accurate setting."""
    rows = from_data(load_data(folder / DATA)["rows"])
    shown = [
        (row.program, row.label, f"{row.error:.2g}", digits(row.whole_s))
        for program in dict.fromkeys(row.program for row in rows)
        for row in front_of([row for row in rows if row.ok and row.program == program], whole)[-1:]
    ]
    return markdown(("program", "settings", "error %", "whole run CPU s"), shown)


def front_of(rows: Sequence[Row], time: Time) -> list[Row]:
    """Rows that no other one beats in both time and error, quickest first."""
    best = pareto_front(np.array([time(row) for row in rows]), np.array([row.error for row in rows]))
    return sorted((row for row, one in zip(rows, best, strict=True) if one), key=time)


def ratios_table(folder: Path) -> str:
    """By how much whole runs of each preset are faster than each peer at the peer's errors, and how many of
    these it keeps; bold: by less than asked."""
    rows = from_data(load_data(folder / DATA)["rows"])

    def cell(preset: str, peer: str) -> str:
        found = ratios(rows, preset, peer, whole)
        own = sum(row.ok and row.program == peer for row in rows)
        text = f"{digits(min(found))} to {digits(max(found))}" if found else "-"
        kept = "" if len(found) == own else f" ({len(found)} of {own})"
        return f"**{text}**{kept}" if not found or min(found) < ASKED[preset] else text + kept

    lines = [(peer, *(cell(preset, peer) for preset in PACKAGE)) for peer in peers_of(rows)]
    return markdown(("peer", *PACKAGE), lines)


def search_table(folder: Path) -> str:
    """How many settings of each peer were tried over a tooth pitch, and how near the best came."""
    rows, lines = from_data(load_data(folder / DATA)["search"]), []
    for peer in peers_of(rows):
        own = [row for row in rows if row.program == peer]
        ran = [row for row in own if row.ok]
        best = min(ran, key=lambda row: row.error, default=None)
        error = "-" if best is None else f"{best.error:.2g}"
        lines.append((peer, len(own), len(own) - len(ran), error))
    return markdown(("peer", "settings tried", "failed", "least error %"), lines)


def versions_table(folder: Path) -> str:
    """Versions of the programs, and those that are missing."""
    content = load_data(folder / DATA)
    absent = {name: f"left out: {why}" for name, why in content["absent"].items()}
    return markdown(("program", "version"), (content["versions"] | absent).items())


TABLES = {
    "peers": peers_table,
    "peer_ratios": ratios_table,
    "peer_search": search_table,
    "peer_versions": versions_table,
}
