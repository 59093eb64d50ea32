"""Interleaved rounds: every method once, then every method again, and the least CPU time of each.

A method that fails is a row with its message; a program that is not installed is named and left out.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from typing import Any

import numpy as np

from benchmarks.peers.reference import ANGLES
from benchmarks.peers.scene import GEAR, TURN, Method, Run
from benchmarks.peers.score import averaged, score

PITCH = round(360 / GEAR.pinion.teeth)  # angles of `ANGLES` on a tooth pitch
NEEDED = {"MuJoCo": ("mujoco", "mujoco"), "Drake": ("pydrake", "drake")}
"""Program -> the module that it needs, and the distribution that has it."""

NOT_TO_BE_HAD = {
    "Chrono": "the package index holds only its reserved name without content (projectchrono 0.0.0), and "
    "another project by the name pychrono",
}
Finest = Mapping[str, np.ndarray]
"""Program -> the torque that it tends to itself, at `ANGLES` [N m]."""


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
    own: float = np.nan  # RMS error against the program's own finest curve [%]

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
    methods: Sequence[Method],
    torque: np.ndarray,
    rounds: int,
    enough_s: float,
    turned: float = TURN,
    finest: Finest | None = None,
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
        return _row(method, runs[i], torque, turned, (finest or {}).get(method.program))

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


def _row(
    method: Method, runs: Sequence[Run], torque: np.ndarray, turned: float, finest: np.ndarray | None
) -> Row:
    covered = np.rad2deg(turned) + 1e-6 >= ANGLES
    curve = np.rad2deg(runs[0].angle), runs[0].torque
    off = score(*curve, ANGLES[covered], torque[covered])
    own = np.nan if finest is None else score(*curve, ANGLES[covered], finest[covered]).error
    loop, whole = (min(getattr(run, name) for run in runs) * TURN / turned for name in ("loop_s", "whole_s"))
    return Row(method.program, method.label, "", *off, loop, whole, len(runs), own)


def curve_of(method: Method) -> np.ndarray:
    """Return the torque that a method finds over one tooth pitch, repeated, at `ANGLES` [N m].

    Raises:
        ArithmeticError: the run failed.
    """
    pitch = ANGLES[:PITCH]
    run = method.run(TURN / GEAR.pinion.teeth)
    found = averaged(np.rad2deg(run.angle), run.torque, pitch)
    return np.resize(found, ANGLES.size)


def as_data(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Return rows for a data file, without numbers where there are none."""
    return [{name: value for name, value in asdict(row).items() if value == value} for row in rows]


def from_data(rows: Sequence[Mapping[str, Any]]) -> list[Row]:
    """Return the rows that `as_data` wrote."""
    return [Row(**row) for row in rows]
