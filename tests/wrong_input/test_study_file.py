"""A user's mistake in a study file or its folder: reported in sentences before anything runs."""

import json
from pathlib import Path

import pytest

from rps_exudyn.study.store import Store
from shell import Command, refusal_of
from study_files import write_grid

START = 'scene = "free-pinion-torque"\nfidelity = "quasi-static"\n'
AXIS = '[[axis]]\npath = "yoke.preload"\nvalues = [100, 200]\n'
SAMPLED = 'design = "sobol"\nsamples = 4\n'


@pytest.fixture(autouse=True)
def no_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wrong input must be found before anything runs."""

    def started(*_: object, **__: object) -> None:
        pytest.fail("a process was started in spite of wrong input")

    monkeypatch.setattr("rps_exudyn.simulate.cases.processes.Processes._start", started)
    monkeypatch.setattr("rps_exudyn.results.provenance.git_hash", lambda: "")


def axis(text: str, path: str = "yoke.preload") -> str:
    return f'{START}[[axis]]\npath = "{path}"\n{text}\n'


MISTAKES = {
    "no TOML": ("= 3", "s.toml is not a TOML file"),
    "unknown key": (f"speed = 3\n{START}{AXIS}", "speed is no key of a study; there are title, scene"),
    "unknown scene": (f'scene = "race"\n{AXIS}', "scene is 'race'; it must be one of free-pinion-torque"),
    "unknown fidelity": (f'fidelity = "best"\n{AXIS}', "fidelity is 'best'; it must be one of full"),
    "accuracy that is no percentage": (f'accuracy = "x"\n{AXIS}', "it must be a percentage greater than 0"),
    "metrics without an accuracy": (f'metrics = ["torque_mean"]\n{AXIS}', "give accuracy, too"),
    "accuracy of formulas": (f'accuracy = "1%"\nfidelity = "closed-form"\n{AXIS}', "has no ladder to climb"),
    "metrics that are none": (f'accuracy = "1%"\nmetrics = ["speed"]\n{AXIS}', "no metric with an error bar"),
    "accuracy and a model of one's own": (
        f'accuracy = "1%"\n[set]\nfidelity.step_angle = "1 deg"\n{AXIS}',
        "accuracy chooses the model itself; leave out fidelity.step_angle",
    ),
    "no axis": (START, "axis is missing: a study varies something"),
    "axis no table": ("axis = 3", "axis must be tables, each under [[axis]]"),
    "unknown axis": (axis("values = [1]", "yoke.preloat"), "yoke.preloat is no parameter; the nearest"),
    "a table": (axis("values = [1]", "yoke"), "yoke is a table; name one of its parameters"),
    "no path": (f"{START}[[axis]]\nvalues = [1]", "axis 1 needs path or paths"),
    "unknown axis key": (axis("range = [1, 2]"), "axis 1 has range, which is no key"),
    "wrong unit": (axis('values = ["3 kg"]'), "axis 1 (yoke.preload) is '3 kg', which is no quantity in N"),
    "wrong axis unit": (axis('unit = "mm"\nvalues = [1]'), "which is no quantity in N"),
    "empty axis": (axis("values = []"), "axis 1 (yoke.preload) is empty"),
    "value twice": (axis('values = [1, "1 N"]'), "has a value twice"),
    "no list": (axis("values = 3"), "has values = 3; it must be a list"),
    "not a number": (axis("values = [nan]"), "it must be finite"),
    "one shape": (axis("values = [1]\nlinspace = [1, 2, 3]"), "it has values and linspace"),
    "linspace": (axis("linspace = [1, 2]"), "it must be [first, last, number]"),
    "logspace from 0": (axis("logspace = [0, 2, 3]"), "both ends must be above 0"),
    "out of limits": (
        axis("values = [0.1, -1]", "mesh.friction"),
        "axis mesh.friction: mesh.friction is -1.0; it must be at least 0 and at most 1.",
    ),
    "does not fit the base": (
        axis('values = ["35 mm"]', "bush.inner_diameter"),
        "axis bush.inner_diameter: bush.inner_diameter is 35 mm; it must be smaller than bush.outer_diameter",
    ),
    "do not fit each other": (
        axis('values = ["25 mm", "29 mm"]', "bush.inner_diameter")
        + '[[axis]]\npath = "bush.outer_diameter"\nvalues = ["28 mm", "30 mm"]\n',
        "the case bush.inner_diameter = 0.029, bush.outer_diameter = 0.028: bush.inner_diameter is 29 mm",
    ),
    "said twice": (
        f"{START}[set]\nyoke.preload = 3\n{AXIS}",
        "varies yoke.preload, which is also given by [set]",
    ),
    "two axes": (
        f"{START}{AXIS}{AXIS}",
        "axis yoke.preload varies yoke.preload, which is also given by axis",
    ),
    "wrong base": (f'{START}[set]\nmesh.friction = "3 N"\n{AXIS}', "mesh.friction is '3 N'"),
    "unknown base": (f"{START}[set]\nmesh.frition = 3\n{AXIS}", "set: mesh.frition is no parameter"),
    "reserved name": (axis('name = "status"\nvalues = [1]'), "axis 1.name is 'status'"),
    "different units": (
        f'{START}[[axis]]\npaths = ["yoke.preload", "mesh.friction"]\nvalues = [1]',
        "different units; use along",
    ),
    "along too short": (
        axis("values = [1, 2]\nalong.mesh.friction = [0.1]"),
        "moves mesh.friction along with 1 values; it needs one for each of its own",
    ),
    "drawn on a grid": (axis("uniform = [1, 2]"), "has uniform, which only a sampled"),
    "grid in a sample": (SAMPLED + axis("linspace = [1, 2, 3]"), "has linspace; a sampled"),
    "uniform reversed": (SAMPLED + axis("uniform = [2, 1]"), "least below most"),
    "normal out of limits": (SAMPLED + axis("normal = [0.1, 0.1]", "mesh.friction"), "at least 0"),
    "unknown design": (f'design = "circle"\n{START}{AXIS}', "design is 'circle'; it must be one of grid"),
    "samples missing": (f'design = "sobol"\n{START}{AXIS}', "samples is missing"),
    "samples of a grid": (f"samples = 3\n{START}{AXIS}", "samples has no meaning for a grid"),
    "seed": (f"{SAMPLED}seed = -1\n{START}{AXIS}", "seed is -1; it must be a whole number from 0"),
    "time limit": (f'time_limit = "3 m"\n{START}{AXIS}', "time_limit is '3 m', which is no quantity in s"),
    "unknown signal": (f'{START}{AXIS}[keep]\nsignals = ["torque"]', "keep.signals has ['torque']"),
    "path upwards": (f'gear = "../gear.toml"\n{START}{AXIS}', "it must lie in the study file's folder"),
    "absolute path": (f'gear = "/etc/passwd"\n{START}{AXIS}', "it must lie in the study file's folder"),
    "through a link": (f'gear = "link/gear.toml"\n{START}{AXIS}', "it must lie in the study file's folder"),
    "gear missing": (f'gear = "none.toml"\n{START}{AXIS}', "none.toml cannot be read: there is no such file"),
    "too many cases": (axis("linspace = [1, 2, 6000]"), "more than 5000 are run with --yes"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_mistake_in_the_file(command: Command, tmp_path: Path, name: str) -> None:
    text, sentence = MISTAKES[name]
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "link").symlink_to("/tmp")
    file = tmp_path / "in" / "s.toml"
    file.write_text(text)
    said = refusal_of(command(["study", str(file)]))
    assert sentence in said
    assert "s.toml" in said
    assert "Traceback" not in said
    assert not (tmp_path / "s").exists()


def test_all_mistakes_at_once(command: Command, tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text(f"speed = 3\nseed = -1\n{START}{AXIS}{AXIS}")
    assert len(command(["study", "s.toml"]).err.splitlines()) == 4


def test_wrong_options(command: Command, tmp_path: Path) -> None:
    write_grid(tmp_path / "s.toml", 100)
    assert "--jobs is 0; it must be a whole number from 1" in command(["study", "s.toml", "--jobs", "0"]).err
    assert "none.toml cannot be read" in command(["study", "none.toml"]).err
    assert not (tmp_path / "s").exists()


def test_dry_run_touches_nothing(command: Command, tmp_path: Path) -> None:
    write_grid(tmp_path / "s.toml", 100, 200)
    answer = command(["study", "s.toml", "--dry-run", "--jobs", "2"])
    assert answer.status == 0
    assert answer.out.count("to do  yoke.preload = ") == 2
    assert "2 cases, 2 of them to be done: about" in answer.out
    assert [path.name for path in tmp_path.iterdir()] == ["s.toml"]


def test_folder_of_something_else(command: Command, tmp_path: Path) -> None:
    write_grid(tmp_path / "s.toml", 100)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear")
    assert "mine is no study's folder, and not empty" in refusal_of(
        command(["study", "s.toml", "--out", "mine"])
    )
    assert "is a file" in command(["study", "s.toml", "--out", "s.toml"]).err


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("{}", "is not the description of a study"),
        ('{"filetype": "rps_exudyn-study", "version": [9, 0]}', "has format version 9.0"),
        ('{"filetype": "rps_exudyn-study", "version": [1, 0]}', "is damaged"),
        ("{", "is damaged"),
    ],
)
def test_foreign_newer_or_damaged_study(
    command: Command, tmp_path: Path, content: str, sentence: str
) -> None:
    write_grid(tmp_path / "s.toml", 100)
    (tmp_path / "s").mkdir()
    (tmp_path / "s" / "study.json").write_text(content)
    assert sentence in refusal_of(command(["study", "s.toml"]))
    assert (tmp_path / "s" / "study.json").read_text() == content


def test_case_cannot_name_a_file_elsewhere(tmp_path: Path) -> None:
    from rps_exudyn.base.errors import InputError
    from rps_exudyn.study.cases import describe
    from rps_exudyn.study.study_file import read_study

    description = describe(read_study(write_grid(tmp_path / "s.toml", 100)), {})
    content = json.loads(description.to_json())
    content["cases"][0]["hash"] = "../../elsewhere"
    content |= {"version": [1, 0]}  # as files without a checksum had it
    del content["sha256"]
    (tmp_path / "study.json").write_text(json.dumps(content))
    with pytest.raises(InputError, match=r"is damaged: cases.0.hash"):
        Store.open(tmp_path)
