"""What a fit leaves for the next gear of a series: where it ended, and what was simulated there.

The next gear differs from it by some percent, so that a fit that begins there needs one or two simulations.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import content_of, read_json_tables, write_json
from rps_exudyn.inference.fitting.problem import Problem

WHAT = "rps_exudyn fit, for the next gear of the series"
_LISTS = ("paths", "tests", "u", "values", "by_law")
_FORMERLY = {"gain", "slopes"}  # of files of earlier versions, not needed any more


@dataclass(frozen=True, eq=False)
class Series:
    """The end of a fit, for another gear with the same tests and free parameters."""

    law: str  # contact law of the fit
    paths: tuple[str, ...]  # of the unknowns
    tests: tuple[str, ...]
    u: np.ndarray  # unknowns, shape (unknowns,)
    values: np.ndarray  # simulated there, of all tests
    by_law: np.ndarray  # what another contact law moves, shape (unknowns,)

    def reason_not_usable(self, problem: Problem, law: str) -> str:
        """Why this is no start for a problem; "" if it is one."""
        if self.law != law:
            return f"it is of mesh.law = {self.law}, not {law}"
        if self.paths != (paths := tuple(each.path for each in problem.unknowns)):
            return f"it fitted {_listed(self.paths)}, not {_listed(paths)}"
        if self.tests != (tests := titles(problem)):
            return f"its tests were {_listed(self.tests)}, not {_listed(tests)}"
        size = sum(block.size for block in problem.prediction.blocks)
        return "" if self.values.size == size else "its curves cover another range of angles"


def titles(problem: Problem) -> tuple[str, ...]:
    """Names of the tests of a problem, in their order."""
    return tuple(block.test.title for block in problem.prediction.blocks)


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(dict.fromkeys(names))


def write_series(series: Series, path: str | Path) -> None:
    """Write a series' file.

    Raises:
        InputError: it cannot be written.
    """
    lists = {name: np.asarray(getattr(series, name)).tolist() for name in _LISTS}
    write_json(path, {"what": WHAT, "law": series.law, **lists})


def read_series(path: str | Path) -> Series:
    """Read a series' file.

    Raises:
        InputError: it cannot be read, or is none.
    """
    written = content_of(path)
    try:
        content = read_json_tables(written.decode("utf-8"), "it")
    except ValueError:
        content = {}
    if set(content) - _FORMERLY != {"what", "law", *_LISTS} or content["what"] != WHAT:
        raise InputError(f"{path} is not a file that fit --series wrote.")
    try:
        paths, tests = (tuple(map(str, content[name])) for name in ("paths", "tests"))
        u, values, by_law = (np.asarray(content[name], dtype=float) for name in ("u", "values", "by_law"))
        finite = all(np.isfinite(each).all() for each in (u, values, by_law))
        if not finite or values.ndim != 1 or u.shape != (len(paths),) or by_law.shape != (len(paths),):
            raise ValueError
    except (TypeError, ValueError, OverflowError):  # no numbers, or too large ones
        raise InputError(f"{path} is damaged: its numbers do not belong to one fit.") from None
    return Series(str(content["law"]), paths, tests, u, values, by_law)
