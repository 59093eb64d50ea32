"""What the loop found of some gears over one leg: signals, works, and whether single runs would be ok."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from rps_exudyn.analysis.many import spread
from rps_exudyn.analysis.resolution import every_second, lag, missed
from rps_exudyn.analysis.torque import mean
from rps_exudyn.checks.after_run import LAG_BOUND, MISSED_TORQUE, ROUNDING, edge_bound
from rps_exudyn.checks.needs_finer import MEAN, PEAK, ROLLING
from rps_exudyn.simulate.loop_design import LEAD, Design
from rps_exudyn.solvers.gear_loop import BUSH, FORCE, MESH, PLUNGER, SEAT
from rps_exudyn.solvers.gear_numbers import COLUMN, LOAD
from rps_exudyn.solvers.many_gears import COARSE, PINION, RACK, Found, Rows
from rps_exudyn.solvers.record import axis_at_pitch_point

STEADY = 2e-3  # of torque and travel: what drifts more over a period is left to a single run
SAFE = 0.8  # of a bound, from which on a single run judges


@dataclass(frozen=True, eq=False)
class LegRecord:
    """Some gears over one leg; arrays have one row for each gear."""

    design: Design
    rows: Rows
    found: Found
    features: np.ndarray  # (n, f)

    @classmethod
    def of(cls, design: Design, rows: Rows, chosen: np.ndarray) -> "LegRecord":
        """Follow the chosen gears."""
        some, features = rows.of(chosen), design.features[chosen]
        found = design.loop.follow(some, design.nodes, design.per_pitch, design.known, features, COARSE)
        return cls(design, some, found, features)

    def some(self, chosen: np.ndarray) -> "LegRecord":
        """Return the record of some of its gears; `chosen` is a mask (n,)."""
        found = replace(
            self.found, **{each.name: getattr(self.found, each.name)[chosen] for each in fields(self.found)}
        )
        return replace(
            self, rows=self.rows.of(np.flatnonzero(chosen)), found=found, features=self.features[chosen]
        )

    def number(self, part: str, name: str) -> np.ndarray:
        """One of the gears' numbers, shape (n, 1)."""
        return self.rows.numbers[:, COLUMN[part, name], None]

    @cached_property
    def signals(self) -> dict[str, np.ndarray]:
        """Signals over the record's first period, (n, m) each."""
        over_record = self.design.between.over_record
        columns = over_record(self.found.out, self.features, [FORCE, *range(8)])
        rack = np.moveaxis(columns[1 + RACK : 7 + RACK], 0, -1)
        lift = axis_at_pitch_point(rack.reshape(-1, 6)).reshape(*rack.shape[:2], 2)
        plunger, force, sense = columns[1 + PLUNGER], self.design.leg.force, -1 if self._of_rack else +1
        stop = self._stop(plunger)
        signals = {
            force: sense * columns[0],
            "rack_displacement": rack[..., 0],
            "rack_y": lift[..., 0],
            "rack_roll": rack[..., 3],
            "rack_yaw": rack[..., 4],
            "seat_force": self.number("spring", "preload") + self.number("spring", "rate") * plunger + stop,
            "yokenut_force": stop,
        }
        return signals | ({"pinion_angle": -columns[1 + PINION]} if self._of_rack else {})

    @property
    def _of_rack(self) -> bool:
        return self.design.leg.body == "rack"

    def _stop(self, plunger: np.ndarray) -> np.ndarray:
        """Force of the yokenut [N] at places (n, m) of the plunger."""
        beyond = np.maximum(plunger - self.number("nut", "clearance"), 0.0)
        return np.asarray(self.number("nut", "stiffness") * beyond)

    def whole(self) -> dict[str, np.ndarray]:
        """Signals over all periods, (n, m), but time and a turned pinion's angle, which are alike, (m,)."""
        whole = {name: self._repeated(name, values) for name, values in self.signals.items()}
        return {"time": self.design.time, "pinion_angle": self.design.angle} | whole

    def _repeated(self, name: str, values: np.ndarray) -> np.ndarray:
        """A signal (n, m) of one period over all of them."""
        times = self.design.periods
        if times == 1:
            return values
        grows = name in ("rack_displacement", "pinion_angle")
        rise = values[:, -1:] - values[:, :1] if grows else np.zeros((len(values), 1))
        pieces = [values[:, :-1] + rise * i for i in range(times)]
        return np.concatenate([*pieces, values[:, -1:] + rise * (times - 1)], axis=1)

    @cached_property
    def works(self) -> dict[str, np.ndarray]:
        """Work over one period [J], (n,) each: of drive and load, lost at each place, and stored; over the
        rack's edges goes what the others leave."""
        works = self._lost()
        works["drive"] = np.trapezoid(self.signals[self.design.leg.force], self._path)
        travel = np.diff(self.signals["rack_displacement"][:, [0, -1]])[:, 0]
        works["load"] = self.rows.numbers[:, LOAD] * travel if self.design.leg.weighted else 0.0 * travel
        stored = self._stored()
        lost = sum(works[name] for name in ("mesh", "damping", "seat", "bush", "bearing"))
        works["edges"] = works["drive"] + works["load"] - (stored[:, 1] - stored[:, 0]) - lost
        return works

    def _lost(self) -> dict[str, np.ndarray]:
        """Work that rubs off or is damped [J], (n,) each."""
        record = self.design.record
        turned, m = abs(record[-1] - record[0]), len(record)
        places = [MESH.start + 1, MESH.start + 2, SEAT.start + 1, BUSH.start + 1]
        even = np.full((m, 1), turned / abs(self.design.loop.speed) / (m - 1))
        even[[0, -1]] /= 2
        weighed = self.design.between.weighed(self.found.out, self.features, places, even)[..., 0]
        lost = dict(zip(("mesh", "damping", "seat", "bush"), weighed, strict=True))
        angle = self.signals.get("pinion_angle", record[None])
        own = np.abs(angle[:, -1] - angle[:, 0])  # it turns to one side alone, see `_turns_on`
        return lost | {"bearing": self.number("bearing", "torque")[:, 0] * own}

    def _stored(self) -> np.ndarray:
        """Elastic energy at the begin and the end of the period [J], (n, 2)."""
        at_ends = np.zeros((len(self.design.record), 2))
        at_ends[0, 0] = at_ends[-1, 1] = 1.0
        columns = [MESH.start, SEAT.start, BUSH.start, PLUNGER]
        energies = self.design.between.weighed(self.found.out, self.features, columns, at_ends)
        rate, preload = self.number("spring", "rate"), self.number("spring", "preload")
        return np.asarray(energies[:3].sum(axis=0) + preload * energies[3] + 0.5 * rate * energies[3] ** 2)

    def surely_ok(self) -> np.ndarray:
        """Which gears were found and pass all checks of a finished run well within their bounds, (n,)."""
        design, gear, signals, out = self.design, self.design.gear, self.signals, self.found.out
        force, angle = signals[design.leg.force], design.record
        in_mesh = gear.basic_rack.addendum * gear.pinion.normal_module / 2
        lifted = np.abs(signals["rack_y"] - self.number("mesh", "axis_offset"))
        normal = out[:, :, MESH.start + 3] + out[:, :, MESH.start + 4]
        travel = spread(signals["rack_displacement"])
        late = lag(angle, signals["rack_roll"]) * gear.rack.bar_diameter / 2 / travel
        drift = np.abs(force[:, -1] - force[:, 0]) / np.abs(force).max(axis=-1)
        checks = (
            self.found.found,
            np.isfinite(out).all(axis=(1, 2)),
            (lifted < SAFE * in_mesh).all(axis=-1),
            (normal > 0).all(axis=-1),
            out[:, :, MESH.start + 5].max(axis=-1) < SAFE * design.bound,
            late < SAFE * min(ROLLING, LAG_BOUND),
            missed(angle, force).max(axis=-1) < SAFE * PEAK * self._size(),
            (drift < STEADY) | (not design.maneuver.closes),
            self._works_ok(),
            self._turns_on(),
        )
        return np.asarray(np.logical_and.reduce(checks))

    def _size(self) -> np.ndarray:
        """Size of the drive's force [N m or N], (n,): its mean, or that of friction, of which a weight may
        leave little to the drive."""
        places = ("mesh", "damping", "edges", "seat", "bush", "bearing")
        lost = np.sum([self.works[name] for name in places], axis=0) / np.ptp(self._path, axis=-1)
        return np.maximum(np.abs(mean(self.design.record, self.signals[self.design.leg.force])), lost)

    @property
    def _path(self) -> np.ndarray:
        """Places of the driven body over the record's first period, (m,) [rad] or (n, m) [m]."""
        return self.design.record * (self.number("mesh", "gain") if self._of_rack else 1.0)

    def _works_ok(self) -> np.ndarray:
        """Whether the mean is resolved, and little work goes over the rack's edges, (n,)."""
        design, works = self.design, self.works
        work, hidden = every_second(design.record, self.signals[design.leg.force])
        scale = np.ptp(self._path, axis=-1) / np.ptp(design.record)
        least = MISSED_TORQUE * np.ptp(design.record) + ROUNDING
        larger = np.maximum(np.abs(works["drive"]), np.abs(works["load"]))
        edges = SAFE * edge_bound(design.gear) * larger
        resolved = scale * hidden < np.maximum(SAFE * MEAN * np.abs(scale * work), least)
        return np.asarray(resolved & (np.abs(works["edges"]) < np.maximum(edges, least)))

    def _turns_on(self) -> np.ndarray:
        """Whether the pinion never turns back, (n,)."""
        if not self._of_rack:
            return np.ones(len(self.rows), dtype=bool)
        steps = np.diff(self.signals["pinion_angle"]) * np.sign(self.design.loop.speed)
        return np.asarray((steps > 0).all(axis=-1))

    def seen(self) -> dict[str, np.ndarray]:
        """Signals at the loop's own angles, (n, k), of which remarks on a gear speak."""
        out = self.found.out[:, LEAD:]
        return {
            "pinion_angle": -out[:, :, PINION],
            "mesh_normal_force_drive": out[:, :, MESH.start + 3],
            "mesh_normal_force_coast": out[:, :, MESH.start + 4],
            "mesh_pressure": out[:, :, MESH.start + 7],
            "yokenut_force": self._stop(out[:, :, PLUNGER]),
        }


def joined(records: Sequence[dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
    """Join signals of legs to one record, whose time goes on where it stood."""
    whole = dict(records[0])
    for leg in records[1:]:
        for name, values in leg.items():
            before = whole[name][-1] if name == "time" else 0.0
            whole[name] = np.concatenate([whole[name], before + values], axis=-1)
    return whole
