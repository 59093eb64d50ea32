"""Picture of a gear: the mesh in three dimensions, the pinion's transverse section, and both in mesh."""

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from manifold3d import Manifold
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rps_exudyn.gears.export import assembled
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.generated_rack import GeneratedRack, Section
from rps_exudyn.gears.geometry_limits import path_on_involute
from rps_exudyn.gears.geometry_report import GeometryReport, geometry_report
from rps_exudyn.gears.helicoid import Flank, transverse_profile
from rps_exudyn.gears.polyhedron import Solid, from_manifold, to_manifold
from rps_exudyn.pages.animation.camera import UNCUT, Camera
from rps_exudyn.pages.animation.drawn import triangles_of
from rps_exudyn.pages.animation.film import cutout
from rps_exudyn.pages.animation.parts import COLOURS, PicturePart, with_normals
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.gear import SteeringGear

SHOWN = np.array([0.034, 0.026, 0.022])  # half the box around the mesh that the 3-D view shows [m]
AZIMUTH, ELEVATION, DISTANCE = 0.46, -0.19, 0.15  # of the eye: from below, into the teeth [rad], [m]
PIXELS = (900, 750)
DASHES = dict.fromkeys(("base", "form"), (0, (6, 6)))  # over a circle that is often hardly smaller
ROUND = np.linspace(0, 2 * np.pi, 361)  # angles of a circle [rad]
CHORD_ERROR = 5e-6  # of the meshes drawn [m], far below a pixel


def draw_geometry(gear: SteeringGear, path: str | Path, force: bool = False) -> None:
    """Save the picture of a gear; `force` draws an undercut one, too.

    Raises:
        InputError: the gear cannot be built, or the file cannot be written.
    """
    style.save(geometry_figure(gear, force), path)


def geometry_figure(gear: SteeringGear, force: bool = False) -> Figure:
    """The picture of a gear, with the warnings of its geometry report.

    Raises:
        InputError: the gear cannot be built.
    """
    report, pair = geometry_report(gear, force), GearPair.of(gear)
    solids = assembled(gear, chord_error=CHORD_ERROR)
    with mpl.rc_context({"font.size": 10}):
        figure = Figure(figsize=(9, 9), layout="constrained")
        axes = figure.subplot_mosaic([["view", "view"], ["section", "mesh"]], height_ratios=[1, 1.1])
    view, section, mesh = axes["view"], axes["section"], axes["mesh"]
    _draw_view(view, pair, solids)
    _draw_section(section, pair, report)
    _draw_mesh(mesh, pair, solids)
    style.title(figure, _headline(gear, report))
    if report.warnings:
        style.footnote(figure, report.warnings)
    return figure


def _draw_view(axes: Axes, pair: GearPair, solids: dict[str, Solid]) -> None:
    centre = np.array([0, 2 * pair.reference_radius, 0])
    box = Manifold.cube(tuple(2 * SHOWN), True).translate(tuple(centre))
    bodies = []
    for name in ("pinion", "rack", "plunger"):
        mesh = from_manifold(to_manifold(solids[name].vertices, solids[name].faces) ^ box)
        bodies.append(triangles_of(PicturePart(name, *with_normals(*mesh)), (np.eye(3), np.zeros(3)), UNCUT))
    image = cutout(bodies, Camera(centre, AZIMUTH, ELEVATION, DISTANCE), PIXELS)
    axes.imshow(image.crop(image.getbbox()))
    axes.set_axis_off()
    axes.set_title("around the mesh: pinion, rack, plunger", loc="left", fontsize=10)


def _draw_section(axes: Axes, pair: GearPair, report: GeometryReport) -> None:
    profile = 1e3 * transverse_profile(pair, 1e-6)
    axes.fill(*profile.T, facecolor=COLOURS["pinion"], alpha=0.45, edgecolor="black", linewidth=1)
    for name, colour in {
        "tip": "other",
        "root": "lift",
        "base": "failure",
        "reference": "lift",
        "form": "bush",
    }.items():
        diameter = getattr(report, f"{name}_diameter")
        look: Any = {"color": style.COLOURS[colour], "linestyle": DASHES.get(name, "-"), "linewidth": 1}
        x, y = 5e2 * diameter * np.cos(ROUND), 5e2 * diameter * np.sin(ROUND)
        axes.plot(x, y, label=f"{name} circle, {diameter * 1e3:.3f} mm", **look)
    _finish_section(axes, "transverse section of the pinion")


def _draw_mesh(axes: Axes, pair: GearPair, solids: dict[str, Solid]) -> None:
    """Draw the pinion's transverse plane through the pitch point at pinion angle 0.

    It shows the teeth, the paths of contact, and as dots the flanks that touch in this plane; the others
    touch elsewhere along their helix.
    """
    for name in ("rack", "pinion"):
        vertices = (solids[name].vertices - pair.pinion_origin) @ pair.pinion_frame
        section = to_manifold(1e3 * vertices, solids[name].faces).slice(0.0).scale((1e-3, 1e-3))
        for polygon in section.to_polygons():
            axes.fill(*1e3 * polygon.T, facecolor=COLOURS[name], alpha=0.45, edgecolor="black", linewidth=1)
    section = _mesh_section(pair)
    pitch = 1e3 * section.pitch_radius
    look: Any = {"color": style.COLOURS["lift"], "linewidth": 0.8, "linestyle": "-."}
    axes.plot(pitch * np.cos(ROUND), pitch * np.sin(ROUND), **look)
    axes.axhline(pitch, label="pitch circle and pitch line", **look)
    ends, pitch_point = np.array(section.path), np.array([0, section.pitch_radius])
    for side, name, key in ((-1, "drive", "failure"), (1, "coast", "other")):
        alpha_t, colour = section.alpha_t, style.COLOURS[key]
        direction = np.array([-side * np.cos(alpha_t), np.sin(alpha_t)])
        line = 1e3 * (pitch_point + ends[:, None] * direction)
        axes.plot(*line.T, color=colour, linewidth=1.8, label=f"path of contact, {name} flanks")
        touching = 1e3 * (pitch_point + _contacts(pair, side)[:, None] * direction)
        if len(touching):
            axes.plot(*touching.T, "o", color=colour, markersize=5, label=f"{name} flanks touch here")
    axes.plot(0, pitch, "k+", markersize=9, label="pitch point")
    axes.set_xlim(-11.5e2 * pair.tip_radius, 11.5e2 * pair.tip_radius)
    axes.set_ylim(2e2 * pair.tip_radius, 2e2 * pair.tip_radius + 17e2 * pair.tip_radius)
    _finish_section(axes, "in mesh, transverse section at pinion angle 0")


def _mesh_section(pair: GearPair) -> Section:
    """The mesh at pinion angle 0."""
    if pair.course is not None:
        return GeneratedRack.of(pair).section_at(0.0)
    return Section(pair.reference_radius, pair.alpha_t, path_on_involute(pair))


def _contacts(pair: GearPair, side: int) -> np.ndarray:
    """Positions q on the path of contact where flanks touch at pinion angle 0 in the middle plane [m]."""
    radius, alpha_t, (start, end) = _mesh_section(pair)
    tangent_point = np.pi / 2 - side * alpha_t
    flanks = [Flank(pair, tooth, side) for tooth in range(pair.teeth)]
    lengths = np.array([float(flank.tangent_length(tangent_point, 0.0)) for flank in flanks])
    pitch = 2 * np.pi * pair.base_radius / pair.teeth
    q = np.concatenate([lengths + turn * pitch * pair.teeth for turn in (-1, 0, 1)])
    q = q - radius * np.sin(alpha_t)
    return q[(q >= start) & (q <= end)]


def _finish_section(axes: Axes, title: str) -> None:
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2, fontsize=8.5, frameon=False)
    axes.set_aspect("equal")
    axes.set_xlabel("e [mm]")
    axes.set_ylabel("Y [mm]")
    axes.set_title(title, loc="left", fontsize=10)
    axes.spines[["top", "right"]].set_visible(False)


def _headline(gear: SteeringGear, report: GeometryReport) -> str:
    pinion = gear.pinion
    headline = (
        f"{pinion.teeth} teeth, mₙ {pinion.normal_module * 1e3:.4g} mm, "
        f"αₙ {np.degrees(pinion.pressure_angle):.4g}°, "
        f"βₚ {np.degrees(pinion.helix_angle):.4g}°, βᵣ {np.degrees(gear.rack.tooth_angle):.4g}°, "
        f"x {pinion.profile_shift:.4g} · {report.travel_per_turn * 1e3:.4g} mm per turn · "
        f"contact ratio {report.transverse_contact_ratio:.3g} transverse + {report.overlap_ratio:.3g} overlap"
    )
    return headline.replace("-", "−")
