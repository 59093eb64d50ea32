"""The command `optimise`: the best gears of a file's variables, or the cheapest of its tolerances."""

from pathlib import Path

from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import HEAD_ALONE, Flag, Printing
from rps_exudyn.cli.output import DONE, FAILED, command_line, present, printing


def optimise(
    file: Path,
    /,
    *,
    out: Path | None = None,
    jobs: int | None = None,
    toy: Flag = False,
    shown: Printing = HEAD_ALONE,
) -> int:
    """Search for the gears whose series is best, or the cheapest tolerances; again after an interruption.

    The exit status is 1 if no design, or no set of tolerances, keeps all limits.

    Args:
        file: Optimisation file (TOML), see docs/tutorial/9-optimisation.md.
        out: Folder of designs, best gears and page; default: the file's name, in the current folder.
        jobs: Number of worker processes; default: one per processor.
        toy: Try the file with eight designs of eight gears, in a folder NAME-toy.
    """
    shown.check()
    from rps_exudyn.optimisation.definition import problem_of
    from rps_exudyn.optimisation.optimisation_page import optimisation_sheet
    from rps_exudyn.optimisation.optimise import PAGE, optimised, toleranced
    from rps_exudyn.optimisation.tolerance_page import tolerance_sheet
    from rps_exudyn.optimisation.tolerances import tolerances_of
    from rps_exudyn.parameters.declaration import read_toml

    with printing(shown.quiet):
        try:
            with shown_progress():
                content = read_toml(file)
                if "tolerances" in content:
                    chosen = toleranced(tolerances_of(file, content), out, jobs, toy)
                    sheet, files = tolerance_sheet(chosen, command_line()), [chosen.folder / PAGE]
                    is_found = chosen.keeps
                else:
                    found = optimised(problem_of(file, content), out, jobs, toy)
                    sheet = optimisation_sheet(found, command_line())
                    files, is_found = [*found.files, found.search.store.path / PAGE], bool(found.front)
        except KeyboardInterrupt:
            kept = "the designs that are done are kept; the same command continues"
            raise KeyboardInterrupt(f"interrupted; {kept}.") from None
        present(sheet, files, every=shown.every, json=shown.json)
    return DONE if is_found else FAILED
