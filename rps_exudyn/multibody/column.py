"""Steering wheel and column in an Exudyn system: a mass that turns, and what twists before the pinion.

Without a universal joint that is Exudyn's spring-damper between two coordinates; with one, an object over
both coordinates, whose torque on the wheel is that on the pinion times the joint's ratio.
"""

from typing import Any

import numpy as np
from exudyn import itemInterface as items

from rps_exudyn.multibody.bodies import add_forces, add_turning_mass, coordinate_marker
from rps_exudyn.multibody.steering_model import SteeringModel
from rps_exudyn.solvers.steering_column import ColumnModel, WheelTorque


def add_column(model: SteeringModel, column: ColumnModel) -> None:
    """Add the wheel where its drive starts, and the column between it and the pinion."""
    place, rate = model.drive.of_time
    add_turning_mass(model, "wheel", column.inertia, ([place(0.0)], [rate(0.0)]))
    if column.bend:
        add_forces(
            model.mbs,
            [model.nodes[name] for name in ("wheel", "pinion")],
            2,
            lambda q, v: jointed_forces(q, v, column),
            lambda q, v, factor_q, factor_v: jointed_tangent(q, v, column, factor_q, factor_v),
        )
    else:
        markers = [coordinate_marker(model, model.nodes[name]) for name in ("wheel", "pinion")]
        given = {"stiffness": column.stiffness, "damping": column.damping}
        model.mbs.AddObject(items.CoordinateSpringDamper(markerNumbers=markers, **given))


def add_wheel_torque(model: SteeringModel, drive: WheelTorque) -> None:
    """Add the hand's torque on the wheel, and the tyres' spring between the ground and the rack."""
    mbs = model.mbs

    def torque(mbs: Any, t: float, load: float) -> float:
        return drive.sign * float(drive.torque(t))

    ground, wheel, rack = (
        coordinate_marker(model, node)
        for node in (mbs.AddNode(items.NodePointGround()), model.nodes["wheel"], model.nodes["rack"])
    )
    mbs.AddLoad(items.LoadCoordinate(markerNumber=wheel, load=0.0, loadUserFunction=torque))
    mbs.AddObject(
        items.CoordinateSpringDamper(
            markerNumbers=[ground, rack], stiffness=drive.tyre.stiffness, offset=drive.tyre.relaxed
        )
    )


def jointed_forces(q: np.ndarray, v: np.ndarray, column: ColumnModel) -> np.ndarray:
    """Return the torques (2,) on wheel and pinion [N m]; their coordinates count against the angles."""
    ratio, twist, twisting = column.twisted((-q[0], -v[0]), q[1], v[1])
    torque = float(column.torque(twist, twisting))
    return np.array([ratio * torque, -torque])


def jointed_tangent(
    q: np.ndarray, v: np.ndarray, column: ColumnModel, factor_q: float, factor_v: float
) -> np.ndarray:
    """Return factor_q dF/dq + factor_v dF/dv of `jointed_forces`, shape (2, 2)."""
    ratio, twist, twisting = column.twisted((-q[0], -v[0]), q[1], v[1])
    slope, torque = float(column.ratio_slope(-q[0])), float(column.torque(twist, twisting))
    of_place = np.array([-column.stiffness * ratio + column.damping * slope * v[0], column.stiffness])
    of_rate = column.damping * np.array([-ratio, 1.0])
    torque_slope = factor_q * of_place + factor_v * of_rate
    turning: Any = np.array([-factor_q * slope * torque, 0.0])
    return np.array([ratio * torque_slope + turning, -torque_slope])
