"""A scene's name stands in its own file and the list of scenes: facts about it are fields of its record."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import rps_exudyn
from rps_exudyn.scenes import SCENE_NAMES

PACKAGE = Path(rps_exudyn.__file__).parent
HELP = ("parameters/rig.py", "parameters/fidelity.py", "results/quantities.py", "cli/")
"""Say for readers what a value belongs to."""
ELSEWHERE = ("templates/", "verification/")  # a user's files; independent methods


def literals(tree: ast.AST) -> Iterator[str]:
    """Yield the strings of a module but for its docstrings."""
    docstrings = {
        id(node.value)
        for body in (getattr(node, "body", []) for node in ast.walk(tree))
        for node in (body if isinstance(body, list) else [])
        if isinstance(node, ast.Expr)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docstrings:
            yield node.value


@cache
def texts() -> dict[str, list[str]]:
    """File of the package -> its strings."""
    return {
        name: list(literals(ast.parse(path.read_text(encoding="utf-8"))))
        for path in sorted(PACKAGE.rglob("*.py"))
        if not (name := path.relative_to(PACKAGE).as_posix()).startswith(ELSEWHERE)
    }


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
