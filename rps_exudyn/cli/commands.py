"""The commands of `rps-exudyn` that simulate and read results: run, study, show, diff, rerun, geometry,
describe, collect, report; and `main`. What shows, begins and checks stands in `tools`.

What a command needs is imported by the command, so that `--help` and `describe` are quick.
"""

import os
import sys
from collections.abc import Iterable, Sequence
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated

from cyclopts import CycloptsError, Parameter, UnusedCliTokensError

import rps_exudyn.cli.tools  # noqa: F401 (registers its commands)
from rps_exudyn.base.atomic import check_writable
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.interrupts import unwrapped_interrupts
from rps_exudyn.cli.app import DONE, FAILED, INTERRUPTED, PAPER_GEAR, PAPER_SETUP, WRONG_INPUT, Flag, app
from rps_exudyn.cli.kept import keep, naming, say
from rps_exudyn.cli.measured_options import Columns
from rps_exudyn.cli.options import GearOptions, SetupOptions
from rps_exudyn.cli.process import prepare_process
from rps_exudyn.cli.progress import shown_progress
from rps_exudyn.scenes import SCENE_NAMES

if TYPE_CHECKING:
    from rps_exudyn.results.result import Result

RESULT_FILES = (".h5", ".hdf5")

began = monotonic()
"""When the command began, from which its time limit runs."""

Scene = Annotated[str, Parameter(help=f"what the test rig does: {', '.join(SCENE_NAMES)}.")]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the exit status."""
    global began
    began = monotonic()
    prepare_process()
    try:
        _check_folder()
        with unwrapped_interrupts():
            status = app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
        sys.stdout.flush()
        return status or DONE
    except BrokenPipeError:  # whoever reads the output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except OSError as error:
        what = f"{error.filename} cannot be used" if error.filename else "the output cannot be written"
        return _refuse([f"{what}: {error.strerror or error}."])
    except MemoryError:
        return _refuse(["there is not enough memory for that; nothing was written."])
    except InputError as error:
        return _refuse(error.problems)
    except CycloptsError as error:
        return _refuse([_sentence(error)])
    except KeyboardInterrupt as interrupt:
        say(str(interrupt) or "interrupted; nothing was written.")
        return INTERRUPTED


@app.command
def run(
    scene: Scene = SCENE_NAMES[0],
    /,
    *,
    setup: SetupOptions = PAPER_SETUP,
    accuracy: str | None = None,
    out: Path | None = None,
    plot: Path | None = None,
    measured: Path | None = None,
    column: Columns = (),
    band: Annotated[list[int] | None, Parameter(consume_multiple=True, negative=())] = None,
    inputs: str | None = None,
    robust: Flag = False,
    time_limit: str | None = None,
    progress: Flag = False,
    json: Flag = False,
) -> int:
    """Simulate one scene: print a summary, write an HDF5 file and a picture.

    Existing files stay: a failed run is written beside them as NAME.failed, another one keeps them as NAME.1.

    Args:
        accuracy: error of the torque that is allowed, for instance 1%: takes the cheapest model that keeps
            it, of all or of the --fidelity given; see docs/accuracy.md.
        out: HDF5 file; without it SCENE.h5 in the current folder.
        plot: picture (.png, .svg, .pdf); without it a .png beside the HDF5 file.
        measured: text file of a measured torque over the pinion angle, each column with its unit; it is drawn
            with the simulated one, compared with it and kept in the HDF5 file. Angles are compared by whole
            turns where the run covers one. What was assumed of the file is said on standard error.
        band: the band that uncertain inputs make of the result, from this number of runs; without a number a
            quick one from 64 runs. NAME.band.json keeps every sample.
        inputs: what is uncertain: series (scatter about this gear), unknown (any gear with such teeth) or
            own (parameters given as "300 N +- 30 N" alone); own by default if there are any, else series.
        robust: where the run fails or its plan is refused, take the next safer settings, and say which.
        time_limit: for instance "20 s": the run is ended after it, whatever it does then (starting, compiling
            and settling count); what it has recorded is kept.
        progress: tell on standard error how far a long run is, as a terminal is told anyway.
        json: print the summary as JSON.
    """
    from rps_exudyn.simulate.time_limit import TimeLimit

    limit = replace(TimeLimit.of(time_limit), begun=began) if time_limit is not None else None
    from rps_exudyn.charts.file_types import PICTURES
    from rps_exudyn.cli.measured_options import read_measured
    from rps_exudyn.results.outcome import Interrupted
    from rps_exudyn.simulate.run import simulate

    preset = setup.preset_alone() if accuracy is not None else None
    chosen = setup.load()
    out = check_writable(out or Path(f"{scene}.h5"), RESULT_FILES)
    plot = check_writable(plot or out.with_suffix(".png"), PICTURES)
    if band is not None or inputs is not None:
        from rps_exudyn.cli.band_command import do_band, sample_count

        refused = {"accuracy": accuracy, "measured": measured, "robust": robust, "time-limit": time_limit}
        count = sample_count(band, [name for name, given in refused.items() if given])
        return do_band(scene, setup, count, inputs, out, plot, json)
    setup.say_medians()
    curve = read_measured(measured, column) if measured else None
    model = chosen.fidelity if accuracy is None else preset
    try:
        with redirect_stdout(sys.stderr), shown_progress(progress):  # standard output is for the result
            result = simulate(
                scene, chosen.steering_gear, model, accuracy=accuracy, robust=robust, time_limit=limit
            )
    except Interrupted as interrupt:
        kept, _ = keep(replace(interrupt.recorded, measured=curve), out, plot)
        where = f"kept in {kept[0]}" if kept else "lost"
        raise KeyboardInterrupt(f"interrupted; what was recorded until then is {where}.") from None
    result = replace(result, measured=curve)
    for finding in ("accuracy", "accuracy_checked"):
        if finding in result.findings:
            say(result.findings[finding])
    files, problems = keep(result, out, plot)
    with naming(files):
        _print_result(result, json, files)
    return max(_verdict(result), FAILED if problems else DONE)


@app.command
def study(
    file: Path,
    /,
    *,
    out: Path | None = None,
    jobs: int | None = None,
    cluster: str | None = None,
    dry_run: Flag = False,
    toy: Flag = False,
    yes: Flag = False,
    json: Flag = False,
) -> int:
    """Simulate all cases of a study file; interrupted or repeated, it does only what is missing.

    Args:
        file: TOML file, see docs/studies.md.
        out: folder of the study; without it one of the file's name in the current folder.
        jobs: number of worker processes; without it one for each processor.
        cluster: address of a Dask scheduler that does the cases instead, for instance tcp://10.0.0.1:8786.
        dry_run: list the cases and estimate the time without simulating.
        toy: try the study at its smallest size, two values of each axis, in a folder NAME-toy.
        yes: run it also if there are very many cases.
        json: print the outcome, or the cases, as JSON.
    """
    from rps_exudyn.cli.study_command import Request, do_study, list_cases

    folder = out or Path(f"{file.stem}-toy" if toy else file.stem)
    request = Request(file, folder, jobs, cluster, toy, yes)
    return list_cases(request, json) if dry_run else do_study(request, json)


@app.command
def show(file: Path, /, *, plot: Path | None = None, from_zero: Flag = False, json: Flag = False) -> int:
    """Print the summary of a result, and draw it again.

    Args:
        file: HDF5 file that `run` wrote.
        plot: picture (.png, .svg, .pdf) of the result.
        from_zero: torques and forces of the picture are drawn from zero on.
        json: print it as JSON.
    """
    from rps_exudyn.study.blocks import load

    if plot:
        from rps_exudyn.charts.file_types import PICTURES

        check_writable(plot, PICTURES)
    result = load(file)
    if plot:
        result.plot(plot, from_zero=from_zero)
    files = [plot] if plot else []
    with naming(files):
        _print_result(result, json, files)
    return DONE


@app.command
def diff(first: Path, second: Path, /, *, plot: Path | None = None, json: Flag = False) -> int:
    """Compare two results: settings that differ, summary side by side, signals over the pinion angle.

    Args:
        first: HDF5 file that `run` wrote.
        second: HDF5 file to compare with it; differences are second minus first.
        plot: picture (.png, .svg, .pdf) of both torques and their difference.
        json: print the comparison as JSON.
    """
    from rps_exudyn.analysis.comparison import compare
    from rps_exudyn.charts.comparison import draw_comparison
    from rps_exudyn.charts.file_types import PICTURES
    from rps_exudyn.cli import printed
    from rps_exudyn.study.blocks import load

    if plot:
        check_writable(plot, PICTURES)
    comparison = compare(load(first), load(second))
    names = (first.stem, second.stem) if first.stem != second.stem else (str(first), str(second))
    if plot:
        draw_comparison(comparison, names, plot)
    files = [plot] if plot else []
    if json:
        printed.print_json(printed.comparison_as_dict(comparison, files))
    else:
        printed.print_comparison(comparison, names, files)
    return DONE


@app.command
def rerun(file: Path, /, *, out: Path | None = None, json: Flag = False) -> int:
    """Simulate again what a result holds, from the parameters in its file, and say whether it is the same.

    Args:
        file: HDF5 file that `run` or `study` wrote; it is not changed.
        out: HDF5 file of the new result; without it none is written.
        json: print the new summary and the numbers that differ as JSON.
    """
    from rps_exudyn.analysis.rerun import differing_numbers, largest_difference
    from rps_exudyn.cli import printed
    from rps_exudyn.parameters.fidelity import Fidelity
    from rps_exudyn.parameters.gear import SteeringGear
    from rps_exudyn.simulate.run import simulate
    from rps_exudyn.study.blocks import load

    if out and check_writable(out, RESULT_FILES).resolve() == file.resolve():
        raise InputError(f"--out {out} is the result that is simulated again; name another file.")
    old = load(file)
    gear = SteeringGear.from_tables(old.gear.model_dump(), where=str(file))
    fidelity = Fidelity.from_tables(old.fidelity, where=str(file))
    with redirect_stdout(sys.stderr), shown_progress(asked=False):
        new = simulate(old.scene, gear, fidelity)
    new = replace(new, measured=old.measured)
    if out:
        new.save(out)
    differing, largest = differing_numbers(old, new), largest_difference(old, new)
    files = [out] if out else []
    if json:
        printed.print_json(printed.result_as_dict(new, files) | {"differing": differing, "largest": largest})
    else:
        printed.print_result(new, files)
        printed.print_differing(differing, largest, str(file))
    return _verdict(new)


@app.command
def geometry(
    *, gear: GearOptions = PAPER_GEAR, out: Path | None = None, force: Flag = False, json: Flag = False
) -> int:
    """Print the geometry report; write the solids or their drawing.

    Args:
        out: solids (.glb, .stl) or drawing (.png, .svg, .pdf).
        force: build the gear even if it is undercut.
        json: print the report as JSON.
    """
    from rps_exudyn.charts.file_types import PICTURES
    from rps_exudyn.charts.geometry import draw_geometry
    from rps_exudyn.cli import printed
    from rps_exudyn.gears.export import FORMATS, export_solids
    from rps_exudyn.gears.report import geometry_report

    chosen = gear.load()
    if out:
        check_writable(out, (*FORMATS, *PICTURES))
    report = geometry_report(chosen, force)
    if out and out.suffix.lower() in FORMATS:
        export_solids(chosen, out)
    elif out:
        draw_geometry(chosen, out, force)
    files = [out] if out else []
    if json:
        printed.print_json(report.as_dict() | {"files": files})
    else:
        printed.print_geometry(report, files)
    return DONE


@app.command
def describe(path: str = "", /, *, setup: SetupOptions = PAPER_SETUP, json: Flag = False) -> int:
    """Print parameters of gear, test and fidelity: value, unit, meaning, and where the value is from.

    Args:
        path: a parameter such as yoke.preload, or a table such as yoke or fidelity; without it all.
        json: print them as JSON.
    """
    from rps_exudyn.cli import printed
    from rps_exudyn.parameters.setup import Setup

    items = Setup.declared_at(path)
    if json:
        printed.print_json(printed.parameters_as_dict(setup.load(), items))
    else:
        printed.print_parameters(setup.load(), items)
    return DONE


@app.command
def collect(folder: Path, /, *, out: Path | None = None) -> int:
    """Write one table of all cases of a study: what was varied, how each ended, its numbers.

    Args:
        folder: folder that `study` wrote.
        out: table (.h5, .csv); without it table.h5 in the folder.
    """
    from rps_exudyn.cli.study_command import do_collect

    do_collect(folder, out)
    return DONE


@app.command
def report(*paths: Path, out: Path | None = None, contact: Flag = False) -> int:
    """Write one HTML page about studies and results: what was run, effects, best, worst and failed cases.

    Args:
        paths: folders that `study` wrote, also half-finished ones, and HDF5 files that `run` wrote.
        out: page (.html); without it report.html in the study's folder, or a page beside the only file.
        contact: add loads of the lines of contact, shares of the teeth and contact pattern to each result.
    """
    from rps_exudyn.report.report import SUFFIXES, default_name, write_report

    if not paths:
        raise InputError("report needs at least one study's folder or result's file.")
    out = check_writable(out or default_name(paths), SUFFIXES)
    with shown_progress():
        write_report(paths, out, contact)
    print(f"written: {out}")
    return DONE


def _check_folder() -> None:
    try:
        Path.cwd()
    except FileNotFoundError:
        raise InputError("the current folder does not exist any more; change to another one.") from None


# --- output ------------------------------------------------------------------------------------


def _print_result(result: "Result", json: bool, files: Iterable[Path] = ()) -> None:
    from rps_exudyn.analysis.measured import compare_with_measured
    from rps_exudyn.cli import printed

    measured, teeth = result.measured, result.gear.pinion.teeth
    compared = compare_with_measured(measured, result.signals, teeth) if measured else None
    if json:
        printed.print_json(printed.result_as_dict(result, files) | printed.measured_as_dict(compared))
    else:
        printed.print_result(result, files)
        printed.print_measured(compared)


def _verdict(result: "Result") -> int:
    from rps_exudyn.results.outcome import Status

    if result.status is Status.OK:
        return DONE
    say(f"the simulation failed ({result.status}): {result.message.rstrip('.')}. {result.status.remedy}")
    return FAILED


def _sentence(error: CycloptsError) -> str:
    """The error of the command line's grammar in one sentence."""
    if isinstance(error, UnusedCliTokensError):
        surplus = " ".join(error.unused_tokens or ())
        return f"{surplus} is more than the command takes; --help shows what it takes."
    return " ".join(str(error).split())


def _refuse(problems: Iterable[str]) -> int:
    for problem in problems:
        say(problem)
    return WRONG_INPUT
