"""Files of measured flanks that are none, do not fit the gear, or are gone."""

from pathlib import Path

import numpy as np
import pytest

import rps_exudyn as rps
from measured_grids import pinion_axes, rack_axes, write_grid
from rps_exudyn.gears.flank_grid import measured_flanks
from rps_exudyn.parameters.gear import SteeringGear

GEAR = SteeringGear()
HEAD = "roll [mm],face [mm],deviation [um]\n"
SQUARE = [(r, z) for r in (2, 4, 6, 8) for z in (-7, -2, 2, 7)]


def rows(line: str = "{r},{z},1", places: list[tuple[int, int]] = SQUARE) -> str:
    """One line for each place."""
    return "".join(line.format(r=r, z=z) + "\n" for r, z in places)


WRONG = {
    "names": ("roll [mm],lead [mm],deviation [um]\n" + rows(), "the column 'lead'"),
    "no face": ("roll [mm],deviation [um]\n" + rows("{r},1"), "must have one column face"),
    "both": ("roll [mm],diameter [mm],face [mm],deviation [um]\n2,9,0,0\n", "one column roll or diameter"),
    "no unit": ("roll,face [mm],deviation [um]\n" + rows(), "no unit at roll"),
    "mass": ("roll [kg],face [mm],deviation [um]\n" + rows(), "wrong in column roll"),
    "text": (HEAD + rows("{r},{z},deep"), "wrong in column deviation"),
    "nan": (HEAD + rows("{r},{z},nan"), "a place without a number"),
    "micrometres as millimetres": (HEAD.replace("um", "mm") + rows(), "limit is 100 um"),
    "metres": (HEAD.replace("roll [mm]", "roll [um]") + rows(), "covers roll"),
    "hole": (HEAD + rows(places=SQUARE[:-1]), "needs 16"),
    "twice": (HEAD + rows(places=[*SQUARE[:-1], SQUARE[0]]), "needs 16"),
    "small": (HEAD + rows(places=SQUARE[:12]), "it needs 4 by 4"),
    "short": (HEAD + rows(places=[(r, z // 3) for r, z in SQUARE]), "covers face"),
    "flank": ("flank," + HEAD + rows("left,{r},{z},1"), "the flank 'left'"),
    "tooth": ("tooth," + HEAD + rows("6,{r},{z},1"), "from 0 to 5"),
    "one tooth": ("tooth," + HEAD + rows("3,{r},{z},1"), "rows of all 6"),
    "one flank": ("flank," + HEAD + rows("drive,{r},{z},1"), "the coast flank of tooth all"),
    "row": (HEAD + rows("{r},{z}"), "a row without deviation"),
    "empty": ("", "has no rows"),
    "binary": (b"\xff\xfe\x00\x01", "not UTF-8 text"),
    "inside the base circle": ("diameter" + HEAD[4:] + rows(), "inside the base circle"),
}


@pytest.mark.parametrize(("content", "said"), WRONG.values(), ids=WRONG)
def test_file_that_is_no_grid_of_this_gear_is_refused(
    content: str | bytes, said: str, tmp_path: Path
) -> None:
    file = tmp_path / "g.csv"
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(rps.InputError, match=said) as caught:
        measured_flanks(GEAR.replace({"pinion.deviation": str(file)}))
    assert len(caught.value.args) == 1
    assert "pinion.deviation" in str(caught.value)


def test_heights_of_a_rack_are_stated_as_in_its_file(tmp_path: Path) -> None:
    axes = rack_axes(GEAR, 9, 9) | {"height": np.linspace(0.5e-3, 1.9e-3, 9)}
    file = write_grid(tmp_path / "r.csv", axes, lambda y, z: 0 * y)
    said = r"rack\.deviation covers height 0\.5 to 1\.9 mm .* from \S+ to 1\.83 mm"
    with pytest.raises(rps.InputError, match=said):
        measured_flanks(GEAR.replace({"rack.deviation": file}))


def test_waves_that_are_too_sharp_are_refused(tmp_path: Path) -> None:
    for part, axes in (("pinion", pinion_axes(GEAR, 65)), ("rack", rack_axes(GEAR, 65))):
        file = write_grid(tmp_path / f"{part}.csv", axes, lambda u, w: 2e-6 * np.sin(2 * np.pi * u / 1e-3))
        with pytest.raises(rps.InputError, match="smooth the grid over longer waves"):
            measured_flanks(GEAR.replace({f"{part}.deviation": file}))


def test_missing_and_changed_files_are_named(tmp_path: Path) -> None:
    with pytest.raises(
        rps.InputError, match=r"rack\.deviation names a file that cannot be read.*nowhere\.csv"
    ):
        GEAR.replace({"rack.deviation": str(tmp_path / "nowhere.csv")})
    file = tmp_path / "g.csv"
    write_grid(file, pinion_axes(GEAR, 5, 5), lambda q, z: 0 * q)
    gear = GEAR.replace({"pinion.deviation": str(file)})
    write_grid(file, pinion_axes(GEAR, 5, 5), lambda q, z: 0 * q + 1e-6)
    with pytest.raises(rps.InputError, match=r"set pinion\.deviation again"):
        measured_flanks(gear)
    file.unlink()
    with pytest.raises(rps.InputError, match=r"pinion\.deviation: .*g\.csv cannot be read"):
        rps.run("free-pinion-torque", gear, fidelity="quasi-static")


def test_file_is_sought_beside_the_gear_and_kept_in_its_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "gears").mkdir()
    write_grid(tmp_path / "gears" / "g.csv", pinion_axes(GEAR, 5, 5), lambda q, z: 0 * q + 1e-6)
    (tmp_path / "gears" / "mine.toml").write_text('[pinion]\ndeviation = "g.csv"\n', encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    gear = SteeringGear.from_toml("gears/mine.toml")
    assert gear.pinion.deviation.startswith("gears/g.csv sha256:")
    assert gear == GEAR.replace({"pinion.deviation": "gears/g.csv"})
    result = rps.run("free-pinion-torque", gear, fidelity="quasi-static")
    result.save(tmp_path / "r.h5")
    assert rps.load(tmp_path / "r.h5").gear.pinion == gear.pinion


def test_models_without_measured_flanks_refuse_them(tmp_path: Path) -> None:
    rack = write_grid(tmp_path / "r.csv", rack_axes(GEAR, 5, 5), lambda y, z: 0 * y - 2e-6)
    gear = GEAR.replace({"rack.deviation": rack})
    sentences = {"closed-form": "leave out rack.deviation", "full": "the largest of rack.deviation"}
    for model, said in sentences.items():
        refused = rps.run("free-pinion-torque", gear, fidelity=model)
        assert refused.status is rps.Status.INVALID
        assert said in refused.message
