"""The curves of a study's cases in one picture, each linked with its row in the table of cases."""

from collections.abc import Sequence
from contextlib import suppress

import matplotlib as mpl
import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import words
from rps_exudyn.charts import style
from rps_exudyn.charts.signals import WIDTH, abscissa
from rps_exudyn.report.blocks import Picture
from rps_exudyn.report.effects_charts import COLOUR_MAP
from rps_exudyn.report.pictures import picture
from rps_exudyn.report.study_messages import case_id, count, settings
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import is_scene, scene_named
from rps_exudyn.study.description import Case
from rps_exudyn.study.store import Store
from rps_exudyn.study.table import CaseTable

MOST_CURVES, MOST_POINTS = 40, 400
HEIGHT = 3.0  # [in]
BRIGHTEST = 0.85  # of the colour map: brighter curves vanish on white


def curve_id(table: CaseTable, case: Case) -> str:
    """The place of a case's curve on its page."""
    return f"curve-of-{case_id(table, case)}"


def curves_of_cases(table: CaseTable, store: Store, listed: Sequence[Case]) -> tuple[list[Picture], set[str]]:
    """Return the picture of the scene's signal in some of the listed cases, and the hashes of those drawn.

    There is no picture of a scene that is not known, or of cases whose signals were not kept.
    """
    scene = table.description.scene
    if not is_scene(scene):
        return [], set()
    signal = scene_named(scene).signal
    ok = {case.hash for case, good in zip(table.cases, table.ok, strict=True) if good}
    cases = list({case.hash: case for case in listed if case.hash in ok}.values())
    cases = cases[:: max(1, -(-len(cases) // MOST_CURVES))]
    results: dict[str, tuple[Case, Result]] = {}
    for case in cases:
        with suppress(InputError):  # a file that has vanished or is damaged by now
            result = store.result(case)
            if signal in result.signals:
                results[", ".join(settings(table, case, 4)) or case.hash] = case, result
    if not results:
        return [], set()
    drawn = _picture(table, results, signal)
    return [drawn], {case.hash for case, _ in results.values()}


def _picture(table: CaseTable, results: dict[str, tuple[Case, Result]], signal: str) -> Picture:
    over = abscissa([result for _, result in results.values()])
    figure, (axes,) = style.panels([HEIGHT], WIDTH)
    colours = mpl.colormaps[COLOUR_MAP](np.linspace(0, BRIGHTEST, len(results)))
    for colour, (label, (_, result)) in zip(colours, results.items(), strict=True):
        some = slice(None, None, max(1, -(-result[over].size // MOST_POINTS)))
        axes.plot(
            SIGNALS[over].displayed(result[over][some]),
            SIGNALS[signal].displayed(result[signal][some]),
            color=colour,
            linewidth=1,
            label=label,
        )
    axes.set_ylabel(SIGNALS[signal].axis_label(words(signal)))
    if over == "pinion_angle":
        style.angle_axis(axes)
    else:
        axes.set_xlabel(SIGNALS["time"].axis_label("time"))
        axes.margins(x=0)
    links = {label: (curve_id(table, case), case_id(table, case)) for label, (case, _) in results.items()}
    caption = f"{words(signal)} of {count(len(results), 'case')}, from the first (dark) to the last (bright)"
    return picture(figure, caption, links)
