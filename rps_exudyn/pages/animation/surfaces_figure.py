"""Picture of both triangulated surfaces, with the triangles that touch over a tooth pitch."""

from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure

from rps_exudyn.analysis.passes import passes
from rps_exudyn.analysis.touched_triangles import touched_triangles
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.pages.animation.camera import UNCUT, Camera
from rps_exudyn.pages.animation.drawn import Triangles, triangles_of
from rps_exudyn.pages.animation.film import cutout
from rps_exudyn.pages.animation.parts import picture_parts
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.result import Result

PIXELS = (700, 560)
OVER = np.diag([1.0, -1.0, -1.0])  # turns the rack's teeth up, into the light
OTHER = {"pinion": "rack", "rack": "pinion"}
AZIMUTH, ELEVATION = 0.5, 0.8  # of the eye [rad]
DISTANCE = 6.5  # of the eye, over the pinion's tip radius
LIFTED = 2e-5  # by which touched triangles are drawn towards the eye [m], far below a pixel
COLOURS, SHOWN = "plasma", 0.98  # share of the triangles within the colours


def draw_surfaces(result: Result, path: Path) -> None:
    """Save the picture.

    Raises:
        InputError: as of `surfaces_figure`, or the file cannot be written.
    """
    style.save(surfaces_figure(result), path)


def surfaces_figure(result: Result) -> Figure:
    """The picture of the first pass of a result whose contact is of triangles.

    Raises:
        InputError: the record has no pass, or lacks the rack's motions.
    """
    if not (runs := passes(result.signals)):
        raise InputError("No picture of where the surfaces touch: the pinion does not turn in this result.")
    gear, fidelity = result.gear, Fidelity.from_tables(result.fidelity)
    found, pair = touched_triangles(gear, fidelity, runs[0].signals), GearPair.of(gear)
    parts = {part.name: part for part in picture_parts(gear)}
    upwards = found.turn.T @ np.array([0.0, 1.0, 0.0])  # in the pinion's frame
    seen = {
        "pinion": (found.turn, found.on_pinion, found.load, pair.tip_radius * upwards),
        "rack": (OVER, found.on_rack, found.load_on_rack, found.on_rack.reshape(-1, 3).mean(axis=0)),
    }
    highest = float(np.quantile(found.load, SHOWN))
    with mpl.rc_context({"font.size": 10}):
        figure = Figure(figsize=(9.5, 4.4), layout="constrained")
        axes = figure.subplots(1, 2)
    for panel, (name, (turn, corners, load, target)) in zip(axes, seen.items(), strict=True):
        camera = Camera(turn @ target, AZIMUTH, ELEVATION, DISTANCE * pair.tip_radius)
        body = triangles_of(replace(parts[name], name="rack"), (turn, np.zeros(3)), UNCUT)
        touched = _coloured(corners @ turn.T + LIFTED * camera.towards_eye, load / highest)
        panel.imshow(cutout([body, touched], camera, PIXELS))
        panel.set_axis_off()
        panel.set_title(f"{name}, from the {OTHER[name]}", loc="left", fontsize=10)
    scale = ScalarMappable(mpl.colors.Normalize(0, highest), COLOURS)
    figure.colorbar(scale, ax=axes, label="largest normal force on a triangle [N]", pad=0.01, extend="max")
    style.head(figure, result, "Where the surfaces touch, over one tooth pitch", {})
    return figure


def _coloured(corners: np.ndarray, share: np.ndarray) -> Triangles:
    """Triangles (n, 3, 3) [m] by their shares of the largest load, large ones first: they stay where several
    lie in one plane."""
    order = np.argsort(-share)
    colours = mpl.colormaps[COLOURS](share[order])[:, :3]
    return corners[order], np.zeros_like(corners), colours, np.full(len(corners), UNCUT)
