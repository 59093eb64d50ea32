"""The motion in a record: turns that an encoder does not count, rows at rest, rows of one angle, and records
whose angle does not show the direction."""

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from rps_exudyn.analysis.measured import TURN
from rps_exudyn.analysis.passes import passes
from rps_exudyn.base.errors import InputError
from rps_exudyn.inference.measured.columns import Table
from rps_exudyn.inference.measured.numbers import is_missing

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


SLOW, WINDOW = 0.2, 5  # of a pass' usual speed, over so many steps: below it the motion begins or ends
FEWEST_ROWS = 12  # of a pass, from which on its speed is judged


def in_motion(driven: np.ndarray, clock: np.ndarray | None) -> np.ndarray:
    """Return which rows are no rest before, between and after the passes, shape (n,), bool.

    Where no clock [s] is recorded, rows follow each other in even times.
    """
    number = np.arange(float(driven.size))
    moves = np.ones(driven.size, dtype=bool)
    last = -1  # row of the pass before
    turned = passes({"pinion_angle": driven, "row": number})
    for each in turned:
        rows = each.signals["row"].astype(int)
        first, end = _moving(each.angle, number[rows] if clock is None else clock[rows])
        if first:
            moves[last + 1 : rows[first]] = False
        elif rows[0] > last + 2:  # one row of the same angle is a turn, no rest
            moves[last + 1 : rows[0]] = False
        last = int(rows[end])
    if turned:
        moves[last + 1 :] = False
    return moves


def _moving(angle: np.ndarray, instants: np.ndarray) -> tuple[int, int]:
    """First and last row of a pass between which it moves at its usual speed, more or less."""
    apart = np.diff(instants)
    if angle.size < FEWEST_ROWS or not (apart > 0).all():
        return 0, angle.size - 1
    speed = np.abs(np.diff(angle)) / apart
    slowest = SLOW * float(np.median(speed))
    held = np.lib.stride_tricks.sliding_window_view(speed, WINDOW)
    steady = np.median(held, axis=1) >= slowest
    begins = np.flatnonzero((speed[: steady.size] >= slowest) & steady)
    ends = np.flatnonzero((speed[WINDOW - 1 :] >= slowest) & steady)
    if not begins.size or not ends.size:
        return 0, angle.size - 1
    return int(begins[0]), int(ends[-1]) + WINDOW


def spread_evenly(driven: np.ndarray, value: np.ndarray) -> tuple[np.ndarray, float]:
    """Return angles or travels (n,) whose rows of one value go on evenly to the next value, and how many rows
    an encoder's step has on average: 1.0 where it is finer than the rows, or rows are repeated as a whole."""
    stays = np.diff(driven) == 0
    begins = np.flatnonzero(np.append(True, ~stays))
    each_step = driven.size / begins.size
    if each_step < ROWS_OF_A_STEP or np.mean(np.diff(value)[stays] != 0) < NEW_VALUES:
        return driven, 1.0
    rows = np.append(begins, driven.size)
    values = np.append(driven[begins], driven[-1])
    return np.interp(np.arange(driven.size), rows, values), each_step


ROWS_OF_A_STEP = 1.5  # on average, from which on an encoder's steps are coarser than the rows
NEW_VALUES = 0.5  # of the rows of one angle, whose torque is another than the row's before
ALTERNATE, LEAST_FLIPS = 0.2, 5  # of the rows, after which torques of two directions change their sign
BETWEEN, FEW_BETWEEN = 0.3, 0.05  # of the usual size: values of two directions leave it empty but for a part
APART = 3.0  # times the difference to the next row but one, that the difference to the next row is


def is_interleaved(value: np.ndarray) -> bool:
    """Return whether torques or forces (n,) of both directions alternate from row to row."""
    if value.size < FEWEST_ROWS:
        return False
    next_one, next_but_one = (float(np.median(np.abs(value[k:] - value[:-k]))) for k in (1, 2))
    if next_one > APART * next_but_one:
        return True
    usual = float(np.median(np.abs(value)))
    flips = int((np.diff(np.sign(value)) != 0).sum())
    if flips < max(LEAST_FLIPS, ALTERNATE * value.size):
        return False
    return float((np.abs(value) < BETWEEN * usual).mean()) < FEW_BETWEEN


def directions(table: Table) -> list[str]:
    """Return the words of a column of directions, where a file has one of two or three words; else none."""
    named = [each.index for each in table.titles if _DIRECTION.fullmatch(each.text)]
    if len(named) != 1:
        return []
    words = [cell for cell in dict.fromkeys(table.column(named[0])) if not is_missing(cell)]
    return words if 1 < len(words) <= MOST_WAYS else []


# --- Times and speeds instead of an angle

NO_ANGLE = "and no pinion angle: give the gear whose travel per turn is known."
TO_REST = 0.05  # of the usual speed, between two parts of a motion
OTHER_SIGN = 0.1  # of the rows, whose torque has the other sign


def angle_by_speed(path: str | Path, beside: Mapping[str, np.ndarray], torque: np.ndarray) -> np.ndarray:
    """Return angles [rad] from `clock` [s], `speed` [rad/s] and torques, all of shape (n,), from 0 on.

    Raises:
        InputError: the times do not rise, or the speed has no sign although the motion turns back.
    """
    if "clock" not in beside:
        raise InputError(
            f"{path} has a speed and neither a pinion angle nor times; name a column time [s] or "
            "pinion_angle [deg]."
        )
    if "speed" not in beside:
        raise InputError(f"{path} holds the rack's speed {NO_ANGLE}")
    speed, steps, why = beside["speed"], np.diff(beside["clock"]), ""
    if not (np.isfinite(beside["clock"]).all() and np.isfinite(speed).all()) or not (
        (steps >= 0).all() and steps.any()
    ):
        why = "its times do not rise, or a speed is missing"
    elif not speed.any():
        why = "its speed is 0"
    else:
        moving = np.flatnonzero(np.abs(speed) >= 0.5 * np.median(np.abs(speed[speed != 0])))
        inner, signs = speed[moving[0] : moving[-1] + 1], np.sign(torque[moving])
        stops = np.abs(inner).min() < TO_REST * np.median(np.abs(inner))
        other = min((signs > 0).mean(), (signs < 0).mean())
        if ((inner >= 0).all() or (inner <= 0).all()) and (stops or other > OTHER_SIGN):
            why = "its speed has one sign although the motion turns back"
    if why:
        raise InputError(
            f"{path} has times and speeds instead of a pinion angle, but {why}; write a pinion_angle [deg], "
            "or speeds that are negative where the pinion turns back."
        )
    return np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 * steps)])


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
