"""The option `run --band`: a scene with the uncertainty of its inputs."""

import itertools
import sys
from collections.abc import Iterable, Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from rps_exudyn.analysis.measured import compared_with_own
from rps_exudyn.base.errors import InputError, as_sentence
from rps_exudyn.base.files import write_json
from rps_exudyn.base.interrupts import INTERRUPTED
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import Printing, SetupOptions
from rps_exudyn.cli.output import DONE, Files, command_line, naming, note, present
from rps_exudyn.inference.uncertainty.band import Band, band_of_runs
from rps_exudyn.inference.uncertainty.input_sets import uncertain_inputs
from rps_exudyn.inference.uncertainty.quick_band import SCENE, quick_band
from rps_exudyn.pages.report.result_page import effects_grid, result_page
from rps_exudyn.pages.report.result_sheet import measured_as_dict, measured_text, result_as_dict, sheet_of
from rps_exudyn.pages.report.sheet_file import KEY, sheet_as_dict
from rps_exudyn.parameters.fidelity import MEAN_STEP
from rps_exudyn.results.page_blocks import CodeText, Fold
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.result import MeasuredTorque
from rps_exudyn.results.rounding import shown_with_bar
from rps_exudyn.results.sheet import Block, Grid, Line, Section, Text
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.contact_law import resolve_contact_law
from rps_exudyn.simulate.cases.run_cases import checked_jobs

QUICK_OTHERWISE = 64  # runs of a scene without a quick band
SHOWN = 5  # contributions


@dataclass(frozen=True)
class BandRun:
    """What `run --band` is asked for; a sample that takes longer than the time limit [s] has failed."""

    scene: str
    options: SetupOptions
    count: int | None  # of samples; None: a quick band
    inputs: str | None
    jobs: int | None = None
    time_limit: float = float("inf")

    def band(self) -> Band:
        """Compute the band.

        Raises:
            InputError: distributions or a number of samples that cannot be, or a gear that fails.
        """
        own, processes = self.options.drawn(), checked_jobs(self.jobs)
        if self.options.fidelity or self.options.choices():
            setup = self.options.load()
        else:  # equilibria in steps that a band needs
            quick = replace(self.options, fidelity="quasi-static")
            setup = quick.load().replace({"fidelity.step_angle": MEAN_STEP})
        gear = setup.steering_gear
        chosen = uncertain_inputs(gear, self.inputs, own)
        made = partial(quick_band, gear, setup.fidelity, chosen)
        if self.count is not None or self.scene != SCENE:
            runs = QUICK_OTHERWISE if self.count is None else self.count
            made = partial(band_of_runs, self.scene, gear, setup.fidelity, chosen, runs)
        with redirect_stdout(sys.stderr), shown_progress() as show:

            def report(done: int, of: int) -> None:
                show(f"sample {done} of {of}", done / of)

            band = made(on_progress=report, jobs=processes, time_limit=self.time_limit)
        law = band.nominal.gear.mesh.law
        single = resolve_contact_law(gear, setup.fidelity, scene_named(self.scene).law).mesh.law
        if law != single:
            note(
                f"the band uses the contact law {law}, as every series of gears; a single run uses {single}."
            )
        return band


def do_band(wanted: BandRun, files: Files, measured: MeasuredTorque | None, shown: Printing) -> int:
    """Compute, keep and print a band; the nominal result goes to the HDF5 file as of any run.

    A measured torque is compared with the nominal result and drawn over the band.

    Raises:
        InputError: distributions or a number of samples that cannot be, or a gear that fails.
    """
    from rps_exudyn.pages.charts.inference import band_figure
    from rps_exudyn.pages.charts.style import save

    band = wanted.band()
    band = replace(band, nominal=replace(band.nominal, measured=measured))
    compared = compared_with_own(band.nominal)
    table = files.out.with_suffix(".band.json")
    files.make_room(table)
    written: list[Path] = []
    content = band.as_dict()
    with naming(written), shown_progress() as show:
        band.nominal.save(files.out)
        written.append(files.out)
        show("drawing", None)
        again = Section("", [Fold("Make the band again", [CodeText(command_line())])])
        page = result_page(band.nominal, files.out, [again], band)
        write_json(table, content | {KEY: sheet_as_dict(page)})
        written.append(table)
        if files.plot is not None:
            save(band_figure(band), files.plot)
            written.append(files.plot)
    del content["values"]  # the file has them

    def data() -> dict[str, Any]:
        return content | {"nominal": result_as_dict(band.nominal) | measured_as_dict(compared)}

    text = itertools.chain(_text(band), measured_text(compared))
    sheet = replace(sheet_of(band.nominal, compared, band), text=text, data=data)
    present(sheet, written, every=shown.every, json=shown.json)
    return INTERRUPTED if band.interrupted else DONE


def _text(band: Band) -> Iterator[Block]:
    count, failed = len(band.drawn.samples), band.drawn.failed
    head = f"{band.nominal.scene} · {band.method} · {failed} of {count} samples failed"
    yield Line(head, is_bold=True)
    if band.interrupted:
        yield Text("Interrupted: the band contains the samples finished before.")
    for cause, number in band.drawn.failures.items():
        yield Text(f"{number} x {cause}")
    yield Grid(_HEAD, list(_metric_rows(band)))
    yield Text(
        "At medians: the run at median inputs, ± its numerical error. Errors: standard errors of the "
        "quantiles; numerical: by how far they move if all samples are wrong by their error bars."
    )
    name = scene_named(band.nominal.scene).main_metric
    if (shares := band.contributions.get(name)) is not None:
        largest = list(shares.fractions.items())[:SHOWN]
        text = ", ".join(f"{path} {100 * share:.0f} %" for path, share in largest)
        yield Text(f"Contributions to {name}: {text}; acting together {100 * shares.together:.0f} %.")
    if band.contributions:
        yield effects_grid(band)
    if failed and name in band.metrics:
        low, high = band.metrics[name].lowest[0], band.metrics[name].highest[-1]
        ends = f"{_end(name, low)} to {_end(name, high)}"
        yield Text(f"With the failed samples at either end, 5 to 95 % of {name}: {ends}.")
    yield Text(_beside(band, name))


_HEAD = (
    *("quantity", "at medians", "5 %", "median", "95 %", "error at 5 %", "error at 95 %"),
    *("numerical at 5 %", "at 95 %"),
)


def _metric_rows(band: Band) -> Iterable[tuple[str, ...]]:
    for name, found in band.metrics.items():
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
    half = band.metrics[name].half_width if name in band.metrics else float("nan")
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
