"""Kernels that count no references to arrays (`compiled.borrowing`) lose none: what is made is freed."""

import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

from rps_exudyn.base import compiled
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import steady_maneuver
from rps_exudyn.solvers.equilibrium import equilibrium_path
from rps_exudyn.solvers.gear_forces import gear_forces


def kept_by(work: object) -> int:
    """How many blocks of memory a function leaves behind."""
    _nrt_python.memsys_enable_stats()
    before = rtsys.get_allocation_stats()
    work()  # type: ignore[operator]
    after = rtsys.get_allocation_stats()
    return (after.mi_alloc - before.mi_alloc) - (after.mi_free - before.mi_free)


@pytest.mark.parametrize(
    "settings",
    [
        {"pinion.profile_slope": 2e-6, "pinion.tip_relief": 5e-6},
        {"mesh.law": "area", "installation.angle_error": 3e-3},
        {"mesh.law": "teeth"},
        {"yoke.friction_law": "stribeck", "pinion.runout": 40e-6, "yoke.clearance": 20e-6},
    ],
)
def test_a_path_leaves_no_memory_behind(settings: dict[str, float | str]) -> None:
    gear, fidelity = SteeringGear().replace(settings), Fidelity.preset("quasi-static")
    maneuver = steady_maneuver(gear, "pinion", 0.0, 2 * np.pi, np.radians(5.0))
    forces, pair = gear_forces(gear, fidelity), GearPair.of(gear)
    statics = forces.statics

    def follow() -> None:
        equilibrium_path(statics, pair, maneuver.drive, maneuver.time)

    follow()  # what is compiled or loaded now keeps memory of its own
    assert kept_by(follow) == 0


def test_memory_that_is_kept_is_seen() -> None:
    make = compiled.kernel(_make)
    make(2)
    arrays: list[np.ndarray] = []
    assert kept_by(lambda: arrays.append(make(3))) == 1


def _make(n):  # type: ignore[no-untyped-def]
    return np.zeros(n)


def test_what_is_unowned_is_the_same_array_and_freed_by_its_owner() -> None:
    """Arrays within tuples, and views of them: what is written is seen, and no memory is freed twice."""
    write = compiled.kernel(_write)
    array, other = np.zeros(3), np.zeros((2, 2))
    write((array, (other, 1.0)))
    assert array.tolist() == [0.0, 5.0, 0.0]
    assert other.tolist() == [[0.0, 0.0], [7.0, 8.0]]
    assert kept_by(lambda: write((array, (other, 1.0)))) == 0


def _write(owned):  # type: ignore[no-untyped-def]
    array, (other, one) = compiled.unowned(owned)
    array[1:][0] = 5.0
    view = other[1]
    view[0], view[1] = 6.0 + one, 8.0


def test_a_borrowing_kernel_must_not_return_arrays() -> None:
    same = compiled.borrowing(_same)

    def call(x):  # type: ignore[no-untyped-def]
        return same(x)[0]

    with pytest.raises(TypeError, match="returns an array"):
        compiled.kernel(call)(np.zeros(2))


def _same(x):  # type: ignore[no-untyped-def]
    return x
