"""A recorded motion, of whatever solver, and its signals: places, forces, works, energy.

From coordinates and rates the parts' force laws (`gear_model`) give normal forces, stored energy and what
each contact dissipates, independently of the sums that the solver used: a balance that closes is therefore
evidence.
"""

from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from rps_exudyn.analysis.work_balance import integral_from_start
from rps_exudyn.forces import pinion_support
from rps_exudyn.forces.force_element import (
    COORDINATE_BLOCKS,
    DAMPING_POWER,
    ELASTIC_ENERGY,
    ENERGY_TERMS,
    FRICTION_POWER,
    FRICTION_STATE,
    Part,
)
from rps_exudyn.forces.friction import PLACES, TIME
from rps_exudyn.results.quantities import SIGNALS, WORKS
from rps_exudyn.solvers.bent_rack import ALONG_BAR, ON_BAR, BentBar
from rps_exudyn.solvers.equilibrium import SETTLED, EquilibriumPath, Start
from rps_exudyn.solvers.gear_forces import GearForces
from rps_exudyn.solvers.gear_model import COLUMNS
from rps_exudyn.solvers.prescribed_motion import OVERCOME, Drive, DrivenBody
from rps_exudyn.solvers.steering_column import ColumnModel, TyreSpring, WheelTorque

WHERE_DAMPED = {"work_seat_damping", "work_yokenut_damping"}  # of parts that need not be
# Of `instant_signals`, no signals of a result; the last before the name of a work summed up over steps
MESH_ENERGY, LOAD_ENERGY, SO_FAR = "mesh_energy", "load_energy", "so_far_"
MESH_TAKEN = f"{SO_FAR}mesh"  # what the teeth took from the bodies
AT_MESH = (0.0, ALONG_BAR)  # where mesh and yoke stand
# Signals of what is not prescribed, in the order of the coordinates
COORDINATES = ("rack_y", "rack_z", "rack_roll", "rack_yaw", "rack_pitch", "plunger_displacement")


@dataclass(frozen=True, eq=False)
class Record:
    """A recorded motion; arrays have one row per step. Those of many gears over the same instants have one
    more axis, the first, but for the time."""

    forces: GearForces
    time: np.ndarray  # [s]
    coordinates: np.ndarray  # (n, .) stacked as in `gear_model`
    rates: np.ndarray  # the same
    # torque on the pinion or the wheel [N m] or force on the rack [N], in the sense of travel along +X
    drive: np.ndarray
    driven: DrivenBody  # body on which it acts
    energy: np.ndarray  # kinetic, and elastic of what is no force element [J]
    contact: np.ndarray | None = None  # the solver's own contact forces on pinion and rack, (n, 7)
    pulse_power: np.ndarray | None = None  # of what shakes the rack [W]
    start: Start = SETTLED  # how far it depends on how the gear came there
    begun: np.ndarray | None = None  # (n, .) state of the bristles at the start of the steps that end here
    wheel: np.ndarray | None = None  # (n, 2) angle and rate of the wheel, where the rig turns it [rad, rad/s]
    column: ColumnModel | None = None  # behind it
    tyre: TyreSpring | None = None  # at the rack, where a torque turns the wheel
    known: np.ndarray | None = None  # (n, .) outputs of all parts, if they are known already

    def since(self, time: float) -> "Record":
        """Return what comes after a time [s]: the part that begins with the last step until then.

        A solver that had to reduce its step does not meet given times any more.
        """
        kept = self.time >= self.time[self.time <= time].max(initial=-np.inf)
        values = {item.name: getattr(self, item.name) for item in fields(self)}
        rows = {name: each for name, each in values.items() if isinstance(each, np.ndarray)}
        return replace(self, **{name: each[kept] for name, each in rows.items()})

    def of(self, body: str) -> np.ndarray:
        """Return the coordinates of one body, shape (n, .)."""
        return self.coordinates[..., COORDINATE_BLOCKS[body]]

    @property
    def bar(self) -> BentBar | None:
        """Return the rack's bar, where it bends or is not straight."""
        return self.forces.bar

    @cached_property
    def all_outputs(self) -> np.ndarray:
        """Outputs of all parts at every step, shape (n, `gear_model.OUTPUTS`)."""
        if self.known is not None:
            return self.known
        return self.forces.outputs(self.coordinates, self.rates, self.time, self.begun)

    def outputs(self, part: Part) -> np.ndarray:
        """Return a part's output at every step: forces, energy terms, own values; shape (n, .).

        Forces on a rack that bends are those on the local pose.
        """
        return self.all_outputs[..., COLUMNS[part.name]]

    @cached_property
    def slip_rates(self) -> np.ndarray:
        """Rates with which contacts slip (n, .): the means over the steps where friction has a state."""
        if self.begun is None:
            return self.rates
        before = self.begun[:, PLACES : PLACES + self.coordinates.shape[1]]
        step = (self.time - self.begun[:, TIME])[:, None]
        even = (step > 0) & np.isfinite(step)
        return np.where(even, (self.coordinates - before) / np.where(even, step, 1.0), self.rates)

    def seen_by(self, part: Part) -> tuple[np.ndarray, np.ndarray]:
        """Return coordinates and rates of a part's bodies, (n, .) each: of a rack that bends those of a
        straight one that touches it there; behind those of a mesh stand those of a supported pinion."""
        place = self.bar.places.get(part.name) if self.bar is not None else None
        coordinates, rates = (
            (self.coordinates, self.slip_rates) if place is None else self.straightened(place)
        )
        columns = part.stacked
        if part.name == "mesh" and len(self.forces.supported):
            columns = np.append(columns, np.arange(-pinion_support.SIZE, 0))
        return coordinates[..., columns], rates[..., columns]

    def forces_of(self, part: Part) -> np.ndarray:
        """Return a part's forces on the coordinates that `seen_by` gives, shape (n, .)."""
        if part.name == "mesh" and len(self.forces.supported):
            return self.outputs(pinion_support.PART)[..., -(part.size + pinion_support.SIZE) :]
        return self.outputs(part)[..., : part.size]

    def straightened(self, place: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
        """Return coordinates and rates with those of a straight rack that touches the bar at a place."""
        if self.bar is None:
            return self.coordinates, self.rates
        coordinates, rates, rack = self.coordinates.copy(), self.rates.copy(), COORDINATE_BLOCKS["rack"]
        coordinates[:, rack], rates[:, rack] = self.bar.poses(self.coordinates, self.rates, place)
        return coordinates, rates


def record_of_path(forces: GearForces, path: EquilibriumPath, drive: Drive) -> Record:
    """Return the record of equilibria along a drive's motion.

    Their kinetic energy is the work that was done against the inertia of what follows the drive; behind a
    column that of what is accelerated there, whose loss by long steps the balance shows.
    """
    energy = integral_from_start(-np.einsum("ti,ti->t", path.applied, path.rates), path.time) + path.kinetic
    if forces.bar is not None:
        energy = energy + forces.bar.elastic_energy(path.coordinates)
    return Record(
        forces,
        path.time,
        path.coordinates,
        path.rates,
        drive.overcome(path.forces),
        drive.body,
        energy,
        begun=np.ascontiguousarray(path.kept[:, 0]) if path.kept.shape[2] else None,
        known=path.outputs,
    )


def signals_of(record: Record) -> dict[str, np.ndarray]:
    """Return all signals of a run, by the names of `quantities`."""
    signals = integrated(instant_signals(record), record.time)
    return signals | _of_bent_bar(record)


def instant_signals(record: Record) -> dict[str, np.ndarray]:
    """Return the signals that follow from each instant by itself; powers by the names of their works, and
    `stored_energy` and `work_mesh_edges` as `integrated` takes them."""
    places, _ = record.straightened(AT_MESH)
    rack = places[..., COORDINATE_BLOCKS["rack"]]
    lift = axis_at_pitch_point(rack)
    signals = {
        "pinion_angle": -record.of("pinion")[..., 0],
        OVERCOME[record.driven]: record.drive,
        "rack_displacement": rack[..., 0],
        "rack_y": lift[..., 0],
        "rack_z": lift[..., 1],
        "rack_roll": rack[..., 3],
        "rack_yaw": rack[..., 4],
        "rack_pitch": rack[..., 5],
        "plunger_displacement": record.of("plunger")[..., 0],
        "work_drive": record.drive * _driven(record, record.rates, 1),
    }
    in_column = of_column(record)
    signals |= in_column
    if record.tyre is not None:
        signals["tyre_force"] = record.tyre.force(record.of("rack")[:, 0])
    if record.pulse_power is not None:
        signals["work_load"] = record.pulse_power
    energy = record.energy + in_column.get("column_energy", 0.0)
    for part in record.forces.parts:
        out = record.outputs(part)
        energy_terms = out[..., part.size : part.size + ENERGY_TERMS]
        values = np.moveaxis(out[..., part.size + ENERGY_TERMS :], -1, 0)
        own = dict(zip(part.outputs, values, strict=False))
        if part.name == "mesh":
            signals["work_mesh_edges"] = _over_edges(record, part, out)
            signals[MESH_ENERGY] = energy_terms[..., ELASTIC_ENERGY]
        if part.name == "load":
            signals[LOAD_ENERGY] = energy_terms[..., ELASTIC_ENERGY]
        else:
            energy = energy + energy_terms[..., ELASTIC_ENERGY]
        for loss, column in (("friction", FRICTION_POWER), ("damping", DAMPING_POWER)):
            name = f"work_{part.name}_{loss}"
            if name in SIGNALS and (name not in WHERE_DAMPED or np.any(energy_terms[..., column])):
                signals[name] = energy_terms[..., column]
        signals |= {name: values for name, values in own.items() if name in SIGNALS}
    if not np.any(signals.get("mesh_pressure", 1.0)):  # a contact of spheres has no lines
        del signals["mesh_pressure"]
    if "mesh_normal_force_drive" in signals:
        signals["mesh_normal_force"] = signals["mesh_normal_force_drive"] + signals["mesh_normal_force_coast"]
    return signals | {"stored_energy": energy} | ({} if record.begun is None else _over_steps(record))


def _over_steps(record: Record) -> dict[str, np.ndarray]:
    """Works [J] that are summed up over the steps of a record with bristles, in which friction turns about
    within a step and slip is a mean over it: of drive, teeth and bristles."""
    works = {
        f"{SO_FAR}work_drive": work_along(
            record.drive[:, None], _driven(record, record.coordinates, 0)[:, None]
        )
    }
    for part in record.forces.parts:
        out, rubs = record.outputs(part), f"work_{part.name}_friction"
        if rubs not in SIGNALS:
            continue
        if not part.size:  # its forces are those of the mesh
            works[SO_FAR + rubs] = out[:, ENERGY_TERMS + part.outputs.index(FRICTION_STATE[0])]
            continue
        places, rates = record.seen_by(part)
        if record.bar is not None:
            places = integral_from_start(rates.T, record.time).T
        taken = -work_along(record.forces_of(part), places)
        if part.name == "mesh":
            works[MESH_TAKEN] = taken
        if part.name in record.forces.with_bristles:
            works[SO_FAR + rubs] = out[:, part.size + ENERGY_TERMS + part.outputs.index(FRICTION_STATE[0])]
        elif part.name != "mesh":  # what its forces take is rubbed off or stored
            damped = integral_from_start(out[:, part.size + DAMPING_POWER], record.time)
            works[SO_FAR + rubs] = taken - out[:, part.size + ELASTIC_ENERGY] - damped
    return works


def work_along(forces: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Work of forces (n, m) along places (n, m) from the start (n,), by the trapezoidal rule."""
    steps = np.einsum("ti,ti->t", forces[1:] + forces[:-1], np.diff(places, axis=0)) / 2
    return np.concatenate([[0.0], np.cumsum(steps)])


def integrated(signals: dict[str, np.ndarray], time: np.ndarray) -> dict[str, np.ndarray]:
    """Return signals of `instant_signals` with works [J] in place of powers, energies from the start, and the
    time from 0; `time` (n,) [s]."""
    whole, powers = {"time": time - time[:1]}, [name for name in signals if name.startswith("work_")]
    works = integral_from_start(np.stack([signals[name] for name in powers]), time)
    taken = dict(zip(powers, works, strict=True))
    for name, values in signals.items():
        if name in (MESH_ENERGY, LOAD_ENERGY):
            continue
        if name.startswith(SO_FAR):
            whole[name.removeprefix(SO_FAR)] = values - values[..., :1]
        elif name == "stored_energy":
            whole[name] = values - values[..., :1]
        else:
            whole[name] = taken.get(name, values)
    if MESH_ENERGY in signals:
        stored = signals[MESH_ENERGY]
        if MESH_TAKEN in signals:
            given = whole["work_mesh_friction"] + whole["work_mesh_damping"]
            whole["work_mesh_edges"] = whole.pop("mesh") - given
        whole["work_mesh_edges"] = whole["work_mesh_edges"] - (stored - stored[..., :1])
    if LOAD_ENERGY in signals:
        raised = signals[LOAD_ENERGY] - signals[LOAD_ENERGY][..., :1]
        whole["work_load"] = whole.get("work_load", 0.0) - raised
    return whole


def _over_edges(record: Record, mesh: Part, out: np.ndarray) -> np.ndarray:
    """Power [W] that loaded material takes along over the edges of the rack, and the mesh's own energy.

    What the teeth's forces take from the bodies, and neither rub off nor damp: the contact laws press along
    the normal only, so that material which enters or leaves loaded does so without a force.
    """
    rates = record.seen_by(mesh)[1]
    taken = -np.einsum("...i,...i->...", record.forces_of(mesh), rates)
    energy_terms = out[..., mesh.size : mesh.size + ENERGY_TERMS]
    return np.asarray(taken - energy_terms[..., FRICTION_POWER] - energy_terms[..., DAMPING_POWER])


def _of_bent_bar(record: Record) -> dict[str, np.ndarray]:
    """Signals of a bar that bends or is not straight; {} of any other."""
    bar = record.bar
    if bar is None:
        return {}
    end = _displaced(record, bar.end, (bar.end, ON_BAR))
    station, _ = bar.places["bush"]
    in_bush = _displaced(record, station - record.of("rack")[:, 0], (station, ALONG_BAR))
    signals = {"rack_end_y": end[:, 0], "rack_end_z": end[:, 1], "rack_bush_y": in_bush[:, 0]}
    signals |= {"rack_bush_z": in_bush[:, 1]}
    if bar.modes:
        signals["bending_energy"] = bar.elastic_energy(record.coordinates)
        signals["work_rack_damping"] = integral_from_start(bar.damping_power(record.rates), record.time)
    return signals


def _displaced(record: Record, station: np.ndarray | float, place: tuple[float, float]) -> np.ndarray:
    """Displacement of the bar's axis along Y and Z at a station [m], shape (n, 2)."""
    rack = record.straightened(place)[0][:, COORDINATE_BLOCKS["rack"]]
    _, b, c = rack[:, 3:].T
    return rack[:, 1:3] + np.column_stack([station * np.sin(c) * np.cos(b), -station * np.sin(b)])


def axis_at_pitch_point(rack: np.ndarray) -> np.ndarray:
    """Return Y and Z of the bar's axis above the pitch point, shape (..., 2) [m], from coordinates (..., 6).

    The reference point travels with the rack, and with it along a tilted axis.
    """
    a, b, c = np.moveaxis(rack[..., 3:], -1, 0)
    along = np.cos(b) * np.cos(c)
    rise = np.cos(a) * np.sin(c) + np.sin(a) * np.sin(b) * np.cos(c)
    swing = np.sin(a) * np.sin(c) - np.cos(a) * np.sin(b) * np.cos(c)
    return np.asarray(rack[..., 1:3] - rack[..., :1] * np.stack([rise, swing], axis=-1) / along[..., None])


def repeated(signals: dict[str, np.ndarray], times: int) -> dict[str, np.ndarray]:
    """Return the signals of one period, whose first instant stands again at its end, over several periods.

    Energies grow from one to the next: a rack under gravity along its bar stores or gives back some in each.
    """
    grows = {"time", "pinion_angle", "rack_displacement"}
    whole = {}
    for name, values in signals.items():
        grown = values[..., -1:] - values[..., :1]
        rise = grown if name in grows or name in WORKS else np.zeros_like(grown)
        periods = [values[..., :-1] + rise * number for number in range(times)]
        whole[name] = np.concatenate([*periods, values[..., -1:] + rise * (times - 1)], axis=-1)
    return whole


def contact_disagreement(record: Record) -> float:
    """Return the largest difference of the solver's own contact forces, over the largest, or 0."""
    if record.contact is None:
        return 0.0
    mesh = next(part for part in record.forces.parts if part.name == "mesh")
    ours = record.outputs(mesh)[:, : mesh.size]
    return float(np.abs(ours - record.contact).max() / np.abs(ours).max())


# --- Wheel and column in a recorded motion


def _driven(record: Record, rows: np.ndarray, column: int) -> np.ndarray:
    """Return place or rate of the driven body in the sense of travel along +X (n,), from coordinates or rates
    of the gear and that column of the wheel's."""
    if record.driven == "wheel":
        assert record.wheel is not None
        return record.wheel[:, column]
    of_body = rows[..., COORDINATE_BLOCKS[record.driven].start]
    return of_body if record.driven == "rack" else -of_body


def of_column(record: Record) -> dict[str, np.ndarray]:
    """Return the signals of wheel and column, the power lost by the name of its work; {} without a wheel."""
    column = record.column
    if column is None or record.wheel is None:
        return {}
    angle = record.wheel[:, 0]
    pinion = COORDINATE_BLOCKS["pinion"].start
    turned = (each[:, pinion] for each in (record.coordinates, record.rates))
    ratio, twist, twisting = column.twisted(record.wheel.T, *turned)
    torque = column.torque(twist, twisting)
    lost = column.damping * twisting**2
    signals = {
        "wheel_angle": angle,
        "pinion_torque": torque,
        "column_torque": ratio * torque,
        "column_twist": column.own_share * twist,
        "column_energy": 0.5 * column.stiffness * twist**2,
        "work_column_damping": lost,
    }
    if column.own_share < 1:
        signals["housing_displacement"] = -(1 - column.own_share) * column.gain * twist
    return signals


def under_torque(record: Record, column: ColumnModel, drive: WheelTorque, wheel: np.ndarray) -> Record:
    """Return the record of a pinion as that of the wheel with its angles and rates (n, 2) [rad, rad/s]."""
    return replace(
        record, drive=drive.torque(record.time), driven="wheel", wheel=wheel, column=column, tyre=drive.tyre
    )


def behind_column(record: Record, column: ColumnModel, wheel: Drive) -> Record:
    """Return the record of a driven pinion as that of the wheel whose motion leads to it."""
    angle, rate = wheel.place(record.time), wheel.rate(record.time)
    torque = column.ratio(angle) * record.drive + column.inertia * wheel.acceleration(record.time)
    return replace(
        record,
        drive=torque,
        driven="wheel",
        energy=record.energy + 0.5 * column.inertia * rate**2,
        wheel=np.column_stack([angle, rate]),
        column=column,
    )
