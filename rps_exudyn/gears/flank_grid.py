"""Flanks as measured: grids of deviations normal to the analytic flank, read from CSV.

    tooth,flank,roll [mm],face [mm],deviation [um]
    all,drive,2.0,-7.0,-1.25
    ...

A row is one place. `flank` is drive, coast or both, `tooth` a number or all; without these columns a row
holds for both flanks and all teeth. Places make a rectangular grid, the same on all flanks:

    pinion   roll: tangent length q, or diameter;  face: Z from the middle of the face width
    rack     height: above the reference line, towards the tips;  across: Z of the rack

A deviation is positive where there is more material; it adds to relief, crowning, slope and errors that
parameters state, as ISO 1328-1 counts deviations from the designed flank. Between the places the surface is a
cubic spline (not-a-knot); beyond them it stays what it is at the edge, for at most one interval.

Contact along a line (`tooth_contact.flank_line`) holds while the deviation bends the flank much less than the
involute does: |dev''| rho < 0.1, dev'' along the profile and rho its radius of curvature.
"""

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from rps_exudyn.base import units
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.trochoid import form_point
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.parameters.named_file import named_content

LARGEST_BEND = 0.1  # |dev''| rho: the depth across the line of contact stays a parabola to as much
LARGEST = 1e-4  # of a deviation [m], as of all other errors of the flanks
FEWEST = 4  # places along each coordinate: a cubic needs them
MOST = 400  # intervals along each; more places are thinned out
EVEN = 1e-4  # of an interval, within which places are taken for even
FLANKS = {"drive": (0,), "coast": (1,), "both": (0, 1)}
COORDINATES = {"pinion": (("roll", "diameter"), ("face",)), "rack": (("height",), ("across",))}


@dataclass(frozen=True, eq=False)
class FlankGrid:
    """Deviations of one part's flanks as cubic B-splines over even places."""

    low: tuple[float, float]  # first place of both coordinates [m]
    steps: tuple[float, float]  # between places [m]
    coefficients: np.ndarray  # (teeth or 1, drive and coast, n + 2, m + 2) of n x m places [m]
    first_tooth: int  # number of the first of the teeth

    @property
    def intervals(self) -> tuple[int, int]:
        """Intervals along both coordinates."""
        return self.coefficients.shape[2] - 3, self.coefficients.shape[3] - 3

    @property
    def high(self) -> tuple[float, float]:
        """Last place of both coordinates [m]."""
        n, m = self.intervals
        return self.low[0] + n * self.steps[0], self.low[1] + m * self.steps[1]

    @property
    def is_of_each_tooth(self) -> bool:
        """Return whether teeth differ."""
        return len(self.coefficients) > 1

    @property
    def highest(self) -> float:
        """Bound of all deviations, at least 0 [m]: a spline lies between its coefficients."""
        return float(max(self.coefficients.max(), 0.0))

    def at(self, u: np.ndarray | float, w: np.ndarray | float, tooth: int, side: int) -> np.ndarray:
        """Return the deviation at places (...) of one flank [m]; side -1 is the drive flank."""
        number = min(max(tooth - self.first_tooth, 0), len(self.coefficients) - 1)
        of_flank = self.coefficients[number, int(side > 0)]
        u, w = np.broadcast_arrays(u, w)
        i, along = self._weights(u, 0)
        j, beside = self._weights(w, 1)
        result = np.zeros(u.shape)
        for k in range(4):
            for m in range(4):
                result += along[k] * beside[m] * of_flank[i + k, j + m]
        return result

    def _weights(self, places: np.ndarray, axis: int) -> tuple[np.ndarray, np.ndarray]:
        """Interval of places, and the four cubic B-splines there."""
        at = np.clip((places - self.low[axis]) / self.steps[axis], 0, self.intervals[axis])
        number = np.minimum(np.floor(at), self.intervals[axis] - 1)
        t = at - number
        r = 1 - t
        splines = [r**3, 4 - 6 * t**2 + 3 * t**3, 4 - 6 * r**2 + 3 * r**3, t**3]
        return number.astype(int), np.array(splines) / 6

    def second_derivatives(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return those by uu, uw, ww at the places, (teeth or 1, 2, n, m) each [1/m]."""
        c, (a, b) = self.coefficients, self.steps
        mean = np.array([1, 4, 1]) / 6

        def along(weights: Sequence[float] | np.ndarray, of: np.ndarray, axis: int) -> np.ndarray:
            n = of.shape[axis] - 2
            parts = [np.take(of, range(k, k + n), axis) * weights[k] for k in range(3)]
            return np.asarray(sum(parts))

        second, first = (1, -2, 1), (-0.5, 0, 0.5)
        uu = along(mean, along(second, c, 2), 3) / a**2
        uw = along(first, along(first, c, 2), 3) / (a * b)
        return uu, uw, along(second, along(mean, c, 2), 3) / b**2


@dataclass(frozen=True)
class MeasuredFlanks:
    """Grids of a gear; None of a part without one."""

    pinion: FlankGrid | None
    rack: FlankGrid | None

    @cached_property
    def are_given(self) -> bool:
        """Return whether there is one."""
        return self.pinion is not None or self.rack is not None

    @cached_property
    def change_along_travel(self) -> bool:
        """Return whether the rack's teeth differ."""
        return self.rack is not None and self.rack.is_of_each_tooth

    @cached_property
    def highest(self) -> float:
        """Bound of what both add to a depth, at least 0 [m]."""
        return sum(grid.highest for grid in (self.pinion, self.rack) if grid is not None)


PERFECT_FLANKS = MeasuredFlanks(None, None)


def measured_flanks(gear: SteeringGear) -> MeasuredFlanks:
    """Return the grids of a gear's flanks."""
    texts = gear.pinion.deviation, gear.rack.deviation
    return _measured(GearPair.of(gear), RackBar.of(gear), *texts) if any(texts) else PERFECT_FLANKS


@lru_cache(maxsize=16)
def _measured(pair: GearPair, bar: RackBar, of_pinion: str, of_rack: str) -> MeasuredFlanks:
    pinion = rack = None
    if of_pinion:
        pinion = _read(of_pinion, "pinion", pair, range(pair.teeth))
        _check_covers(pinion, "pinion", of_pinion, _met_by_pinion(pair), 0.0)
        _check_bend(bend_on_pinion(pinion, pair), "pinion", of_pinion)
    if of_rack:
        rack = _read(of_rack, "rack", pair, bar.teeth)
        _check_covers(rack, "rack", of_rack, _met_by_rack(pair), pair.reference_height)
        _check_bend(bend_on_rack(rack, pair), "rack", of_rack)
    return MeasuredFlanks(pinion, rack)


# --- what a grid must be ---------------------------------------------------------------------------
Ranges = tuple[tuple[float, float], tuple[float, float]]


def _met_by_pinion(pair: GearPair) -> Ranges:
    """Tangent lengths and Z of the pinion's flank that meet the rack [m]."""
    low, high = (each + pair.reference_radius * np.sin(pair.alpha_t) for each in pair.active_path)
    reach = _reach(pair) / np.cos(pair.delta)
    b = min(pair.face_width / 2, reach)
    return (max(low, form_point(pair).tangent_length), high), (-b, b)


def _met_by_rack(pair: GearPair) -> Ranges:
    """y and z of the rack's flank that meet the pinion, rack frame [m]."""
    first, last = (
        pair.reference_radius + each * np.sin(pair.alpha_t) - pair.bar_axis_height
        for each in pair.active_path
    )
    across = min(_reach(pair), pair.face_width / 2 * np.cos(pair.delta))
    return (first, last), (-across, across)


def _reach(pair: GearPair) -> float:
    """Half chord of the bar where the pinion reaches deepest [m]."""
    deepest = pair.reference_radius + pair.active_path[1] * np.sin(pair.alpha_t) - pair.bar_axis_height
    return float(np.sqrt(max(pair.bar_radius**2 - deepest**2, 0.0)))


def _check_covers(grid: FlankGrid, part: str, text: str, met: Ranges, below: float) -> None:
    """Refuse a grid that ends more than an interval within what meets the other part, `below` its axis."""
    for axis, (low, high) in enumerate(met):
        step = grid.steps[axis]
        if grid.low[axis] - step > low or grid.high[axis] + step < high:
            name, ends = COORDINATES[part][axis][0], [grid.low[axis], grid.high[axis], low, high]
            if name == "height":
                ends = [-(ends[k] + below) for k in (1, 0, 3, 2)]
            first, last, from_, to = (f"{1e3 * each:.4g}" for each in ends)
            raise InputError(
                f"{part}.deviation covers {name} {first} to {last} mm in {_name(text)}; the flank meets the "
                f"other part from {from_} to {to} mm."
            )


def bend_on_pinion(grid: FlankGrid, pair: GearPair) -> float:
    """Return the largest |dev''| rho of a grid on the pinion: r_b^2 dev_qq / (q cos beta_b)."""
    (low, high), _ = _met_by_pinion(pair)
    q = grid.low[0] + grid.steps[0] * np.arange(grid.intervals[0] + 1)
    met = (q >= low) & (q <= high)
    uu = grid.second_derivatives()[0][:, :, met]
    bend = pair.base_radius**2 * np.abs(uu) / (q[met] * np.cos(pair.beta_b))[:, None]
    return float(bend.max(initial=0.0))


def bend_on_rack(grid: FlankGrid, pair: GearPair) -> float:
    """Return the same of a grid on the rack, along the transverse section of the pinion, rho at its tip."""
    q = pair.active_path[1] + pair.reference_radius * np.sin(pair.alpha_t)
    (low, high), _ = _met_by_rack(pair)
    y = grid.low[0] + grid.steps[0] * np.arange(grid.intervals[0] + 1)
    uu, uw, ww = (each[:, :, (y >= low) & (y <= high)] for each in grid.second_derivatives())
    most = 0.0
    for side in (-1, +1):
        radial = np.cross(pair.rack_flank_normal(side), pair.pinion_frame[:, 2])
        _, r_y, r_z = radial / np.linalg.norm(radial)
        along = (uu * r_y**2 + 2 * uw * r_y * r_z + ww * r_z**2)[:, int(side > 0)]
        most = max(most, float(np.abs(along).max(initial=0.0)) * q / np.cos(pair.beta_b))
    return most


def _check_bend(bend: float, part: str, text: str) -> None:
    """Refuse waves that are too sharp."""
    if bend > LARGEST_BEND:
        raise InputError(
            f"{part}.deviation bends the flank by {bend:.2g} of the involute's curvature in {_name(text)}; "
            f"contact along a line holds to {LARGEST_BEND:g}: smooth the grid over longer waves."
        )


def _name(text: str) -> str:
    return text.rpartition(" sha256:")[0]


# --- reading ---------------------------------------------------------------------------------------
def _read(text: str, part: str, pair: GearPair, teeth: range) -> FlankGrid:
    """Read a grid.

    Raises:
        InputError: it is none.
    """
    path, content = named_content(text, f"{part}.deviation")
    try:
        rows = _rows(content, part)
        return _grid(rows, part, pair, teeth)
    except ValueError as error:
        raise InputError(f"{part}.deviation: {path} {error}.") from None


def _rows(content: bytes, part: str) -> dict[str, np.ndarray]:
    """Columns of the file, lengths [m], tooth and flank as text."""
    try:
        lines = [
            line for line in content.decode("utf-8-sig").splitlines() if line.strip()[:1] not in ("", "#")
        ]
    except UnicodeDecodeError:
        raise ValueError("is not UTF-8 text") from None
    if len(lines) < 2:
        raise ValueError("has no rows")
    text, between = "\n".join(lines), next((each for each in ";\t" if each in lines[0]), ",")
    if between == ";":  # of spreadsheets whose decimal mark is a comma
        text = text.replace(",", ".")
    table = list(csv.reader(io.StringIO(text), delimiter=between))
    names = [each.partition("[")[0].strip() for each in table[0]]
    known = {"tooth", "flank", "deviation", *(name for each in COORDINATES[part] for name in each)}
    if unknown := [name for name in names if name not in known]:
        raise ValueError(f"has the column {unknown[0]!r}; known are {', '.join(sorted(known))}")
    for each in (*COORDINATES[part], ("deviation",)):
        if sum(name in names for name in each) != 1:
            raise ValueError(f"must have one column {' or '.join(each)}")
    columns: dict[str, np.ndarray] = {}
    for i, (name, title) in enumerate(zip(names, table[0], strict=True)):
        try:
            cells = [row[i].strip() for row in table[1:]]
        except IndexError:
            raise ValueError(f"has a row without {name}") from None
        if name in ("tooth", "flank"):
            columns[name] = np.array(cells)
            continue
        unit = title.partition("[")[2].partition("]")[0].strip()
        if not unit:
            raise ValueError(f"has no unit at {name}; write for instance {name} [mm]")
        try:
            columns[name] = np.array(cells, dtype=float) * units.to_si(f"1 {unit}", "m")
        except ValueError as error:
            raise ValueError(f"is wrong in column {name}: {error}") from None
        if not np.isfinite(columns[name]).all():
            raise ValueError(f"has a place without a number in column {name}")
    if (largest := np.abs(columns["deviation"]).max()) > LARGEST:
        raise ValueError(f"has a deviation of {1e6 * largest:.4g} um; the limit is {1e6 * LARGEST:g} um")
    return columns


def _grid(columns: dict[str, np.ndarray], part: str, pair: GearPair, teeth: range) -> FlankGrid:
    """The surface through all rows."""
    count = len(columns["deviation"])
    flank, tooth = (
        columns.get(name, np.full(count, usual)) for name, usual in (("flank", "both"), ("tooth", "all"))
    )
    if strange := set(flank.tolist()) - set(FLANKS):
        raise ValueError(f"names the flank {strange.pop()!r}; write drive, coast or both")
    if strange := set(tooth.tolist()) - {"all", *map(str, teeth)}:
        raise ValueError(
            f"names the tooth {strange.pop()!r}; write all, or a number from {teeth[0]} to {teeth[-1]}"
        )
    u, w = _places(columns, part, pair)
    values: dict[tuple[str, int], np.ndarray] = {}
    axes = np.unique(u), np.unique(w)
    for of_tooth, of_flank in sorted(set(zip(tooth.tolist(), flank.tolist(), strict=True))):
        own = (tooth == of_tooth) & (flank == of_flank)
        values |= {
            (of_tooth, k): _surface(u[own], w[own], columns["deviation"][own], axes) for k in FLANKS[of_flank]
        }
    named = sorted({key[0] for key in values})
    if named != ["all"] and set(named) != set(map(str, teeth)):
        raise ValueError(
            f"has rows of {len(named)} teeth; it must have rows of all {len(teeth)}, or of all alike"
        )
    order = ["all"] if named == ["all"] else list(map(str, teeth))
    if missing := [(name, k) for name in order for k in (0, 1) if (name, k) not in values]:
        name, k = missing[0]
        raise ValueError(f"has no rows of the {('drive', 'coast')[k]} flank of tooth {name}")
    surfaces = np.array([[values[name, k] for k in (0, 1)] for name in order])
    lows, steps = [], []
    for axis, places in enumerate(axes):
        surfaces, low, step = _even(surfaces, places, 2 + axis)
        surfaces = _coefficients(surfaces, 2 + axis)
        lows.append(low)
        steps.append(step)
    first = 0 if order == ["all"] else teeth[0]
    return FlankGrid((lows[0], lows[1]), (steps[0], steps[1]), np.ascontiguousarray(surfaces), first)


def _places(columns: dict[str, np.ndarray], part: str, pair: GearPair) -> tuple[np.ndarray, np.ndarray]:
    """Both coordinates of all rows [m]."""
    if part == "rack":
        return -(columns["height"] + pair.reference_height), columns["across"]
    if "roll" in columns:
        return columns["roll"], columns["face"]
    square = (columns["diameter"] / 2) ** 2 - pair.base_radius**2
    if (square < 0).any():
        raise ValueError(f"has a diameter inside the base circle of {2e3 * pair.base_radius:.4f} mm")
    return np.sqrt(square), columns["face"]


def _surface(u: np.ndarray, w: np.ndarray, d: np.ndarray, axes: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Values of one flank on the grid (n, m)."""
    n, m = map(len, axes)
    if n < FEWEST or m < FEWEST:
        raise ValueError(f"has {n} by {m} places on a flank; it needs {FEWEST} by {FEWEST}")
    place = np.searchsorted(axes[0], u) * m + np.searchsorted(axes[1], w)
    if len(u) != n * m or len(np.unique(place)) != n * m:
        raise ValueError(
            f"has {len(u)} rows of a flank; a grid of {n} by {m} places needs {n * m}, the same on all flanks"
        )
    values = np.empty(n * m)
    values[place] = d
    return values.reshape(n, m)


def _even(values: np.ndarray, places: np.ndarray, axis: int) -> tuple[np.ndarray, float, float]:
    """Values at even places along an axis, the first place and the step between them."""
    gaps, count = np.diff(places), len(places) - 1
    low, span = float(places[0]), float(places[-1] - places[0])
    if np.ptp(gaps) <= EVEN * gaps.mean() and count <= MOST:
        return values, low, span / count
    from scipy.interpolate import CubicSpline  # a third of a second to load

    count = min(int(np.ceil(span / gaps.min())), MOST)
    at = np.linspace(places[0], places[-1], count + 1)
    return CubicSpline(places, values, axis=axis)(at), low, span / count


def _coefficients(values: np.ndarray, axis: int) -> np.ndarray:
    """Coefficients (n + 2) of the cubic B-spline through n even places; not-a-knot: the third derivative is
    continuous at the places next to the ends."""
    n = values.shape[axis]
    matrix = np.zeros((n + 2, n + 2))
    for i in range(n):
        matrix[i, i : i + 3] = 1 / 6, 4 / 6, 1 / 6
    matrix[n, :5] = matrix[n + 1, -5:] = 1, -4, 6, -4, 1
    moved = np.moveaxis(values, axis, 0)
    right = np.concatenate([moved, np.zeros((2, *moved.shape[1:]))])
    solved = np.linalg.solve(matrix, right.reshape(n + 2, -1)).reshape(right.shape)
    return np.moveaxis(solved, 0, axis)
