"""The default rack under a force across its end, its line over the bar and its play; its lift by a torque."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from benchmarks.measure import run_ok
from benchmarks.topic import Topic, digits, load_data, markdown, save_data
from rps_exudyn.forces.force_element import COORDINATE_BLOCKS
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.rack_beam import RackBeam
from rps_exudyn.pages.charts import style
from rps_exudyn.pages.charts.scene_figures import draw
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.scenes.at_rest import OutsideLoads, moved_by_modes
from rps_exudyn.solvers.balance import SIZE
from rps_exudyn.solvers.equilibrium import equilibrium_path
from rps_exudyn.solvers.gear_forces import gear_forces
from rps_exudyn.solvers.prescribed_motion import Steady

FORCE = 98.0  # [N]
MODEL = Fidelity.preset("quasi-static").replace({"rack": "flexible"})
ENLARGED = 100.0
DATA = "deflection.json"
PLAY = ("radial_play_y", "radial_play_z")
SHOWN = {
    ("radial-play", "flexible"): PLAY,
    ("radial-play", "free"): PLAY,
    ("rack-lift", "flexible"): ("rack_lift", "rack_lift_closed_form", "rack_lift_end"),
}


def run(folder: Path, force: float = FORCE, scenes: Sequence[tuple[str, str]] = tuple(SHOWN)) -> None:
    """Compute and draw the bar's line under a force along Y [N], and these scenes of the default gear."""
    gear = SteeringGear()
    line = deflected_line(gear, force)
    style.save(picture(gear, line, force), folder / "deflected.png")
    rows = [moved(scene, rack, folder) for scene, rack in scenes]
    station, deflection = line.tolist()
    content = {"force": force, "station": station, "deflection": deflection, "scenes": rows}
    save_data(folder / DATA, content)


def moved(scene: str, rack: str, folder: Path) -> dict[str, Any]:
    """Figures of a scene [SI]; that of the flexible rack is drawn."""
    result = run_ok(scene, SteeringGear(), MODEL.replace({"rack": rack}))
    if rack == "flexible":
        draw(result, folder / f"{scene.replace('-', '_')}.png")
    figures = {name: result.summary[name] for name in SHOWN[scene, rack]}
    return {"scene": scene, "rack": rack, "figures": figures}


def moves_table(folder: Path) -> str:
    """What the rack's end and the mesh move, rigid and flexible rack."""
    rows = [
        [row["scene"], row["rack"], f"`{name}`", digits(1e6 * value, 3)]
        for row in load_data(folder / DATA)["scenes"]
        for name, value in row["figures"].items()
    ]
    return markdown(["scene", "rack", "quantity", "µm"], rows)


def deflected_line(gear: SteeringGear, force: float) -> np.ndarray:
    """Stations along the bar and its displacement along Y there from rest, shape (2, n) [m]."""
    place, bar = RackBar.of(gear).x_min, RackBeam.of(gear)
    steps = np.stack([np.linspace(0, force, 11), np.zeros(11)], axis=1)
    loads = OutsideLoads(np.zeros(len(steps)), steps)
    outside = loads.generalised(place, moved_by_modes(gear, MODEL, place))
    balance = replace(gear_forces(gear, MODEL).statics, outside=outside)
    path = equilibrium_path(balance, GearPair.of(gear), Steady("pinion", 0.0, 0.0), loads.time)
    moved = path.coordinates[-1] - path.coordinates[0]
    rack, modes = moved[COORDINATE_BLOCKS["rack"]], bar.modes(gear.rack.modes)
    bent = np.where(modes.plane == 0, moved[SIZE:], 0.0) @ modes.shape
    return np.stack([modes.nodes, rack[1] + modes.nodes * rack[5] + bent])


def picture(gear: SteeringGear, line: np.ndarray, force: float) -> Figure:
    """The bar with its teeth, the bush, the yoke; both axes to scale, the deflection enlarged."""
    bar, pair = RackBar.of(gear), GearPair.of(gear)
    figure, (axes, under) = style.panels([2.2, 2.6])
    x, enlarged = 1e3 * line[0], 1e3 * ENLARGED * line[1]
    radius = 1e3 * pair.bar_radius
    axes.fill_between(x, enlarged - radius, enlarged + radius, color="#9fb6c8", linewidth=0)
    axes.plot(x, enlarged, color=style.COLOURS["torque"], linewidth=1)
    teeth = [1e3 * end for end in bar.toothed_ends]
    axes.plot(teeth, [-radius] * 2, color=style.COLOURS["roll"], linewidth=3)
    axes.add_patch(_box(1e3 * gear.bush.distance, -1.25 * radius, 1e3 * gear.bush.length, 2.5 * radius))
    axes.add_patch(_box(-500 * gear.yoke.plunger_diameter, radius, 1e3 * gear.yoke.plunger_diameter, radius))
    axes.set_aspect("equal")
    axes.set_ylabel(f"Y [mm], x {ENLARGED:g}")
    style.line(under, x, line[1], SIGNALS["rack_end_y"], "displacement", "torque")
    under.axvline(0, **style.REFERENCE_LINE)
    style.abscissa(under, "station along the bar [mm]; mesh and yoke at 0")
    style.title(figure, f"The default rack under {force:g} N across its end: bar, bush and plunger to scale")
    return figure


def _box(x: float, y: float, width: float, height: float) -> Rectangle:
    return Rectangle((x, y), width, height, facecolor="none", edgecolor="black", linewidth=1)


TOPIC = Topic(
    "10 s",
    "flexible_rack",
    run,
    {"force": 50.0, "scenes": (("rack-lift", "flexible"),)},
    {"play_and_lift": moves_table},
)
