"""The tables behind `--accuracy`: what is stricter costs more, and settings follow the tooth pitch."""

import numpy as np
import pytest

from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.simulate.by_accuracy import choose, scene_table

GEAR = SteeringGear()
STEADY = ("free-pinion-torque", "load-test", "rack-push")


@pytest.mark.parametrize("scene", STEADY)
def test_stricter_is_never_cheaper(scene: str) -> None:
    table = scene_table(scene)
    strictest = min(each.promised for each in table.settings)
    wanted = np.geomspace(max(strictest, table.floor), 10.0, 12)
    costs = [choose(scene, GEAR, float(each)).setting.cost for each in wanted * (1 + 1e-9)]
    assert costs == sorted(costs, reverse=True)
    assert costs[0] > costs[-1]


def test_the_step_follows_the_tooth_pitch() -> None:
    few, many = (choose("free-pinion-torque", GEAR.replace({"pinion.teeth": z}), 1.0) for z in (6, 8))
    assert few.fidelity.step_angle * 6 == pytest.approx(many.fidelity.step_angle * 8)
