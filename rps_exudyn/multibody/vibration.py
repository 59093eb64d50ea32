"""Whether a steadily driven gear vibrates by itself, or goes on vibrating: eigenvalues along its record.

Friction between parts that yield can feed a vibration; nothing else may damp it much. Implicit steps damp
what is faster than they are, so that a record looks smooth in which the gear in truth shakes. The linearised
motion tells: an eigenvalue's real part is the rate at which its vibration grows.
"""

import numpy as np

from rps_exudyn.multibody.steering_model import SteeringModel
from rps_exudyn.solvers.record import Record

INSTANTS = 12  # of a record at which the motion is linearised
SLOWEST = 0.5  # radians of a vibration in one step; slower ones the record shows itself


def vibration(model: SteeringModel, record: Record) -> dict[str, float]:
    """Return by how many powers of e the fastest growing vibration grows over a record, and by how many that
    one dies which dies most slowly; nothing of spheres, of a bush of segments and of friction that
    remembers, whose tangents are others."""
    others = model.contacts is not None or bool(model.segments) or model.forces.memory.needed
    if others or len(record.time) < 2:
        return {}
    some = np.unique(np.linspace(0, len(record.time) - 1, INSTANTS).astype(int))
    step, time = float(np.median(np.diff(record.time))), record.time[some]
    values = np.linalg.eigvals(_systems(model, record, some))
    rates = np.where(np.abs(values.imag) * step > SLOWEST, values.real, -np.inf).max(axis=1)
    if not np.isfinite(rates).all():  # where nothing vibrates so fast
        return {}
    return {
        "vibration_grows": float(np.trapezoid(np.maximum(rates, 0.0), time)),
        "vibration_dies": float(-np.trapezoid(rates, time)),
    }


def _systems(model: SteeringModel, record: Record, instants: np.ndarray) -> np.ndarray:
    """Matrices of the linearised motion of what moves freely, as systems of first order, (n, 2m, 2m)."""
    forces, (_, data) = model.forces, model.forces.dynamics
    mass = np.array(model.mbs.sys["dynamicSolver"].GetSystemMassMatrix())
    held = (model.drive.coordinate, *forces.locked)
    free = np.array([i for i in range(len(mass)) if i not in held])
    block, m = np.ix_(free, free), len(free)
    systems = np.zeros((len(instants), 2 * m, 2 * m))
    systems[:, :m, m:] = np.eye(m)
    for system, i in zip(systems, instants, strict=True):
        place, rate = record.coordinates[i], record.rates[i]
        slopes = [
            forces.dynamics_tangent(place, rate, data, *factors)[block]
            for factors in ((1.0, 0.0), (0.0, 1.0))
        ]
        system[m:] = np.linalg.solve(mass[block], np.hstack(slopes))
    return systems
