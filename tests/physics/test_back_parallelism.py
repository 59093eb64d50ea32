"""A back that slopes against the teeth: the plunger follows it, the spring with it, and no work is lost."""

import numpy as np
import pytest

import rps_exudyn as rps

SLOPE = 0.5e-3
STIFF = {
    "mesh.law": "line",
    "yoke.spring_rate": "500 N/mm",
    "yoke.clearance": "1 mm",
    "test.start_angle": "-300 deg",
}
GEAR = rps.SteeringGear().replace({**STIFF, "test.turns": 600 / 360})
SLOPING = GEAR.replace({"rack.back_parallelism": SLOPE})


def torque(gear: rps.SteeringGear) -> rps.Result:
    result = rps.run("free-pinion-torque", gear, fidelity="quasi-static")
    assert result.status.value == "ok"
    return result


def test_the_plunger_follows_the_back() -> None:
    """By -b x, less what seat and mesh yield under the change of the spring's force: up to a tenth."""
    sloping, plain = torque(SLOPING), torque(GEAR)
    place = sloping.signals["rack_displacement"]
    moved = sloping.signals["plunger_displacement"] - plain.signals["plunger_displacement"].mean()
    assert np.ptp(place) > 0.05
    rise = np.polyfit(place, moved, 1)[0]
    assert -SLOPE < rise < -0.85 * SLOPE
    # the spring's force presses: at each place the torque of a gear with that preload
    for x in (-0.02, 0.02):
        here = np.abs(place - x) < 0.003
        preload = GEAR.yoke.preload + GEAR.yoke.spring_rate * float(moved[here].mean())
        other = torque(GEAR.replace({"yoke.preload": preload, "test.turns": 1.0}))
        found = float(sloping.signals["pinion_torque"][here].mean())
        # and b P along X helps or hinders
        along = SLOPE * preload * float(place[-1] - place[0]) / (600 * np.pi / 180)
        assert found == pytest.approx(other.summary["torque_mean"] - along, rel=0.02)
    assert abs(sloping.summary["energy_residual"]) < 1e-3


def test_no_work_without_friction() -> None:
    """What the slope takes from the drive stands in the spring."""
    gear = SLOPING.replace(dict.fromkeys(("mesh.friction", "yoke.friction", "bush.drag"), 0.0))
    signals = torque(gear.replace({"bearing.friction_torque": 0.0})).signals
    spring = np.ptp(signals["stored_energy"])
    assert spring > 1e-3
    assert abs(signals["work_drive"][-1] - signals["stored_energy"][-1]) < 0.01 * spring
