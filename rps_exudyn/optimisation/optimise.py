"""Python's way in: a file in, the best gears or the cheapest tolerances out, with a page in their folder."""

import sys
from collections.abc import Sequence
from pathlib import Path
from shlex import join

from rps_exudyn.base.files import replacing
from rps_exudyn.optimisation.confirmation import confirm
from rps_exudyn.optimisation.definition import Problem, read_problem
from rps_exudyn.optimisation.optimisation_page import Optimisation, gear_sheets, optimisation_sheet
from rps_exudyn.optimisation.search import search
from rps_exudyn.optimisation.tolerance_page import tolerance_sheet
from rps_exudyn.optimisation.tolerance_search import Tolerancing, search_tolerances
from rps_exudyn.optimisation.tolerances import ToleranceProblem, tolerances_of
from rps_exudyn.pages.report.html import write_page
from rps_exudyn.pages.report.sheet_file import FOLDER_SHEET, write_sheet
from rps_exudyn.parameters.declaration import read_toml
from rps_exudyn.parameters.gear import gear_file
from rps_exudyn.results.sheet import Sheet
from rps_exudyn.simulate.cases.run_cases import CaseRunner, checked_jobs
from rps_exudyn.study.definition import Study

PAGE = "optimisation.html"


def optimise(
    file: str | Path, out: str | Path | None = None, jobs: int | None = None, toy: bool = False
) -> Optimisation:
    """Search for the gears whose series is best, and compute the best ones again on fresh gears.

    The folder holds each design as soon as it is computed: the same call continues after an interruption, and
    ends as one that was not interrupted. It will hold the best gears and a page, too.

    Args:
        file: TOML file, see docs/tutorial/9-optimisation.md.
        out: folder, as of a study; by default the file's name, in the current folder.
        jobs: number of processes; by default one per processor, where that is faster.
        toy: tries the file with eight designs of eight gears, in a folder NAME-toy.

    Raises:
        InputError: everything that is wrong with the file, a folder of something else, or no pymoo.

    Examples:
        >>> lines = ["designs = 8", "confirm = [0, 0]", "errors = 'none'", "fidelity = 'closed-form'"]
        >>> lines += ["variables.yoke.preload = [200, 400]", "objectives.torque_mean.goal = 'least'"]
        >>> import pathlib
        >>> _ = pathlib.Path("least.toml").write_text("\\n".join(lines))
        >>> found = rps.optimise("least.toml")
        >>> len(found.search.designs), found.front[0].gear.yoke.preload < 300
        (8, True)
    """
    return optimised(read_problem(file), out, jobs, toy)


def tolerances(
    file: str | Path, out: str | Path | None = None, jobs: int | None = None, toy: bool = False
) -> Tolerancing:
    """Choose the cheapest classes of tolerances with which a share of the gears keeps the limits.

    The folder serves as that of `optimise`, also after an interruption.

    Args:
        file: TOML file with the table `tolerances`, see docs/tutorial/9-optimisation.md.
        out: folder, as of a study; by default the file's name, in the current folder.
        jobs: number of processes; by default one per processor, where that is faster.
        toy: tries the file with 64 gears, in a folder NAME-toy.

    Raises:
        InputError: everything that is wrong with the file, gears that fail, or a folder of something else.

    Examples:
        >>> lines = ["confirm = [256, 0]", "errors = 'none'", "fidelity = 'closed-form'", "samples = 256"]
        >>> lines += ["constraints.torque_mean.most = '0.7 N*m'"]
        >>> lines += ["tolerances.yoke.preload.fine = ['300 N +- 9 N', 1]"]
        >>> import pathlib
        >>> _ = pathlib.Path("costs.toml").write_text("\\n".join(lines))
        >>> rps.tolerances("costs.toml").classes
        {'yoke.preload': 'fine'}
    """
    return toleranced(tolerances_of(Path(file), read_toml(file)), out, jobs, toy)


def optimised(problem: Problem, out: str | Path | None, jobs: int | None, toy: bool) -> Optimisation:
    """Do what `optimise` does, of a file that was read."""
    folder = _folder(problem.study, out, toy)
    problem = problem.toy() if toy else problem
    with CaseRunner(checked_jobs(jobs), problem.study.time_limit) as runner:
        done = search(problem, folder, runner)
        found = Optimisation(done, confirm(done, runner))
    for path, design in found.files.items():
        with replacing(path) as partial:
            partial.write_text(gear_file(design.gear), encoding="utf-8")
    _write([optimisation_sheet(found, _command()), *gear_sheets(found)], folder)
    return found


def toleranced(problem: ToleranceProblem, out: str | Path | None, jobs: int | None, toy: bool) -> Tolerancing:
    """Do what `tolerances` does, of a file that was read."""
    folder = _folder(problem.problem.study, out, toy)
    problem = problem.toy() if toy else problem
    with CaseRunner(checked_jobs(jobs), problem.problem.study.time_limit) as runner:
        found = search_tolerances(problem, folder, runner)
    _write([tolerance_sheet(found, _command())], folder)
    return found


def _folder(study: Study, out: str | Path | None, toy: bool) -> Path:
    return Path(f"{study.name}-toy" if toy else study.name) if out is None else Path(out)


def _command() -> str:
    return join(["rps-exudyn", *sys.argv[1:]])


def _write(sheets: Sequence[Sheet], folder: Path) -> None:
    """Write the page, and the sheet by which `report` shows the folder."""
    write_page(sheets, folder / PAGE)
    write_sheet(sheets[0], folder / FOLDER_SHEET)
