"""The angle of an encoder that counts one turn only, and records whose angle does not tell the direction."""

import re

import numpy as np

from rps_exudyn.measured.layout import Layout
from rps_exudyn.measured.numbers import is_missing

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
