"""The reduced gear as C: the header `gear_data.h`, which the sources of the FMU include."""

from collections.abc import Iterable

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.closed_form import bush_drag
from rps_exudyn.solvers.reduced_gear import ReducedGear
from rps_exudyn.solvers.temperature_and_wear import friction_factor, tested_gear

LEAST_COMPLIANCE = 1e-10  # of the rack under a load, by which one is sought at the least [m/N]
TEMPERATURES = np.arange(233.15, 374.0, 10.0)  # at which the conditions' laws are asked [K]


def header(gear: SteeringGear, reduced: ReducedGear, parameters: Iterable[float], token: str) -> str:
    """Return the header of a gear's table; `gear` is as given, the table that of the gear in operation."""
    tested = tested_gear(gear)
    operation = operation_table(gear, reduced)
    step, spacing = (float(each[1] - each[0]) for each in (reduced.angles, reduced.loads))
    least = max(float(-np.diff(reduced.error, axis=1).max() / spacing), LEAST_COMPLIANCE)
    numbers = {
        "GAIN": reduced.gain, "INERTIA": reduced.inertia, "DAMPING": reduced.damping,
        "FIRST_ANGLE": reduced.angles[0], "ANGLE_STEP": step, "LEAST_LOAD": reduced.loads[0],
        "LOAD_STEP": spacing, "LEAST_COMPLIANCE": least, "CONSTANT": reduced.constant,
        "SEAT_SHARE": reduced.seat_share, "TABLE_PRELOAD": tested.yoke.preload,
        "MESH_FRICTION_OF_TABLE": tested.mesh.friction, "YOKE_FRICTION_OF_TABLE": tested.yoke.friction,
    }  # fmt: skip
    counts = {
        "CELLS": len(reduced.angles) - 1, "ROWS": len(reduced.loads) - 1, "REPEATS": int(reduced.repeats),
        "ELEMENTS": len(reduced.shares), "SPEEDS": len(reduced.speeds), "TEMPERATURES": len(operation),
    }  # fmt: skip
    arrays = {
        "FREE": reduced.free, "COURSE": reduced.course, "UNDER_LOAD": reduced.loaded,
        "LIMIT": reduced.friction, "SHARE": reduced.shares, "STIFFNESS": reduced.stiffness,
        "NODE_SPEED": reduced.speeds,
        "SPEED_FACTOR": reduced.speed_factor, "OPERATION": operation,
        "PARAMETERS": np.array(list(parameters)),
    }  # fmt: skip
    lines = [
        "/* One gear: made by rps-exudyn export. SI units. */",
        "#ifndef GEAR_DATA_H",
        "#define GEAR_DATA_H",
        f'#define TOKEN "{token}"',
        *(f"#define {name} {value}" for name, value in counts.items()),
        *(f"#define {name} ({float(value)!r})" for name, value in numbers.items()),
        *(f"static const double {name}{_shape(each)} = {_braces(each)};" for name, each in arrays.items()),
        "#endif",
    ]
    return "\n".join(lines) + "\n"


def operation_table(gear: SteeringGear, reduced: ReducedGear) -> np.ndarray:
    """Return what temperatures make of a gear, (t, 6): temperature, factor and summand of the preload, factor
    of the plunger's friction, friction that no load changes over that of the table, and viscous drag.

    Temperatures for which the laws of `temperature_and_wear` do not hold are left out.
    """
    rows = []
    for kelvin in sorted({*TEMPERATURES.tolist(), gear.conditions.temperature}):
        warm = gear.replace({"conditions.temperature": kelvin})
        more = warm.replace({"yoke.preload": 1.01 * gear.yoke.preload}) if gear.yoke.preload else warm
        try:
            here, there = tested_gear(warm), tested_gear(more)
        except InputError:
            continue
        change = more.yoke.preload - warm.yoke.preload
        factor = (there.yoke.preload - here.yoke.preload) / change if change else 1.0
        coulomb = here.replace({"bush.viscous_drag": 0.0})
        fixed = reduced.gain * bush_drag(coulomb, reduced.gain) + gear.bearing.friction_torque
        share = fixed / reduced.constant if reduced.constant else 1.0
        drag = here.bush.viscous_drag * reduced.gain_squared
        summand = here.yoke.preload - factor * gear.yoke.preload
        rows.append((kelvin, factor, summand, friction_factor(warm), share, drag))
    return np.array(rows if len(rows) > 1 else rows * 2)


def _shape(values: np.ndarray) -> str:
    return "".join(f"[{size}]" for size in values.shape)


def _braces(values: np.ndarray) -> str:
    if values.ndim == 1:
        return "{" + ", ".join(f"{value:.17g}" for value in values.tolist()) + "}"
    return "{" + ",\n".join(_braces(each) for each in values) + "}"
