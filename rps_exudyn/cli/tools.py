"""The commands around results: fit, animate, view, explore, init, check, validate, doctor."""

from pathlib import Path

from rps_exudyn.cli.app import DONE, FAILED, PAPER_GEAR, Flag, app
from rps_exudyn.cli.measured_options import Columns, Freed, Priors, chosen_columns
from rps_exudyn.cli.options import GearOptions


@app.command
def fit(
    *files: str,
    gear: GearOptions = PAPER_GEAR,
    prior: Priors = (),
    free: Freed = (),
    column: Columns = (),
    single_law: Flag = False,
    out: Path = Path("fitted.toml"),
    plot: Path | None = None,
    report: Path | None = None,
    series: Path | None = None,
    like: Path | None = None,
    json: Flag = False,
) -> int:
    """Estimate preload, friction, drag and runout from measured curves, and say what they cannot tell apart.

    Args:
        files: measured files, FILE of a free turning or TEST=FILE, where TEST is free, reversal,
            load-test@80kg, rack-push, yoke-out or bearing; several of one test are its repeats.
        single_law: leave out the fit by another contact law, whose difference is added to the intervals.
        out: gear file (.toml) with the estimates in place.
        plot: picture (.png, .svg, .pdf) of measured and fitted torque.
        report: page (.html) with pictures, intervals, correlations and what was assumed.
        series: file (.json) with what this fit leaves for the next gear of the series.
        like: such a file of another gear, with the same tests: this fit begins there.
        json: print the fit as JSON.
    """
    from rps_exudyn.cli.fit_command import do_fit, print_fit

    found, written = do_fit(
        files,
        gear.load(),
        free=free,
        priors=prior,
        columns=dict(chosen_columns(column)),
        other_law=not single_law,
        out=out,
        plot=plot,
        report=report,
        series=series,
        like=like,
    )
    if json:
        from rps_exudyn.cli.printed import print_json
        from rps_exudyn.fitting.findings import fit_as_dict

        print_json(fit_as_dict(found) | {"files": [str(file) for file in written]})
    else:
        print_fit(found, written)
    return DONE if found.converged else FAILED


@app.command
def animate(file: Path, /, *, out: Path | None = None, view: str = "gear", apart: Flag = False) -> int:
    """Show the motion of a result in three dimensions: a page to turn and play, a film, or a still.

    Args:
        file: HDF5 file that `run` or `study` wrote.
        out: page (.html), film (.gif, .mp4) or still (.png, .webp); without it a page beside the file.
        view: where film and still look from: gear, mesh, along-the-pinion or whole-rack; a page has them all.
        apart: the parts taken apart, in film and still; a page has a slider for it.
    """
    from rps_exudyn.cli.animate_command import do_animate

    do_animate(file, out, view, apart)
    return DONE


@app.command
def view(file: Path, /) -> int:
    """Play the gear of a result in Exudyn's own viewer, where there is a display.

    Args:
        file: HDF5 file that `run` wrote; its motion is computed anew.
    """
    from rps_exudyn.cli.view_command import do_view

    do_view(file)
    return DONE


@app.command
def init(folder: Path = Path(), /) -> int:
    """Write what to begin with: the paper's gear, the shipped studies and examples; existing files stay.

    Args:
        folder: where; without it the current folder.
    """
    from rps_exudyn.cli.init_command import do_init

    for path in do_init(folder):
        print(f"written: {path}")
    return DONE


@app.command
def check(
    *,
    gear: GearOptions = PAPER_GEAR,
    inputs: str | None = None,
    limits: Path | None = None,
    rated_torque: str = "30 N*m",
    out: Path | None = None,
    jobs: int | None = None,
    json: Flag = False,
) -> int:
    """Judge a gear by its requirement sheet: torque, variation, efficiency, strength, lift, travel, gain.

    Exit status 1: a requirement is not kept.

    Args:
        inputs: what is uncertain: series, unknown or own, as for `run --band`.
        limits: TOML file whose limits replace the shipped ones, which `rps_exudyn/requirements/limits.toml`
            lists with their sources.
        rated_torque: on the pinion, for the strength of the teeth and the lift.
        out: the sheet as a file (.json).
        jobs: number of processes; without it one for each processor.
        json: print the sheet as JSON.
    """
    from rps_exudyn.cli.check_command import do_check

    return DONE if do_check(gear, inputs, limits, rated_torque, out, json, jobs) else FAILED


@app.command
def validate(
    rows: Path | None = None,
    /,
    *,
    only: tuple[str, ...] = (),
    out: Path | None = None,
    jobs: int | None = None,
    json: Flag = False,
) -> int:
    """Compare with data from outside: manuals, standards, other programs, closed forms; a verdict for each.

    Args:
        rows: folder of rows, each a folder with a row.toml; without it those that come with the package.
        only: name of a row to run alone; may be repeated.
        out: page (.html), with data (.json) and picture (.png) beside it; without it validation.html.
        jobs: number of processes; without it one for each processor.
        json: print the rows as JSON.
    """
    from rps_exudyn.cli.validate_command import do_validate

    do_validate(rows, only, out or Path("validation.html"), json, jobs)
    return DONE


@app.command
def doctor(*, clear_cache: Flag = False) -> int:
    """Tell whether this installation computes what it should, and where it keeps what.

    Args:
        clear_cache: remove the compiled kernels first; they are compiled again when needed.
    """
    from rps_exudyn.cli.doctor_command import do_doctor

    return DONE if do_doctor(clear_cache) else FAILED


@app.command
def explore(
    *, gear: GearOptions = PAPER_GEAR, host: str = "127.0.0.1", port: int = 0, browser: bool = True
) -> int:
    """Serve a page with sliders on this machine: torque, losses, geometry and limits while they are dragged.

    Args:
        host: address to listen at; another than this machine's own lets others compute here.
        port: its port; 0 takes a free one.
        browser: open the page in the browser.
    """
    from rps_exudyn.cli.explore_command import do_explore

    do_explore(gear.load(), host, port, browser)
    return DONE
