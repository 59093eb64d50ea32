"""Many gears' free pinion torque by one compiled loop: figures and torque curves, without all other signals.

What the loop cannot judge, gears lost, limits of the contact laws, records that ask for shorter steps, it
leaves to single runs: a row that it gives is one that a single run ends ok.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rps_exudyn.analysis.many import spread
from rps_exudyn.analysis.on_centre import describe_on_centre
from rps_exudyn.analysis.rack_motion import describe_rack
from rps_exudyn.analysis.resolution import every_second, lag, missed
from rps_exudyn.analysis.torque import describe_torque, mean
from rps_exudyn.base.errors import InputError
from rps_exudyn.checks.after_run import (
    LAG_BOUND,
    MISSED_TORQUE,
    ROUNDING,
    edge_bound,
)
from rps_exudyn.checks.before_run import refused
from rps_exudyn.checks.needs_finer import MEAN, PEAK, ROLLING
from rps_exudyn.mesh_contact.steel import BEARABLE_PRESSURE
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.figures import gain
from rps_exudyn.scenes.remarks import remarks
from rps_exudyn.simulate.loop_design import LEAD, Design, Table
from rps_exudyn.solvers.gear_loop import BUSH, FORCE, MESH, PLUNGER, SEAT
from rps_exudyn.solvers.gear_numbers import COLUMN
from rps_exudyn.solvers.gear_rows import RUNOUT, RUNOUT_ANGLE, packed_rows, rows_of_table
from rps_exudyn.solvers.many_gears import COARSE, Found, Rows
from rps_exudyn.solvers.record import axis_at_pitch_point

SCENE = "free-pinion-torque"
FEWEST = 4  # gears for each that is followed to learn from: with fewer single runs are quicker
STEADY = 2e-3  # of torque and travel: what drifts more over a period is left to a single run
TOGETHER = 256  # gears whose signals are held at once
SAFE = 0.8  # of a bound, from which on a single run judges

TABLES = ("basic_rack", "pinion", "rack", "installation", "yoke", "bush", "bearing", "mesh")
NOT_NUMBERS = ("rack.bow", "rack.side_force", "rack.side_angle", "installation.gravity")


@dataclass(frozen=True, eq=False)
class Looped:
    """What the loop found; rows that it leaves to single runs have nan, and no message."""

    ended: np.ndarray  # (n,) whether the row is the loop's
    summary: dict[str, np.ndarray]  # figure -> (n,)
    messages: list[str]
    angle: np.ndarray  # (m,) [rad], in the order in which they are turned
    torque: np.ndarray  # (n, m) [N m]


def why_not(scene: str, gear: SteeringGear, fidelity: Fidelity, values: Mapping[str, Any]) -> str:
    """Return what of a batch the loop does not know, or ""."""
    if scene != SCENE or gear.test.path != "one-way":
        return "the loop knows the scene free-pinion-torque, one way"
    usual = fidelity.replace({"step_angle": Fidelity.preset("quasi-static").step_angle})
    if usual != Fidelity.preset("quasi-static"):
        return "the loop knows the fidelity quasi-static, with its own step_angle"
    if gear.mesh.law == "teeth" or gear.rack.bow or gear.rack.side_force or gear.installation.gravity:
        return "the loop knows no teeth that bend, no bow, side force or weight of the rack"
    laws = {gear.mesh.friction_law, gear.yoke.friction_law, gear.bush.friction_law, gear.bearing.friction_law}
    if laws != {"coulomb"}:
        return "the loop knows Coulomb's friction alone"
    for path, column in values.items():
        number = SteeringGear.declared_at(path)[0]
        known = path.partition(".")[0] in TABLES and path not in NOT_NUMBERS
        if not known or not isinstance(gear.value_at(path), float) or not hasattr(number, "show"):
            return f"the loop does not know how gears differ in {path}"
        if np.asarray(column).dtype.kind not in "fiu":
            return f"the values of {path} are no plain numbers"
    return ""


def looped(
    gear: SteeringGear, fidelity: Fidelity, table: Table, ranges: Table | None = None
) -> Looped | None:
    """Find the torque of gears that differ in a table; None if it cannot begin.

    Args:
        gear: what they have in common.
        fidelity: how they are modelled.
        table: path -> values (n,) in SI.
        ranges: path -> values that tell over what the parameters of a larger table vary of which this is a
            part: then its gears end as in any other part. Without it the table is whole.
    """
    count = len(next(iter(table.values())))
    if ranges is None and count < fewest(table):
        return None
    valid, rows, reference = _rows(gear, fidelity, table, ranges)
    if rows is None or refused(reference, fidelity, steady=True):
        return None
    some = {path: values[valid] for path, values in table.items()}
    design = Design.of(reference, fidelity, some, ranges)
    if design is None:
        return None
    parts = [_part(design, rows, begin) for begin in range(0, len(rows), TOGETHER)]
    return _joined(parts, valid, count, design.angle)


def fewest(table: Table) -> int:
    """Return the number of gears from which a loop over a table is quicker than single runs."""
    return FEWEST * (2 * sum(np.ptp(values) > 0 for values in table.values()) + 1)


def _rows(
    gear: SteeringGear, fidelity: Fidelity, table: Table, ranges: Table | None
) -> tuple[np.ndarray, Rows | None, SteeringGear]:
    """Which gears can exist, their rows, and the reference gear."""
    valid = _within(table, table if ranges is None else ranges)
    for attempt in range(2 if valid.size else 0):
        part = {path: np.asarray(values, dtype=float)[valid] for path, values in table.items()}
        try:
            centre = {path: float(np.median(values)) for path, values in (ranges or part).items()}
            reference = gear.replace(centre | ({RUNOUT: 0.0} if {RUNOUT, RUNOUT_ANGLE} & {*part} else {}))
            full = part | ({RUNOUT: np.full(len(valid), gear.pinion.runout)} if _fixed_runout(part) else {})
            return valid, rows_of_table(reference, fidelity, full, ranges), reference
        except InputError:
            if attempt:
                break
            valid = np.array([row for row in valid.tolist() if _exists(gear, fidelity, table, row)], np.intp)
            if not valid.size:
                break
    return valid, None, gear


def _fixed_runout(table: Mapping[str, Any]) -> bool:
    return RUNOUT_ANGLE in table and RUNOUT not in table


def _within(table: Table, ranges: Table) -> np.ndarray:
    """Rows of a table within the ranges."""
    inside = [(ranges[path].min() <= each) & (each <= ranges[path].max()) for path, each in table.items()]
    return np.flatnonzero(np.logical_and.reduce(inside))


def _exists(gear: SteeringGear, fidelity: Fidelity, table: Table, row: int) -> bool:
    return can_exist(gear, fidelity, {path: float(values[row]) for path, values in table.items()})


def can_exist(gear: SteeringGear, fidelity: Fidelity, settings: Mapping[str, float]) -> bool:
    """Tell whether a gear with other settings can be built."""
    try:
        packed_rows([gear.replace(settings)], fidelity)
    except InputError:
        return False
    return True


def _part(design: Design, rows: Rows, begin: int) -> "_Part":
    """Follow some of the gears and describe them."""
    chosen = np.arange(begin, min(begin + TOGETHER, len(rows)))
    some, features = rows.of(chosen), design.features[chosen]
    found = design.loop.follow(some, design.nodes, design.per_pitch, design.known, features, COARSE)
    return _Part.of(design, some, found, features)


@dataclass(frozen=True, eq=False)
class _Part:
    """Some gears of a loop, described."""

    kept: np.ndarray  # (n,) whether the rows are the loop's
    summary: dict[str, np.ndarray]
    messages: list[str]
    torque: np.ndarray  # (n, m)

    @classmethod
    def of(cls, design: Design, rows: Rows, found: Found, features: np.ndarray) -> "_Part":
        """Signals, figures, checks and remarks of gears that the loop has found."""
        signals = _signals(design, rows, found, features)
        works = _works(design, rows, found, features, signals)
        kept = found.found & _surely_ok(design, rows, found, signals, works)
        whole = {name: _repeated(name, values, design) for name, values in signals.items()}
        whole["pinion_angle"] = design.angle
        gear = design.gear
        summary = {
            **describe_torque(whole["pinion_angle"], whole["pinion_torque"], gear.pinion.teeth),
            **describe_on_centre(whole, gear.pinion.teeth, gear.test.centre_window),
            "rack_gain": gain(whole),
            **describe_rack(whole, float(design.loop.pair.gain)),
            **_shares(works),
        }
        messages = _remarks(design, rows, found, kept)
        blank = {name: np.where(kept, np.asarray(values), np.nan) for name, values in summary.items()}
        return cls(kept, blank, messages, np.where(kept[:, None], whole["pinion_torque"], np.nan))


def _signals(design: Design, rows: Rows, found: Found, features: np.ndarray) -> dict[str, np.ndarray]:
    """Signals over the record's first period, (n, m) each."""
    columns = design.between.over_record(found.out, features, [FORCE, *range(1, 8)])
    rack = np.moveaxis(columns[1:7], 0, -1)
    lift = axis_at_pitch_point(rack.reshape(-1, 6)).reshape(*rack.shape[:2], 2)
    plunger = columns[7]
    rate, preload = (rows.numbers[:, COLUMN["spring", name], None] for name in ("rate", "preload"))
    stop = _stop(rows, plunger)
    return {
        "pinion_torque": columns[0],
        "rack_displacement": rack[..., 0],
        "rack_y": lift[..., 0],
        "rack_roll": rack[..., 3],
        "rack_yaw": rack[..., 4],
        "seat_force": preload + rate * plunger + stop,
        "yokenut_force": stop,
    }


def _repeated(name: str, values: np.ndarray, design: Design) -> np.ndarray:
    """A signal (n, m) of one period over all of them."""
    if design.periods == 1:
        return values
    rise = values[:, -1:] - values[:, :1] if name == "rack_displacement" else np.zeros((len(values), 1))
    pieces = [values[:, :-1] + rise * i for i in range(design.periods)]
    return np.concatenate([*pieces, values[:, -1:] + rise * (design.periods - 1)], axis=1)


def _works(
    design: Design, rows: Rows, found: Found, features: np.ndarray, signals: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Work over one period [J], (n,) each: of the drive, lost at each place, and stored."""
    ends = design.record[[0, -1]]
    duration = abs(ends[1] - ends[0]) / abs(design.loop.speed)
    m, places = len(design.record), [MESH.start + 1, MESH.start + 2, SEAT.start + 1, BUSH.start + 1]
    even = np.full((m, 1), duration / (m - 1))
    even[[0, -1]] /= 2
    lost_there = design.between.weighed(found.out, features, places, even)[..., 0]
    works = dict(zip(("mesh", "damping", "seat", "bush"), lost_there, strict=True))
    works["bearing"] = rows.numbers[:, COLUMN["bearing", "torque"]] * abs(ends[1] - ends[0])
    works["drive"] = np.trapezoid(signals["pinion_torque"], design.record)
    at_ends = np.zeros((m, 2))
    at_ends[0, 0] = at_ends[-1, 1] = 1.0
    energies = design.between.weighed(found.out, features, [MESH.start, SEAT.start, BUSH.start, 7], at_ends)
    rate, preload = (rows.numbers[:, COLUMN["spring", name], None] for name in ("rate", "preload"))
    stored = energies[:3].sum(axis=0) + preload * energies[3] + 0.5 * rate * energies[3] ** 2
    works["stored"] = stored[:, 1] - stored[:, 0]
    lost = sum(works[name] for name in ("mesh", "damping", "seat", "bush", "bearing"))
    works["edges"] = works["drive"] - works["stored"] - lost
    return works


def _shares(works: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The summary's loss fractions; the work that goes over the rack's edges is what the others leave."""
    places = {
        "mesh": works["mesh"] + works["damping"] + works["edges"],
        **{name: works[name] for name in ("seat", "bush", "bearing")},
    }
    whole = sum(places.values())
    return {f"loss_share_{name}": work / whole for name, work in places.items()}


def _surely_ok(
    design: Design,
    rows: Rows,
    found: Found,
    signals: dict[str, np.ndarray],
    works: dict[str, np.ndarray],
) -> np.ndarray:
    """Which gears pass all checks of a finished run well within their bounds, shape (n,)."""
    gear, torque, angle = design.gear, signals["pinion_torque"], design.record
    in_mesh = gear.basic_rack.addendum * gear.pinion.normal_module / 2
    offset = rows.numbers[:, COLUMN["mesh", "axis_offset"], None]
    normal = found.out[:, :, MESH.start + 3] + found.out[:, :, MESH.start + 4]
    size = np.abs(mean(angle, torque))
    travel = spread(signals["rack_displacement"])
    late = lag(angle, signals["rack_roll"]) * gear.rack.bar_diameter / 2 / travel
    work, hidden = every_second(angle, torque)
    drift = np.abs(torque[:, -1] - torque[:, 0]) / np.abs(torque).max(axis=-1)
    least = MISSED_TORQUE * np.ptp(angle) + ROUNDING
    edges = SAFE * edge_bound(gear) * np.abs(works["drive"])
    checks = (
        np.isfinite(found.out).all(axis=(1, 2)),
        (np.abs(signals["rack_y"] - offset) < SAFE * in_mesh).all(axis=-1),
        (normal > 0).all(axis=-1),
        found.out[:, :, MESH.start + 5].max(axis=-1) < SAFE * design.bound,
        late < SAFE * min(ROLLING, LAG_BOUND),
        hidden < np.maximum(SAFE * MEAN * np.abs(work), least),
        missed(angle, torque).max(axis=-1) < SAFE * PEAK * size,
        (drift < STEADY) | (not design.maneuver.closes),
        np.abs(works["edges"]) < np.maximum(edges, least),
    )
    return np.asarray(np.logical_and.reduce(checks))


def _remarks(design: Design, rows: Rows, found: Found, kept: np.ndarray) -> list[str]:
    """Remarks on each gear at the loop's angles, by the function that remarks on single runs."""
    inside = slice(LEAD, LEAD + len(design.nodes) - LEAD)
    columns = {
        "mesh_normal_force_drive": found.out[:, inside, MESH.start + 3],
        "mesh_normal_force_coast": found.out[:, inside, MESH.start + 4],
        "mesh_pressure": found.out[:, inside, MESH.start + 7],
        "yokenut_force": _stop(rows, found.out[:, inside, PLUNGER]),
    }
    pressed = np.minimum(columns["mesh_normal_force_drive"], columns["mesh_normal_force_coast"]).min(axis=1)
    said = kept & (
        (pressed <= 0)
        | (columns["mesh_pressure"].max(axis=1) > BEARABLE_PRESSURE)
        | (columns["yokenut_force"].max(axis=1) > 0)
    )
    clearance = rows.numbers[:, COLUMN["nut", "clearance"]]
    messages = [""] * len(rows)
    for i in np.flatnonzero(said).tolist():
        yoke = design.gear.yoke.model_copy(update={"clearance": float(clearance[i])})
        signals = {name: column[i] for name, column in columns.items()}
        signals["pinion_angle"] = design.nodes[inside]
        messages[i] = "; ".join(remarks(design.gear.model_copy(update={"yoke": yoke}), signals))
    return messages


def _stop(rows: Rows, plunger: np.ndarray) -> np.ndarray:
    """Force of the yokenut [N] at places (n, m) of the plunger."""
    stiffness, clearance = (rows.numbers[:, COLUMN["nut", name], None] for name in ("stiffness", "clearance"))
    return np.asarray(stiffness * np.maximum(plunger - clearance, 0.0))


def _joined(parts: list[_Part], valid: np.ndarray, count: int, angle: np.ndarray) -> Looped:
    """The parts one after the other, in the rows of the table."""
    ended, torque = np.zeros(count, dtype=bool), np.full((count, len(angle)), np.nan)
    ended[valid] = np.concatenate([part.kept for part in parts])
    torque[valid] = np.concatenate([part.torque for part in parts])
    summary = {}
    for name in parts[0].summary:
        summary[name] = np.full(count, np.nan)
        summary[name][valid] = np.concatenate([part.summary[name] for part in parts])
    messages = [""] * count
    for row, message in zip(valid.tolist(), (each for part in parts for each in part.messages), strict=True):
        messages[row] = message
    return Looped(ended, summary, messages, angle, torque)
