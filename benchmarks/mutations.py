"""Lines of physics made wrong one at a time, in a copy of the checkout: which test fails?

A mutation is another sign, operator or small number in a function of Python: a wrong kernel would compile for
minutes. A seed and the line's text decide which are drawn, so that other lines may change. The test files
nearest to the line run. A run keeps what it has of the same line and the same tests.
"""

import ast
import os
import re
import resource
import shutil
import subprocess
import sys
from collections import Counter
from hashlib import sha256
from operator import itemgetter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from benchmarks.topic import ROOT, Columns, Topic, begun, load_data, markdown, rows_table, save_data

DATA, SEED = "mutations.json", "1"
DRAWN = {"forces": 8, "tooth_contact": 7, "simulate": 5, "scenes": 10}  # in a folder of the package
PER_FILE, NEIGHBOURS = 2, 5  # mutations, and test files
LIMIT = 30  # CPU time of the tests of a mutation [s]
COMPILED = re.compile(r"\b(kernel|inline|entry|primitive)\b")  # decorators
NO_PHYSICS = re.compile(r"[\"'#]|raise |len\(|progress|fraction|monotonic|process_time|timeout|jobs")
PLACES = re.compile(r"(?<= )[-+*/<>](?= )|(?<=[(=\[ ])-(?=\w)|(?<![.\w])[1-4](?![.\w])")
SWAPPED = dict(zip("+-*/<>1234", "-+/*><2345", strict=True))
BEFORE = {"caught": 16, "of": 30, "source": "other lines of commit 5678199, nearest tests, 60 s each"}
KEY = itemgetter("file", "right", "wrong", "tests")  # of what is not tried again
Mutation = dict[str, Any]  # its file and line, and the line's text, right and wrong


def run(folder: Path, drawn: dict[str, int] = DRAWN) -> None:
    """Try each mutation."""
    known = {KEY(row): row["by"] for row in begun(folder / DATA).get("mutations", [])}
    with TemporaryDirectory() as place:
        tree = Path(place) / "tree"
        shutil.copytree(ROOT, tree, symlinks=True, ignore=shutil.ignore_patterns(".*"))
        rows = [each for part, most in drawn.items() for each in draw(tree, part, most)]
        tests = [neighbours(tree, row["file"]) for row in rows]
        for row, names in zip(rows, tests, strict=True):
            row["tests"] = sha256(b"".join((tree / name).read_bytes() for name in names)).hexdigest()[:12]
            row["by"] = known.get(KEY(row))
        for row, names in zip(rows, tests, strict=True):
            if row["by"] is None:
                row["by"] = caught_by(tree, row, names)
                print(row, flush=True)
            tried = [each for each in rows if each["by"] is not None]
            save_data(folder / DATA, {"seed": SEED, "before": BEFORE, "mutations": tried})


def draw(tree: Path, part: str, most: int) -> list[Mutation]:
    """Return mutations of a folder or file of the package."""
    found: dict[str, Mutation] = {}
    for file in sorted((tree / "rps_exudyn").glob(f"{part}/**/*.py")) or [tree / "rps_exudyn" / part]:
        text, name = file.read_text(encoding="utf-8"), file.relative_to(tree).as_posix()
        for function in (each for each in ast.walk(ast.parse(text)) if isinstance(each, ast.FunctionDef)):
            body = function.body[ast.get_docstring(function) is not None :]
            if not body or COMPILED.search(" ".join(map(ast.unparse, function.decorator_list))):
                continue
            for number in range(body[0].lineno, (body[-1].end_lineno or 0) + 1):
                right = text.splitlines()[number - 1].strip()
                for at in () if NO_PHYSICS.search(right) else PLACES.finditer(" " + right):
                    wrong = (" " + right)[: at.start()] + SWAPPED[at[0]] + (" " + right)[at.end() :]
                    key = sha256(f"{SEED} {name} {wrong}".encode()).hexdigest()
                    found[key] = {"file": name, "line": number, "right": right, "wrong": wrong.strip()}
    ranked = [found[key] for key in sorted(found)]
    files = [each["file"] for each in ranked]
    chosen = [each for i, each in enumerate(ranked) if files[:i].count(each["file"]) < PER_FILE]
    return chosen[:most]


def neighbours(tree: Path, file: str) -> list[str]:
    """Return the nearest test files: of its name, that use more of it, of modules that import it."""
    tests = sorted((tree / "tests").glob("*/test_*.py"), key=lambda path: len(path.stem))
    uses = {path: _names_in(path) for path in [*tests, *(tree / "rps_exudyn").rglob("*.py")]}
    leaf, level = Path(file).stem, {file.removesuffix(".py").replace("/", ".")}
    level |= {leaf.replace("_", "-")} if "/scenes/" in file else set()  # a scene is run by its name
    nearest = [path for path in tests if leaf in path.stem or path.stem[5:] in leaf]
    while level and len(nearest) < NEIGHBOURS:
        ranks = {path: sum(used[each] for each in level) for path, used in uses.items()}
        near = [path for path in tests if ranks[path] and path not in nearest]
        nearest += sorted(near, key=lambda path: -ranks[path])
        above = [path.relative_to(tree).with_suffix("").parts for path in uses if ranks[path]]
        level = {".".join(parts) for parts in above if parts[0] == "rps_exudyn"}
    return [str(path.relative_to(tree)) for path in nearest[:NEIGHBOURS]]


def _names_in(file: Path) -> Counter[str]:
    """Return the modules that a file imports from, with how many names of each, and its strings."""
    names: Counter[str] = Counter()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            names.update([str(node.module)] * len(node.names))
            names.update(f"{node.module}.{each.name}" for each in node.names)
        elif isinstance(node, ast.Constant):
            names[str(node.value)] += 1
    return names


def caught_by(tree: Path, mutation: Mutation, tests: list[str]) -> str:
    """Return the first test that fails with the mutation alone, within `LIMIT`; "" if none does."""
    file = tree / mutation["file"]
    right = file.read_text(encoding="utf-8")
    lines = right.split("\n")
    lines[mutation["line"] - 1] = lines[mutation["line"] - 1].replace(mutation["right"], mutation["wrong"])
    file.write_text("\n".join(lines), encoding="utf-8")
    first = _failed(tree, tests)
    file.write_text(right, encoding="utf-8")
    return "" if first and _failed(tree, [first]) else first


def _failed(tree: Path, tests: list[str]) -> str:
    """Return the first test that fails within `LIMIT`; "" if there is none."""
    command = [sys.executable, "-m", "pytest", "-n", "0", "-x", "-q", "-p", "no:cacheprovider", *tests]
    given = {"PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1", "OPENBLAS_NUM_THREADS": "1"}

    def confine() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT))
        resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30))

    done = subprocess.run(
        command, cwd=tree, env=os.environ | given, capture_output=True, text=True, preexec_fn=confine
    )
    names = re.findall(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", done.stdout, re.M)
    return [*names, "a module"][0] if done.returncode in (1, 2) else ""


def counts(folder: Path) -> str:
    """How many are caught, of each folder of the package, of all, and of those of an earlier draw."""
    data = load_data(folder / DATA)
    tried = Counter(row["file"].split("/")[1] for row in data["mutations"])
    caught = Counter(row["file"].split("/")[1] for row in data["mutations"] if row["by"])
    rows = [(f"`{part}`", tried[part], caught[part]) for part in DRAWN]
    rows += [("all", tried.total(), caught.total())]
    rows += [("all, in an earlier draw", data["before"]["of"], data["before"]["caught"])]
    return markdown(("lines of", "mutated", "caught"), rows)


COLUMNS: Columns = {
    "line": lambda row: f"{row['file'].partition('/')[2]}:{row['line']}",
    "caught by": lambda row: row["by"].partition(".py")[0].rpartition("/")[2] or "-",
    "made wrong": lambda row: f"`{row['wrong']}`".replace("|", r"\|"),
}
TABLES = {"mutations": rows_table(DATA, "mutations", COLUMNS), "mutation_counts": counts}
TOPIC = Topic("15 min", "testing", run, {"drawn": {"forces/bush.py": 1}}, TABLES)
