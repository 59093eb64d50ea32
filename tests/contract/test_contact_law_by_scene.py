"""The contact law that a task gets where the gear's is by-scene, and where it is named."""

import pytest

import rps_exudyn as rps
from rps_exudyn.pages.report.result_sheet import sheet_of
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes import SCENE_NAMES, scene_named
from rps_exudyn.scenes.contact_law import FLANK_DEVIATIONS, LAW_OF_SERIES, resolve_contact_law

GEAR, EQUILIBRIA = SteeringGear(), Fidelity.preset("quasi-static")


def law(gear: SteeringGear, model: str, needed: str, varied: tuple[str, ...] = ()) -> str:
    return resolve_contact_law(gear, Fidelity.preset(model), needed, varied).mesh.law  # type: ignore[arg-type]


def test_loads_and_impacts_need_teeth_that_bend() -> None:
    assert GEAR.mesh.law == "by-scene"
    bending = {name for name in SCENE_NAMES if scene_named(name).law == "teeth"}
    assert bending == {"load-test", "yoke-impact"}
    assert LAW_OF_SERIES == "teeth"


@pytest.mark.parametrize("path", FLANK_DEVIATIONS)
def test_deviations_of_flanks_need_teeth_that_bend(path: str) -> None:
    texts = {"errors": "ISO 1328 class 8, seed 3", "deviation": "studies/gears/measured_rack.csv"}
    deviation = next((text for end, text in texts.items() if path.endswith(end)), "5 um")
    assert law(GEAR, "flank", "line") == "line"
    assert law(GEAR.replace({path: deviation}), "flank", "line") == "teeth"
    assert law(GEAR, "flank", "line", varied=(path,)) == "teeth"


@pytest.mark.parametrize("model", ["closed-form", "full"])
def test_models_without_bending_teeth_have_lines(model: str) -> None:
    assert law(GEAR.replace({"pinion.crowning": "5 um"}), model, "teeth") == "line"


def test_named_law_stays() -> None:
    """As in a file of an earlier version, whatever the scene needs."""
    for named in ("line", "teeth"):
        gear = GEAR.replace({"mesh.law": named})
        assert resolve_contact_law(gear, EQUILIBRIA, "teeth") is gear
        assert resolve_contact_law(gear, EQUILIBRIA, "line") is gear


def test_result_and_sheet_name_the_law() -> None:
    result = rps.run("free-pinion-torque", fidelity="closed-form")
    assert result.gear.mesh.law == "line"
    assert sheet_of(result).lead.endswith("default; closed-form; law line")
