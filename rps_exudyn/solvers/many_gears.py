"""Many gears along the same pinion angles: their records, what is known of their motion, and the follower.

A few gears are followed first: a reference, and two for each parameter that varies. What they do is known of
all others to first order; the follower finds the rest of their motion by the equations of single runs, mostly
with one evaluation of the forces at each instant.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.force_element import COORDINATE_BLOCKS, PINION, PLUNGER, RACK
from rps_exudyn.forces.friction import PLAIN
from rps_exudyn.forces.pinion_support import at_rest
from rps_exudyn.forces.yoke import pressed_seat
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_report import check_gear
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.balance import NOTHING_ACCELERATED
from rps_exudyn.solvers.closed_form import GRAVITY
from rps_exudyn.solvers.follower import ACCEPT, NO_COLUMN, follow, room_to_follow
from rps_exudyn.solvers.gear_forces import GearForces, gear_forces
from rps_exudyn.solvers.gear_model import GEAR, OUTPUTS
from rps_exudyn.solvers.prescribed_motion import DrivenBody
from rps_exudyn.solvers.record import Record
from rps_exudyn.solvers.settling import CLOSE, TYPICAL_APPROACH, find_approach

RUNOUT, RUNOUT_ANGLE = "pinion.runout", "pinion.runout_angle"
COUNTERS = "force_evaluations", "newton_iterations", "jacobians"
ZONES = 1e-4  # allowed error of friction zones over their size
COURSE = "course_starts", "course"  # of the record of flanks
CHECKED = 5  # values of a parameter among which gears are packed to confirm
TURN = (5**0.5 - 1) / 2  # of a range from parameter to parameter, so that these gears are unlike
Y, Z, YAW, PITCH = RACK + 1, RACK + 2, RACK + 4, RACK + 5

Table = Mapping[str, np.ndarray]
"""Path of a parameter -> values, SI."""


class Packing(NamedTuple):
    """How records are packed by polynomials over single parameters."""

    degree: int  # of the polynomials
    between: int  # gears packed for each, beside those at both ends
    error: float  # allowed, of a record's numbers over their size
    checked: int  # gears packed to confirm, at most `CHECKED`


EXACT = Packing(4, 5, 1e-10, CHECKED)
QUICK = Packing(2, 1, 1e-8, 2)  # of a tooth: 1e-5 um


# --- records ---------------------------------------------------------------------------------------
def _columns(name: str, dtype: np.dtype = GEAR, first: int = 0) -> list[int]:
    """Places of all numbers of a name in a record seen as numbers of eight bytes."""
    found: list[int] = []
    for key in dtype.names or ():
        kind, offset = dtype.fields[key][:2]  # type: ignore[index]
        place = first + offset // 8
        if key == name:
            found += range(place, place + kind.itemsize // 8)
        elif kind.names:
            found += _columns(name, kind, place)
    return found


ZONE_COLUMNS = _columns("zone")
REST_GAP = _columns("rest_gap")


def as_numbers(records: np.ndarray) -> np.ndarray:
    """Return records (n,) as numbers of eight bytes each, shape (n, .); whole numbers are none of them."""
    return records.view(np.float64).reshape(len(records), -1)


def packed(gears: Sequence[SteeringGear], fidelity: Fidelity, weighted: bool = False) -> np.ndarray:
    """Return the records of gears, packed one by one; each under the weight of its load test if asked for."""
    records = np.zeros(len(gears), GEAR)
    for i, gear in enumerate(gears):
        check_gear(gear)
        load = gear.test.direction * GRAVITY * gear.test.load_mass if weighted else 0.0
        records[i] = gear_forces(gear, fidelity, load).statics.gears[0]
    return records


def same_structure(records: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Return which records (n,) have the whole numbers of a reference (1,): counts, switches, places of
    tables, and its course. Those of others need other room, or move otherwise."""

    def differ(some: np.ndarray, other: np.ndarray) -> np.ndarray:
        if some.dtype.names is None:
            apart = (some != other) & (some.dtype.kind in "iu")
            return np.asarray(apart.reshape(len(records), -1).any(axis=1))
        return np.logical_or.reduce([differ(some[name], other[name]) for name in some.dtype.names])

    flanks, course = records["mesh"]["flank"], reference["mesh"]["flank"]
    alike = [(flanks[name] == course[name]).reshape(len(records), -1).all(axis=1) for name in COURSE]
    return ~differ(records, reference) & np.logical_and(*alike)


def packed_table(
    reference: SteeringGear,
    fidelity: Fidelity,
    table: Table,
    ranges: Table | None = None,
    weighted: bool = False,
    packing: Packing = EXACT,
) -> np.ndarray:
    """Return the records of gears that differ from the reference in a table: path -> values (n,), SI.

    Of one parameter alone each number is a short polynomial over the range of its values, and the changes by
    several parameters add up; where exactly packed gears within the ranges confirm that, no other gear need
    be packed. So the record of a gear does not depend on the others of the table.

    `ranges` has the values between whose ends all others lie, by default the table's. Where `weighted`, each
    gear stands under the weight of its load test.
    """
    within = tuple(
        (path, _spread(values, number))
        for number, (path, values) in enumerate({**table, **(ranges or {})}.items())
    )
    if _add_up(reference, fidelity, within, weighted, packing):
        quick = _by_polynomials(reference, fidelity, table, _arrays(within), weighted, packing)
        assert quick is not None
        return quick
    count = len(next(iter(table.values())))
    return packed([_gear(reference, table, row) for row in range(count)], fidelity, weighted)


def _gear(reference: SteeringGear, table: Table, row: int) -> SteeringGear:
    return reference.replace({path: float(values[row]) for path, values in table.items()})


def _spread(values: np.ndarray, number: int) -> tuple[float, ...]:
    """Some values of a parameter between the ends of all, in another order than of other parameters."""
    places = (np.arange(CHECKED) / CHECKED + TURN * number) % 1
    some = np.sort(values)[np.rint(places * (len(values) - 1)).astype(int)]
    return float(np.min(values)), *some.tolist(), float(np.max(values))


def _arrays(within: tuple[tuple[str, tuple[float, ...]], ...]) -> dict[str, np.ndarray]:
    return {path: np.array(values) for path, values in within}


@lru_cache(maxsize=16)
def _add_up(
    reference: SteeringGear,
    fidelity: Fidelity,
    within: tuple[tuple[str, tuple[float, ...]], ...],
    weighted: bool,
    packing: Packing,
) -> bool:
    """Return whether exactly packed gears within ranges confirm sums of polynomials; of those that exist."""
    ranges = _arrays(within)
    table = {path: values[1:-1] for path, values in ranges.items()}
    quick = _by_polynomials(reference, fidelity, table, ranges, weighted, packing)
    if quick is None:
        return False
    exact = {}
    for row in range(packing.checked):
        with suppress(InputError):
            exact[row] = packed([_gear(reference, table, row)], fidelity, weighted)
    return bool(exact) and _alike(quick[[*exact]], np.concatenate([*exact.values()]), packing.error)


def _alike(quick: np.ndarray, exact: np.ndarray, error: float) -> bool:
    """Return whether records are those of gears packed one by one."""
    numbers, right = as_numbers(quick), as_numbers(exact)
    allowed = np.full(numbers.shape[1], error)
    allowed[ZONE_COLUMNS], allowed[REST_GAP] = ZONES, np.inf  # which `adjust` finds
    finite = np.isfinite(right).all(axis=0)
    size = np.abs(right[:, finite]).max(axis=0)
    moved = np.abs(numbers[:, finite] - right[:, finite])
    within = moved <= np.maximum(allowed[finite] * size, 1e-300)
    return bool(within.all() and np.array_equal(numbers[:, ~finite], right[:, ~finite]))


def _by_polynomials(
    reference: SteeringGear, fidelity: Fidelity, table: Table, ranges: Table, weighted: bool, packing: Packing
) -> np.ndarray | None:
    """Records as sums of polynomials of single parameters; None where other things than numbers change."""
    count = len(next(iter(table.values())))
    base = packed([reference], fidelity, weighted)
    records = np.repeat(base, count)
    numbers, here = as_numbers(records), as_numbers(base)
    for path, values in table.items():
        if path in (RUNOUT, RUNOUT_ANGLE):
            continue
        ends = float(ranges[path].min()), float(ranges[path].max())
        probed = _probed(reference, fidelity, path, *ends, weighted, packing.between)
        if probed is None:
            return None
        places, of_probes, moving = probed
        if moving.size:
            numbers[:, moving] += _polynomials(
                places, of_probes[:, moving] - here[:, moving], values, packing.degree
            )
    if RUNOUT in table or RUNOUT_ANGLE in table:
        pair = GearPair.of(reference)
        e = table.get(RUNOUT, np.full(count, pair.runout))
        angle = table.get(RUNOUT_ANGLE, np.full(count, pair.runout_angle))
        flank = records["mesh"]["flank"]
        for i, (size, turned) in enumerate(zip(e.tolist(), angle.tolist(), strict=True)):
            centre = replace(pair, runout=size, runout_angle=turned).eccentricity
            flank["eccentric_e"][i], flank["eccentric_y"][i] = centre[0], centre[1]
    return records


@lru_cache(maxsize=256)
def _probed(
    reference: SteeringGear,
    fidelity: Fidelity,
    path: str,
    low: float,
    high: float,
    weighted: bool,
    between: int,
) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Values of a parameter, the numbers of gears with them, and which of these change; None where other
    things than numbers change. Kept for the parts of one table."""
    nodes = chebyshev.chebpts1(between)
    places = np.unique(np.append((low + high) / 2 + (high - low) / 2 * nodes, (low, high)))
    probes = [reference.replace({path: float(value)}) for value in places]
    of_probes = packed(probes, fidelity, weighted)
    if GearPair.of(probes[0]).design is not GearPair.of(reference).design:
        return None
    numbers = as_numbers(of_probes)
    moving = np.flatnonzero(
        (of_probes.view(np.int64).reshape(numbers.shape) != of_probes[:1].view(np.int64)).any(axis=0)
    )
    return (places, numbers, moving) if np.isfinite(numbers[:, moving]).all() else None


def _polynomials(places: np.ndarray, values: np.ndarray, at: np.ndarray, degree: int) -> np.ndarray:
    """Polynomials through values (m, columns) at places (m,), at other places (n,); shape (n, columns)."""
    middle, half = (places[-1] + places[0]) / 2, (places[-1] - places[0]) / 2
    if not half:
        return np.repeat(values[:1], len(at), axis=0)
    terms = chebyshev.chebvander((places - middle) / half, min(degree, len(places) - 1))
    coefficients = np.linalg.lstsq(terms, values, rcond=None)[0]
    powers = chebyshev.chebvander((at - middle) / half, terms.shape[1] - 1)
    return np.asarray(sum(power[:, None] * each for power, each in zip(powers.T, coefficients, strict=True)))


# --- motion ----------------------------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class MotionResponse:
    """Places at the mesh beside what rigid bodies do, of a reference, and what features add to them."""

    places: np.ndarray  # (1 + f, k, m), m coordinates; per feature from the second on
    rates: np.ndarray  # the same, by the follower's differences

    @classmethod
    def of(cls, places: np.ndarray, time_step: float) -> "MotionResponse":
        """From places at even instants."""
        rates = np.empty(places.shape)
        rates[:, 1:] = np.diff(places, axis=1) / time_step
        rates[:, 0] = rates[:, 1]
        rates[:, 2:] += (rates[:, 2:] - rates[:, 1:-1]) / 2
        return cls(places, rates)

    def since(self, first: int) -> "MotionResponse":
        """Return the same from an instant on."""
        return MotionResponse(self.places[:, first:], self.rates[:, first:])

    def of_gears(self, features: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return places and rates of gears with features (n, f); shape (n, k, m). Each gear's sum is one of
        its own, rounded alike in whatever company."""
        weights = np.column_stack([np.ones(len(features)), features])[:, None]
        places, rates = (
            (weights @ values.reshape(len(values), -1)).reshape(-1, *values.shape[1:])
            for values in (self.places, self.rates)
        )
        return places, rates


@dataclass(frozen=True, eq=False)
class Found:
    """What became of gears at even angles; arrays have one row for each gear."""

    record: Record  # of all of them
    found: np.ndarray  # (n,) whether there is an equilibrium at all angles
    resting: np.ndarray  # (n,) place of the rack under the preload along Y [m]
    counts: dict[str, np.ndarray]  # what it took, by the names of `quantities`, (n,) each


@dataclass(frozen=True, eq=False)
class GearSeries:
    """Gears of one design under one motion of the rig; a driven rack moves as the pinion would move it."""

    forces: GearForces  # of the reference gear
    pair: GearPair  # its geometry
    speed: float  # of the pinion, with its sense [rad/s]
    body: DrivenBody = "pinion"  # that the rig moves

    @property
    def share(self) -> float:
        """Share of the runout across the pinion's axis that the rack follows along X."""
        return float(np.cos(self.pair.beta_p) / np.cos(self.pair.beta_r))

    def rigid(self, records: np.ndarray, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return places of gears (n,) by gain and runout at angles (k,) of the pinion, and their rates; shape
        (n, k, m), supports at 0. A course is that of the series."""
        flank, speed, size = records["mesh"]["flank"], self.speed, self.forces.statics.size
        towards_e, towards_y, gain = (flank[name][:, None] for name in ("eccentric_e", "eccentric_y", "gain"))
        sin, cos = np.sin(angles), np.cos(angles)
        across, lift = towards_y * sin + towards_e * cos, towards_y * cos - towards_e * sin
        places, rates = (np.zeros((len(records), len(angles), size)) for _ in range(2))
        places[..., RACK], rates[..., RACK] = gain * angles, gain * speed
        if self.pair.course is not None:
            places[..., RACK], rates[..., RACK] = (
                self.pair.travel_at(angles),
                self.pair.gain_at(angles) * speed,
            )
        places[..., PINION], rates[..., PINION] = -angles, -speed
        if self.body == "rack":
            places[..., PINION] += self.share * across / gain
            rates[..., PINION] += self.share * lift / gain * speed
        else:
            places[..., RACK] += self.share * across
            rates[..., RACK] += self.share * lift * speed
        places[..., Y] = places[..., PLUNGER] = lift
        rates[..., Y] = rates[..., PLUNGER] = -across * speed
        return places, rates

    def adjusted(self, records: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return records whose yokes are adjusted so that the preload acts at rest, the places of their racks
        along Y there (n,) [m], and which teeth carry the preload (n,)."""
        ideal, n = records.copy(), len(records)
        flank, spring = ideal["mesh"]["flank"], records["spring"]
        flank["friction"], flank["law"], ideal["is_supported"] = 0.0, PLAIN, 0
        flank["eccentric_e"] = flank["eccentric_y"] = 0.0
        x, y, residual = np.zeros(n), flank["axis_offset"] - TYPICAL_APPROACH, np.zeros(n)
        loads, works = np.ascontiguousarray(spring["preload"]), self.forces.works
        find_approach(self.forces.law, loads, x, y, ideal, self.forces.pool, works, residual)
        if len(self.forces.supported):
            y -= at_rest(records["support"], loads)[1]
        seat, made = records["seat"], records.copy()
        density, form = 2 * seat["half_length"] * seat["density"], (seat["over_y"], seat["over_z"])
        made["seat"]["rest_gap"] = pressed_seat(loads, density, seat["half_angle"], *form).depth - y
        return made, y, residual <= CLOSE

    def follow(
        self,
        records: np.ndarray,
        angles: np.ndarray,
        per_pitch: int,
        response: MotionResponse,
        features: np.ndarray,
    ) -> Found:
        """Follow gears (n,) with features (n, f) over even angles (k,) [rad] at which motion is known."""
        balance, n, k = self.forces.statics, len(records), len(angles)
        m = balance.size
        gears, resting, carried = self.adjusted(records)
        places, rates = self.rigid(gears, angles)
        beside, turning = response.of_gears(features)
        places += beside
        places[..., Y] += (resting + self.forces.approach)[:, None]
        rates += turning
        driven = COORDINATE_BLOCKS[self.body].start
        coordinates, speeds = places.copy(), rates.copy()
        x, yaw, pitch = (places[..., i] for i in (RACK, YAW, PITCH))
        coordinates[..., Y] += x * pitch
        coordinates[..., Z] -= x * yaw
        speeds[..., Y] += rates[..., RACK] * pitch + x * rates[..., PITCH]
        speeds[..., Z] -= rates[..., RACK] * yaw + x * rates[..., YAW]
        time = np.abs(angles - angles[0]) / abs(self.speed)
        forces, outputs = np.zeros((n, k, m)), np.zeros((n, k, OUTPUTS))
        ended, counts = np.zeros(n, dtype=np.int64), np.zeros((n, 5))
        follow(
            self.forces.law,
            0,
            time,
            per_pitch,
            places,
            rates,
            balance.free(driven),
            balance.lengths,
            np.zeros((k, m)),
            NO_COLUMN,
            np.zeros(k),
            NOTHING_ACCELERATED,
            ACCEPT,
            coordinates,
            speeds,
            forces,
            outputs,
            np.zeros((n, k, 2, 0)),
            gears,
            self.forces.pool,
            self.forces.works,
            ended,
            counts,
            room_to_follow(k, m),
        )
        sense = 1.0 if self.body == "rack" else -1.0
        record = Record(
            self.forces,
            time,
            coordinates,
            speeds,
            -sense * forces[..., driven],
            self.body,
            np.zeros((n, k)),
            known=outputs,
        )
        taken = {"steps": ended} | dict(zip(COUNTERS, counts.T, strict=False))
        return Found(record, carried & (ended == k), resting, taken)

    def beside_rigid(self, found: Found, records: np.ndarray, angles: np.ndarray) -> np.ndarray:
        """Return places (n, k, m) at the mesh of gears found, beside gain, runout and the preload's."""
        at, (rigid, _) = found.record.coordinates.copy(), self.rigid(records, angles)
        x = at[..., RACK].copy()
        at[..., Y] -= x * at[..., PITCH]
        at[..., Z] += x * at[..., YAW]
        at -= rigid
        at[..., Y] -= (found.resting + self.forces.approach)[:, None]
        return at
