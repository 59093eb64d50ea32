"""Tables about the peers, from the stored rows: errors, times, ratios at equal error, versions."""

from collections.abc import Callable, Sequence
from pathlib import Path

from benchmarks.peers.rounds import Row, from_data
from benchmarks.topic import digits, load_data, markdown

DATA = "peers.json"
PACKAGE = "quasi-static", "flank", "full"
ASKED = {"quasi-static": 10.0, "flank": 10.0, "full": 1.0}
"""How many times faster than each peer at equal error a preset is meant to be, whole runs."""

Time = Callable[[Row], float]


def whole(row: Row) -> float:
    """Time of a whole run [s]."""
    return row.whole_s


def loop(row: Row) -> float:
    """Time of the solver's loop [s]."""
    return row.loop_s


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


# --- tables ------------------------------------------------------------------------------------------
def peers_table(folder: Path) -> str:
    """Errors and times of every program and setting."""
    head = (
        "program",
        "settings",
        "mean %",
        "shape %",
        "error %",
        "against its own limit %",
        "loop CPU s",
        "whole run CPU s",
        "rounds",
    )
    rows = from_data(load_data(folder / DATA)["rows"])
    return markdown(head, [_cells(row) for row in rows])


def _cells(row: Row) -> tuple[object, ...]:
    if not row.ok:
        return row.program, row.label, *[""] * 6, _line(row.message)
    own = "" if row.own != row.own else f"{row.own:.2g}"
    times = (digits(row.loop_s), digits(row.whole_s))
    return (
        row.program,
        row.label,
        f"{row.mean:+.2g}",
        f"{row.shape:.2g}",
        f"{row.error:.2g}",
        own,
        *times,
        row.rounds,
    )


def _line(message: str) -> str:
    """First line of a message, as far as a table has room for it."""
    return message.splitlines()[0].replace("|", "/")[:120]


def ratios_table(folder: Path) -> str:
    """By how much each preset is faster than each peer at the peer's errors, and what was asked."""
    rows = from_data(load_data(folder / DATA)["rows"])
    lines = []
    for preset in PACKAGE:
        for peer in peers_of(rows):
            cells, kept = [], True
            for time in (whole, loop):
                found = ratios(rows, preset, peer, time)
                cells.append(f"{digits(min(found))} to {digits(max(found))}" if found else "-")
                if time is whole:
                    kept = bool(found) and min(found) >= ASKED[preset]
            reached = len(ratios(rows, preset, peer, whole))
            own = sum(row.ok and row.program == peer for row in rows)
            lines.append((preset, peer, *cells, f"{reached} of {own}", f"{ASKED[preset]:g}", _yes(kept)))
    head = ("preset", "peer", "whole runs", "loop", "peer's errors kept", "asked", "reached")
    return markdown(head, lines)


def _yes(kept: bool) -> str:
    return "yes" if kept else "**no**"


def limits_table(folder: Path) -> str:
    """The mean that each peer tends to, off the reference."""
    limits = load_data(folder / DATA)["limits"]
    rows = [(name, limit["settings"], f"{limit['mean']:+.2g} %") for name, limit in limits.items()]
    return markdown(("peer", "finest settings", "mean"), rows)


def search_table(folder: Path) -> str:
    """All settings that were searched: errors over one tooth pitch, the time of a turn at that pace."""
    rows = from_data(load_data(folder / DATA)["search"])
    lines = [
        (row.program, row.label, f"{row.mean:+.2g}", f"{row.shape:.2g}", digits(row.loop_s))
        if row.ok
        else (row.program, row.label, "", "", _line(row.message))
        for row in rows
    ]
    return markdown(("peer", "settings", "mean %", "shape %", "loop CPU s per turn"), lines)


def versions_table(folder: Path) -> str:
    """Versions of the programs, and those that are missing."""
    content = load_data(folder / DATA)
    rows = [
        *content["versions"].items(),
        *((name, f"left out: {why}") for name, why in content["absent"].items()),
    ]
    return markdown(("program", "version"), rows)


TABLES = {
    "peers": peers_table,
    "peer_ratios": ratios_table,
    "peer_limits": limits_table,
    "peer_search": search_table,
    "peer_versions": versions_table,
}
