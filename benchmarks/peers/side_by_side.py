"""The same gear in other programs and in this package: time against error, in one interleaved run."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.peers import plans
from benchmarks.peers.chart import work_precision_figure
from benchmarks.peers.compared import DATA, TABLES, front_of, loop
from benchmarks.peers.reference import COARSE, FINE, at_angles, reference
from benchmarks.peers.rounds import Row, absent, as_data, from_data, installed, measured, versions
from benchmarks.peers.scene import GEAR, TURN, Method
from benchmarks.topic import Topic, begun, load_data, save_data
from rps_exudyn.pages.charts import style
from verification.references import Method as ReferenceMethod

PICTURE = "peers.png"
WARMED = TURN / 36
PITCH = TURN / GEAR.pinion.teeth


def run(
    folder: Path,
    own: Sequence[Method] = tuple(plans.OF_PACKAGE),
    searched: Sequence[Method] = tuple(plans.SEARCHED),
    methods: Mapping[str, ReferenceMethod] = FINE,
    rounds: int = 9,
    enough_s: float = 12.0,
    turned: float = TURN,
    search_again: bool = True,
) -> None:
    """Search the peers' settings, run the best of them and the package's in rounds, and draw them.

    Without `search_again` only programs are searched that the data file has no search of.
    """
    known = reference(methods)
    torque, searched = at_angles(known), [each for each in searched if installed(each.program)]
    search = [] if search_again else from_data(begun(folder / DATA).get("search", []))
    done = {row.program for row in search}
    search += measured([each for each in searched if each.program not in done], torque, 1, 0.0, PITCH)
    labels = {(row.program, row.label) for row in best(search)}
    chosen = [method for method in searched if (method.program, method.label) in labels]
    warm(own)
    content = {
        "rows": as_data(measured([*own, *chosen], torque, rounds, enough_s, turned)),
        "search": as_data(search),
        "reference": {"mean": float(np.mean(torque)), "uncertainty_percent": known.uncertainty},
        "versions": versions(),
        "absent": absent(),
    }
    save_data(folder / DATA, content)
    draw(folder)


def warm(methods: Sequence[Method]) -> None:
    """Run one method of each program over a little angle, which compiles kernels and loads libraries."""
    for method in {method.program: method for method in methods}.values():
        with suppress(ArithmeticError):  # the rounds tell
            method.run(WARMED)


def draw(folder: Path) -> None:
    """Draw the stored rows."""
    content = load_data(folder / DATA)
    figure = work_precision_figure(from_data(content["rows"]), content["reference"]["uncertainty_percent"])
    style.save(figure, folder / PICTURE)


def best(search: Sequence[Row], most: int = plans.MOST) -> list[Row]:
    """Return of each program the rows that no other of it beats in error and time, at most `most`, evenly."""
    chosen: list[Row] = []
    for program in dict.fromkeys(row.program for row in search):
        rows = [row for row in search if row.program == program and row.ok]
        if not rows:
            continue
        kept = front_of(rows, loop)
        places = np.unique(np.linspace(0, len(kept) - 1, min(most, len(kept))).round().astype(int))
        chosen += [kept[place] for place in places]
    return chosen


TOY = {"own": plans.OF_PACKAGE[:2], "searched": (), "methods": COARSE, "rounds": 1}
TOPIC = Topic("20 min", "peers", run, TOY, TABLES)

AGAIN = Topic(
    "5 min",
    "peers",
    partial(run, search_again=False),
    TOY,
    {},
    about="the rounds of `peers` again, with the settings that its search found (needs the extra [peers])",
)
