"""Other libraries are used by their public names, unchanged, and without subclasses of their compilers."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import rps_exudyn

PACKAGE = Path(rps_exudyn.__file__).parent
OWN = {"rps_exudyn"}
PRIVATE = ("numba.core", "numba.np", "numba.cpython", "numba.experimental")
"""Modules that are their libraries' own, whatever their names."""
COMPILER = "base/kernel_compiler.py"
"""No run needs it: numba documents that its extensions use `numba.core`."""
SETTINGS = "exudyn.config."  # made to be set
UNTOUCHED = ("numba", "numpy", "scipy", "exudyn", "matplotlib", "h5py", "trimesh", "pydantic")


def imported(tree: ast.AST) -> dict[str, str]:
    """Names in a module that stand for other libraries' modules and objects, with what they stand for."""
    names = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for each in node.names:
                whole = each.name if each.asname else each.name.partition(".")[0]
                names[each.asname or whole] = whole
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names |= {each.asname or each.name: f"{node.module}.{each.name}" for each in node.names}
    known = sys.stdlib_module_names
    return {
        name: of
        for name, of in names.items()
        if of.partition(".")[0] not in OWN and of.partition(".")[0] not in known
    }


def root(node: ast.AST) -> str:
    """The name that a chain of attributes begins with."""
    while isinstance(node, ast.Attribute):
        node = node.value
    return node.id if isinstance(node, ast.Name) else ""


def full(node: ast.AST, names: dict[str, str]) -> str:
    """What a chain of attributes stands for, "" if it is no other library's."""
    parts = []
    while isinstance(node, ast.Attribute):
        parts.append(node.attr)
        node = node.value
    if not isinstance(node, ast.Name) or node.id not in names:
        return ""
    return ".".join([names[node.id], *reversed(parts)])


def is_private(name: str) -> bool:
    parts = name.split(".")
    hidden = any(part.startswith("_") and not part.endswith("__") for part in parts)
    return hidden or any(name == each or name.startswith(f"{each}.") for each in PRIVATE)


def faults(source: str) -> Iterator[str]:
    """Yield what a module does to other libraries that it should not do."""
    tree = ast.parse(source)
    names = imported(tree)
    for name in names.values():
        if is_private(name):
            yield f"imports {name}"
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and (name := full(node, names)):
            if name.startswith(SETTINGS):
                continue
            if isinstance(node.ctx, ast.Store | ast.Del):
                yield f"changes {name}"
            elif is_private(name):
                yield f"uses {name}"
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            if node.func.id in ("setattr", "delattr") and root(node.args[0]) in names:
                yield f"changes {names[root(node.args[0])]}"
        elif isinstance(node, ast.ClassDef):
            for base in node.bases:
                if full(base, names).partition(".")[0] in ("numba", "llvmlite"):
                    yield f"subclasses {full(base, names)}"


@pytest.mark.parametrize(
    ("source", "fault"),
    [
        ("from numba.core import cgutils", "imports numba.core.cgutils"),
        ("import matplotlib as m\nm._api.check()", "uses matplotlib._api.check"),
        ("import numba\nnumba.config.CACHE_DIR = 'x'", "changes numba.config.CACHE_DIR"),
        ("import numba\nsetattr(numba.config, 'CACHE_DIR', 'x')", "changes numba"),
        ("from numba.types import Type\nclass Mine(Type): ...", "subclasses numba.types.Type"),
    ],
)
def test_faults_are_found(source: str, fault: str) -> None:
    assert fault in list(faults(source))


def test_no_module_reaches_into_other_libraries() -> None:
    found = {
        str(file.relative_to(PACKAGE)): each
        for file in sorted(PACKAGE.rglob("*.py"))
        if file != PACKAGE / COMPILER and (each := list(faults(file.read_text(encoding="utf-8"))))
    }
    assert found == {}


RUN = f"""
import importlib, sys
libraries = {UNTOUCHED}
for library in libraries:
    importlib.import_module(library)
def attributes():
    return {{
        (name, key): id(value)
        for name, module in list(sys.modules.items())
        if name.partition(".")[0] in libraries
        for key, value in list(vars(module).items())
        if callable(value) or isinstance(value, (str, bytes, tuple))
    }} | {{
        (name, key, part): id(each)
        for name, module in list(sys.modules.items())
        if name.partition(".")[0] in libraries
        for key, value in list(vars(module).items())
        if isinstance(value, type) and value.__module__.partition(".")[0] in libraries
        for part, each in list(vars(value).items())
        if callable(each)
    }}
import rps_exudyn as rps
before = attributes()
rps.run("free-pinion-torque", fidelity="quasi-static")
after = attributes()
print([key for key in before if key in after and after[key] != before[key]])
"""


def test_a_run_leaves_the_libraries_as_they_were() -> None:
    done = subprocess.run([sys.executable, "-c", RUN], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
