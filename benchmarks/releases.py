"""Metrics over releases: what can be counted in the tree of each release, and what it published.

A release is a commit; its tree is read from the history, the present one from the folder.
"""

import json
import re
import subprocess
import tarfile
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from benchmarks.topic import ROOT, Topic, load_data, markdown, save_data

DATA, PRESENT = "releases.json", "1.1"
RELEASES = {"1.0": "05ad42b588bae20943b0b63067661e80ae622c5a"}
"""Release -> commit."""

WORDS = {
    "package_lines": "lines of the package",
    "test_lines": "lines of its tests",
    "tests": "test functions",
    "scenes": "scenes",
    "validation_rows": "rows of external data",
    "published_files": "published data files and pictures",
    "judged": "metrics of random plans judged against a reference",
    "covered": "of these within their error bars",
    "run": "CPU time of `rps-exudyn run`, not the first one [s]",
}


def run(folder: Path, releases: Mapping[str, str] = RELEASES) -> None:
    """Count in the tree of each release and in the present one."""
    found = {}
    for name, commit in releases.items():
        archive = subprocess.run(["git", "archive", commit], cwd=ROOT, check=True, capture_output=True)
        with TemporaryDirectory() as place, tarfile.open(fileobj=BytesIO(archive.stdout)) as tree:
            tree.extractall(place, filter="data")
            found[name] = metrics_of(Path(place))
    save_data(folder / DATA, {"releases": found | {PRESENT: metrics_of(ROOT)}})


def metrics_of(tree: Path) -> dict[str, Any]:
    """Return the metrics of a tree; None where it has published no such number."""
    package, tests = (_texts(tree / folder) for folder in ("rps_exudyn", "tests"))
    scenes = re.search(r"SCENE_NAMES = \((.*?)\)", _read(tree / "rps_exudyn/scenes/__init__.py"), re.S)
    bars = _read(tree / "results/coverage/README.md")
    coverage = re.search(r"^\| all \| \d+ \| (\d+) \| ([\d.]+%)", bars, re.M)
    steps = json.loads(_read(tree / "results/first_use/ten_minutes.json"))["steps"]
    runs = [round(step["cpu"], 1) for step in steps if re.fullmatch("rps-exudyn run", step["command"])]
    return {
        "package_lines": sum(text.count("\n") for text in package),
        "test_lines": sum(text.count("\n") for text in tests),
        "tests": sum(len(re.findall(r"^\s*def test_", text, re.M)) for text in tests),
        "scenes": len(re.findall(r'"[\w-]+"', scenes[1])) if scenes else None,
        "validation_rows": len(list((tree / "validation").rglob("row.toml"))),
        "published_files": len(json.loads(_read(tree / "results/published.json"))),
        "judged": int(coverage[1]) if coverage else None,
        "covered": coverage[2] if coverage else None,
        "run": runs[0],
    }


def _texts(folder: Path) -> list[str]:
    return [_read(path) for path in sorted(folder.rglob("*.py"))]


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8") if path.exists() else ""


def table(folder: Path) -> str:
    """The metrics as rows, the releases as columns."""
    releases = load_data(folder / DATA)["releases"]
    rows = [
        (words, *("-" if each[name] is None else each[name] for each in releases.values()))
        for name, words in WORDS.items()
    ]
    return markdown(("metric", *releases), rows)


TOPIC = Topic(takes="1 s", folder="coverage", run=run, toy={"releases": {}}, tables={"releases": table})
