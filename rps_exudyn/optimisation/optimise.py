"""Python's way in: a file in, the best gears out."""

import sys
from pathlib import Path
from shlex import join

from rps_exudyn.base.files import replacing
from rps_exudyn.optimisation.confirmation import confirm
from rps_exudyn.optimisation.definition import read_problem
from rps_exudyn.optimisation.optimisation_page import Optimisation, gear_sheets, optimisation_sheet
from rps_exudyn.optimisation.search import search
from rps_exudyn.optimisation.tolerance_page import tolerance_sheet
from rps_exudyn.optimisation.tolerance_search import Tolerancing, search_tolerances
from rps_exudyn.optimisation.tolerances import read_tolerances
from rps_exudyn.pages.report.html import write_page
from rps_exudyn.parameters.declaration import read_toml
from rps_exudyn.parameters.gear import gear_file
from rps_exudyn.simulate.cases.run_cases import CaseRunner, checked_jobs

PAGE = "optimisation.html"


def optimise(
    file: str | Path, out: str | Path | None = None, jobs: int | None = None, toy: bool = False
) -> Optimisation | Tolerancing:
    """Search for the gears whose series is best, and compute the best ones again on fresh gears.

    Of a file with the table `tolerances`, choose the cheapest classes instead, see `tolerances`.

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
    stem = Path(file).stem
    if "tolerances" in read_toml(file):
        wanted = read_tolerances(file)
        wanted, stem = (wanted.toy(), f"{stem}-toy") if toy else (wanted, stem)
        with CaseRunner(checked_jobs(jobs), wanted.problem.study.time_limit) as runner:
            chosen = search_tolerances(wanted, Path(stem if out is None else out), runner)
        write_page([tolerance_sheet(chosen, join(["rps-exudyn", *sys.argv[1:]]))], chosen.folder / PAGE)
        return chosen
    problem = read_problem(file)
    problem, stem = (problem.toy(), f"{stem}-toy") if toy else (problem, stem)
    folder = Path(stem if out is None else out)
    with CaseRunner(checked_jobs(jobs), problem.study.time_limit) as runner:
        done = search(problem, folder, runner)
        found = Optimisation(done, confirm(done, runner))
    for path, design in found.files.items():
        with replacing(path) as partial:
            partial.write_text(gear_file(design.gear), encoding="utf-8")
    command = join(["rps-exudyn", *sys.argv[1:]])
    write_page([optimisation_sheet(found, command), *gear_sheets(found)], folder / PAGE)
    return found
