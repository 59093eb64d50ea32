"""Signals of the steering column in a recorded motion, and equilibria of the pinion seen from the wheel."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rps_exudyn.solvers.drive import Drive
from rps_exudyn.solvers.steering_column import SteeringColumn
from rps_exudyn.solvers.wheel_torque import WheelTorque

if TYPE_CHECKING:
    from rps_exudyn.solvers.record import Record


def driven_rate(record: "Record") -> np.ndarray:
    """Return the rate of the driven body in the sense of travel along +X, shape (n,) [rad/s or m/s]."""
    if record.driven == "rack":
        return record.of_rates("rack")[..., 0]
    if record.driven == "wheel":
        assert record.wheel is not None
        return record.wheel[:, 1]
    return -record.of_rates("pinion")[..., 0]


def of_column(record: "Record") -> dict[str, np.ndarray]:
    """Return the signals of wheel and column at each instant, the power lost by the name of its work; {}
    where the rig does not turn the wheel."""
    column = record.column
    if column is None or record.wheel is None:
        return {}
    angle, rate = record.wheel.T
    ratio = column.ratio(angle)
    twist = column.output(angle) + record.of("pinion")[:, 0]
    twisting = ratio * rate + record.of_rates("pinion")[:, 0]
    torque = column.torque(twist, twisting)
    lost = column.damping * twisting**2
    return {
        "wheel_angle": angle,
        "pinion_torque": torque,
        "column_torque": ratio * torque,
        "column_twist": twist,
        "column_energy": 0.5 * column.stiffness * twist**2,
        "work_column_damping": lost,
    }


def under_torque(record: "Record", column: SteeringColumn, drive: WheelTorque, angle: np.ndarray) -> "Record":
    """Return the record of a pinion as that of the wheel at angles (n,) [rad] that a torque turns."""
    twist = column.output(angle) + record.of("pinion")[:, 0]
    twisting = _backward(twist, record.time) - record.of_rates("pinion")[:, 0]
    return replace(
        record,
        drive=drive.torque(record.time),
        driven="wheel",
        wheel=np.column_stack([angle, twisting / column.ratio(angle)]),
        column=column,
        tyre=drive.tyre,
    )


def _backward(values: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Rate of values (n,) over time [s]."""
    return np.gradient(values, time) if time.size > 1 else np.zeros_like(values)


def behind_column(record: "Record", column: SteeringColumn, wheel: Drive) -> "Record":
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
