"""The flank contact integrated along generators: simple, exact limits; the reference for `flank_contact`.

Law "area" only.
"""

import numpy as np

from rps_exudyn.base.compiled import kernel
from rps_exudyn.mesh_contact.flank_data import N_ACROSS, Q_FORM, Q_TIP, RELIEF, RELIEF_START
from rps_exudyn.mesh_contact.flank_generator import press_area
from rps_exudyn.mesh_contact.flank_line import (
    LINES,
    LOAD,
    SUMS,
    Band,
    add_side,
    first_tooth,
    line_of,
    side_of,
)
from rps_exudyn.mesh_contact.wrench import WRENCH_SIZE

COARSE = 200


@kernel
def flank_quadrature(angle, rate, position, rotation, velocity, spin, data):  # type: ignore[no-untyped-def]
    """A mesh contact kernel, see `wrench`; `data` from `pack_generators`."""
    out, sums = np.zeros(WRENCH_SIZE), np.empty(SUMS)
    generators = int(data[N_ACROSS])
    for sign in (-1.0, 1.0):
        side = side_of(sign, angle, rate, position, rotation, velocity, spin, data)
        first, last, turn = first_tooth(angle, side, data)
        sums[:] = 0.0
        for tooth in range(first, last + 1):
            line, _ = line_of(tooth, turn, side, data)
            before = sums[LOAD]
            plain = Band(data[Q_FORM], min(data[Q_TIP], data[RELIEF_START]), 0.0, 0.0)
            press_area(COARSE, generators, plain, line, side, data, sums)
            if data[RELIEF] > 0:
                relieved = Band(data[RELIEF_START], data[Q_TIP], data[RELIEF], data[RELIEF_START])
                press_area(COARSE, generators, relieved, line, side, data, sums)
            if sums[LOAD] > before:
                sums[LINES] += 1
        add_side(sums, angle, position, side, data, out)
    return out
