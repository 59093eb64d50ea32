"""The command `animate`: page, film or still of a motion."""

from pathlib import Path

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import Flag
from rps_exudyn.cli.output import DONE

PAGES = (".html", ".htm")


def animate(file: Path, /, *, out: Path | None = None, view: str = "gear", apart: Flag = False) -> int:
    """Show the motion of a result in three dimensions: an interactive page, a film, or a still picture.

    Args:
        file: HDF5 file that `run` or `study` wrote.
        out: Page (.html), film (.gif, .mp4) or still (.png, .webp); default: a page beside the file.
        view: Camera of film and still: gear, mesh, along-the-pinion or whole-rack; a page has all of them.
        apart: Exploded view, for film and still; a page has a slider for it.
    """
    from rps_exudyn.pages.animation.animation_page import write_page
    from rps_exudyn.pages.animation.camera import VIEWS
    from rps_exudyn.pages.animation.film import FILMS, STILLS, write_film, write_still
    from rps_exudyn.study.case_blocks import beside, load

    if view not in VIEWS:
        raise InputError(f"--view is {view!r}; it must be one of {', '.join(VIEWS)}.")
    target = check_writable(out or beside(file, f"{file.stem}-animation.html"), (*PAGES, *FILMS, *STILLS))
    result, explode, kind = load(file), float(apart), target.suffix.lower()
    with shown_progress() as show:
        show(f"drawing {target.name}", None)
        if kind in PAGES:
            write_page(result, target)
        elif kind in FILMS:
            write_film(result, target, view, explode=explode)
        else:
            write_still(result, target, view, explode=explode)
    print(f"written: {target}")
    return DONE
