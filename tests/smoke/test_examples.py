"""Scripts and notebooks of `studies/examples` run as a user runs them, and find what theory says.

Each in a fresh process, in a folder that `rps-exudyn init` wrote. Notebooks are JSON: their cells of code run
one after the other, without Jupyter.
"""

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from reader import EXAMPLES, Session
from rps_exudyn import read_measured_torque
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes import SCENE_NAMES, add_scene, scene_named
from rps_exudyn.solvers.closed_form import free_torque, torque_per_preload
from shell import in_fresh_process

NOTEBOOKS = sorted(EXAMPLES.glob("*.ipynb"))
SCRIPTS = {
    "preload_sweep": "[PICTURE.png]",
    "own_exudyn_model": "[view]",
    "own_gear": "[GEAR.toml]",
    "own_scene": "",
    "weave": "[PICTURE.png]",
    "tables_and_datasets": "",
    "measured/make_made_up": "[FOLDER]",
}
"""Each script, and what its first lines say that it takes."""

Ran = Callable[..., str]


@pytest.fixture
def ran(tmp_path: Path) -> Ran:
    """A function that runs an example with arguments, where it stands, and returns what it printed."""

    def run(name: str, *arguments: str) -> str:
        script = shutil.copytree(EXAMPLES, tmp_path / "examples") / f"{name}.py"
        printed = f"python {script.name} {SCRIPTS[name]}".strip()
        assert f"\n    {printed}\n" in script.read_text(encoding="utf-8")
        done = in_fresh_process(" ".join(["python", script.name, *arguments]), script.parent)
        assert (done.returncode, done.stderr) == (0, "")
        return done.stdout

    return run


def test_every_script_is_tested() -> None:
    found = {str(path.relative_to(EXAMPLES).with_suffix("")) for path in EXAMPLES.rglob("*.py")}
    assert found == SCRIPTS.keys()


def test_sweep_finds_the_torque_that_the_preload_does_not_make(ran: Ran, tmp_path: Path) -> None:
    """Torque is linear in the preload; without any the drag of the bush and the bearings remain."""
    printed = ran("preload_sweep", "sweep.png")
    assert (tmp_path / "examples" / "sweep.png").stat().st_size > 5000
    left = float(re.findall(r"to ([\d.]+) N mm", printed)[0])
    gear = SteeringGear()
    drag = gear.bush.drag * GearPair.of(gear).gain + gear.bearing.friction_torque
    assert left == pytest.approx(1e3 * drag, rel=0.03)


def test_weave_feels_the_friction_of_the_gear(ran: Ran, tmp_path: Path) -> None:
    """On centre the hand holds the free torque and what lags of the rack's load: 1.0 to 1.3 times it."""
    printed = ran("weave", "weave.png")
    assert (tmp_path / "examples" / "weave.png").stat().st_size > 5000
    torque, band = map(float, re.findall(r"no acceleration +([\d.]+) \+- ([\d.]+) N m", printed)[0])
    free = free_torque(SteeringGear())
    assert free < torque < 1.3 * free
    assert 0.05 < band / torque < 0.3


def test_exudyn_system_can_be_taken_over(ran: Ran) -> None:
    """The bar moves by gain times speed, whatever pulls: the drive is prescribed, the teeth are stiff.

    Micrometres of yield within 0.2 s make less than 1 %; the example's own sensor tells it.
    """
    gear = SteeringGear()
    expected = 1e3 * GearPair.of(gear).gain * gear.test.speed
    speed, by_gain = (float(each) for each in re.findall(r"([\d.]+) mm/s", ran("own_exudyn_model")))
    assert by_gain == pytest.approx(expected, rel=1e-3)
    assert speed == pytest.approx(expected, rel=0.01)


def test_own_gear_travels_as_its_teeth_say(ran: Ran) -> None:
    """z pi m_n / cos beta_r per turn; the gear that cannot be built is refused."""
    printed = ran("own_gear")
    travel = float(re.findall(r"travel ([\d.]+) mm", printed)[0])
    tooth_angle = SteeringGear().rack.tooth_angle
    assert travel == pytest.approx(7 * np.pi * 2 / np.cos(tooth_angle), abs=0.006)
    assert "refused: yoke.plunger_diameter is 15 mm" in printed


def test_own_scene_holds_the_pull(ran: Ran) -> None:
    """The middle of the loop is the pull times the gain; friction shifts it by a part of what rubs."""
    printed = ran("own_scene")
    pulled, free = (float(each) for each in re.findall(r"around (-?[\d.]+) N m", printed))
    assert pulled - free == pytest.approx(200 * GearPair.of(SteeringGear()).gain, rel=0.02)


def test_own_scene_cannot_take_the_name_of_another() -> None:
    with pytest.raises(InputError, match="give yours another name"):
        add_scene(scene_named(SCENE_NAMES[0]))
    with pytest.raises(InputError, match="it must be one of"):
        scene_named("pulled-reversal")


def test_table_has_the_slope_of_the_closed_form(ran: Ran) -> None:
    """dT/dP of the formula, friction being small: within 5 % of the equilibria's."""
    printed = ran("tables_and_datasets")
    slopes = [float(each) for each in re.findall(r"([\d.]+) N mm per newton", printed)]
    for friction, slope in zip((0.05, 0.1), slopes, strict=True):
        gear = SteeringGear().replace({"mesh.friction": friction})
        assert slope == pytest.approx(1e3 * torque_per_preload(gear), rel=0.05)


def test_made_up_curves_are_made_anew(ran: Ran, tmp_path: Path) -> None:
    """To the last digit of the files, which other versions of libraries may round otherwise."""
    ran("measured/make_made_up", str(tmp_path))
    shipped_files = [*(EXAMPLES / "measured").glob("*.csv"), EXAMPLES.parent / "measured.csv"]
    assert {path.name for path in shipped_files} == {path.name for path in tmp_path.glob("*.csv")}
    for path in shipped_files:
        made, shipped = (read_measured_torque(each) for each in (tmp_path / path.name, path))
        for signal, values in shipped.signals.items():
            np.testing.assert_allclose(made.signals[signal], values, rtol=0, atol=2e-4)


@pytest.mark.parametrize("notebook", [pytest.param(path, id=path.stem) for path in NOTEBOOKS])
def test_notebook_runs(notebook: Path, tmp_path: Path) -> None:
    """In its own folder, where Jupyter starts it."""
    content = json.loads(notebook.read_text(encoding="utf-8"))
    assert content["nbformat"] == 4
    cells = [cell for cell in content["cells"] if cell["cell_type"] == "code"]
    assert len({cell["id"] for cell in content["cells"]}) == len(content["cells"])
    assert not any(cell["outputs"] for cell in cells)  # versions print differently
    session = Session(shutil.copytree(EXAMPLES, tmp_path / "examples"))
    try:
        for number, cell in enumerate(cells, 1):
            session.run("".join(cell["source"]), f"{notebook.name}, cell {number}")
    finally:
        session.end()
