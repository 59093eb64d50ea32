"""The command `run`: one simulation, and the files that it leaves, kept whatever disk and terminal do."""

import sys
from collections.abc import Sequence
from contextlib import redirect_stdout
from dataclasses import replace
from math import inf
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import PICTURES, RESULT_FILES, check_writable
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import (
    HEAD_ALONE,
    PAPER_SETUP,
    Columns,
    Flag,
    Inputs,
    Jobs,
    Printing,
    SetupOptions,
    chosen_columns,
)
from rps_exudyn.cli.output import DONE, FAILED, Files, keep, note, present, printing, verdict
from rps_exudyn.results.outcome import Interrupted
from rps_exudyn.scenes import SCENE_NAMES

if TYPE_CHECKING:
    from rps_exudyn.parameters.gear import SteeringGear
    from rps_exudyn.results.result import MeasuredTorque

Scene = Annotated[str, Parameter(help=f"Test on the rig: {', '.join(SCENE_NAMES)}.")]


def run(
    scene: Scene = SCENE_NAMES[0],
    /,
    *,
    setup: SetupOptions = PAPER_SETUP,
    level: int | None = None,
    accuracy: str | None = None,
    metrics: Annotated[list[str] | None, Parameter(consume_multiple=True, negative=())] = None,
    out: Path | None = None,
    plot: Path | None = None,
    measured: Path | None = None,
    column: Columns = (),
    band: Annotated[list[int] | None, Parameter(consume_multiple=True, negative=())] = None,
    inputs: Inputs = None,
    jobs: Jobs = None,
    robust: Flag = False,
    time_limit: str | None = None,
    progress: Flag = False,
    overwrite: Flag = False,
    no_plot: Flag = False,
    shown: Printing = HEAD_ALONE,
) -> int:
    """Simulate one scene: print a summary, write an HDF5 file and a picture.

    Existing files are kept: a new run renames them to NAME.1, a failed run is written to NAME.failed.

    Args:
        level: Level of the ladder, 1 by default: each level halves the steps and refines the contacts. The
            printed error bars come from this level and the one below; see docs/accuracy.md.
        accuracy: Allowed error of the scene's own metric, for instance 1%. The run climbs the levels, by the
            cheapest preset first or by the given --fidelity, until the error bar is within it; see
            docs/accuracy.md.
        metrics: Metrics that --accuracy keeps instead.
        out: HDF5 file; default: SCENE.h5 in the current folder.
        plot: Picture (.png, .svg, .pdf); default: a .png beside the HDF5 file.
        measured: Text file of a measured torque over the pinion angle, with a unit for each column. The run
            draws it over the simulated torque, compares both, and stores it in the HDF5 file. A file of both
            directions makes the free torque's test.path there-and-back, unless that is given. Assumptions
            about the file are printed on standard error.
        band: Compute the band of the result for uncertain inputs, from this number of runs; without a number
            a quick band from 64 runs. NAME.band.json holds every sample.
        robust: If the run fails or its plan is refused, try safer settings, and name them; --accuracy tries
            the next preset anyway.
        time_limit: Elapsed time after which the run is stopped, for instance "20 s"; starting and compiling
            count. What was recorded is kept. With --band: the limit of each sample.
        progress: Show progress even when output is redirected.
        overwrite: Replace the files of an earlier run instead of renaming them.
        no_plot: Draw no picture.
    """
    began = monotonic()
    shown.check()
    if no_plot and plot:
        raise InputError(f"--no-plot draws no picture; leave out --plot {plot}.")
    from rps_exudyn.analysis.measured import compared_with_own
    from rps_exudyn.pages.report.result_sheet import sheet_of
    from rps_exudyn.simulate.cases.time_limit import TimeLimit
    from rps_exudyn.simulate.run import simulate

    limit = replace(TimeLimit.of(time_limit), begun=began) if time_limit is not None else None
    preset = setup.preset_alone() if accuracy is not None else None
    chosen = setup.load()
    out = check_writable(out or Path(f"{scene}.h5"), RESULT_FILES)
    picture = None if no_plot else check_writable(plot or out.with_suffix(".png"), PICTURES)
    if band is not None or inputs is not None:
        from rps_exudyn.cli.run_band import BandRun, do_band, sample_count

        refused = {"level": level is not None, "accuracy": accuracy, "metrics": metrics, "robust": robust}
        count = sample_count(band, [name for name, given in refused.items() if given])
        with printing(shown.quiet):
            curve = read_measured(measured, column, scene, chosen.steering_gear) if measured else None
            wanted = BandRun(scene, setup, count, inputs, jobs, limit.seconds if limit else inf)
            return do_band(wanted, Files(out, picture, overwrite), curve, shown)
    if jobs is not None:
        raise InputError("--jobs shares the runs of a band among processes; add --band.")
    gear = chosen.steering_gear
    with printing(shown.quiet):
        setup.say_medians()
        curve = read_measured(measured, column, scene, gear) if measured else None
        if curve is not None and not setup.states("test.path"):
            gear = as_turned(gear, scene, curve)
    model = chosen.fidelity if accuracy is None else preset
    try:
        with printing(shown.quiet), redirect_stdout(sys.stderr), shown_progress(progress):
            result = simulate(
                scene,
                gear,
                model,
                level=level,
                accuracy=accuracy,
                metrics=metrics,
                robust=robust,
                time_limit=limit,
            )
    except Interrupted as interrupt:
        kept = list[Path]()
        keep(replace(interrupt.recorded, measured=curve), Files(out, picture, overwrite), kept)
        where = f"kept in {kept[0]}" if kept else "lost"
        raise KeyboardInterrupt(f"interrupted; the record until then is {where}.") from None
    result = replace(result, measured=curve)
    files, is_kept = list[Path](), False

    def finish() -> None:
        nonlocal is_kept
        is_kept = keep(result, Files(out, picture, overwrite), files)

    with printing(shown.quiet):
        if text := result.findings.get("accuracy"):  # what it has reached, and what the next level would cost
            note(f"{text}.")
        sheet = sheet_of(result, compared_with_own(result))
        present(sheet, files, every=shown.every, json=shown.json, finish=finish)
    return max(verdict(result), DONE if is_kept else FAILED)


def as_turned(gear: "SteeringGear", scene: str, measured: "MeasuredTorque") -> "SteeringGear":
    """The gear whose test turns there and back, as a measured free torque does; said on standard error."""
    from rps_exudyn.analysis.passes import both_directions, passes
    from rps_exudyn.scenes.free_pinion_torque import SCENE as FREE

    if scene != FREE.name or both_directions(passes(measured.signals)) is None:
        return gear
    note(f"{measured.name} has both directions: the run turns there and back (--set test.path=one-way: not).")
    return gear.replace({"test.path": "there-and-back"})


def read_measured(path: Path, columns: Sequence[str], scene: str, gear: "SteeringGear") -> "MeasuredTorque":
    """The measured torque in a file, with the signs that a fit gives it; what was assumed is said on standard
    error. A weight makes torques of one sign both ways, which stay.
    """
    from rps_exudyn.inference.fitting.bench_tests import KINDS, with_signs
    from rps_exudyn.inference.fitting.fit import doubts
    from rps_exudyn.inference.measured.reading import read_measured_torque
    from rps_exudyn.scenes.free_pinion_torque import SCENE as FREE

    measured = read_measured_torque(path, chosen_columns(columns), gear)
    if scene not in KINDS or not KINDS[scene].weighted:
        measured = with_signs(measured)
    note(f"{path}: {'; '.join(measured.assumed)}.")
    if scene == FREE.name:
        for doubt in doubts(measured, gear):
            note(f"Check the file: {doubt}.")
    return measured
