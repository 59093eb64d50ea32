"""Each preset through the command line, without stand-ins; full over a small part of a turn."""

import pytest

from rps_exudyn import load
from rps_exudyn.parameters.fidelity import PRESETS
from rps_exudyn.solvers.closed_form import free_torque
from shell import Command

TOY = ["test.turns=0.00833333", "fidelity.profile_samples=12", "fidelity.axial_samples=10"]
PRESET_SETTINGS: dict[str, list[str]] = {
    "flank": ["test.turns=0.05"],
    "quasi-static": ["test.turns=0.05"],
    "closed-form": [],
    "full": TOY,
    "reduced": [],
}
SCENES = {"reduced": "reversal"}  # of presets that do not turn steadily


def test_every_preset_is_run_here() -> None:
    assert set(PRESET_SETTINGS) == set(PRESETS)


@pytest.mark.parametrize("preset", PRESET_SETTINGS)
def test_preset_runs_and_its_file_holds_what_was_asked(preset: str, command: Command) -> None:
    settings = [word for setting in PRESET_SETTINGS[preset] for word in ("--set", setting)]
    scene = SCENES.get(preset, "free-pinion-torque")
    answer = command(["run", scene, "--fidelity", preset, *settings, "--json"])
    assert answer.status == 0, answer.err
    assert answer.json["files"] == [f"{scene}.h5", f"{scene}.png"]
    result = load(f"{scene}.h5")
    assert result.fidelity["name"].split(" with ")[0] == preset
    mean = "torque_jump" if preset in SCENES else "torque_mean"
    ways = 2 if preset in SCENES else 1
    expected = ways * free_torque(result.gear)
    # within what a toy gear mesh and a part of a tooth pitch leave of the mean
    assert result.summary[mean] == pytest.approx(expected, rel=0.05)
