"""The command `window`: the values of a parameter at which a share of a series keeps the limits."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import PICTURES, check_writable
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import HEAD_ALONE, PAPER_GEAR, GearOptions, Inputs, Printing, rated_torque_of
from rps_exudyn.cli.output import DONE, FAILED, command_line, present, printing


def window(
    *parameters: str,
    gear: GearOptions = PAPER_GEAR,
    limits: Path,
    share: str = "95%",
    inputs: Inputs = None,
    between: Annotated[
        tuple[str, ...], Parameter(name="--range", negative=(), allow_leading_hyphen=True, show_default=False)
    ] = (),
    rated_torque: str = "30 N*m",
    samples: int | None = None,
    out: Path | None = None,
    shown: Printing = HEAD_ALONE,
) -> int:
    """Find the values of a parameter at which a share of the gears keeps its limits; a map of two.

    The exit status is 1 if there is none.

    Args:
        parameters: PATH of the parameter, or of two.
        limits: TOML file of limits, as of `check`; only its rows count.
        share: Share of the gears that must keep all limits.
        between: "LEAST, MOST" of each parameter, where its values are looked for.
        rated_torque: Pinion torque for requirements that have one.
        samples: Number of gears at each computed value.
        out: Sheet as a page (.html), as data (.json), or its picture (.png, .svg, .pdf).
    """
    shown.check()
    from rps_exudyn.assessment.requirements.window import window as find
    from rps_exudyn.assessment.requirements.window_page import window_figure, window_page
    from rps_exudyn.pages.charts.style import save
    from rps_exudyn.pages.report.sheet_file import write_sheet

    if out is not None:
        check_writable(out, (".json", ".html", *PICTURES))
    ranges = {path: each.split(",") for path, each in zip(parameters, between, strict=False)}
    if wrong := [each for each in between if each.count(",") != 1] or between[len(parameters) :]:
        raise InputError(f'--range has {wrong[0]!r}; it takes "LEAST, MOST", once for each parameter.')
    torque = rated_torque_of(rated_torque)
    chosen, own = gear.load(), gear.drawn()
    with printing(shown.quiet):
        with shown_progress() as show:
            found = find(
                chosen,
                parameters,
                limits,
                share=share,
                inputs=inputs,
                own=own,
                ranges={path: (low, high) for path, (low, high) in ranges.items()},
                rated_torque=torque,
                samples=samples,
                on_progress=lambda done, of: show("series of gears", done / of),
            )
            sheet = window_page(found, chosen, inputs or ("own" if own else "series"), command_line())
            if out is not None and out.suffix in PICTURES:
                save(window_figure(found), out)
            elif out is not None:
                write_sheet(sheet, out)
        present(sheet, [out] if out is not None else [], every=shown.every, json=shown.json)
    return DONE if found.best_share >= found.share else FAILED
