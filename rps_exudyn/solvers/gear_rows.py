"""The numbers of many gears that differ in some parameters: packed one by one, or each number as a function.

Of one parameter alone each number is a short polynomial over the range of its values, and the changes by
several parameters add up; where exactly packed gears confirm that, no other gear need be packed.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.report import check_gear
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.closed_form import GRAVITY
from rps_exudyn.solvers.gear_forces import gear_forces, load_at_end
from rps_exudyn.solvers.gear_numbers import COLUMN, COUNT, LOAD, LOAD_PLACE, REST_GAP, arrays_of, numbers_of
from rps_exudyn.solvers.many_gears import Rows

RUNOUT, RUNOUT_ANGLE = "pinion.runout", "pinion.runout_angle"
DEGREE = 4  # of the polynomials
EXACT, ZONES = 1e-10, 1e-4  # allowed error of numbers over their size; of friction zones
CHECKED = 5  # gears packed to confirm
ZONE_COLUMNS = [column for (_, name), column in COLUMN.items() if name == "zone"]

Table = Mapping[str, np.ndarray]


def packed_rows(gears: list[SteeringGear], fidelity: Fidelity) -> Rows:
    """Pack gears one by one, each under the weight of its load test.

    Raises:
        InputError: a gear that cannot exist.
    """
    numbers, arrays = [], []
    for gear in gears:
        check_gear(gear)
        forces = gear_forces(gear, fidelity)
        data = forces.packed(forces.condensed_fit)
        numbers.append(numbers_of(data))
        weight = load_at_end(gear, gear.test.direction * GRAVITY * gear.test.load_mass).data
        numbers[-1][[LOAD, LOAD_PLACE]] = weight.force[0], weight.place
        arrays.append(arrays_of(data))
    seat = np.array([gear.yoke.seat_stiffness for gear in gears])
    references, points, stiffnesses = (_stacked(each) for each in zip(*arrays, strict=True))
    return Rows(np.array(numbers), references, points, stiffnesses, seat)


def _stacked(arrays: tuple[np.ndarray, ...]) -> np.ndarray:
    """Arrays of all gears, or one if they are alike."""
    alike = all(each is arrays[0] or np.array_equal(each, arrays[0]) for each in arrays)
    return np.ascontiguousarray(np.stack(arrays[:1] if alike else arrays))


def rows_of_table(
    reference: SteeringGear, fidelity: Fidelity, table: Table, ranges: Table | None = None
) -> Rows:
    """Return the rows of gears that differ from the reference in a table: path -> values (n,), SI.

    `ranges` holds values between whose ends all others lie, by path; without it those of the table.

    Raises:
        InputError: a value that is not allowed, or a gear that cannot exist.
    """
    count = len(next(iter(table.values())))

    def gear(row: int) -> SteeringGear:
        return reference.replace({path: float(values[row]) for path, values in table.items()})

    some = sorted({*np.linspace(0, count - 1, CHECKED).astype(int).tolist()})
    exact = packed_rows([gear(row) for row in some], fidelity)
    quick = _by_polynomials(reference, fidelity, table, table if ranges is None else ranges)
    if quick is not None and _alike(quick.of(np.array(some)), exact):
        return quick
    return packed_rows([gear(row) for row in range(count)], fidelity)


def _alike(quick: Rows, exact: Rows) -> bool:
    """Tell whether numbers are those of gears packed one by one."""
    allowed = np.full(COUNT, EXACT)
    allowed[ZONE_COLUMNS], allowed[REST_GAP] = ZONES, np.inf  # the loop adjusts the yoke
    size = np.abs(exact.numbers).max(axis=0)
    finite = np.isfinite(size)
    error = np.abs(quick.numbers[:, finite] - exact.numbers[:, finite])
    right = error <= np.maximum(allowed * size, 1e-300)[finite]
    same = all(
        a.shape == b.shape and np.allclose(a, b, rtol=EXACT, atol=0)
        for a, b in (
            (quick.references, exact.references),
            (quick.points, exact.points),
            (quick.stiffnesses, exact.stiffnesses),
        )
    )
    return bool(right.all() and same and np.array_equal(quick.numbers[:, ~finite], exact.numbers[:, ~finite]))


def _by_polynomials(reference: SteeringGear, fidelity: Fidelity, table: Table, ranges: Table) -> Rows | None:
    """Numbers as sums of polynomials of single parameters; None where other things than numbers change."""
    count = len(next(iter(table.values())))
    base = packed_rows([reference], fidelity)
    finite = np.isfinite(base.numbers[0])
    numbers, seat = np.repeat(base.numbers, count, axis=0), np.repeat(base.seat_stiffness, count)
    for path, values in table.items():
        if path in (RUNOUT, RUNOUT_ANGLE):
            continue
        probed = _probed(reference, fidelity, path, float(ranges[path].min()), float(ranges[path].max()))
        if probed is None:
            return None
        places, packed = probed
        changed = packed[:, finite] - base.numbers[:, finite]
        numbers[:, finite] += _polynomials(places, changed, values)
    if RUNOUT in table or RUNOUT_ANGLE in table:
        pair = GearPair.of(reference)
        e = table.get(RUNOUT, np.full(count, pair.runout))
        angle = table.get(RUNOUT_ANGLE, np.full(count, pair.runout_angle))
        packed_rows([reference.replace({RUNOUT: float(e.max()), RUNOUT_ANGLE: float(angle[0])})], fidelity)
        packed_rows([reference.replace({RUNOUT: float(e.min()), RUNOUT_ANGLE: float(angle[-1])})], fidelity)
        for row, each in zip(numbers, zip(e.tolist(), angle.tolist(), strict=True), strict=True):
            centre = replace(pair, runout=each[0], runout_angle=each[1]).eccentricity
            row[COLUMN["mesh", "eccentric_e"]], row[COLUMN["mesh", "eccentric_y"]] = centre[0], centre[1]
    return Rows(numbers, base.references, base.points, base.stiffnesses, seat)


@lru_cache(maxsize=256)
def _probed(
    reference: SteeringGear, fidelity: Fidelity, path: str, low: float, high: float
) -> tuple[np.ndarray, np.ndarray] | None:
    """Values of a parameter and the numbers of gears with them; None where other things than numbers change.

    Kept for the parts of one table.
    """
    nodes = chebyshev.chebpts1(DEGREE + 1)
    places = np.unique(np.append((low + high) / 2 + (high - low) / 2 * nodes, (low, high)))
    probes = [reference.replace({path: float(value)}) for value in places]
    packed = packed_rows(probes, fidelity)
    arrays = (packed.references, packed.points, packed.stiffnesses)
    design = GearPair.of(reference).design
    if GearPair.of(probes[0]).design is not design or any(len(each) > 1 for each in arrays):
        return None
    return places, packed.numbers


def _polynomials(places: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Polynomials through values (m, columns) at places (m,), at other places (n,); shape (n, columns)."""
    middle, half = (places[-1] + places[0]) / 2, (places[-1] - places[0]) / 2
    if not half:
        return np.repeat(values[:1], len(at), axis=0)
    scaled = (places - middle) / half
    terms = chebyshev.chebvander(scaled, min(DEGREE, len(places) - 1))
    coefficients = np.linalg.lstsq(terms, values, rcond=None)[0]
    return np.asarray(chebyshev.chebvander((at - middle) / half, terms.shape[1] - 1) @ coefficients)
