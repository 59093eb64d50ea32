"""Stick-slip of gear and column: maps of speed and damping, limits measured and predicted, methods."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

import rps_exudyn as rps
from benchmarks.accuracy_speed.chart import in_decades
from benchmarks.measure import least_time
from benchmarks.topic import Columns, Topic, load_data, rows_table, save_data, table_of
from rps_exudyn.analysis.friction_oscillator import Oscillator, sticking_speed, sticks
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import RUBBING_PARTS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.solvers.sliding_stability import (
    one_inertia_damping,
    presliding_angle,
    reduced_gear,
    sliding_damping,
)
from verification.sliding_limit import measured_damping
from verification.stick_slip import event_based, on_bristles, regularised

DATA = "stick_slip.json"
STIFFNESS = 100.0  # of the column [N m/rad]
RATIOS = (1.1, 1.2, 1.5)  # static over kinetic friction of teeth and plunger
TRAVELS = (0.0, 2e-6, 10e-6)  # of the bristles [m]; 0: friction that depends on the speed alone
SHEETS = tuple((ratio, travel) for ratio in RATIOS for travel in TRAVELS)
CELLS = (36, 28)  # speeds and dampings of a sheet
SPEEDS, DAMPINGS = (0.2, 15.0), (0.01, 0.6)  # [rad/s], and damping ratios
LIMITS = tuple((travel, speed) for travel in (0.0, 0.2e-6, 0.5e-6) for speed in (0.5, 0.8, 1.5, 2.5))
TRIED = ((0.0, 1.0, 0.05), (0.0, 5.0, 0.03), (0.0, 4.0, 0.2), (2e-6, 1.0, 0.05), (2e-6, 4.0, 0.2))
"""Travel, speed and damping ratio of cells in which the whole gear is run, static ratio 1.2."""
STILL = 0.05  # of the wheel's speed: below it a cell sticks ...
STEADY = 0.9  # ... and above it slides


def gear_with(ratio: float, travel: float, **test: object) -> SteeringGear:
    """Return the default gear on a column, its teeth and plunger with a static ratio, on bristles or not."""
    law: dict[str, object] = {"column.stiffness": STIFFNESS}
    law |= {f"{part}.friction_law": "bristle" if travel else "stribeck" for part in RUBBING_PARTS}
    law |= {f"{part}.static_ratio": ratio for part in RUBBING_PARTS[:2]}
    law |= {f"{part}.bristle_travel": travel for part in RUBBING_PARTS if travel}
    return SteeringGear().replace(law | {f"test.{name}": value for name, value in test.items()})


def damping_of(model: Oscillator, ratio: float) -> float:
    """Return the damping of a damping ratio [N m s/rad]."""
    return float(2 * ratio * np.sqrt(model.stiffness * model.inertia))


def run(
    folder: Path,
    cells: tuple[int, int] = CELLS,
    limits: tuple[tuple[float, float], ...] = LIMITS,
    tried: tuple[tuple[float, float, float], ...] = TRIED,
    steps: int = 6,
    sheets: tuple[tuple[float, float], ...] = SHEETS,
    periods: int = 40,
) -> None:
    """Measure maps, limits, sticking speeds and methods; draw and keep them."""
    speeds, ratios = np.geomspace(*SPEEDS, cells[0]), np.geomspace(*DAMPINGS, cells[1])
    data: dict[str, Any] = {"speeds": speeds.tolist(), "ratios": ratios.tolist()}
    data["sheets"] = [sheet(*each, speeds, ratios, periods) for each in sheets]
    data["tried"] = [whole_gear(*cell) for cell in tried]
    style.save(map_picture(data), folder / "stick_slip_map.png")
    data["limits"] = [bisected(*each) for each in limits]
    data["sticking"] = [
        [ratio, sticking_speed(_damped(reduced_gear(gear_with(1.2, 0.0)), ratio))]
        for ratio in (0.01, 0.03, 0.1, 0.3)[: len(sheets)]
    ]
    data["methods"] = methods(steps)
    save_data(folder / DATA, data)
    style.save(method_picture(data["methods"]), folder / "stick_slip_methods.png")


def _damped(model: Oscillator, ratio: float) -> Oscillator:
    return replace(model, damping=damping_of(model, ratio))


def sheet(
    ratio: float, travel: float, speeds: np.ndarray, ratios: np.ndarray, periods: int
) -> dict[str, Any]:
    """One sheet: least speed over the wheel's in each cell, and the limit over the speed, as ratios."""
    gear = gear_with(ratio, travel)
    model = reduced_gear(gear)
    unit = damping_of(model, 1.0)
    if travel:
        speed, damping = np.meshgrid(speeds, ratios * unit)
        least = on_bristles(model, presliding_angle(gear), speed, damping, periods)
    else:
        least = np.stack([1.0 - sticks(_damped(model, each), speeds) for each in ratios])
    falling = [model.linear_limit(float(speed)) / unit for speed in speeds]
    return {"ratio": ratio, "travel": travel, "least": np.round(least, 4).tolist(), "falling": falling}


def whole_gear(travel: float, speed: float, ratio: float) -> dict[str, Any]:
    """Run the scene in one cell of the whole gear."""
    gear = gear_with(1.2, travel, speed=speed)
    gear = gear.replace({"column.damping": damping_of(reduced_gear(gear), ratio)})
    result = rps.run("stick-slip", gear)
    cell = {"travel": travel, "speed": speed, "ratio": ratio}
    if result.status is not Status.OK:
        return cell | {"message": result.message}
    return cell | {"share": result.summary["stick_share"], "torque": result.summary["stick_slip_torque"]}


def map_picture(data: dict[str, Any]) -> Figure:
    """One panel a sheet: where it sticks, vibrates and slides; limits as lines, runs of the whole gear as
    marks."""
    with mpl.rc_context({"font.size": 9}):
        figure = Figure(figsize=(8, 7.6), layout="constrained")
        panels = figure.subplots(len(RATIOS), len(TRAVELS), sharex=True, sharey=True)
    colours = mpl.colors.ListedColormap(["#b00020", "#f3c9a5", "#ffffff"])
    norm = mpl.colors.BoundaryNorm([-100, STILL, STEADY, 100], 3)
    for axes, each in zip(panels.flat, data["sheets"], strict=False):
        axes.set(xscale="log", yscale="log")
        axes.pcolormesh(data["speeds"], data["ratios"], each["least"], cmap=colours, norm=norm, alpha=0.55)
        shown = axes.get_ylim()
        falling = _within(each["falling"], shown)
        axes.plot(data["speeds"], falling, color="black", linestyle="--", label="limit, falling friction")
        for cell in data["tried"]:
            if each["ratio"] == 1.2 and cell["travel"] == each["travel"] and "share" in cell:
                look: Any = {"markerfacecolor": "black" if cell["share"] > 0 else "white", "markersize": 6}
                axes.plot(cell["speed"], cell["ratio"], "o", color="black", **look)
        axes.set_ylim(shown)
        law = f"bristles {1e6 * each['travel']:g} µm" if each["travel"] else "speed alone"
        axes.set_title(f"static ratio {each['ratio']:g}, {law}", fontsize=9)
    for axes in panels[-1]:
        axes.set_xlabel("wheel's speed [rad/s]")
    for axes in panels[:, 0]:
        axes.set_ylabel("damping ratio")
    panels[0, 1].legend(fontsize=7, loc="upper right", frameon=False)
    style.title(figure, "Stick-slip of gear and column, from rest: red sticks, pale vibrates, white slides")
    return figure


def _within(limit: Sequence[float | None], shown: tuple[float, float]) -> np.ndarray:
    """A line over the map where it is within the damping ratios shown; elsewhere nan, as where it is not."""
    values = np.array([np.nan if value is None else value for value in limit])
    return np.where((values >= shown[0]) & (values <= shown[1]), values, np.nan)


def bisected(travel: float, speed: float) -> dict[str, Any]:
    """The limit of the whole gear's steady sliding, measured and predicted [N m s/rad]."""
    gear, model = gear_with(1.2, travel, speed=speed), Fidelity.preset("flank")
    found = {"predicted": one_inertia_damping(gear), "with_guides": sliding_damping(gear, model)}
    case: dict[str, Any] = {"travel": travel, "speed": speed}
    case |= {name: value if np.isfinite(value) else None for name, value in found.items()}
    if case["predicted"] is None:
        return case | {"message": "stable without damping"}
    try:
        return case | {"measured": measured_damping(gear, model, case["predicted"])}
    except ArithmeticError as error:
        return case | {"message": str(error)}


def methods(steps: int) -> list[dict[str, Any]]:
    """Error of the stick-slip period and CPU time of events, explicit and implicit integration."""
    model, drive = _damped(reduced_gear(gear_with(1.2, 0.0)), 0.05), 1.0
    exact = event_based(model, drive, rtol=1e-11)
    assert exact is not None
    period, cycles, natural = exact.stick + exact.slip, 6, 2 * np.pi / model.frequency
    found: list[tuple[str, float, float]] = []
    for tolerance in np.geomspace(1e-2, 1e-9, steps):
        cpu, cycle = least_time(partial(event_based, model, drive, cycles, float(tolerance)), 1)
        found.append(("events", abs((cycle.stick + cycle.slip) / period - 1) if cycle else np.nan, cpu))
    for (implicit, per_period), zone in product(((False, 40), (True, 10)), (0.1, 0.01)):
        for k in range(steps):
            settings = zone * drive, natural / (per_period * 2**k), cycles * period, implicit
            cpu, motion = least_time(partial(regularised, model, drive, *settings), 1)
            name = f"{'implicit' if implicit else 'explicit'}, zone {zone:g}"
            found.append((name, _period_error(*motion, period), cpu))
    return [{"method": m, "error": e, "cpu": cpu / cycles} for m, e, cpu in found if np.isfinite(e)]


def _period_error(time: np.ndarray, twist: np.ndarray, period: float) -> float:
    """Error of the last cycle's length, between its falling passages of the mean."""
    later = time > time[-1] / 3
    if not np.isfinite(twist).all():
        return float("nan")
    moved, when = twist[later] - twist[later].mean(), time[later]
    down = np.flatnonzero((moved[:-1] > 0) & (moved[1:] <= 0))
    if down.size < 2:
        return float("nan")
    passed = when[down] + moved[down] / (moved[down] - moved[down + 1]) * np.diff(when)[down]
    return float(abs((passed[-1] - passed[0]) / (down.size - 1) / period - 1))


def method_picture(found: list[dict[str, Any]]) -> Figure:
    """Error over CPU time, a line a method."""
    figure, (axes,) = style.panels([4.2], 7.0)
    for colour, name in zip(style.SEVERAL, dict.fromkeys(case["method"] for case in found), strict=False):
        points = [(case["cpu"], max(case["error"], 1e-8)) for case in found if case["method"] == name]
        axes.plot(*zip(*points, strict=True), "o-", color=colour, label=name, markersize=4)
    in_decades(axes)
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.set(xlabel="CPU time of a cycle [s]", ylabel="error of the period")
    axes.legend(frameon=False)
    style.title(figure, "Stick-slip cycle by events, explicit and implicit integration, in plain Python")
    return figure


def limits_table(folder: Path) -> str:
    """Measured and predicted limits of friction that depends on speed alone."""
    cases = load_data(folder / DATA)["limits"]
    columns: Columns = {
        "speed rad/s": "{speed:g}",
        "one inertia N m s/rad": lambda case: _shown(case["predicted"]),
        "whole gear N m s/rad": lambda case: _shown(case["with_guides"]),
        "measured N m s/rad": lambda case: (
            f"*{case['message']}*" if "message" in case else _shown(case["measured"])
        ),
        "measured / whole gear": _share,
    }  # bristles were measured with a law of earlier versions
    return table_of([case for case in cases if not case["travel"]], columns)


def _shown(value: float | None) -> str:
    return "-" if value is None else f"{value:.4f}"


def _share(case: dict[str, Any]) -> str:
    if "message" in case:
        return ""
    return f"{case['measured'] / case['with_guides']:.3f}" if case["with_guides"] else "-"


STICKING: Columns = {
    "damping ratio": lambda row: f"{row[0]:g}",
    "largest sticking speed rad/s": lambda row: f"{row[1]:.2f}",
}


TOPIC = Topic(
    "2 min",
    "stick_slip",
    run,
    {"cells": (3, 2), "limits": (), "tried": (), "steps": 1, "sheets": SHEETS[3:6:2], "periods": 2},
    {"stick_slip_limits": limits_table, "sticking": rows_table(DATA, "sticking", STICKING)},
)
