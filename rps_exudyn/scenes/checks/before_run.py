"""Checks of a plan before it is run: the memory that its record needs, and the rack's teeth."""

import os
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear

# --- Plans whose record no memory holds, refused before they start

BYTES_PER_STEP = 1500  # of a run: states, forces, signals, and the file made of them; measured 1200
BYTES_PER_SPHERE = 200  # of a sphere on the flanks: coordinates, and its row in the contact's search
SMALL = 16e6  # [bytes]: less than the package itself takes, once it runs
SHARE = 0.7  # of the free memory that a run may take


def check_memory(steps: int, spheres: int = 0) -> None:
    """Check that the record of so many steps, and so many spheres on the flanks, fit into the free memory.

    Raises:
        InputError: they do not.
    """
    needed = BYTES_PER_STEP * steps + BYTES_PER_SPHERE * spheres
    if needed < SMALL:
        return
    free = free_memory()
    if needed > SHARE * free:
        size = f"{steps:.3g} steps" + (f" and {spheres:.3g} spheres" if spheres else "")
        cure = "a larger fidelity.step_angle or a shorter test" + (" or fewer spheres" if spheres else "")
        raise InputError(
            f"the test has {size}, which take about {needed / 1e9:.3g} GB of memory; {free / 1e9:.3g} GB are "
            f"free: choose {cure}."
        )


def free_memory() -> float:
    """Return the memory that a process may still take [bytes], of the machine, its container and its own
    limit; infinite where the system reports none."""
    free, container = [float("inf")], Path("/sys/fs/cgroup")
    with suppress(AttributeError, OSError, ValueError):
        free.append(float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")))
    with suppress(OSError, ValueError, KeyError):
        lines = dict(line.split(":") for line in Path("/proc/meminfo").read_text().splitlines())
        free.append(1024.0 * int(lines["MemAvailable"].split()[0]))
    with suppress(OSError, ValueError):  # no such file, or "max"
        most, taken = (int((container / f"memory.{name}").read_text()) for name in ("max", "current"))
        free.append(float(most - taken))
    with suppress(ImportError, OSError, ValueError):
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        if limit != resource.RLIM_INFINITY:
            free.append(float(limit - pages * resource.getpagesize()))
    return min(free)


# --- What a model or a gear lacks


def check_dynamics(fidelity: Fidelity, scene: str, missing: str, *others: str) -> None:
    """Check that a model has inertia, or one of the other solvers; equilibria are without what is `missing`.

    Raises:
        InputError: it has none.
    """
    if fidelity.solver not in ("generalized-alpha", *others):
        raise InputError(
            f"fidelity.solver is {fidelity.solver}; {scene} needs generalized-alpha: equilibria have no "
            f"{missing}."
        )


def check_travel(gear: SteeringGear, angles: Sequence[float], test: str) -> float:
    """Check that the pinion stays on the rack's teeth at these angles [rad]; `test` names what leads there.

    Returns `largest_angle`.

    Raises:
        InputError: it would not.
    """
    allowed = largest_angle(gear)
    farthest = max(abs(angle) for angle in angles)
    if farthest > allowed:
        raise InputError(
            f"{test} leads to a pinion angle of {np.degrees(farthest):.6g} deg; the teeth for "
            f"rack.travel = {gear.rack.travel * 1e3:g} mm allow {np.degrees(allowed):.6g} deg either way "
            f"({allowed / (2 * np.pi):.4g} turns from the centre)."
        )
    return allowed


def largest_angle(gear: SteeringGear) -> float:
    """Return how far the pinion may turn either way from the rack's middle [rad]."""
    bar = RackBar.of(gear)
    farthest = bar.largest_displacement
    return float(np.abs(bar.pair.angle_at(np.array([-farthest, farthest]))).min())
