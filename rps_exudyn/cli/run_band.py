"""The option `run --band`: a scene with the uncertainty of its inputs."""

import sys
from collections.abc import Iterable
from contextlib import redirect_stdout
from dataclasses import replace
from functools import partial
from pathlib import Path

from rps_exudyn.analysis.measured import compared_with_own
from rps_exudyn.base.errors import InputError, as_sentence
from rps_exudyn.base.files import write_json
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import SetupOptions
from rps_exudyn.cli.output import (
    DONE,
    INTERRUPTED,
    Files,
    command_line,
    naming,
    note,
    print_files,
    print_json,
    put,
    put_table,
)
from rps_exudyn.cli.printed import measured_as_dict, print_measured, print_sheet, result_as_dict
from rps_exudyn.inference.uncertainty.band import Band, band_of_runs
from rps_exudyn.inference.uncertainty.input_sets import uncertain_inputs
from rps_exudyn.inference.uncertainty.quick_band import SCENE, quick_band
from rps_exudyn.pages.report.html import CodeText, Fold, Section
from rps_exudyn.pages.report.result_page import result_article
from rps_exudyn.pages.report.sheet import sheet_of
from rps_exudyn.pages.report.sheet_file import KEY, sheet_as_dict
from rps_exudyn.parameters.fidelity import MEAN_STEP
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.result import MeasuredTorque
from rps_exudyn.results.rounding import shown_with_bar
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.law_by_scene import with_law
from rps_exudyn.simulate.cases.run_cases import checked_jobs

QUICK_OTHERWISE = 64  # runs of a scene without a quick band
SHOWN = 5  # contributions


def do_band(
    scene: str,
    options: SetupOptions,
    count: int | None,
    inputs: str | None,
    files: Files,
    measured: MeasuredTorque | None = None,
    *,
    every: bool = True,
    as_json: bool = False,
    jobs: int | None = None,
    time_limit: float = float("inf"),
) -> int:
    """Compute, keep and print a band; the nominal result goes to the HDF5 file as of any run.

    A sample that takes longer than the time limit [s] is one that failed. A measured torque is compared with
    the nominal result and drawn over the band.

    Raises:
        InputError: distributions or a number of samples that cannot be, or a gear that fails.
    """
    from rps_exudyn.pages.charts.inference import band_figure
    from rps_exudyn.pages.charts.style import save

    own, processes = options.drawn(), checked_jobs(jobs)
    if options.chooses_model:
        setup = options.load()
    else:  # equilibria in steps that a band needs
        setup = replace(options, fidelity="quasi-static").load().replace({"fidelity.step_angle": MEAN_STEP})
    gear = setup.steering_gear
    chosen = uncertain_inputs(gear, inputs, own)
    quick = count is None and scene == SCENE
    with redirect_stdout(sys.stderr), shown_progress() as show:

        def report(done: int, of: int) -> None:
            show(f"sample {done} of {of}", done / of)

        made = partial(quick_band, gear, setup.fidelity, chosen)
        if not quick:
            runs = QUICK_OTHERWISE if count is None else count
            made = partial(band_of_runs, scene, gear, setup.fidelity, chosen, runs)
        band = made(on_progress=report, jobs=processes, time_limit=time_limit)
    law = band.nominal.gear.mesh.law
    single = with_law(gear, setup.fidelity, scene_named(scene).law).mesh.law
    if law != single:
        note(f"the band uses the contact law {law}, as every series of gears; a single run uses {single}.")
    band = replace(band, nominal=replace(band.nominal, measured=measured))
    compared = compared_with_own(band.nominal)
    table = files.out.with_suffix(".band.json")
    files.make_room(table)
    written: list[Path] = []
    with naming(written):
        band.nominal.save(files.out)
        written.append(files.out)
        content = band.as_dict()
        with shown_progress() as show:
            show("drawing", None)
            again = Section("", [Fold("Make the band again", [CodeText(command_line())])])
            article = result_article(band.nominal, files.out, [again], band)
            write_json(table, content | {KEY: sheet_as_dict(article, band.nominal.gear)})
            written.append(table)
            if files.plot is not None:
                save(band_figure(band), files.plot)
                written.append(files.plot)
        if as_json:
            del content["values"]  # the file has them
            nominal = result_as_dict(band.nominal) | measured_as_dict(compared)
            print_json(content | {"nominal": nominal, "files": [str(file) for file in written]})
        elif every:
            print_band(band, written)
            print_measured(compared)
        else:
            count = len(band.nominal.summary)
            print_sheet(sheet_of(band.nominal, compared, band), written, f"{count} quantities")
    return INTERRUPTED if band.interrupted else DONE


def print_band(band: Band, files: Iterable[Path]) -> None:
    """Print quantiles with their errors, contributions, and what the band does not contain."""
    count, failed = len(band.drawn.samples), band.drawn.failed
    put(f"{band.nominal.scene} · {band.method} · {failed} of {count} samples failed", "bold")
    if band.interrupted:
        put("Interrupted: the band contains the samples finished before.")
    for cause, number in band.drawn.failures.items():
        put(f"{number} x {cause}")
    put_table(_HEAD, list(_figure_rows(band)))
    put(
        "At medians: the run at median inputs, ± its numerical error. Errors: standard errors of the "
        "quantiles; numerical: by how far they move if all samples are wrong by their error bars."
    )
    name = scene_named(band.nominal.scene).figure
    if (shares := band.contributions.get(name)) is not None:
        largest = list(shares.fractions.items())[:SHOWN]
        text = ", ".join(f"{path} {100 * share:.0f} %" for path, share in largest)
        put(f"Contributions to {name}: {text}; acting together {100 * shares.together:.0f} %.")
    if failed and name in band.figures:
        low, high = band.figures[name].lowest[0], band.figures[name].highest[-1]
        put(
            f"With the failed samples at either end, 5 to 95 % of {name}: {_end(name, low)} to "
            f"{_end(name, high)}."
        )
    put(_beside(band, name))
    print_files(files)


_HEAD = (
    *("quantity", "at medians", "5 %", "median", "95 %", "error at 5 %", "error at 95 %"),
    *("numerical at 5 %", "at 95 %"),
)


def _figure_rows(band: Band) -> Iterable[tuple[str, ...]]:
    for name, found in band.figures.items():
        show = SUMMARY[name].show
        of_level = band.drawn.numerical.get(name)
        errors = [show(float(found.errors[at])) for at in (0, -1)]
        errors += ["" if of_level is None else show(float(of_level.of_quantiles[at])) for at in (0, -1)]
        nominal = band.nominal.summary.get(name)
        shown = (
            "" if nominal is None else shown_with_bar(SUMMARY[name], nominal, band.nominal.errors.get(name))
        )
        yield name, shown, show(found.low), show(found.median), show(found.high), *errors


def _end(name: str, value: float) -> str:
    return SUMMARY[name].show(value) if abs(value) < float("inf") else "unknown"


def _beside(band: Band, name: str) -> str:
    """What the band does not contain: errors of the solution and of the contact law."""
    half = band.figures[name].half_width if name in band.figures else float("nan")
    parts = [f"half the band of 90 % of {name} is {SUMMARY[name].show(half)}"]
    if name in band.drawn.numerical:
        parts.append(f"the numerical error of a gear is {_end(name, band.drawn.numerical[name].of_sample)}")
    if band.law is not None:
        low, high = (100 * each for each in band.law.mean_torque)
        parts.append(f"the contact law {band.law.law} deviates by {low:+.2g} to {high:+.2g} %")
    return as_sentence("; ".join(parts))


def sample_count(band: list[int] | None, beside: list[str]) -> int | None:
    """Return the number of samples that --band asks for; None for the quick band.

    Raises:
        InputError: several numbers, none of --band itself, or options that a band does not go with.
    """
    if band is None:
        raise InputError("--inputs chooses the uncertain inputs of a band; add --band.")
    if beside:
        raise InputError(f"--band makes many runs; leave out --{', --'.join(beside)}.")
    if len(band) > 1:
        raise InputError(f"--band has {len(band)} numbers; it takes one, the number of samples, or none.")
    return band[0] if band else None
