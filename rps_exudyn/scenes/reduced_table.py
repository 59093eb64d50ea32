"""The table of a reduced gear from equilibria: turned both ways under each load, and turned about once."""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.masses import pinion_inertia, rack_masses
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import RUBBING_PARTS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.checks.before_run import largest_angle
from rps_exudyn.scenes.maneuver import Maneuver, StepLimits, steady_maneuver, swing_maneuver, whole_periods
from rps_exudyn.scenes.scene import WITHOUT_BARS, RunOptions
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.closed_form import bush_drag, mean_state
from rps_exudyn.solvers.reduced_gear import ReducedGear, elements
from rps_exudyn.solvers.sliding_stability import reduced_gear

PER_PITCH, LOADS = 48, 12  # equilibria in a tooth pitch, and loads either way, at level 1
TURN = 0.2  # pinion angle of the swing that shows how friction turns about [rad]
LOCK = 0.98  # of the angle up to which the rack has teeth: the motion before a record needs some
SPEEDS = np.concatenate([[0.0], np.geomspace(1e-3, 100.0, 41)])  # of the pinion [rad/s]
KEPT = 8  # tables of this process

Follow = Callable[[SteeringGear, Fidelity, Maneuver, RunOptions], SceneRun]
"""What follows the equilibria of a maneuver (`run_maneuver.by_equilibrium`)."""


class TableLost(Exception):
    """Equilibria of a table that were not found.

    Attributes:
        run: that ended.
        load: under which it did [N].
    """

    def __init__(self, run: SceneRun, load: float) -> None:
        super().__init__(run.outcome.message)
        self.run, self.load = run, load

    @property
    def sentence(self) -> str:
        """Return the cause, and the load of the table at which it is."""
        return f"the table under a load of {self.load:.4g} N: {self.run.outcome.message}"


@lru_cache(maxsize=KEPT)
def table_of(
    follow: Follow, gear: SteeringGear, fidelity: Fidelity, largest_load: float, level: int = 1
) -> ReducedGear:
    """Return the reduced gear of a table up to a load either way [N].

    A gear whose tooth pitches or turns are alike has the table of one; any other that of all its travel.

    Raises:
        TableLost: there are no equilibria.
    """
    model = fidelity.replace({"solver": "equilibrium"})
    # what else the test asks for changes nothing in the table
    test = {"test.start_angle": 0.0, "test.amplitude": TURN, "test.cycles": 1, "test.direction": 1}
    kinetic = {f"{part}.static_ratio": 1.0 for part in RUBBING_PARTS}
    turned = gear.replace({**test, **kinetic, "bush.viscous_drag": 0.0})
    pair, pitch = GearPair.of(gear), 2 * np.pi / gear.pinion.teeth
    gain = float(pair.gain)
    loads = np.linspace(-largest_load, largest_load, LOADS * 2**level + 1)
    period = next((each for each in (pitch, 2 * np.pi) if whole_periods(turned, each)), None)
    lock = LOCK * largest_angle(gear)
    first, last = (-pitch, period - pitch) if period else (-lock, lock)
    count = int(np.ceil(PER_PITCH * 2**level / 2 * (last - first) / pitch / 2)) * 2
    rows = [_both_ways(follow, turned, model, load, (first, last), count) for load in loads.tolist()]
    up, down = (np.column_stack([row[way]["pinion_torque"] for row in rows]) for way in (0, 1))
    travel = np.column_stack([sum(each["rack_displacement"] for each in row) / 2 for row in rows])
    angles = np.linspace(first, last, count + 1)
    error, gains = travel - pair.travel_at(angles)[:, None], pair.gain_at(angles)
    moved = float(np.mean(gains**2))
    if period:  # both ends are the same place, of which the later one has settled
        up[0], down[0] = up[-1], down[0]
        down[-1] = down[0]
        error[-1] = error[0] = (error[0] + error[-1]) / 2
    oscillator, mean = reduced_gear(gear), mean_state(turned, 1, 0.0)
    of_load = max(mean.mesh_loss + mean.plunger_loss, 1e-300)
    speeds = SPEEDS if oscillator.surplus > 0 else SPEEDS[:1]
    at_speed = np.array([float(oscillator.friction(speed)) for speed in speeds])
    reduced = ReducedGear(
        gain=gain,
        gain_squared=moved,
        inertia=pinion_inertia(gear) + rack_masses(gear).mass * moved,
        drag=gear.bush.viscous_drag * moved,
        angles=angles,
        repeats=period is not None,
        loads=loads,
        up=up,
        down=down,
        course=np.column_stack(
            [pair.travel_at(angles) - gain * angles, (gains - gain) * np.ones(len(angles))]
        ),
        error=error,
        shares=np.ones(1),
        stiffness=np.ones(1),
        speeds=speeds,
        speed_factor=at_speed / at_speed[-1] if at_speed[-1] else np.ones(len(speeds)),
        constant=float(gain * bush_drag(turned, gain) + gear.bearing.friction_torque),
        seat_share=mean.plunger_loss / of_load,
        yokenut_force=max(float(way["yokenut_force"].max()) for way in rows[len(rows) // 2]),
    )
    return _with_elements(follow, reduced, turned, model)


def _both_ways(
    follow: Follow, gear: SteeringGear, model: Fidelity, load: float, ends: tuple[float, float], count: int
) -> tuple[Signals, Signals]:
    """Return the records of the pinion turned to and fro, both in the order of rising angles."""
    found: list[Signals] = []
    for sense in (1, -1):
        (first, last), least = ends[::sense], StepLimits(count, count)
        maneuver = steady_maneuver(gear, "pinion", first, last, 2 * np.pi, least).one_period()
        run = follow(gear, model, maneuver.under(load), WITHOUT_BARS)
        if not run.ok:
            raise TableLost(run, load)
        found.append({name: values[..., ::sense] for name, values in run.signals.items()})
    return found[0], found[1]


def _with_elements(follow: Follow, reduced: ReducedGear, gear: SteeringGear, model: Fidelity) -> ReducedGear:
    """Return the reduced gear whose elements turn about as equilibria without load do.

    Raises:
        TableLost: there are no equilibria.
    """
    maneuver = swing_maneuver(gear, model.step_angle).begun_earlier(1)
    run = follow(gear, model, maneuver, WITHOUT_BARS)
    if not run.ok:
        raise TableLost(run, 0.0)
    angle, torque = run.signals["pinion_angle"], run.signals["pinion_torque"]
    top = int(np.argmax(angle))
    back = slice(top, top + int(np.argmin(angle[top:])) + 1)
    middle = len(reduced.loads) // 2
    here = angle[back]
    x = (here - reduced.angles[0]) % (reduced.angles[-1] - reduced.angles[0]) + reduced.angles[0]
    up, down = (np.interp(x, reduced.angles, each[:, middle]) for each in (reduced.up, reduced.down))
    jump = up - down
    if jump.min() <= 0:  # a gear without friction
        return replace(reduced, shares=np.ones(1), stiffness=np.ones(1))
    turned = (up - torque[back]) / jump
    shares, stiffness = elements(here[0] - here, turned, float(jump.mean()) / 2)
    return replace(reduced, shares=shares, stiffness=stiffness)
