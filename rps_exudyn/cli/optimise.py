"""The command `optimise`: the best gears of a file's variables, for a series of each."""

from pathlib import Path

from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import HEAD_ALONE, Printing
from rps_exudyn.cli.output import DONE, FAILED, command_line, present, printing


def optimise(
    file: Path, /, *, out: Path | None = None, jobs: int | None = None, shown: Printing = HEAD_ALONE
) -> int:
    """Search for the gears whose series is best. Run it again after an interruption: designs are kept.

    The exit status is 1 if no design keeps all limits.

    Args:
        file: Optimisation file (TOML), see docs/optimisation.md.
        out: Folder of designs, best gears and page; default: the file's name, in the current folder.
        jobs: Number of worker processes; default: one per processor.
    """
    shown.check()
    from rps_exudyn.optimisation.optimisation_page import gear_files, optimisation_sheet
    from rps_exudyn.optimisation.optimise import PAGE
    from rps_exudyn.optimisation.optimise import optimise as run

    folder = out or Path(file.stem)
    with printing(shown.quiet):
        try:
            with shown_progress():
                found = run(file, folder, jobs)
        except KeyboardInterrupt:
            kept = f"designs are kept in {folder}; the same command continues"
            raise KeyboardInterrupt(f"interrupted; {kept}.") from None
        files = [*gear_files(found), folder / PAGE]
        present(optimisation_sheet(found, command_line()), files, every=shown.every, json=shown.json)
    return DONE if found.front else FAILED
