"""Windows of parameters: the end by hand, none, a map, the command, and wrong input."""

import json
from pathlib import Path

import pytest

import rps_exudyn as rps
from rps_exudyn.inference.uncertainty.input_sets import carried
from rps_exudyn.parameters.declaration import DEG
from rps_exudyn.parameters.fidelity import FOR_MEANS
from shell import Command

GEAR, PRELOAD = rps.SteeringGear(), "yoke.preload"
COARSE = FOR_MEANS.replace({"step_angle": 5 * DEG})
SCATTER = "uniform(20 N*mm, 60 N*mm)"
OWN = carried({}, {"bearing.friction_torque": SCATTER})
LIMITS = {"free_torque": {"least": "0.5 N*m", "most": "0.8 N*m"}, "gain": {"least": "30 mm"}}


@pytest.fixture(autouse=True)
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("window", "judging"):
        monkeypatch.setattr(f"rps_exudyn.assessment.requirements.{module}.FOR_MEANS", COARSE)


def test_ends_are_those_of_the_gear_at_the_quantile() -> None:
    """A friction of the bearings adds to the torque: at the ends its quantile of 90 % meets the limit."""
    found = rps.window(GEAR, PRELOAD, LIMITS, share=0.9, inputs="own", own=OWN, samples=16)
    law = {"mesh.law": "teeth"}
    for end, quantile, limit in zip(found.ends, (0.1, 0.9), (0.5, 0.8), strict=True):
        friction = float(OWN["bearing.friction_torque"].quantile(quantile))
        gear = GEAR.replace({PRELOAD: end.value, "bearing.friction_torque": friction, **law})
        torque = rps.run("free-pinion-torque", gear, fidelity=COARSE, start_angle="-180 deg").summary
        assert torque["torque_mean"] == pytest.approx(limit, abs=0.001)
        assert end.limited_by == ("free_torque",)
        assert 0 < end.numerical < 5
    assert found.best_share == 1
    assert found.each["gain"].min() == 1
    low, high = (end.value for end in found.ends)
    assert low < found.best[PRELOAD] < high


def test_without_a_window_the_nearest_value_and_what_forbids_it() -> None:
    """Limits of half the scatter's width are kept by half of the gears where all their range is reached."""
    narrow = {"free_torque": {"least": "0.61 N*m", "most": "0.63 N*m"}}
    found = rps.window(GEAR, PRELOAD, narrow, inputs="own", own=OWN, samples=16)
    assert found.ends == ()
    assert found.forbidden_by == ("free_torque",)
    assert found.best_share == pytest.approx(0.5, abs=0.07)
    assert 275 < found.best[PRELOAD] < 300


def test_two_parameters_have_a_map() -> None:
    """A stronger friction needs a smaller preload."""
    found = rps.window(
        GEAR,
        [PRELOAD, "yoke.friction"],
        LIMITS,
        inputs="own",
        own=OWN,
        samples=8,
        ranges={PRELOAD: ("150 N", "600 N"), "yoke.friction": (0.05, 0.2)},
    )
    inside = found.shares >= found.share
    middles = [
        found.places[0][inside[:, k]].mean() for k in range(len(found.places[1])) if inside[:, k].any()
    ]
    assert len(middles) > 20
    assert middles == sorted(middles, reverse=True)


def test_command_prints_ends_and_what_limits_them(command: Command) -> None:
    Path("own.toml").write_text('free_torque = { most = "0.8 N*m" }\n')
    scatter = ("--set", f"bearing.friction_torque={SCATTER}", "--samples", "8")
    answer = command(["window", PRELOAD, "--limits", "own.toml", "--out", "w.json", *scatter])
    lines = answer.out.splitlines()
    assert answer.status == 0
    assert lines[0].startswith("Window of the yoke preload: ")
    assert lines[1].endswith("95 % of the gears keep the limits")
    assert lines[2].endswith("the search ended here, no limit does")
    assert "free torque, at most 0.8 N m" in lines[3]
    data = json.loads(Path("w.json").read_text())
    assert data["ends"][1]["limited_by"] == ["free_torque"]
    assert data["best_share"] == 1
    assert command(["report", "w.json"]).status == 0
    assert "data:image/svg" in Path("w.html").read_text()
    none = command(["window", PRELOAD, "--limits", "own.toml", "--range", "500 N, 600 N", *scatter])
    assert none.status == 1
    assert "forbidden  by free torque, at most 0.8 N m" in none.out


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"share": "120%"}, "the share is '120%'; it must be more than 0 % and less than 100 %"),
        ({"share": 0}, "the share is 0; it must be more than 0 %"),
        ({"paths": "yoke.preloads"}, "yoke.preloads is no number of a gear; the nearest one is yoke.preload"),
        ({"paths": "pinion.runout"}, "pinion.runout is 0 mm; give the range"),
        ({"paths": [PRELOAD] * 3}, "a window has one parameter or two"),
        (
            {"paths": [PRELOAD, "yoke.friction"]},
            "a map needs the range of each parameter; give that of yoke.",
        ),
        ({"paths": "bearing.friction_torque"}, "bearing.friction_torque carries a distribution"),
        ({"ranges": {PRELOAD: (400, 300)}}, "the range of yoke.preload is 400 N to 300 N; it must rise"),
        ({"ranges": {PRELOAD: ("1 m", 300)}}, "the range of yoke.preload is '1 m'"),
        ({"samples": 3}, "the window has 3 gears at each value; it needs at least 8"),
        (
            {"limits": {"free_torque": {"least": 2, "most": 1}}},
            "limits: free_torque.least must be below most, 1 N m",
        ),
        ({"limits": {"hysteresis_area": {"most": 2}}}, "the tests of this gear"),
    ],
)
def test_wrong_input_is_one_sentence(changes: dict[str, object], said: str) -> None:
    usual = {"paths": PRELOAD, "limits": LIMITS, "inputs": "own", "own": OWN} | changes
    with pytest.raises(rps.InputError) as refused:
        rps.window(GEAR, **usual)  # type: ignore[arg-type]
    assert [problem.startswith(said) for problem in refused.value.problems] == [True]
