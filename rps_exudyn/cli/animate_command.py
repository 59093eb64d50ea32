"""The command `animate`: which file is made how."""

from pathlib import Path

from rps_exudyn.animation.camera import VIEWS
from rps_exudyn.animation.film import FILMS, STILLS, write_film, write_still
from rps_exudyn.animation.page import write_page
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable
from rps_exudyn.cli.progress import shown_progress
from rps_exudyn.study.blocks import beside, load

PAGES = (".html", ".htm")


def do_animate(file: Path, out: Path | None, view: str, apart: bool) -> None:
    """Write page, film or still by the suffix of `out`, and name the file.

    Raises:
        InputError: an unknown view or suffix, or a result without a motion.
    """
    if view not in VIEWS:
        raise InputError(f"--view is {view!r}; it must be one of {', '.join(VIEWS)}.")
    target = check_writable(out or beside(file, f"{file.stem}-animation.html"), (*PAGES, *FILMS, *STILLS))
    result, explode, kind = load(file), float(apart), target.suffix.lower()
    with shown_progress():
        if kind in PAGES:
            write_page(result, target)
        elif kind in FILMS:
            write_film(result, target, view, explode=explode)
        else:
            write_still(result, target, view, explode=explode)
    print(f"written: {target}")
