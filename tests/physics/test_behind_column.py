"""The reference of plans that turn the wheel: its integrator against a closed form, its metrics against the
scene's."""

from math import nan
from typing import cast

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.friction import STATE_SIZE
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import Result
from rps_exudyn.simulate.run_plan import run_unchecked
from rps_exudyn.solvers.balance import Balance
from rps_exudyn.solvers.steering_column import ColumnModel
from verification.behind_column import Behind, Wheel, WheelMetrics, metrics_of_wheel, size_of
from verification.sampler import REACHES, drawn, random_gear
from verification.stability import ScenePlan
from verification.stated_ranges import GEAR

STIFFNESS, INERTIA = 100.0, 6e-5
PARTS = ("mesh", "yoke", "bush", "bearing")

SEED = 17
SCENES = ("steering-feel", "stick-slip")
ZONES = 1e-3, 1e-2


def plan_of(number: int) -> ScenePlan:
    """The random plan of that number."""
    rng = np.random.default_rng([SEED, number])
    scene = SCENES[number % len(SCENES)]
    while True:
        gear = random_gear(rng, "reversal" if scene == "stick-slip" else scene)
        laws = {path: value for path, value in drawn(rng, type(gear), GEAR).items() if "friction_law" in path}
        gear = gear.replace(laws)
        try:
            REACHES[scene](gear)
        except InputError:
            continue
        break
    still = scene == "steering-feel" and rng.random() < 0.5
    zone = float(np.exp(rng.uniform(*np.log(ZONES))))
    fidelity = Fidelity.preset("quasi-static" if still else "flank").replace({"zone_ratio": zone})
    return ScenePlan(scene, gear, fidelity)


def errors(plan: ScenePlan, result: Result, right: WheelMetrics) -> dict[str, float]:
    """Error of the metric; of stick-slip's peak as well."""
    error = (plan.main_metric(result) - right.main_metric) / size_of(plan, right)
    if plan.scene == "steering-feel":
        return {"error": error, "metric_error": nan}
    return {"error": error, "metric_error": result.summary["breakaway_torque"] / right.peak - 1}


class NoForces:
    """The forces of no gear."""

    has_bristles = False

    def __init__(self) -> None:
        self.memory = np.zeros((2, STATE_SIZE))

    def tangent(self, q: np.ndarray, *rest: object) -> np.ndarray:
        return np.zeros((q.size, q.size))

    def force(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.zeros(q.size)


def alone(turned: float) -> Behind:
    """An inertia without a gear behind a column whose wheel was turned by an angle [rad]."""
    return Behind(
        wheel=Wheel(lambda time: np.full_like(time, turned), np.zeros_like),
        column=ColumnModel(0.04, STIFFNESS, 0.0, 0.0, 0.0),
        balance=cast(Balance, NoForces()),
        mass=np.diag([INERTIA, *[1.0] * 7]),
        moving=np.arange(8),
        time=0.0,
        place=np.zeros(8),
        rate=np.zeros(8),
    )


def error(steps: int) -> float:
    """Error after a natural period of an inertia that swings about the wheel's angle, over that angle."""
    state, period = alone(0.01), 2 * np.pi * np.sqrt(INERTIA / STIFFNESS)
    for end in np.linspace(0, period, steps + 1)[1:]:
        state.go(float(end))
    return abs(float(state.place[0])) / 0.01


def test_integrator_is_of_second_order() -> None:
    """Half the step, a quarter of the error in phase or less (the swing's end is its turn, where an error of
    phase counts squared), and below 0.1 % in 60 steps."""
    assert error(60) < 1e-3
    assert error(60) < error(30) / 3.5


def test_stick_slip_near_its_limit_lies_within_its_bars() -> None:
    """A gear on bristles that vibrates near the speed at which it sticks, beside implicit Runge-Kutta."""
    plan = plan_of(27)
    right = metrics_of_wheel(plan, 1)
    made = run_unchecked(plan.scene, plan.gear, plan.fidelity)
    assert max(abs(each) for each in errors(plan, made, right).values()) < 0.01


def test_torque_at_the_wheel_does_the_work_on_the_pinion_through_a_joint() -> None:
    """A joint bent by 40 deg: torque's range and peak of scene and reference to 0.5 % of the peak; the torque
    on the pinion differs from that at the wheel by up to 30 %."""
    bent = {"column.joint_angle": "40 deg", "test.speed": "30 rpm"}
    plan = ScenePlan("stick-slip", SteeringGear().replace(bent), Fidelity.preset("flank"))
    found = errors(plan, rps.run("stick-slip", plan.gear), metrics_of_wheel(plan, 1))
    assert max(abs(each) for each in found.values()) < 5e-3


def test_stick_slip_of_the_scene_is_the_references() -> None:
    """Torque's range and peak of a gear that sticks and slips: to 0.5 % of the peak, where 10 % less static
    friction show."""
    law = {f"{part}.friction_law": "stribeck" for part in PARTS}
    ratio = {f"{part}.static_ratio": 1.2 for part in PARTS}
    plan = ScenePlan("stick-slip", SteeringGear().replace(law | ratio), Fidelity.preset("flank"))
    result = rps.run("stick-slip", plan.gear)
    found = errors(plan, result, metrics_of_wheel(plan, 1))
    assert max(abs(each) for each in found.values()) < 5e-3
    less = {f"{part}.static_ratio": 1.1 for part in PARTS}
    other = ScenePlan("stick-slip", plan.gear.replace(less), plan.fidelity)
    assert errors(plan, result, metrics_of_wheel(other, 1))["metric_error"] == pytest.approx(0.09, abs=0.03)
