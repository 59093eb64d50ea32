"""Answers to clicks: simulation, band, window, sheet, picture, pattern, measured curve, fit."""

import base64
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic
from typing import Any

import numpy as np

from rps_exudyn.analysis.measured import rows_at_reversal
from rps_exudyn.analysis.passes import passes
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.progress import Progress, passed_on
from rps_exudyn.inference.fitting import findings
from rps_exudyn.inference.fitting.bench_tests import with_signs
from rps_exudyn.inference.fitting.fit import doubts, fit
from rps_exudyn.inference.measured.reading import read_measured_torque
from rps_exudyn.inference.uncertainty.band import OnProgress, band_of_runs
from rps_exudyn.inference.uncertainty.input_sets import uncertain_inputs
from rps_exudyn.inference.uncertainty.statistics import LEVELS
from rps_exudyn.pages.explore import sliders
from rps_exudyn.pages.explore.sliders import BY_PATH, Answer, Wish, fidelity_of
from rps_exudyn.pages.explore.typed_limits import limits_of
from rps_exudyn.pages.report.gear_picture import gear_picture
from rps_exudyn.pages.report.html import page
from rps_exudyn.pages.report.result_page import result_page, touching_picture
from rps_exudyn.parameters.fidelity import FOR_MEANS, Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.page_blocks import Picture, Pictures
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import MeasuredTorque
from rps_exudyn.results.sheet import Sheet
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.free_pinion_torque import SCENE
from rps_exudyn.simulate.run import simulate

SAMPLES = 24  # gears of a band
WINDOW_PATH = "yoke.preload"  # the parameter that the plug adjusts when a gear is assembled
NO_LIMIT = "No limit is typed for the window: open Limits and type one, for instance 1.8 N m at most."
Click = Callable[[SteeringGear, Wish], Answer]
FindWindow = Callable[[SteeringGear, str, Mapping[str, Any], OnProgress], Sheet]
"""Gear, path, limits by metric -> sheet of the window of that parameter. Windows stand above the pages: who
starts the page hands the function over, one of a module, because it goes to other processes."""


def on_request(gear: SteeringGear, wish: Wish, answered: Click) -> Answer:
    """Answer a click, by one of `KINDS`; "problems" are sentences why there is no answer."""
    try:
        return answered(gear, wish)
    except InputError as error:
        return {"problems": list(error.problems)}


def _reported(part: str) -> OnProgress:
    """What reports how many parts of a whole are done."""
    began = monotonic()

    def report(done: int, of: int) -> None:
        if done:
            elapsed = monotonic() - began
            passed_on(Progress(f"{part} {done} of {of}", done / of, elapsed, elapsed * (of / done - 1)))

    return report


def _band(gear: SteeringGear, wish: Wish) -> Answer:
    """Quantiles of the scene's curve over gears of a series."""
    chosen = wish.gear(gear)
    dynamic = scene_named(wish.scene).needs_inertia
    model = Fidelity.preset(fidelity_of(wish.scene)) if dynamic else FOR_MEANS
    inputs = uncertain_inputs(chosen, None, {})
    band = band_of_runs(wish.scene, chosen, model, inputs, SAMPLES, on_progress=_reported("gear"))
    if band.curves is None:
        return {"problems": ["The runs share no curve, so there is no band."]}
    signal = scene_named(wish.scene).signal
    along = sliders.abscissa(band.nominal)
    ends = {"low": 0, "inner_low": 1, "inner_high": -2, "high": -1}
    found: list[Answer] = []
    for name, at in ends.items():
        signals = {**band.nominal.signals, signal: band.curves.quantiles[at]}
        curves = sliders.curves_of(replace(band.nominal, signals=signals), signal, along)
        found = found or [{"direction": each["direction"], "x": each["x"]} for each in curves]
        for part, each in zip(found, curves, strict=True):
            part[name] = each["y"]
    inner, outer = (100 * (LEVELS[-1 - k] - LEVELS[k]) for k in (1, 0))
    return {"band": found, "levels": [round(inner), round(outer)], "gears": len(band.drawn.samples)}


def window_of(find: FindWindow, gear: SteeringGear, wish: Wish) -> Answer:
    """Where a share of a series keeps the typed limits, over `WINDOW_PATH`.

    Raises:
        InputError: no limits, or some that cannot be.
    """
    typed = limits_of(wish.limits or {})["limits"]
    if problems := [text for each in typed.values() for text in each.get("problems", ())]:
        raise InputError(problems)
    if not typed:
        raise InputError(NO_LIMIT)
    ends = {name: {key: each[key] for key in ("least", "most")} for name, each in typed.items()}
    tables = {name: {key: end for key, end in each.items() if end is not None} for name, each in ends.items()}
    sheet = find(Wish(wish.state).gear(gear), WINDOW_PATH, tables, _reported("part"))
    drawn = [block for each in sheet.sections for block in each.blocks if isinstance(block, Pictures)]
    images = {each.place: {"src": _image(each), "alt": each.caption} for each in drawn[0].pictures}
    rows = [[row.value, row.words, row.is_vague] for row in sheet.rows]
    return {"rows": rows, "lead": sheet.lead, "images": images}


def _sheet(gear: SteeringGear, wish: Wish) -> Answer:
    result = simulate(wish.scene, wish.gear(gear), fidelity_of(wish.scene))
    return {"page": page([result_page(result, Path(f"{wish.scene}.h5"))])}


def _picture(gear: SteeringGear, wish: Wish) -> Answer:
    found = gear_picture(wish.gear(gear))
    return {"problems": ["This gear cannot be drawn."]} if found is None else asdict(found)


def _pattern(gear: SteeringGear, wish: Wish) -> Answer:
    result = simulate(SCENE.name, Wish(wish.state).gear(gear), fidelity_of(SCENE.name))
    return {"image": _image(touching_picture(result))}


def _image(picture: Picture) -> str:
    return f"data:image/svg+xml;base64,{base64.b64encode(picture.svg.encode()).decode('ascii')}"


def _read(wish: Wish, folder: str, gear: SteeringGear) -> tuple[Path, MeasuredTorque]:
    file = Path(folder) / "measured.csv"
    try:
        file.write_bytes(base64.b64decode(wish.measured, validate=True))
        return file, with_signs(read_measured_torque(file, gear=gear))
    except InputError as error:
        raise InputError([text.replace(f"{file}", "the file") for text in error.problems]) from None
    except ValueError:
        raise InputError("a measured file must come as base64.") from None


def _measured(gear: SteeringGear, wish: Wish) -> Answer:
    chosen = Wish(wish.state).gear(gear)
    with TemporaryDirectory() as folder:
        _, measured = _read(wish, folder, chosen)
    found = [
        {
            "direction": each.direction,
            "x": np.round(SIGNALS["pinion_angle"].displayed(each.angle), 3).tolist(),
            "y": np.round(each.direction * each.signals["pinion_torque"], 6).tolist(),
            "at_reversal": rows_at_reversal(each),
        }
        for each in passes(measured.signals)
    ]
    return {"measured": found, "assumed": [*measured.assumed, *doubts(measured, chosen)]}


def _fit(gear: SteeringGear, wish: Wish) -> Answer:
    """A fit to the measured file: values of sliders, and sentences."""
    chosen = Wish(wish.state).gear(gear)
    with TemporaryDirectory() as folder:
        file, _ = _read(wish, folder, chosen)
        found = fit([file], chosen, other_law=False)
    fitted = [BY_PATH[each.path] for each in found.estimates if each.path in BY_PATH]
    state = {each.path: min(max(each.of(found.gear), each.low), each.high) for each in fitted}
    sentences = [*findings.level_sentences(found), *found.warnings]
    return {"state": state, "sentences": [f"{text[:1].upper()}{text[1:]}." for text in sentences if text]}


SIMULATION = "simulation"  # of a scene of dynamics, several at a time
WINDOW = "window"  # by `window_of`, where a function finds it
KINDS: Mapping[str, Click] = {
    SIMULATION: sliders.simulated,
    "band": _band,
    "sheet": _sheet,
    "picture": _picture,
    "pattern": _pattern,
    "measured": _measured,
    "fit": _fit,
}
