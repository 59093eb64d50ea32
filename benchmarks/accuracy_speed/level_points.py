"""Error bars along the ladder: printed and true error of presets and levels, over the cost of the whole run.

The default gear runs in every scene as a user runs it, by `rps.run` with all that belongs to it. The true
error is that of the scene's main metric against a reference made without the ladder (`stability.references`).
"""

from collections.abc import Mapping, Sequence
from functools import partial
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

import rps_exudyn as rps
from benchmarks.accuracy_speed.chart import STYLES, in_decades, shown_time
from benchmarks.accuracy_speed.measurement import PRESET_FAMILIES
from benchmarks.measure import least_time
from benchmarks.stability.references import best_reference, size_in
from benchmarks.topic import Topic, begun, load_data, markdown, save_data
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.fidelity import PRESETS, Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.scenes import SCENE_NAMES, scene_named
from verification.stability import ScenePlan

LEVELS = (0, 1, 2, 3)
REPEATS, SLOW = 5, 1.0  # of a run; one that takes longer [s] is not repeated
MOST_SECONDS = 8.0  # of CPU time of a run, after which no finer level is run
DATA, PICTURE = "levels.json", "levels.png"
COLUMNS = 3  # panels side by side
LEAST = 1e-4  # error that is drawn at the edge [%]


def run(folder: Path, scenes: Sequence[str] = SCENE_NAMES, levels: Sequence[int] = LEVELS) -> None:
    """Run every preset that these scenes allow on these levels, and draw them; scenes that a run before this
    one left in the file are not run again."""
    rows: list[dict[str, Any]] = begun(folder / DATA).get("points", [])
    for scene in scenes:
        if scene not in {row["scene"] for row in rows}:
            rows += points_of(scene, levels)
            save_data(folder / DATA, {"points": rows})
    style.save(levels_figure(rows), folder / PICTURE)


def points_of(scene: str, levels: Sequence[int]) -> list[dict[str, Any]]:
    """Return all points of a scene whose reference is known."""
    gear, main_metric = SteeringGear(), scene_named(scene).main_metric
    model = Fidelity.preset("flank" if scene_named(scene).needs_inertia else "quasi-static")
    try:
        right = best_reference(ScenePlan(scene, gear, model), main_metric)
    except rps.InputError:  # a scene that needs more than the default gear
        return []
    if right is None:
        return []
    how, value, doubt = right
    points = []
    for preset in PRESETS:
        for level in levels if preset != "closed-form" else (None,):
            seconds, result = measured(scene, gear, preset, level)
            if result is None:
                break
            percent = 100 / size_in(result, main_metric)
            point = {"scene": scene, "preset": preset, "level": level, "seconds": seconds}
            point |= {"error": percent * abs(result.summary[main_metric] - value), "doubt": percent * doubt}
            point |= {"bar": percent * result.errors[main_metric], "by": how}
            print(point, flush=True)
            points.append(point)
            if seconds > MOST_SECONDS:
                break
    return points


def measured(
    scene: str, gear: SteeringGear, preset: str, level: int | None
) -> tuple[float, rps.Result | None]:
    """Return the least CPU time of a whole run [s], and the run; None of one that does not end well."""
    work = partial(rps.run, scene, gear, fidelity=preset, level=level)
    try:
        seconds, result = least_time(work, 1)
    except rps.InputError:  # a model that the scene does not have
        return nan, None
    if result.status is not Status.OK or scene_named(scene).main_metric not in result.errors:
        return seconds, None
    return (least_time(work, REPEATS)[0] if seconds < SLOW else seconds), result


def levels_figure(rows: Sequence[Mapping[str, Any]]) -> Figure:
    """Draw a panel for each scene: true errors filled, printed ones open, those of one run joined."""
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    lines = -(-len(scenes) // COLUMNS)
    figure = Figure(figsize=(9, 2.5 * lines + 0.8), layout="constrained")
    panels = figure.subplots(lines, COLUMNS, squeeze=False).ravel()
    for axes, scene in zip(panels, scenes, strict=False):
        _draw_scene(axes, [row for row in rows if row["scene"] == scene])
        axes.set_title(scene, loc="left", fontsize=10)
    for axes in panels[len(scenes) :]:
        axes.set_visible(False)
    figure.supxlabel("error of the scene's main metric [%]", fontsize=10)
    figure.supylabel("CPU time of the whole run [s]", fontsize=10)
    drawn = {row["preset"] for row in rows}
    looks = {preset: STYLES[family] for preset, family in PRESET_FAMILIES.items() if preset in drawn}
    handles = [Line2D([], [], color=c, marker=m, label=preset) for preset, (c, m) in looks.items()]
    handles += [Line2D([], [], color="black", marker="o", linestyle="", label="true error")]
    handles += [
        Line2D([], [], color="black", marker="o", fillstyle="none", linestyle="", label="printed error")
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=6, frameon=False, fontsize=9)
    return figure


def _draw_scene(axes: Axes, rows: Sequence[Mapping[str, Any]]) -> None:
    in_decades(axes)
    largest = np.nanmax([[row["error"], row["doubt"], row["bar"]] for row in rows])
    axes.set_xlim(LEAST / 2, max(10, 2 * largest))
    axes.grid(color="#e4e4e4")
    for row in rows:
        colour, marker = STYLES[PRESET_FAMILIES[row["preset"]]]
        true, printed = max(row["error"], row["doubt"], LEAST), max(row["bar"], LEAST)
        axes.plot([true, printed], [row["seconds"]] * 2, "-", color=colour, linewidth=0.8, alpha=0.6)
        axes.plot(true, row["seconds"], marker, color=colour, markersize=6)
        axes.plot(printed, row["seconds"], marker, color=colour, fillstyle="none", markersize=6)


def levels_table(folder: Path) -> str:
    """Cost of the whole default run by each preset."""
    scenes = dict.fromkeys(row["scene"] for row in load_data(folder / DATA)["points"])
    costs = {scene: whole_runs(folder, scene) for scene in scenes}
    presets = [preset for preset in PRESETS if any(preset in own for own in costs.values())]
    lines = [
        (scene, *(shown_time(own[preset]) if preset in own else "-" for preset in presets))
        for scene, own in costs.items()
    ]
    return markdown(("scene", *presets), lines)


def whole_runs(folder: Path, scene: str) -> dict[str, float]:
    """Preset -> CPU time of its whole default run [s], as far as it was measured."""
    rows = begun(folder / DATA).get("points", [])
    return {
        row["preset"]: row["seconds"] for row in rows if row["scene"] == scene and row["level"] in (1, None)
    }


TOPIC = Topic(
    "10 min",
    "accuracy_speed",
    run,
    {"scenes": ("free-pinion-torque",), "levels": (0, 1)},
    {"levels": levels_table},
)
