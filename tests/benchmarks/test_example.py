"""The example script in `studies/examples` runs as a user would run it, and finds what theory says."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear

SCRIPT = Path(__file__).parents[2] / "studies" / "examples" / "preload_sweep.py"


def test_preload_sweep_finds_the_torque_that_the_preload_does_not_make(tmp_path: Path) -> None:
    """Torque is linear in the preload; without any the drag of the bush and the bearings remain."""
    picture = tmp_path / "sweep.png"
    done = subprocess.run([sys.executable, SCRIPT, picture], capture_output=True, text=True, check=True)
    assert picture.stat().st_size > 5000
    left = float(re.findall(r"to ([\d.]+) N mm", done.stdout)[0])
    gear = SteeringGear()
    drag = gear.bush.drag * GearPair.of(gear).gain + gear.bearing.friction_torque
    assert left == pytest.approx(1e3 * drag, rel=0.03)
