"""Origin of a result: versions, git hash, date, machine."""

import json
import os
import platform
import subprocess
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import distribution, version
from pathlib import Path

FIELDS = ("package_version", "library_versions", "git_hash", "date", "machine")
MODEL_VERSION = 2
"""To be raised when the same parameters give other numbers: finished cases are then done anew."""
LIBRARIES = ("exudyn", "numpy", "scipy", "llvmlite", "h5py", "trimesh", "manifold3d")


def provenance() -> dict[str, str]:
    """Return the text of the root attributes of a result, see docs/hdf5-format.md."""
    date = datetime.now(UTC).isoformat(timespec="seconds")
    texts = package_version(), library_versions(), git_hash(), date, machine()
    return dict(zip(FIELDS, texts, strict=True))


@cache
def package_version() -> str:
    return version("rps-exudyn")


@cache
def library_versions() -> str:
    """Return JSON text: name -> version of the libraries that compute."""
    return json.dumps({name: _version(name) for name in LIBRARIES})


def _version(name: str) -> str:
    """The version of an installed library, without reading the rest of its metadata."""
    lines = (distribution(name).read_text("METADATA") or "").splitlines()
    found = next((line for line in lines if line.startswith("Version:")), None)
    return found.removeprefix("Version:").strip() if found else version(name)


@cache
def git_hash() -> str:
    """Return the commit of the checkout that runs, "-dirty" if edited since; "" if installed elsewhere."""
    folder = Path(__file__).parent
    if not _git(folder, "ls-files", Path(__file__).name):  # an installed copy inside some other checkout
        return ""
    return _git(folder, "describe", "--always", "--abbrev=40", "--exclude=*", "--dirty")


@cache
def machine() -> str:
    """Return processor, its count, operating system and Python, without names of the host or its user."""
    return f"{_processor()}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:  # not Linux
        lines = []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine()


def _git(folder: Path, *arguments: str) -> str:
    command = ["git", "-C", str(folder), *arguments]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    except (OSError, subprocess.SubprocessError):  # no git, or no checkout
        return ""
    return done.stdout.strip()
