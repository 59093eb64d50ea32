"""Picture of a gear: the mesh in three dimensions, the pinion's transverse section, and both in mesh."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from manifold3d import Manifold
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from rps_exudyn.gears.export import assembled
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_limits import path_on_involute
from rps_exudyn.gears.geometry_report import GeometryReport, geometry_report
from rps_exudyn.gears.helicoid import Flank, transverse_profile
from rps_exudyn.gears.polyhedron import Solid, from_manifold, to_manifold
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.gear import SteeringGear

PART_COLOURS = {
    name: to_rgb(style.PART_COLOURS[part])
    for name, part in {"pinion": "mesh", "rack": "rack", "plunger": "seat"}.items()
}
VIEW = np.array([-0.5, -0.22, 1.0])  # from the parts to the eye, housing frame: from below, into the teeth
SHOWN = np.array([0.034, 0.026, 0.022])  # half the box around the mesh that the 3-D view shows [m]
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
    parts = []
    for name, colour in PART_COLOURS.items():
        vertices, faces = from_manifold(to_manifold(solids[name].vertices, solids[name].faces) ^ box)
        parts.append((vertices, faces, colour))
    axes.imshow(shaded_image(parts, VIEW, np.array([0, 1.0, 0]), pixels_wide=700))
    axes.set_axis_off()
    axes.set_title("around the mesh: pinion, rack, plunger", loc="left", fontsize=10)


def _draw_section(axes: Axes, pair: GearPair, report: GeometryReport) -> None:
    profile = 1e3 * transverse_profile(pair, 1e-6)
    axes.fill(*profile.T, facecolor=PART_COLOURS["pinion"], alpha=0.45, edgecolor="black", linewidth=1)
    angle = np.linspace(0, 2 * np.pi, 361)
    circles = {
        "tip": (report.tip_diameter, "#0072B2", "-"),
        "root": (report.root_diameter, "#555555", "-"),
        "base": (report.base_diameter, "#B84A00", (0, (6, 6))),  # over the root circle, often hardly larger
        "reference": (report.reference_diameter, "#59616B", "-"),
        "form": (report.form_diameter, "#009E73", (0, (6, 6))),  # over the reference circle, likewise
    }
    for name, (diameter, colour, dashes) in circles.items():
        x, y, label = np.cos(angle), np.sin(angle), f"{name} circle, {diameter * 1e3:.3f} mm"
        axes.plot(5e2 * diameter * x, 5e2 * diameter * y, color=colour, ls=dashes, linewidth=1, label=label)
    _finish_section(axes, "transverse section of the pinion")


def _draw_mesh(axes: Axes, pair: GearPair, solids: dict[str, Solid]) -> None:
    """Draw the pinion's transverse plane through the pitch point at pinion angle 0.

    It shows the teeth, the paths of contact, and as dots the flanks that touch in this plane; the others
    touch elsewhere along their helix.
    """
    for name in ("rack", "pinion"):
        for polygon in _section(pair, solids[name]):
            axes.fill(
                *1e3 * polygon.T, facecolor=PART_COLOURS[name], alpha=0.45, edgecolor="black", linewidth=1
            )
    pitch = 1e3 * pair.reference_radius
    angle = np.linspace(0, 2 * np.pi, 361)
    axes.plot(pitch * np.cos(angle), pitch * np.sin(angle), color="#59616B", linewidth=0.8, linestyle="-.")
    axes.axhline(pitch, color="#59616B", linewidth=0.8, linestyle="-.", label="pitch circle and pitch line")
    ends = np.array(path_on_involute(pair))
    for side, name, colour in ((-1, "drive", "#B84A00"), (1, "coast", "#0072B2")):
        direction = np.array([-side * np.cos(pair.alpha_t), np.sin(pair.alpha_t)])
        line = 1e3 * (np.array([0, pair.reference_radius]) + ends[:, None] * direction)
        axes.plot(*line.T, color=colour, linewidth=1.8, label=f"path of contact, {name} flanks")
        touching = 1e3 * (np.array([0, pair.reference_radius]) + _contacts(pair, side)[:, None] * direction)
        if len(touching):
            axes.plot(*touching.T, "o", color=colour, markersize=5, label=f"{name} flanks touch here")
    axes.plot(0, pitch, "k+", markersize=9, label="pitch point")
    axes.set_xlim(-11.5e2 * pair.tip_radius, 11.5e2 * pair.tip_radius)
    axes.set_ylim(2e2 * pair.tip_radius, 2e2 * pair.tip_radius + 17e2 * pair.tip_radius)
    _finish_section(axes, "in mesh, transverse section at pinion angle 0")


def _section(pair: GearPair, solid: Solid) -> list[np.ndarray]:
    """Polygons (e, Y) in which the pinion's transverse plane cuts a part [m]."""
    vertices = (solid.vertices - pair.pinion_origin) @ pair.pinion_frame
    return to_manifold(1e3 * vertices, solid.faces).slice(0.0).scale((1e-3, 1e-3)).to_polygons()


def _contacts(pair: GearPair, side: int) -> np.ndarray:
    """Positions q on the path of contact where flanks touch at pinion angle 0 in the middle plane [m]."""
    start, end = path_on_involute(pair)
    tangent_point = np.pi / 2 - side * pair.alpha_t
    lengths = np.array(
        [float(Flank(pair, tooth, side).tangent_length(tangent_point, 0.0)) for tooth in range(pair.teeth)]
    )
    pitch = 2 * np.pi * pair.base_radius / pair.teeth
    q = np.concatenate([lengths + turn * pitch * pair.teeth for turn in (-1, 0, 1)])
    q = q - pair.reference_radius * np.sin(pair.alpha_t)
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


# --- Shaded pictures of triangle meshes: parallel projection, hidden surfaces by a depth buffer
#
# Matplotlib sorts whole triangles by distance, which fails for parts in mesh; here every pixel is resolved.

AMBIENT = 0.35  # brightness of a face turned away from the light
OVERSAMPLING = 2  # pixels per shown pixel, each way, averaged for smooth edges


def shaded_image(
    parts: list[tuple[np.ndarray, np.ndarray, tuple[float, float, float]]],
    towards_viewer: np.ndarray,
    up: np.ndarray,
    pixels_wide: int,
) -> np.ndarray:
    """Draw several parts, with the picture's frame around them.

    Args:
        parts: vertices (n, 3), faces (m, 3) and colour (red, green, blue in 0..1) of each.
        towards_viewer: direction from the parts to the eye, shape (3,).
        up: direction that points upwards in the picture, shape (3,).
        pixels_wide: width of the picture.

    Returns:
        Red, green, blue, alpha in 0..1, shape (height, pixels_wide, 4), transparent background.
    """
    axes = _camera(towards_viewer, up)
    triangles = np.concatenate([vertices[faces] for vertices, faces, _ in parts]) @ axes.T
    colours = np.concatenate([np.broadcast_to(colour, (len(faces), 3)) for _, faces, colour in parts])
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    visible = normals[:, 2] > 0
    triangles, colours, normals = triangles[visible], colours[visible], normals[visible]
    light = np.array([-0.4, 0.5, 0.77])
    bright = np.clip(normals @ light / np.linalg.norm(normals, axis=1), 0, 1)
    colours = colours * (AMBIENT + (1 - AMBIENT) * bright[:, None])

    low, high = triangles.reshape(-1, 3).min(axis=0), triangles.reshape(-1, 3).max(axis=0)
    width = pixels_wide * OVERSAMPLING
    scale = width / (high[0] - low[0])
    height = OVERSAMPLING * int(np.ceil((high[1] - low[1]) * scale / OVERSAMPLING))
    triangles = (triangles - [low[0], high[1], 0]) * [scale, -scale, 1]
    image = np.zeros((height, width, 4))
    depth = np.full((height, width), -np.inf)
    for corners, colour in zip(triangles, colours, strict=True):
        _fill(image, depth, corners, colour)
    blocks = image.reshape(height // OVERSAMPLING, OVERSAMPLING, pixels_wide, OVERSAMPLING, 4)
    return blocks.mean(axis=(1, 3))


def _camera(towards_viewer: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Rows: right, up, and towards the viewer."""
    forward = towards_viewer / np.linalg.norm(towards_viewer)
    right = np.cross(up, forward)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(forward, right), forward])


def _fill(image: np.ndarray, depth: np.ndarray, corners: np.ndarray, colour: np.ndarray) -> None:
    """Draw one triangle, corners (x, y, depth) in pixels, shape (3, 3), y downwards."""
    (x0, y0), (x1, y1) = np.floor(corners[:, :2].min(axis=0)), np.ceil(corners[:, :2].max(axis=0))
    rows, columns = slice(max(int(y0), 0), int(y1) + 1), slice(max(int(x0), 0), int(x1) + 1)
    y, x = np.mgrid[rows, columns][:, : image.shape[0], : image.shape[1]] + 0.5
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = corners
    area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
    v = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area
    w = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area
    distance = az + v * (bz - az) + w * (cz - az)
    tile = depth[rows, columns]
    distance, inside = distance[: tile.shape[0], : tile.shape[1]], (v >= 0) & (w >= 0) & (v + w <= 1)
    nearer = inside[: tile.shape[0], : tile.shape[1]] & (distance > tile)
    tile[nearer] = distance[nearer]
    image[rows, columns][nearer] = [*colour, 1.0]
