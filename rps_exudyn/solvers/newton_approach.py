"""The compiled part of the yoke's adjustment: where a load presses the guided rack into the mesh."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from rps_exudyn.base.compiled import kernel_over

Kernel = Callable[..., Any]

MAX_STEPS = 60
FARTHEST = 20e-6  # of one step [m]
CLOSE = 1e-4  # largest unbalanced force accepted [N]
SMALLEST_FRACTION = 1e-3


@cache
def newton_approach(mesh_tangent: Kernel) -> Kernel:
    """Compile approach(load, x, y, data) -> x, y, residual: the place of the rack, which keeps its direction,
    where the teeth carry a load [N] along -Y and no force along X, by Newton's method from a place [m]."""

    def approach(load, x, y, data):  # type: ignore[no-untyped-def]
        q, v, tangent = np.zeros(7), np.zeros(7), np.empty((7, 7))
        norm, fraction, move_x, move_y = np.inf, 1.0, 0.0, 0.0
        for _ in range(MAX_STEPS):
            q[1], q[2] = x + fraction * move_x, y + fraction * move_y
            tangent[:] = 0.0
            force = mesh_tangent(q, v, data, 1.0, 0.0, tangent)
            along, across = force[1], force[2] - load
            residual = max(abs(along), abs(across))
            if not residual < norm:  # too far along the last step
                fraction *= 0.5
                if fraction < SMALLEST_FRACTION:
                    break
                continue
            x, y, norm, fraction = q[1], q[2], residual, 1.0
            if norm <= CLOSE:
                break
            a, b, c, d = tangent[1, 1], tangent[1, 2], tangent[2, 1], tangent[2, 2]
            size = a * d - b * c
            if not abs(size) > 0:
                break
            move_x, move_y = (b * across - d * along) / size, (c * along - a * across) / size
            largest = max(abs(move_x), abs(move_y))
            if not np.isfinite(largest):
                break
            if largest > FARTHEST:
                move_x, move_y = move_x * FARTHEST / largest, move_y * FARTHEST / largest
        return x, y, norm

    return kernel_over(approach, mesh_tangent)
