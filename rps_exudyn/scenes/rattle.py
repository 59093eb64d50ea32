"""Rattle: a road's force along a tie rod shakes the rack's end, the pinion held; the plunger hits the nut.

One cycle settles, then `test.road_cycles` are recorded. Motions with impacts are chaotic
(`analysis.impacts`): the same follows for each of `test.road_phases` phases at which the force begins. A
growing sine finds the size of the force at which the plunger first hits.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from rps_exudyn.analysis.impacts import describe_rattle, split_at_repeats
from rps_exudyn.analysis.work_balance import describe_balance
from rps_exudyn.forces.external_load import RoadForce
from rps_exudyn.forces.pinion_support import with_float
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Remark
from rps_exudyn.scenes.checks.before_run import check_dynamics, check_travel
from rps_exudyn.scenes.maneuver import Maneuver, even
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.scene import RunOptions, Scene
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.prescribed_motion import Steady

ZONE = 0.02  # of friction, halved with the steps: by creep in it metrics are up to 0.5 % off, in 0.1 2.7 %
STEPS_PER_SWING = 8  # of the plunger between seat and yokenut, its fastest motion: metrics to 1 %, speed 2 %
STEPS_PER_BAND = 20  # of the fastest vibration in the band of the acceleration
KEPT = 4  # of so many instants one stays in the result, whose metrics come from all of them
GROWING = "growing-sine"
RIGID = Remark(
    Code.RACK_RIGID,
    "the rack is rigid (fidelity.rack): impact forces are up to twice too large and rattle begins at "
    "smaller forces; choose flexible",
)


@dataclass(frozen=True)
class GrowingForce(RoadForce):
    """A sine whose amplitude grows evenly from 0, at `begin` [s], to its peak after `duration` [s]."""

    begin: float
    duration: float

    def grown(self, time: float) -> float:
        """Return the amplitude at a time [s] over the largest."""
        return min(max((time - self.begin) / self.duration, 0.0), 1.0)

    def share(self, time: float) -> float:
        """Return the force at a time over its peak."""
        return self.grown(time) * super().share(time)


def rattle(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Shake the rack along the tie rod and record."""
    check_dynamics(fidelity, "rattle", "impacts")
    chosen, test = with_float(gear, fidelity.with_bending()), gear.test
    chosen = chosen.replace({"zone_ratio": ZONE / 2.0**options.halvings})
    maneuvers = list(shaken_by_road(gear, chosen.swing_steps or STEPS_PER_SWING))
    growing = test.road_shape == GROWING
    band = (test.band_low, test.band_high)

    def metrics(signals: Signals) -> dict[str, float]:
        if growing:
            return threshold(signals, maneuvers) | describe_balance(signals)
        of_cycles = describe_rattle(signals, 1 / test.road_frequency, gear.yoke.plunger_mass, band)
        return of_cycles | describe_balance(signals)

    run = run_maneuver(gear, chosen, maneuvers, options).described(metrics)
    described = run.noting(None if chosen.rack == "flexible" else RIGID)
    if growing:
        described = described.noting(_threshold_remark(gear, described.summary))
    return replace(described, signals=_thinned(described.signals, maneuvers))


def threshold(signals: Signals, maneuvers: Sequence[Maneuver]) -> dict[str, float]:
    """Return the amplitude of growing forces at which the yokenut is first hit [N]: its mean and its standard
    deviation over the phases; {} if one of them ends without."""
    found = []
    for run, maneuver in zip(split_at_repeats(signals), maneuvers, strict=False):
        road, hits = maneuver.pulse, np.flatnonzero(run["yokenut_force"] > 0)
        assert isinstance(road, GrowingForce)
        if not hits.size:
            return {}
        hit = float(run["time"][hits[0]] - run["time"][0])
        found.append(float(np.linalg.norm(road.peak)) * road.grown(hit + road.begin))
    if len(found) < len(maneuvers):
        return {}
    return {
        "rattle_threshold_force": float(np.mean(found)),
        "rattle_threshold_scatter": float(np.std(found)),
    }


def _threshold_remark(gear: SteeringGear, metrics: Mapping[str, float]) -> Remark:
    test = gear.test
    if "rattle_threshold_force" not in metrics:
        not_hit = f"the yokenut is not hit up to test.road_force = {test.road_force:.4g} N"
        return Remark(Code.NOT_HIT, not_hit)
    growth = test.road_force / test.road_cycles
    too_high = f"the force grows by {growth:.3g} N per cycle; the threshold may be too high by as much"
    return Remark(Code.THRESHOLD_RESOLUTION, too_high)


def shaken_by_road(gear: SteeringGear, steps_per_swing: int = STEPS_PER_SWING) -> Iterator[Maneuver]:
    """Yield one maneuver for each phase at which the force begins: one cycle of run-in, then the record."""
    test, yoke = gear.test, gear.yoke
    check_travel(gear, (test.start_angle,), "test.start_angle")
    peak = test.road_force * np.array([np.cos(test.road_angle), np.sin(test.road_angle), 0.0])
    swing = 2 * np.pi * np.sqrt(yoke.plunger_mass / (yoke.seat_stiffness + yoke.nut_stiffness))
    step = min(swing / steps_per_swing, 1 / (STEPS_PER_BAND * test.band_high))
    per_cycle = even(1 / (test.road_frequency * step))
    cycle, steps = 1 / test.road_frequency, per_cycle * test.road_cycles
    drive = Steady("pinion", test.start_angle, 0.0)
    shape: Callable[..., RoadForce] = RoadForce
    if test.road_shape == GROWING:
        shape = partial(GrowingForce, begin=cycle, duration=test.road_cycles * cycle)
    of_road = tuple(peak.tolist()), RackBar.of(gear).x_min, test.road_frequency
    for phase in 2 * np.pi * np.arange(test.road_phases) / test.road_phases:
        force = shape(*of_road, float(phase), test.road_shape == "half-sine")
        yield Maneuver(drive, cycle / per_cycle, per_cycle, steps, pulse=force)


def _thinned(signals: Signals, maneuvers: list[Maneuver]) -> Signals:
    """Keep some of the instants of each maneuver, and what the force was there; {} of an empty record."""
    if not signals:
        return {}
    kept: list[Signals] = []
    for run, maneuver in zip(split_at_repeats(signals), maneuvers, strict=False):
        instants = np.append(np.arange(0, len(run["time"]) - 1, KEPT), len(run["time"]) - 1)
        thin = {name: values[instants] for name, values in run.items()}
        road = maneuver.pulse
        assert road is not None
        since_start = thin["time"] - run["time"][0] + maneuver.lead * maneuver.time_step
        thin["road_force"] = np.linalg.norm(road.peak) * np.array([road.share(time) for time in since_start])
        kept.append(thin)
    return {name: np.concatenate([run[name] for run in kept]) for name in kept[0]} if kept else signals


SCENE = Scene(
    name="rattle",
    title="Rattle: yokenut's force under a road's",
    run=rattle,
    signal="yokenut_force",
    main_metric="rattle_force_rms",
    chart="rattle",
    needs_inertia=True,
    has_impacts=True,
    revolutions=None,
    at_test_speed=False,
)
