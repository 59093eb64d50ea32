"""Interleaved rounds: every method once, then every method again, and the least CPU time of each.

A method that fails is a row with its message; a program that is not installed is named and left out.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from typing import Any

import numpy as np

from benchmarks.peers.reference import ANGLES
from benchmarks.peers.scene import TURN, Method, Run
from benchmarks.peers.score import score

NEEDED = {"MuJoCo": ("mujoco", "mujoco"), "Drake": ("pydrake", "drake"), "Newton": ("newton", "newton")}
"""Program -> the module that it needs, and the distribution that has it."""

NOT_TO_BE_HAD = {
    "Chrono": "the package index holds only its reserved name without content (projectchrono 0.0.0), and "
    "another project by the name pychrono"
}


@dataclass(frozen=True)
class Row:
    """One method's errors and cost; times in CPU seconds per turn."""

    program: str
    label: str
    message: str = ""
    mean: float = np.nan  # error of the mean [%]
    shape: float = np.nan  # RMS of the rest [%]
    loop_s: float = np.nan
    whole_s: float = np.nan
    rounds: int = 0

    @property
    def ok(self) -> bool:
        """Return whether it ran."""
        return not self.message

    @property
    def error(self) -> float:
        """RMS of mean and shape [%]."""
        return float(np.hypot(self.mean, self.shape))


def installed(program: str) -> bool:
    """Return whether a program can be run: the package's own presets always."""
    name = program.partition(",")[0]
    return name not in NEEDED or find_spec(NEEDED[name][0]) is not None


def absent() -> dict[str, str]:
    """Return the programs that cannot be run here, and why."""
    missing = {name: "not installed" for name in NEEDED if not installed(name)}
    return missing | NOT_TO_BE_HAD


def versions() -> dict[str, str]:
    """Return the versions of the programs that are installed."""
    found = {}
    for name, (_, distribution) in {**NEEDED, "Exudyn": ("", "exudyn")}.items():
        try:
            found[name] = version(distribution)
        except PackageNotFoundError:
            continue
    return found


def measured(
    methods: Sequence[Method], torque: np.ndarray, rounds: int, enough_s: float, turned: float = TURN
) -> list[Row]:
    """Run all methods in rounds, each once a round; `torque` [N m] is the reference at `ANGLES`.

    A method whose runs have taken `enough_s` together is left out of further rounds: its least time is that
    of fewer.
    """
    runs: dict[int, list[Run]] = {i: [] for i in range(len(methods))}
    failed: dict[int, str] = {}

    def row(i: int) -> Row:
        method = methods[i]
        if i in failed:
            return Row(method.program, method.label, failed[i])
        return _row(method, runs[i], torque, turned)

    for number in range(rounds):
        for i, method in enumerate(methods):
            if i in failed or sum(run.whole_s for run in runs[i]) > enough_s:
                continue
            try:
                runs[i].append(method.run(turned))
            except ArithmeticError as error:
                failed[i] = str(error)
            print(f"round {number + 1}: {row(i)}", flush=True)
    return [row(i) for i in range(len(methods))]


def _row(method: Method, runs: Sequence[Run], torque: np.ndarray, turned: float) -> Row:
    covered = np.rad2deg(turned) + 1e-6 >= ANGLES
    off = score(np.rad2deg(runs[0].angle), runs[0].torque, ANGLES[covered], torque[covered])
    loop, whole = (min(getattr(run, name) for run in runs) * TURN / turned for name in ("loop_s", "whole_s"))
    return Row(method.program, method.label, "", *off, loop, whole, len(runs))


def as_data(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Return rows for a data file, without numbers where there are none."""
    return [{name: value for name, value in asdict(row).items() if value == value} for row in rows]


def from_data(rows: Sequence[Mapping[str, Any]]) -> list[Row]:
    """Return the rows that `as_data` wrote, perhaps of earlier versions with more fields."""
    return [Row(**{each.name: row[each.name] for each in fields(Row) if each.name in row}) for row in rows]
