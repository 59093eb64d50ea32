"""The angle of an encoder that counts one turn only, and records whose angle does not show the direction."""

import re
from collections.abc import Callable

import numpy as np

from rps_exudyn.inference.measured.layout import Layout
from rps_exudyn.inference.measured.numbers import is_missing

TURN = 2 * np.pi
NEAR_TURN = 0.5  # of a turn: a larger step is no motion but the count beginning anew ...
FEW_STEPS = 3.0  # ... if what is left of it is at most so many usual steps
_DIRECTION = re.compile(r"dir|direction|richtung|drehrichtung|laufrichtung|sense|way", re.I)
MOST_WAYS = 3  # words of a column of directions: forth, back, at rest


def counted_on(angle: np.ndarray) -> tuple[np.ndarray, int]:
    """Return angles [rad] (n,) that do not begin anew at each turn, and how often they did.

    A record that goes back by a whole turn and repeats an angle, or by other than a turn, is one of several
    passes, and stays.
    """
    steps = np.diff(angle)
    whole = np.where(np.abs(steps) > NEAR_TURN * TURN, np.round(steps / TURN), 0.0)
    left = steps - whole * TURN
    usual = float(np.median(np.abs(steps[whole == 0]))) if (whole == 0).any() else 0.0
    joins = (whole != 0) & (np.abs(left) > 1e-6 * TURN) & (np.abs(left) <= FEW_STEPS * usual)
    if not joins.any() or np.ptp(angle) > (1 + 1e-6) * TURN:
        return angle, 0
    turns = np.concatenate([[0.0], np.cumsum(np.where(joins, whole, 0.0))])
    return angle - turns * TURN, int(joins.sum())


def directions(layout: Layout) -> list[str]:
    """Return the words of a column of directions, where a file has one of two or three words; else none."""
    titles = layout.header[1] if layout.header else []
    named = [i for i, title in enumerate(titles) if _DIRECTION.fullmatch(title.strip().strip("\"'"))]
    if len(named) != 1:
        return []
    cells = (row[named[0]].strip() for _, row in layout.rows if named[0] < len(row))
    words = list(dict.fromkeys(cell for cell in cells if not is_missing(cell)))
    return words if 1 < len(words) <= MOST_WAYS else []


# --- The clock and the speed that a bench records beside the curve, or instead of an angle
#
# A column whose unit is not certain is left out.

_TITLE = re.compile(r"(?P<name>[^\[\](){}/]+?)\s*[\[({/,_ ]+\s*(?P<unit>[^\])}]+?)\s*[\])}]?")
_SPEED = r"(?:\w+ )?(?:speed|velocity|rate)|drehzahl|(?:winkel|dreh)?geschwindigkeit|n|omega|v"
_TITLES_OF = {
    "clock": r"time|zeit|t|messzeit|elapsed(?: time)?|timestamp",
    "speed": _SPEED,
    "rack_speed": _SPEED,
}
_SIZES = {
    "clock": {"s": 1.0, "sec": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0},
    "speed": {
        **dict.fromkeys(("°/s", "deg/s", "deg/sec", "grad/s"), TURN / 360),
        **dict.fromkeys(("rpm", "1/min", "u/min", "rev/min", "min-1", "min^-1"), TURN / 60),
        **dict.fromkeys(("1/s", "u/s", "rev/s"), TURN),
        "rad/s": 1.0,
    },
    "rack_speed": {"m/s": 1.0, "mm/s": 1e-3, "mm/min": 1e-3 / 60},
}


def recorded(layout: Layout, column: Callable[[int], np.ndarray]) -> dict[str, np.ndarray]:
    """Return `clock` [s], `speed` [rad/s] and `rack_speed` [m/s], as far as the columns' titles name them.

    `column` returns the numbers of a column of the file, NaN where a value is missing.
    """
    titles = layout.header[1] if layout.header else []
    units = layout.units[1] if layout.units else [""] * len(titles)
    found = {}
    for quantity, names in _TITLES_OF.items():
        fitting = [
            (index, size)
            for index, title in enumerate(titles)
            if (size := _size(quantity, names, title, units[index] if index < len(units) else ""))
        ]
        if len(fitting) == 1:
            index, size = fitting[0]
            found[quantity] = size * column(index)
    return found


TO_REST = 0.05  # of the usual speed, between two parts of a motion
OTHER_SIGN = 0.1  # of the rows, whose torque has the other sign


def angle_by_speed(clock: np.ndarray, speed: np.ndarray, torque: np.ndarray) -> np.ndarray:
    """Return angles [rad] from times [s], speeds [rad/s] and torques, all of shape (n,), from 0 on.

    Raises:
        ValueError: the times do not rise, or the speed has no sign although the motion turns back; its text
            is the cause.
    """
    steps = np.diff(clock)
    if not (np.isfinite(clock).all() and np.isfinite(speed).all() and (steps >= 0).all() and steps.any()):
        raise ValueError("its times do not rise, or a speed is missing")
    if not speed.any():
        raise ValueError("its speed is 0")
    moving = np.flatnonzero(np.abs(speed) >= 0.5 * np.median(np.abs(speed[speed != 0])))
    inner = speed[moving[0] : moving[-1] + 1]
    if (inner >= 0).all() or (inner <= 0).all():
        stops = np.abs(inner).min() < TO_REST * np.median(np.abs(inner))
        signs = np.sign(torque[moving])
        other = min((signs > 0).mean(), (signs < 0).mean())
        if stops or other > OTHER_SIGN:
            raise ValueError("its speed has one sign although the motion turns back")
    return np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 * steps)])


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
