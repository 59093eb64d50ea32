"""Many gears of a steady scene at once: the same signals and metrics as single runs, computed together.

Each row that is returned is one that a single run ends ok. What cannot be judged here is left to single
runs: gears without an equilibrium, limits of the contact laws. Error bars come from two levels of the ladder,
each with its maneuvers.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.geometry_report import check_gear
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import RUBBING_PARTS
from rps_exudyn.parameters.gear import SteeringGear, surfaces_of
from rps_exudyn.results.outcome import Remark
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.checks.after_run import unsettled_share
from rps_exudyn.scenes.checks.neglected_inertia import MovedMasses, of_many
from rps_exudyn.scenes.checks.rules import OF_BARS, REMARKS, SHORT_BARS, RuleInput, refused, remarks
from rps_exudyn.scenes.error_bar_terms import bar_terms
from rps_exudyn.scenes.error_bars import error_bars
from rps_exudyn.scenes.ladder import model_at
from rps_exudyn.scenes.maneuver import StepLimits
from rps_exudyn.scenes.scene import Scene, SteadyRecord, SteadyTest
from rps_exudyn.scenes.scene_run import Signals, one_after_another
from rps_exudyn.simulate.shared_maneuver import SAFE, FollowedGears, SharedManeuver, is_alike, signals_of_some
from rps_exudyn.solvers.many_gears import (
    EXACT,
    QUICK,
    RUNOUT,
    RUNOUT_ANGLE,
    Packing,
    Table,
    packed,
    packed_table,
    same_structure,
)
from rps_exudyn.solvers.record import WHERE_DAMPED
from rps_exudyn.solvers.temperature_and_wear import is_new

FEWEST = 2  # gears for each that is followed first: with fewer single runs are quicker
AT_ONCE = 100_000  # instants of gears whose signals are held at once
LEVEL = 1  # of the ladder
WEIGHT = "test.load_mass"
TABLES = ("basic_rack", "pinion", "rack", "installation", "yoke", "bush", "bearing", "mesh")
WITH_MASS = ("basic_rack", "pinion", "rack", "bush")
NOT_NUMBERS = (
    *("rack.bow", "rack.side_force", "rack.side_angle", "rack.travel"),
    *("installation.gravity", "installation.gravity_angle", "installation.gravity_slope"),
)
GAIN = ("pinion.normal_module", "rack.tooth_angle")  # from lock to lock each gear turns by its own angle

UNSUPPORTED = {
    "scene": "the gears of this scene are run singly",
    "fidelity": "many gears are computed together only by the fidelity quasi-static",
    "parts": "a bow, a side force, the rack's weight, listed pitch errors, measured flanks, surfaces or a "
    "sloping back need single runs",
    "course": "gears of variable ratio are run singly where the rack drives",
    "friction": "bristles, or friction of the plunger in its bore or along the pinion, need single runs",
    "conditions": "temperature, wear or a grease needs single runs",
    "parameter": "gears that differ in {path} are run singly",
    "text": "the values of {path} are not plain numbers",
    "few": "the table has too few gears to be computed together, or its middle gear is not found",
}
"""All reasons for which no gears of a table are computed together."""


def unsupported_reason(scene: str, gear: SteeringGear, fidelity: Fidelity, values: Mapping[str, Any]) -> str:
    """Return why the gears of a table cannot be computed together, or ""."""
    usual = Fidelity.preset("quasi-static")
    free = "step_angle", "strip_stations", "pinion"
    same = fidelity.replace({name: getattr(usual, name) for name in free})
    supported = fidelity.pinion == "supported"
    rack, pinion = gear.rack, gear.pinion
    listed = rack.pitch_errors or pinion.pitch_errors or rack.deviation or pinion.deviation
    parts = rack.bow or rack.side_force or rack.back_parallelism or gear.installation.gravity or listed
    reasons = {
        "scene": scene_named(scene).test is None,
        "fidelity": same != usual,
        "parts": bool(parts or surfaces_of(gear)),
        "course": not rack.ratio.is_constant and scene_named(scene).signal != "pinion_torque",
        "conditions": not is_new(gear),
        "friction": any(getattr(gear, part).facts.has_state for part in RUBBING_PARTS)
        or bool(gear.yoke.bore_friction or gear.yoke.bore_damping)
        or bool(supported and gear.pinion.axial_friction),
    }
    if reason := next((name for name, holds in reasons.items() if holds), ""):
        return UNSUPPORTED[reason]
    for path, column in values.items():
        number = SteeringGear.declared_at(path)[0]
        known = path == WEIGHT or (path.rpartition(".")[0] in TABLES and path not in NOT_NUMBERS)
        known &= gear.test.path != "lock-to-lock" or path not in GAIN
        if not known or not isinstance(gear.value_at(path), float) or not hasattr(number, "show"):
            return UNSUPPORTED["parameter"].format(path=path)
        if np.asarray(column).dtype.kind not in "fiu":
            return UNSUPPORTED["text"].format(path=path)
    return ""


@dataclass(frozen=True, eq=False)
class GearTable:
    """Gears found together; rows that are left to single runs have nan, and no remarks."""

    ended: np.ndarray  # (n,) whether the row was found
    summary: dict[str, np.ndarray]  # metric -> (n,)
    errors: dict[str, np.ndarray]  # metric -> half width of its bar, (n,)
    counters: dict[str, np.ndarray]  # what it took -> (n,)
    remarks: list[list[Remark]]
    signals: Signals  # by time, (m,) where all gears have the same, else (n, m)

    def signals_of(self, row: int) -> Signals:
        """Return the signals of one gear, (m,) each, without works of damping where nothing damps."""
        own = signals_of_some(self.signals, row)
        return {name: values for name, values in own.items() if name not in WHERE_DAMPED or values.any()}


def simulate_table(
    scene: str,
    gear: SteeringGear,
    fidelity: Fidelity,
    table: Table,
    ranges: Table | None = None,
    signals: Sequence[str] | None = None,
) -> GearTable | None:
    """Find the signals and metrics of gears that differ in a table; None if that cannot begin.

    The table has path -> values (n,), SI. `ranges` has the values of a larger table of which this one is a
    part: then its gears end as in any other part. `signals` are names of those kept; None keeps all.
    """
    count = len(next(iter(table.values())))
    if ranges is None and count < fewest(table):
        return None
    fine, coarse = (
        TableAtLevel.of(scene, gear, fidelity, level, table, ranges) for level in (LEVEL, LEVEL - 1)
    )
    if fine is None or coarse is None or not np.array_equal(fine.rows, coarse.rows):
        return None
    at_once = max(1, AT_ONCE // sum(len(shared.nodes) for shared in fine.shared_maneuvers))
    parts: list[_Part] = []
    for begin in range(0, len(fine.records), at_once):
        each = np.arange(begin, min(begin + at_once, len(fine.records)))
        gears = [_existing(gear, _settings(table, row)) for row in fine.rows[each].tolist()]
        exist = np.array([one is not None for one in gears], dtype=bool)
        existing = [one for one in gears if one is not None]
        followed, companion = (_GearsAtLevel.of(level, each[exist], existing) for level in (fine, coarse))
        followed, companion = (
            one.some(np.isin(one.chosen, other.chosen))
            for one, other in ((followed, companion), (companion, followed))
        )
        parts += followed.described(companion, signals)
    return _joined(parts, count)


def table_of_metrics(scene: str, gear: SteeringGear, fidelity: Fidelity, table: Table) -> GearTable | None:
    """Find the metrics of gears at level 1, without bars and signals: for searches among many designs, each
    of them with few gears. None if that cannot begin.

    No gear is followed to learn from: all begin with the motion of the middle one. That takes a tenth more
    evaluations of the forces than what 26 gears teach, which cost more. Whether each gear can be built is not
    looked at. Arguments as of `simulate_table`.
    """
    level = TableAtLevel.of(scene, gear, fidelity, LEVEL, table, packing=QUICK, learned={})
    if level is None:
        return None
    count = len(level.rows)
    found = _GearsAtLevel.of(level, np.arange(count), [gear] * count)
    ended = np.ones(len(found.chosen), dtype=bool)
    part = GearTable(ended, found.summary, {}, found.counters, [[] for _ in ended], {})
    return _joined([(level.rows[found.chosen], part)], len(next(iter(table.values()))))


@dataclass(frozen=True, eq=False)
class TableAtLevel:
    """What the gears of a table share in a scene at a level of the ladder, and each one's constants."""

    scene: Scene  # that they run
    shared_maneuvers: list[SharedManeuver]  # one for each maneuver
    recorded: int  # how many of them make the record; the others go beside
    rows: np.ndarray  # of the table, of gears that can exist, (n,)
    records: np.ndarray  # their constants, (n,)
    alike: bool  # whether all have the same masses

    @classmethod
    def of(
        cls,
        name: str,
        gear: SteeringGear,
        fidelity: Fidelity,
        level: int,
        table: Table,
        ranges: Table | None = None,
        packing: Packing = EXACT,
        learned: Table | None = None,
    ) -> "TableAtLevel | None":
        """Compute it; arguments as of `simulate_table`. None if the gear in the middle is not found.

        Gears are followed first over the values `learned`, by default the ranges.
        """
        scene, asked, fidelity = scene_named(name), fidelity, model_at(level, fidelity)
        assert scene.test is not None
        try:
            weighted = is_weighted(scene, gear)
            rows, records, reference = _records(gear, fidelity, table, ranges, weighted, packing)
            if records is None or refused(reference, asked, motion="steady"):
                return None
            same = same_structure(records, packed([reference], fidelity, weighted))
            rows, records = rows[same], records[same]
            if not rows.size:  # each gear has another course
                return None
            some = {path: values[rows] for path, values in table.items()}
            whole = some if ranges is None else ranges
            shaped = reference if is_alike(reference, whole) else reference.replace({RUNOUT: 1e-6})
            maneuvers, beside = scene.test.maneuvers(shaped, fidelity.step_angle, StepLimits())
        except InputError:  # a test that leaves the rack's teeth
            return None
        if weighted and not reference.test.load_mass > 0:
            return None
        shared_maneuvers = []
        for maneuver in [*maneuvers, *([beside] if beside else [])]:
            taught = ranges if learned is None else learned
            shared = SharedManeuver.of(maneuver.halved(level - 1), reference, fidelity, some, taught)
            if shared is None:
                return None
            shared_maneuvers.append(shared)
        alike = not any(path.startswith(WITH_MASS) for path in table)
        return cls(scene, shared_maneuvers, len(maneuvers), rows, records, alike)

    @property
    def test(self) -> SteadyTest:
        """Return the steady test of the scene."""
        assert self.scene.test is not None
        return self.scene.test


def fewest(table: Table) -> int:
    """Return the number of gears from which following a table's gears together is quicker."""
    return FEWEST * (2 * sum(np.ptp(values) > 0 for values in table.values()) + 1)


def is_weighted(scene: Scene, gear: SteeringGear) -> bool:
    """Return whether a weight pulls at the rack in some maneuver of a scene."""
    assert scene.test is not None
    heavy = gear.replace({WEIGHT: 1.0, "test.path": "one-way"})
    maneuvers, _ = scene.test.maneuvers(heavy, float(np.deg2rad(20)), StepLimits())
    return any(maneuver.rack_load for maneuver in maneuvers)


def _records(
    gear: SteeringGear,
    fidelity: Fidelity,
    table: Table,
    ranges: Table | None,
    weighted: bool,
    packing: Packing,
) -> tuple[np.ndarray, np.ndarray | None, SteeringGear]:
    """Which gears can exist, their records, and the reference gear."""
    valid = _within(table, table if ranges is None else ranges)
    for attempt in range(2 if valid.size else 0):
        part = {path: np.asarray(values, dtype=float)[valid] for path, values in table.items()}
        try:
            centre = {path: float(np.median(values)) for path, values in (ranges or part).items()}
            reference = gear.replace(centre | ({RUNOUT: 0.0} if {RUNOUT, RUNOUT_ANGLE} & {*part} else {}))
            fixed = RUNOUT_ANGLE in part and RUNOUT not in part
            full = part | ({RUNOUT: np.full(len(valid), gear.pinion.runout)} if fixed else {})
            return valid, packed_table(reference, fidelity, full, ranges, weighted, packing), reference
        except InputError:
            if attempt:
                break
            exist = [row for row in valid.tolist() if can_exist(gear, fidelity, _settings(table, row))]
            valid = np.array(exist, dtype=np.intp)
            if not valid.size:
                break
    return valid, None, gear


def _within(table: Table, ranges: Table) -> np.ndarray:
    """Rows of a table within the ranges; none without its weight."""
    inside = [(ranges[path].min() <= each) & (each <= ranges[path].max()) for path, each in table.items()]
    weighted = np.greater(table.get(WEIGHT, 1.0), 0.0)
    return np.flatnonzero(np.logical_and.reduce(inside) & weighted)


def _settings(table: Table, row: int) -> dict[str, float]:
    return {path: float(values[row]) for path, values in table.items()}


def _existing(gear: SteeringGear, settings: Mapping[str, float]) -> SteeringGear | None:
    """Return a gear with other settings; None if it cannot be built."""
    try:
        made = gear.replace(settings)
        check_gear(made)
    except InputError:
        return None
    return made


def can_exist(gear: SteeringGear, fidelity: Fidelity, settings: Mapping[str, float]) -> bool:
    """Return whether a gear with other settings can be built."""
    try:
        packed([gear.replace(settings)], fidelity)
    except InputError:
        return False
    return True


@dataclass(frozen=True, eq=False)
class _GearsAtLevel:
    """Gears of a table that were computed together and pass all checks."""

    table: TableAtLevel  # they are of
    chosen: np.ndarray  # which of its gears, (n,)
    gears: list[SteeringGear]  # each of them
    record: SteadyRecord  # of all of them
    counters: dict[str, np.ndarray]  # what it took, (n,) each

    @classmethod
    def of(cls, table: TableAtLevel, chosen: np.ndarray, gears: list[SteeringGear]) -> "_GearsAtLevel":
        """Follow the chosen gears over all maneuvers; those found in each."""
        recorded = table.recorded
        followed = [FollowedGears.of(shared, table.records, chosen) for shared in table.shared_maneuvers]
        kept = np.logical_and.reduce([each.surely_ok() for each in followed])
        some = [gears[i] for i in np.flatnonzero(kept).tolist()]
        joined = one_after_another([each.whole(kept) for each in followed[:recorded]])
        beside = followed[recorded].whole(kept) if len(followed) > recorded else {}
        records = followed[0].records[kept]
        load, series = records["load"]["force"][:, 0], followed[0].shared.series
        gain = series.pair.travel_rule if series.pair.course else records["mesh"]["flank"]["gain"]
        counters = {
            name: np.sum([each.counts[name] for each in followed[:recorded]], axis=0)[kept]
            for name in followed[0].counts
        }
        record = SteadyRecord(table.shared_maneuvers[0].gear, joined, beside, gain, np.abs(load))
        return cls(table, chosen[kept], some, record, counters)

    def some(self, kept: np.ndarray) -> "_GearsAtLevel":
        """Return those of the gears that a mask (n,) keeps."""
        gears, record = [self.gears[i] for i in np.flatnonzero(kept).tolist()], self.record
        signals, beside = (signals_of_some(each, kept) for each in (record.signals, record.beside))
        gain = record.gain if callable(record.gain) else record.gain[kept]
        some = SteadyRecord(record.gear, signals, beside, gain, record.load[kept])
        counters = {name: each[kept] for name, each in self.counters.items()}
        return type(self)(self.table, self.chosen[kept], gears, some, counters)

    def metrics(self, signals: Signals) -> dict[str, np.ndarray]:
        """Return the metrics of a record of theirs, (n,) each."""
        found = self.table.test.metrics(replace(self.record, signals=signals))
        return {name: np.broadcast_to(values, len(self.gears)) for name, values in found.items()}

    @cached_property
    def summary(self) -> dict[str, np.ndarray]:
        """Their metrics, (n,) each."""
        return self.metrics(self.record.signals)

    def bars(self, coarse: "_GearsAtLevel") -> tuple[dict[str, np.ndarray], np.ndarray]:
        """Return the half widths of the metrics' bars (n,), and whose main metric inertia leaves as it is."""
        scene, shared, values = self.table.scene, self.table.shared_maneuvers[0], self.summary
        signals, gain = self.record.signals, self.record.gain
        bars = error_bars(self.metrics, signals, values, coarse.record.signals, coarse.summary)
        preload = np.array([gear.yoke.preload for gear in self.gears])[:, None]
        middle = replace(MovedMasses.of(shared.gear), preload=preload)
        middle = middle if callable(gain) else replace(middle, gain=gain[:, None])
        masses = middle if self.table.alike else of_many([MovedMasses.of(gear) for gear in self.gears])
        start = shared.start
        findings = {} if shared.maneuver.closes else {"start_unsettled": start.unsettled_behind}
        findings["unsettled_mean"] = unsettled_share(start, signals)
        recorded = signals, values, findings
        terms, measured = bar_terms(scene, shared.fidelity, self.metrics, *recorded, masses)
        given = RuleInput(shared.gear, numbers=measured)
        holds = np.logical_and.reduce([rule.within(given, SAFE) for rule in OF_BARS])
        none = np.zeros(len(self.gears))
        return {name: bars[name] + terms.get(name, none) for name in bars}, holds

    def described(self, coarse: "_GearsAtLevel", names: Sequence[str] | None) -> "list[_Part]":
        """Return the rows of the gears with their metrics, the bars of these from the same gears a level
        below, and the signals of these names, by default all; nothing where no gear is left."""
        if not self.gears:
            return []
        bars, holds = self.bars(coarse)
        if not holds.all():
            return self.some(holds).described(coarse.some(holds), names)
        summary, test = dict(self.summary), self.table.test
        of_test, signals = test.remarks(self.record), self.record.signals
        fidelity = self.table.shared_maneuvers[0].fidelity
        remarks_of_gears = [
            [*met, *own, *remarks(SHORT_BARS, RuleInput(gear, fidelity))]
            for gear, met, own in zip(self.gears, self._limits_met(), of_test, strict=True)
        ]
        if test.formulas is not None:
            by_formula = [test.formulas(each) for each in self.gears]
            for name in dict.fromkeys(name for own in by_formula for name in own):
                summary[name] = np.array([own.get(name, np.nan) for own in by_formula])
        wanted = signals if names is None else names
        kept = {name: signals[name] for name in wanted if name in signals}
        ended = np.ones(len(self.gears), dtype=bool)
        return [
            (
                self.table.rows[self.chosen],
                GearTable(ended, summary, bars, self.counters, remarks_of_gears, kept),
            )
        ]

    def _limits_met(self) -> list[list[Remark]]:
        """Remarks on each gear by the function that remarks on single runs, where there is a cause."""
        signals = self.record.signals
        given = RuleInput(self.gears[0], signals=signals)
        within = np.logical_and.reduce(np.broadcast_arrays(*(rule.within(given) for rule in REMARKS)))
        return [
            [] if within[i] else list(remarks(REMARKS, RuleInput(gear, signals=signals_of_some(signals, i))))
            for i, gear in enumerate(self.gears)
        ]


_Part = tuple[np.ndarray, GearTable]
"""Rows of a table, and what was found in them."""


def _joined(parts: Sequence[_Part], count: int) -> GearTable:
    """The parts one after the other, in the rows of the table."""
    whole = GearTable(np.zeros(count, dtype=bool), {}, {}, {}, [[] for _ in range(count)], {})
    for rows, part in parts:
        whole.ended[rows] = True
        for group in ("summary", "errors", "counters", "signals"):
            columns = getattr(whole, group)
            for name, values in getattr(part, group).items():
                if group == "signals" and values.ndim == 1:
                    columns[name] = values
                else:
                    columns.setdefault(name, np.full((count, *values.shape[1:]), np.nan))[rows] = values
        for row, remarks_of_row in zip(rows.tolist(), part.remarks, strict=True):
            whole.remarks[row] = remarks_of_row
    known = {name: values for name, values in whole.summary.items() if not np.isnan(values).all()}
    return replace(whole, summary=known)


def record_at(gear: SteeringGear, fidelity: Fidelity, level: int, weighted: bool) -> np.ndarray | None:
    """Return the record (1,) of a gear at a level of the ladder; None if it cannot exist."""
    try:
        return packed([gear], model_at(level, fidelity), weighted)
    except InputError:
        return None


def metrics_nearby(
    scene: str,
    gear: SteeringGear,
    fidelity: Fidelity,
    level: int,
    gears: Sequence[SteeringGear],
    records: Sequence[np.ndarray],
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return which gears (n,) were computed together, and their metrics (n,), nan of the others.

    The gears are so near to a reference that its motion is a good guess of theirs: none is followed first.

    The reference is the first of the gears, which can exist; `record_at` makes their records (1,).
    """
    together, chosen, model = np.zeros(len(gears), dtype=bool), scene_named(scene), model_at(level, fidelity)
    assert chosen.test is not None
    maneuvers, beside = chosen.test.maneuvers(gear, model.step_angle, StepLimits())
    shared = [
        SharedManeuver.of(each.halved(level - 1), gear, model, {WEIGHT: np.zeros(len(gears))})
        for each in [*maneuvers, *([beside] if beside else [])]
    ]
    joined = np.zeros(len(gears), records[0].dtype)
    for row, record in enumerate(records):
        joined[row] = record[0]
    alike = np.flatnonzero(same_structure(joined, joined[:1]))
    if None in shared or not alike.size:
        return together, {}
    found = [each for each in shared if each is not None]
    table = TableAtLevel(chosen, found, len(maneuvers), np.arange(len(gears)), joined, alike=True)
    ended = _GearsAtLevel.of(table, alike, [gears[i] for i in alike.tolist()])
    together[ended.chosen] = True
    metrics = {name: np.full(len(gears), np.nan) for name in ended.summary}
    for name, values in ended.summary.items():
        metrics[name][ended.chosen] = values
    return together, metrics
