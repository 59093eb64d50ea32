"""The section about the contact of the teeth: loads of the lines, shares of the teeth, contact pattern.

It is drawn on request: the contact law is evaluated again at every recorded pose.
"""

from collections.abc import Iterator

import numpy as np

from rps_exudyn.analysis.load_distribution import LoadDistribution, load_distribution
from rps_exudyn.analysis.passes import passes
from rps_exudyn.base.errors import InputError
from rps_exudyn.charts.contact_pattern import pattern_figure
from rps_exudyn.charts.load_distribution import FLANKS, load_figure
from rps_exudyn.report.blocks import Block, Grid, Pictures, Section, Text
from rps_exudyn.report.pictures import picture
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result


def contact_section(result: Result) -> Section:
    """Return the section, or one sentence where the record does not know the contact's loads."""
    return Section("Contact of the teeth", list(_blocks(result)))


def _blocks(result: Result) -> Iterator[Block]:
    if result.status is not Status.OK:
        yield Text("The simulation failed: its loads would not be those of the gear.")
        return
    if result.fidelity["mesh"] != "flank":
        modelled = result.fidelity["mesh"]
        yield Text(f"fidelity.mesh is {modelled}; loads along the lines of contact are those of flank.")
        return
    try:
        yield Pictures([picture(pattern_figure(result), "Contact pattern")])
        yield Pictures([picture(load_figure(result), "Loads on the lines of contact")])
        yield _largest(load_distribution(result.gear, passes(result.signals)[0].signals))
    except InputError as error:  # no pass, no motions of the rack, or a law without load per length
        yield Text(" ".join(error.problems))


def _largest(loads: LoadDistribution) -> Grid:
    """The numbers of both sides over the first pass."""
    rows = []
    for side, name in FLANKS.items():
        chosen, share = loads.side == side, loads.largest_share(side)
        carries = bool(np.isfinite(share).any())
        rows.append(
            [
                name,
                f"{loads.force_on(side).max():.4g} N",
                f"{1e-3 * loads.load[chosen].max(initial=0.0):.4g} N/mm",
                f"{1e-6 * loads.pressure[chosen].max(initial=0.0):.4g} MPa",
                f"{100 * np.nanmin(share):.3g} to {100 * np.nanmax(share):.3g} %" if carries else "",
            ]
        )
    columns = ("flanks", "normal force", "largest load per length", "Hertz's pressure", "share of one tooth")
    return Grid(columns, rows)
