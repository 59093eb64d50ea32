"""Contact of triangles against analytic flanks on eleven gears, at equal pressure per depth.

Each gear turns by one tooth pitch in equilibria of free pinion torque. The reference is law "area" over
strips along the lines of contact, which has no triangles. The gears are the default one and ten random ones:
both hands, five to nine teeth, with their manufacturing errors.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import maneuvers_of_test
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.solvers.gear_forces import gear_forces
from verification.equilibria import equilibria
from verification.faceted import FACETED, Surface, cut_rack, faceted_run, flanks, meshed, shaped
from verification.law_area import by_law
from verification.population import random_gears

SEED, DRAWN = 31, 200  # the first of each hand and number of teeth are taken
TEETH = range(5, 10)
DATA = "triangles.json"
SURFACES: dict[str, tuple[Surface, bool]] = {
    "flanks, 0.1 um": (flanks(1e-7), False),
    "flanks, 1 um": (flanks(1e-6), False),
    "Boolean rack": (flanks(1e-7), True),
    "closed pinion, 0.1 um": (meshed(1e-7), False),
    "cut in 100 steps": (shaped(100), False),
}
"""Column -> facets of the pinion, and whether the rack is that of a Boolean cut."""
STRIPS = Fidelity.preset("quasi-static").replace(
    {"step_angle": FACETED.step_angle, "strip_stations": 16, "strip_points": 8}
)


def run(folder: Path, gears: int = 2 * len(TEETH) + 1) -> None:
    """Measure the gears."""
    rows = [measured(gear) for gear, _ in zip(chosen(), range(gears), strict=False)]
    save_data(folder / DATA, {"gears": rows})


def chosen() -> Iterator[SteeringGear]:
    """Yield the default gear and one of each hand and number of teeth."""
    yield SteeringGear()
    known = set()
    for gear in random_gears(SEED, DRAWN):
        key = gear.pinion.helix_angle > 0, gear.pinion.teeth
        if gear.pinion.teeth in TEETH and key not in known:
            known.add(key)
            yield gear


def measured(gear: SteeringGear) -> dict[str, Any]:
    """Mean and peak to peak of a gear, and what triangles differ by [%]."""
    gear = by_law(gear.replace({"test.turns": 1 / gear.pinion.teeth}), "area")
    maneuver = maneuvers_of_test(gear, "pinion", STRIPS.step_angle)[0]
    mean, ripple = _numbers(equilibria(gear, gear_forces(gear, STRIPS), maneuver))
    row: dict[str, Any] = {
        "teeth": gear.pinion.teeth,
        "helix": float(np.degrees(gear.pinion.helix_angle)),
        "shaft": float(np.degrees(GearPair.of(gear).delta)),
        "runout": gear.pinion.runout,
        "mean": mean,
        "ripple": ripple,
    }
    for name, (surface, is_cut) in SURFACES.items():
        done = faceted_run(gear, FACETED, surface, cut_rack(gear) if is_cut else None)
        found = _numbers(done)
        row[name] = [100 * (found[0] / mean - 1), 100 * (found[1] - ripple) / mean]
    return row


def _numbers(run: SceneRun) -> tuple[float, float]:
    """Mean and peak to peak of the torque [N m]; nan of a run that failed."""
    if not run.ok:
        return np.nan, np.nan
    torque = run.signals["pinion_torque"]
    return float(torque.mean()), float(np.ptp(torque))


def differences_table(folder: Path) -> str:
    """What triangles differ by over the gears [% of the mean]: the median and the largest size."""
    gears = load_data(folder / DATA)["gears"]
    rows = []
    for name in SURFACES:
        found = np.abs(np.array([row[name] for row in gears], dtype=float))  # None: failed
        ran = found[~np.isnan(found[:, 0])]
        spans = (f"{np.median(column):.2f}, {column.max():.2f}" for column in ran.T)
        rows.append((name, *spans, len(gears) - len(ran)))
    return markdown(("surfaces", "mean: median, largest %", "peak to peak %", "failed"), rows)


TOPIC = Topic("4 min", "contact_laws", run, {"gears": 1}, {"triangles": differences_table})
