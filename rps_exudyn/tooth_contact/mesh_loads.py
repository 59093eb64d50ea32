"""Loads of single triangles of the pinion's surface, by the law of `mesh_contact`."""

import numpy as np

from rps_exudyn.base.compiled import CUBE, MATRIX, VECTOR, Array, entry, stacked_zeros
from rps_exudyn.tooth_contact.laws import SCRATCH
from rps_exudyn.tooth_contact.mesh_contact import BALL, BLOCK, TRIANGLE, TRIANGLES, mesh_contact
from rps_exudyn.tooth_contact.wrench import NORMAL_COAST, NORMAL_DRIVE


def mesh_loads(
    angles: np.ndarray, positions: np.ndarray, turns: np.ndarray, record: np.ndarray, pool: np.ndarray
) -> np.ndarray:
    """Return the normal force on each triangle of the pinion in n poses at rest, shape (n, triangles) [N].

    Args:
        angles: the pinion's turns about k (n,) [rad].
        positions: the rack's reference points (n, 3) [m].
        turns: the rack's rotation matrices, rack -> housing (n, 3, 3).
        record, pool: those of `triangles.triangles_of`.
    """
    loads = np.zeros((len(angles), int(record[0]["triangle_count"])))
    fill_mesh_loads(angles, positions, turns, record.copy(), pool, np.zeros(1, SCRATCH), loads)
    return loads


@entry(VECTOR, MATRIX, CUBE, Array(TRIANGLES, 1), VECTOR, Array(SCRATCH, 1), MATRIX)
def fill_mesh_loads(angles, positions, turns, records, pool, works, loads):  # type: ignore[no-untyped-def]
    """Fill the forces; the record is changed, so that the contact has one block or one triangle."""
    data, work, still = records[0], works[0], stacked_zeros(3)
    triangles, balls, count = data.triangles, data.balls, data.triangle_count
    for i in range(angles.size):
        for block in range((count + BLOCK - 1) // BLOCK):
            first = BLOCK * block
            data.balls = balls + BALL * block
            data.triangles, data.triangle_count = triangles + TRIANGLE * first, min(BLOCK, count - first)
            mesh_contact(
                angles[i], 0.0, positions[i], turns[i], still, still, data, pool, work, 0.0, 0.0
            )  # fmt: skip
            if work.wrench[NORMAL_DRIVE] + work.wrench[NORMAL_COAST] == 0:
                continue
            data.triangle_count = 1
            for k in range(first, min(first + BLOCK, count)):
                data.triangles = triangles + TRIANGLE * k
                mesh_contact(
                    angles[i], 0.0, positions[i], turns[i], still, still, data, pool, work, 0.0, 0.0
                )  # fmt: skip
                loads[i, k] = work.wrench[NORMAL_DRIVE] + work.wrench[NORMAL_COAST]
