"""The strings in the package's code, file by file."""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import rps_exudyn

PACKAGE = Path(rps_exudyn.__file__).parent
ELSEWHERE = ("templates/",)  # files of a user


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
