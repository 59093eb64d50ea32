"""Say how far a torque curve of the scene is from the reference: python score.py CURVE.csv [--limit PERCENT]

CURVE.csv has two columns, pinion angle [deg] and pinion torque [N m], and may have lines of words. The angles
rise and cover 0 to 360 at most 12 apart. Where a curve has several values within half a degree of an angle of
the reference, their mean counts, so that what a program rings with at every step is not held against it;
elsewhere the curve is joined by straight lines. Errors are in % of the reference's mean:

    mean     of the curve, off the reference's
    shape    RMS of what is left of the difference without its mean
    error    RMS of both together; it passes if it is at most the limit, 1 % unless said otherwise

Needs numpy, and torque.csv beside it.
"""

import argparse
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

REFERENCE = "torque.csv"
LIMIT = 1.0  # [%]
WIDEST = 12.0  # gap between angles that is still joined [deg]


class Score(NamedTuple):
    """Errors of a curve, % of the reference's mean."""

    mean: float
    shape: float

    @property
    def error(self) -> float:
        """RMS of both."""
        return float(np.hypot(self.mean, self.shape))


def read_curve(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return angle [deg] and torque [N m], (n,) each.

    Raises:
        ValueError: the file holds no such columns.
    """
    rows = []
    for line in path.read_text(encoding="utf-8").splitlines():
        cells = line.replace(";", ",").split(",")
        try:
            rows.append((float(cells[0]), float(cells[1])))
        except (ValueError, IndexError):
            if rows:
                raise ValueError(f"{path}: {line!r} is no pair of angle and torque") from None
    if len(rows) < 2:
        raise ValueError(f"{path} holds no rows of angle and torque")
    angle, torque = np.array(rows).T
    return angle, torque


def score(angle: np.ndarray, torque: np.ndarray, true_angle: np.ndarray, true: np.ndarray) -> Score:
    """Return the errors of a curve over angles [deg], (n,), against a reference (m,) at even angles.

    Raises:
        ValueError: the curve does not cover the reference's angles, or holds values that are not finite.
    """
    if not (np.isfinite(angle).all() and np.isfinite(torque).all()):
        raise ValueError("angles and torques must be finite numbers")
    gaps = np.diff(angle)
    if (gaps <= 0).any() or gaps.max() > WIDEST:
        raise ValueError(f"angles must rise, by at most {WIDEST:g} degrees from row to row")
    window = (true_angle[1] - true_angle[0]) / 2
    if angle[0] > true_angle[0] + window or angle[-1] < true_angle[-1] - window:
        raise ValueError(f"angles must cover {true_angle[0]:g} to {true_angle[-1]:g} degrees")
    own = averaged(angle, torque, true_angle)
    off = 100 * (own - true)[:-1] / np.mean(true[:-1])  # the last angle is the first
    return Score(float(np.mean(off)), float(np.std(off)))


def averaged(angle: np.ndarray, torque: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Return the torque at wanted, even angles (m,): the mean of several values around one, or joined."""
    window = (wanted[1] - wanted[0]) / 2
    joined = np.interp(wanted, angle, torque)
    first, last = (np.searchsorted(angle, wanted + side * window) for side in (-1, 1))
    total = np.concatenate([[0.0], np.cumsum(torque)])
    mean = (total[last] - total[first]) / np.maximum(last - first, 1)
    return np.where(last - first > 1, mean, joined)


def main(arguments: list[str] | None = None) -> int:
    """Print the errors; return 0 if the curve passes, else 1."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("curve", type=Path)
    parser.add_argument("--limit", type=float, default=LIMIT, help="largest error [%%]")
    parser.add_argument("--reference", type=Path, default=Path(__file__).with_name(REFERENCE))
    asked = parser.parse_args(arguments)
    try:
        found = score(*read_curve(asked.curve), *read_curve(asked.reference))
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 1
    passes = found.error <= asked.limit
    print(f"mean {found.mean:+.3g} %, shape {found.shape:.3g} %, error {found.error:.3g} %")
    print(f"{'passes' if passes else 'fails'}: at most {asked.limit:g} % is asked for")
    return 0 if passes else 1


if __name__ == "__main__":
    sys.exit(main())
