"""The same gear in other programs and in this package: time against error, in one interleaved run."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.peers import plans
from benchmarks.peers.chart import work_precision_figure
from benchmarks.peers.compared import TABLES
from benchmarks.peers.reference import COARSE, FINE, at_angles, reference
from benchmarks.peers.rounds import Row, absent, as_data, curve_of, from_data, installed, measured, versions
from benchmarks.peers.scene import GEAR, TURN, Method
from benchmarks.topic import Topic, load_data, save_data
from rps_exudyn.pages.charts import style
from verification.references import Method as ReferenceMethod
from verification.work_precision import pareto_front

DATA, PICTURE = "peers.json", "peers.png"
WARMED = TURN / 36
PITCH = TURN / GEAR.pinion.teeth


def run(
    folder: Path,
    own: Sequence[Method] = tuple(plans.OF_PACKAGE),
    searched: Sequence[Method] = tuple(plans.SEARCHED),
    finest: Mapping[str, Method] = plans.FINEST,
    methods: Mapping[str, ReferenceMethod] | None = None,
    rounds: int = 9,
    enough_s: float = 12.0,
    turned: float = TURN,
) -> None:
    """Search the peers' settings, run the best of them and the package's in rounds, and draw them."""
    torque = at_angles(reference(methods or FINE))
    searched = [method for method in searched if installed(method.program)]
    search, limits = measured(searched, torque, 1, 0.0, PITCH), dict(limits_of(finest))
    mean = np.mean(torque)
    found = {
        "search": as_data(search),
        "limits": {
            name: {"settings": finest[name].label, "mean": float(100 * (np.mean(curve) / mean - 1))}
            for name, curve in limits.items()
        },
    }
    _side_by_side(folder, own, searched, found, methods, limits, rounds, enough_s, turned)


def run_again(
    folder: Path,
    own: Sequence[Method] = tuple(plans.OF_PACKAGE),
    searched: Sequence[Method] = tuple(plans.SEARCHED),
    methods: Mapping[str, ReferenceMethod] | None = None,
    rounds: int = 9,
    enough_s: float = 12.0,
    turned: float = TURN,
) -> None:
    """Run the rounds again, with the peers' settings that an earlier search found, and keep what it found."""
    searched = [method for method in searched if installed(method.program)]
    nothing: dict[str, Any] = {"search": [], "limits": {}, "rows": []}
    found = load_data(folder / DATA) if (folder / DATA).is_file() else nothing
    _side_by_side(folder, own, searched, found, methods, {}, rounds, enough_s, turned)


def _side_by_side(
    folder: Path,
    own: Sequence[Method],
    searched: Sequence[Method],
    found: Mapping[str, Any],
    methods: Mapping[str, ReferenceMethod] | None,
    limits: Mapping[str, np.ndarray],
    rounds: int,
    enough_s: float,
    turned: float,
) -> None:
    """Run the package's settings and the best of those searched in rounds, store and draw them."""
    known = reference(methods or FINE)
    torque = at_angles(known)
    labels = {(row.program, row.label) for row in best(from_data(found["search"]))}
    chosen = [method for method in searched if (method.program, method.label) in labels]
    warm(own)
    rows = measured([*own, *chosen], torque, rounds, enough_s, turned, limits)
    before = {(row.program, row.label): row.own for row in from_data(found.get("rows", []))}
    content = {
        "rows": as_data([replace(row, own=before.get((row.program, row.label), row.own)) for row in rows]),
        "search": found["search"],
        "limits": found["limits"],
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


def limits_of(finest: Mapping[str, Method]) -> Iterator[tuple[str, np.ndarray]]:
    """Yield program and torque of the finest settings that can be run and end well."""
    for name, method in finest.items():
        if installed(method.program):
            try:
                yield name, curve_of(method)
            except ArithmeticError as error:
                print(f"{name}, {method.label}: {error}", flush=True)


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
        front = pareto_front(np.array([r.loop_s for r in rows]), np.array([r.error for r in rows]))
        kept = sorted((r for r, one in zip(rows, front, strict=True) if one), key=lambda r: r.loop_s)
        places = np.unique(np.linspace(0, len(kept) - 1, min(most, len(kept))).round().astype(int))
        chosen += [kept[place] for place in places]
    return chosen


TOPIC = Topic(
    "the same gear in MuJoCo and Drake: time against error (needs the extra [peers])",
    "20 min",
    "peers",
    run,
    {
        "own": plans.OF_PACKAGE[:2],
        "searched": (),
        "finest": {},
        "methods": COARSE,
        "rounds": 1,
    },
    TABLES,
)

AGAIN = Topic(
    "the rounds of `peers` again, with the settings that its search found (needs the extra [peers])",
    "5 min",
    "peers",
    run_again,
    {"own": plans.OF_PACKAGE[:2], "searched": (), "methods": COARSE, "rounds": 1},
    {},
)
