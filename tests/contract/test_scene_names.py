"""A scene's name stands in its own file and the list of scenes: facts about it are fields of its record."""

import ast
import re
from dataclasses import replace

import pytest

from package_strings import literals, texts
from rps_exudyn.scenes import SCENE_NAMES, scene_named

HELP = ("parameters/rig.py", "parameters/fidelity.py", "results/quantities.py", "cli/")
"""Say for readers what a value belongs to."""


def files_with(scene: str) -> list[str]:
    """Return the files of the package that hold a scene's name; a word of English only as a whole string."""
    named = re.compile(rf"(?<![\w-]){scene}(?![\w-])" if "-" in scene else rf"\A{scene}\Z")
    return [name for name, found in texts().items() if any(named.search(text) for text in found)]


@pytest.mark.parametrize("scene", SCENE_NAMES)
def test_a_scenes_name_stands_in_its_file_alone(scene: str) -> None:
    own = {"scenes/__init__.py", f"scenes/{scene.replace('-', '_')}.py"}
    found = files_with(scene)
    assert own <= set(found)
    assert [name for name in found if name not in own and not name.startswith(HELP)] == []


def test_a_name_in_code_is_found_and_one_in_a_docstring_is_not() -> None:
    tree = ast.parse('"""of load-test"""\ndef f():\n    """load-test"""\n    return f"load-test@{1}"\n')
    assert [text for text in literals(tree) if "load-test" in text] == ["load-test@"]


def test_former_names_of_fields_still_work() -> None:
    scene = scene_named("reversal")
    assert getattr(scene, "figure") == scene.main_metric  # noqa: B009
    assert replace(scene, figure="torque_jump").main_metric == "torque_jump"  # type: ignore[call-arg]
    assert replace(scene, main_metric="lost_motion").main_metric == "lost_motion"
