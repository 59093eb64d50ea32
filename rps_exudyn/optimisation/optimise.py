"""Python's way in: a file in, the best gears out."""

import sys
from pathlib import Path
from shlex import join

from rps_exudyn.base.files import replacing
from rps_exudyn.optimisation.confirmation import confirm
from rps_exudyn.optimisation.definition import Problem, read_problem
from rps_exudyn.optimisation.optimisation_page import (
    Optimisation,
    gear_files,
    gear_sheets,
    optimisation_sheet,
)
from rps_exudyn.optimisation.search import search
from rps_exudyn.pages.report.html import write_page
from rps_exudyn.parameters.gear import gear_file
from rps_exudyn.simulate.cases.processes import Processes
from rps_exudyn.simulate.cases.run_cases import checked_jobs

PAGE = "optimisation.html"


def optimise(file: str | Path, out: str | Path | None = None, jobs: int | None = None) -> Optimisation:
    """Search for the gears whose series is best, and compute the best ones again on fresh gears.

    The folder holds each design as soon as it is computed: the same call continues after an interruption, and
    ends as one that was not interrupted.

    Args:
        file: TOML file, see docs/optimisation.md.
        out: folder, as of a study; by default the file's name, in the current folder.
        jobs: number of processes; by default one per processor.

    Raises:
        InputError: everything that is wrong with the file, a folder of something else, or no pymoo.
    """
    return optimised(read_problem(file), Path(out) if out is not None else Path(Path(file).stem), jobs)


def optimised(problem: Problem, folder: Path, jobs: int | None = None) -> Optimisation:
    """Return what a search and its confirmation find; files of the best gears and the page are written.

    Raises:
        InputError: see `optimise`.
    """
    with Processes(checked_jobs(jobs), problem.study.time_limit, folder / "messages.log") as executor:
        done = search(problem, folder, executor)
        found = Optimisation(done, confirm(done, executor))
    for path, gear in gear_files(found).items():
        with replacing(path) as partial:
            partial.write_text(gear_file(gear), encoding="utf-8")
    command = join(["rps-exudyn", *sys.argv[1:]])
    write_page([optimisation_sheet(found, command), *gear_sheets(found)], folder / PAGE)
    return found
