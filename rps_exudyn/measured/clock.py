"""The clock and the speed that a bench records beside the curve: what tells how fast it turned.

Nothing depends on them but a warning, so that a column whose unit is not certain is left out, not asked for.
"""

import re

import numpy as np

from rps_exudyn.measured.layout import Layout
from rps_exudyn.measured.numbers import Format

_TITLE = re.compile(r"(?P<name>[^\[\](){}/]+?)\s*[\[({/,_ ]+\s*(?P<unit>[^\])}]+?)\s*[\])}]?")
_NAMES = {
    "clock": r"time|zeit|t|messzeit|elapsed(?: time)?|timestamp",
    "speed": r"(?:\w+ )?(?:speed|velocity|rate)|drehzahl|(?:winkel|dreh)?geschwindigkeit|n|omega|v",
}
_TURN = 2 * np.pi
_SIZES = {
    "clock": {"s": 1.0, "sec": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0},
    "speed": {
        **dict.fromkeys(("°/s", "deg/s", "deg/sec", "grad/s"), _TURN / 360),
        **dict.fromkeys(("rpm", "1/min", "u/min", "rev/min", "min-1", "min^-1"), _TURN / 60),
        **dict.fromkeys(("1/s", "u/s", "rev/s"), _TURN),
        "rad/s": 1.0,
        "m/s": 1.0,
        "mm/s": 1e-3,
        "mm/min": 1e-3 / 60,
    },
}


def recorded(layout: Layout, lines: list[int], numbers: Format) -> dict[str, np.ndarray]:
    """Return `clock` [s] and `speed` [rad/s], or [m/s] of a rack, at these lines, where the file has them.

    Values that are missing are NaN.
    """
    titles = layout.header[1] if layout.header else []
    units = layout.units[1] if layout.units else [""] * len(titles)
    found = {}
    for quantity, names in _NAMES.items():
        fitting = [
            (index, size)
            for index, title in enumerate(titles)
            if (size := _size(quantity, names, title, units[index] if index < len(units) else ""))
        ]
        if len(fitting) == 1:
            index, size = fitting[0]
            cells = {line: row[index] for line, row in layout.rows if index < len(row)}
            found[quantity] = size * numbers.column([cells.get(line, "") for line in lines])
    return found


def _size(quantity: str, names: str, title: str, below: str) -> float | None:
    """The size of the title's unit, in its text or in the row below, if it names the quantity."""
    text = title.strip().strip("\"'").strip()
    divided = _TITLE.fullmatch(text)
    name, unit = (divided["name"], divided["unit"]) if divided and not below else (text, below)
    if not re.fullmatch(names, name.strip(), re.I):
        return None
    return _SIZES[quantity].get(unit.strip().strip("[](){} ").lower())


def speeds(signals: dict[str, np.ndarray], parts: int = 10) -> np.ndarray:
    """Return how fast a pass was turned, part by part without its ends: shape (parts - 2,); empty if unknown.

    `signals` are those of the pass: `pinion_angle` and `clock` or `speed`.
    """
    angle = signals["pinion_angle"]
    if angle.size < 2 * parts:
        return np.zeros(0)
    inner = np.array_split(np.arange(angle.size), parts)[1:-1]
    if "speed" in signals:
        found = np.array([np.median(np.abs(signals["speed"][part])) for part in inner])
    elif "clock" in signals:
        clock = signals["clock"]
        apart = [clock[part[-1]] - clock[part[0]] for part in inner]
        turned = [abs(angle[part[-1]] - angle[part[0]]) for part in inner]
        found = np.array([a / t if t > 0 else np.nan for a, t in zip(turned, apart, strict=True)])
    else:
        return np.zeros(0)
    return found[np.isfinite(found) & (found > 0)]
