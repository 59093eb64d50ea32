"""Whether a steadily driven gear vibrates by itself, or goes on vibrating: eigenvalues along its record.

Friction between parts that yield can feed a vibration; nothing else may damp it much. Implicit steps damp
what is faster than they are, so that a record looks smooth in which the gear in truth shakes. The linearised
motion tells.
"""

import numpy as np

from rps_exudyn.multibody.steering_model import SteeringModel
from rps_exudyn.solvers.balance import eigenvalues, slopes
from rps_exudyn.solvers.record import Record

INSTANTS = 12  # of a record at which the motion is linearised
SLOWEST = 0.5  # radians of a vibration in one step; slower ones the record shows itself


def vibration(model: SteeringModel, record: Record) -> dict[str, float]:
    """Return by how many powers of e the fastest growing vibration grows over a record, and by how many that
    one dies which dies most slowly; nothing of spheres, of a bush of segments and of bristles, whose
    tangents are others, and nothing behind a column, whose scenes look for themselves."""
    others = model.contacts is not None or bool(model.segments) or model.forces.dynamics.has_bristles
    if others or model.column is not None or len(record.time) < 2:
        return {}
    some = np.unique(np.linspace(0, len(record.time) - 1, INSTANTS).astype(int))
    step, time = float(np.median(np.diff(record.time))), record.time[some]
    mass = np.array(model.mbs.sys["dynamicSolver"].GetSystemMassMatrix())
    held = (model.drive.coordinate, *model.forces.locked)
    free = np.array([i for i in range(len(mass)) if i not in held])
    by_place, by_rate = (
        each[:, free[:, None], free]
        for each in slopes(model.forces.dynamics, record.coordinates[some], record.rates[some])
    )
    values = eigenvalues(mass[np.ix_(free, free)], by_place, by_rate)
    rates = np.where(np.abs(values.imag) * step > SLOWEST, values.real, -np.inf).max(axis=1)
    if not np.isfinite(rates).all():  # where nothing vibrates so fast
        return {}
    return {
        "vibration_grows": float(np.trapezoid(np.maximum(rates, 0.0), time)),
        "vibration_dies": float(-np.trapezoid(rates, time)),
    }
