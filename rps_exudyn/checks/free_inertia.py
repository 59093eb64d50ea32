"""The inertia that equilibria leave out: of how the rack moves besides following the drive.

Where a swing turns about, friction lets go and the rack rolls, tilts and shifts to its other side. Equilibria
do that without inertia. In a slow swing it matters little; in a fast one the rack swings on its guides, which
only dynamics know.
"""

from collections.abc import Iterator

import numpy as np

from rps_exudyn.gears.bar_section import mass_and_moments
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Status
from rps_exudyn.solvers.record import Record

FREE_BOUND = 5e-4
"""Of the teeth's mean normal force, RMS over the record: dynamics then differ by 1 % of the torque, RMS."""


def free_inertia(record: Record, gear: SteeringGear) -> float:
    """Return the largest RMS over a record of the inertia forces that act on the rack besides those along its
    travel, moments over the distance of what holds the rack against them [N]."""
    mass, moments = mass_and_moments(RackBar.of(gear), gear.rack.density)
    levers = np.array([gear.rack.bar_diameter / 2, gear.bush.distance, gear.bush.distance])
    masses = np.concatenate([[mass, mass], moments / levers])
    # at even instants: over shorter steps the rack turns over with a larger acceleration
    steps = int(np.ceil(2 * np.ptp(record.time) / np.diff(record.time).max()))
    even = np.linspace(record.time[0], record.time[-1], steps + 1)
    rates = np.column_stack([np.interp(even, record.time, each) for each in record.of_rates("rack")[:, 1:].T])
    acceleration = np.gradient(rates, even, axis=0)
    return float(np.sqrt(np.mean((masses * acceleration) ** 2, axis=0)).max())


def inertia_followed(
    record: Record, signals: dict[str, np.ndarray], gear: SteeringGear
) -> Iterator[tuple[Status, Code, str]]:
    """Check that equilibria along a drive that is not steady miss little of the rack's inertia."""
    if "mesh_normal_force" not in signals:
        return
    share = free_inertia(record, gear) / max(float(np.mean(signals["mesh_normal_force"])), 1e-9)
    if share > FREE_BOUND:
        yield (
            Status.INVALID,
            Code.SWING_TOO_FAST,
            f"the swing is too fast for equilibria: as it turns about, the rack's inertia besides its travel "
            f"is {share:.2%} of the teeth's force, allowed are {FREE_BOUND:.2%}; choose generalized-alpha",
        )
