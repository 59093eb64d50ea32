"""Gears and models that a scene cannot run: one sentence, before anything is simulated."""

import pytest

import rps_exudyn as rps

GEAR = rps.SteeringGear()
EQUILIBRIA = rps.Fidelity.preset("quasi-static")
NO_PLAY = "needs equilibria of a free or flexible rack"
NO_IMPACTS = "equilibria have no impacts"
NOT_REDUCED = ("free-pinion-torque", "load-test", "rack-push", "yoke-impact", "input-shaft-play", "rattle")
"""Scenes that the reduced gear does not have."""


@pytest.mark.parametrize(
    ("scene", "settings", "fidelity", "sentence"),
    [
        ("load-test", {"test.load_mass": 0.0}, "flank", r"test\.load_mass is 0 kg"),
        ("reversal", {"test.amplitude": "40 turn"}, "flank", "deg either way"),
        ("yoke-impact", {"test.pulse_period": "1 ms"}, "flank", r"test\.pulse_period is 1 ms"),
        ("yoke-impact", {}, "quasi-static", NO_IMPACTS),
        ("yoke-impact", {}, "closed-form", NO_IMPACTS),
        ("rattle", {}, "quasi-static", NO_IMPACTS),
        ("stick-slip", {}, "quasi-static", "equilibria have no slip"),
        ("free-pinion-torque", {"mesh.law": "teeth"}, "full", "teeth, but .*general-contact has only line"),
        ("steering-feel", {}, "closed-form", "has no steering column"),
        ("radial-play", {}, "closed-form", NO_PLAY),
        ("radial-play", {}, EQUILIBRIA.replace({"rack": "guided"}), NO_PLAY),
        ("rack-lift", {}, "closed-form", NO_PLAY),
        ("rack-lift", {}, EQUILIBRIA.replace({"rack": "guided"}), NO_PLAY),
        ("input-shaft-play", {}, EQUILIBRIA.replace({"pinion": "rigid"}), "needs a supported pinion"),
        *((scene, {}, "reduced", r"fidelity\.solver is reduced") for scene in NOT_REDUCED),
    ],
)
def test_what_a_scene_cannot_run(
    scene: str, settings: dict[str, object], fidelity: str | rps.Fidelity, sentence: str
) -> None:
    with pytest.raises(rps.InputError, match=sentence) as refused:
        rps.run(scene, GEAR.replace(settings), fidelity=fidelity)
    assert len(refused.value.problems) == 1
