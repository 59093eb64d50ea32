"""Stability maps: where each method stops being right, and what theory predicts.

The plans are those of `plans/*.toml`, which `rps-exudyn study` runs too; here each is run without checks, and
compared with the same maneuver in small steps. Beside them stand explicit methods: classical Runge-Kutta on
the gear (`verification.runge_kutta`), Exudyn's velocity Verlet on the bush's chain.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from time import process_time
from types import MappingProxyType
from typing import Any

import numpy as np
from scipy.optimize import brentq

from benchmarks.stability.chart import draw_maps
from benchmarks.stability.explicit_limits import SPHERES, chain_frequency, chain_is_bounded
from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.bush import bush_chain
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.checks.rules import DEEPEST, STEPS_PER_PITCH
from rps_exudyn.simulate.run import simulate
from rps_exudyn.solvers.equilibrium import equilibrium_path
from rps_exudyn.solvers.gear_forces import gear_forces
from rps_exudyn.study.cases import setup_of
from rps_exudyn.study.definition import Axis, Case, Study, axis_quantity
from rps_exudyn.study.study_file import read_study
from rps_exudyn.tooth_contact.mean_depth import mean_depth
from rps_exudyn.tooth_contact.spheres import sphere_radius
from verification.law_area import by_law
from verification.runge_kutta import runge_kutta
from verification.stability import (
    INACCURATE,
    REFERENCES,
    SLOW,
    STILL,
    WRONG,
    Cell,
    Choices,
    Line,
    ScenePlan,
    StabilityMap,
    cell_of,
    cpu_time_limit,
    error_of,
    reference,
    run_and_check,
)
from verification.stable_step import STEPS, DrivenGear, simple_limits

PLANS = Path(__file__).parent / "plans"
TIME_LIMIT = 30.0  # CPU time of a cell, and of its reference [s]

Predict = Callable[[SteeringGear, Fidelity], float]


def maps_of(
    file: str,
    lines: Mapping[str, Predict] = MappingProxyType({}),
    methods: Sequence[Choices] = REFERENCES,
    thinned: Callable[[Study], Study] = lambda study: study,
) -> list[StabilityMap]:
    """The maps of a study over two axes; of a third, its first, one map for each value.

    `lines` are predicted values of y, in its display unit, for the cell's gear and fidelity.
    """
    study = thinned(read_study(PLANS / f"{file}.toml"))
    *kinds, x, y = study.axes
    maps = []
    for kind in kinds[0].values or () if kinds else [None]:
        fixed = {kinds[0].name: kind} if kinds else {}

        def plan_of(a: Any, b: Any, fixed: dict[str, Any] = fixed) -> ScenePlan:
            setup = setup_of(study, Case("", fixed | {x.name: a, y.name: b}))
            gear = by_law(setup.steering_gear, "area")  # whose stiffness is varied
            return ScenePlan(study.scene, gear, setup.fidelity)

        cells = [[cell_and_flag(plan_of(a, b), methods) for a in _rising(x)] for b in _rising(y)]
        plans = [plan_of(a, _rising(y)[0]) for a in _rising(x)]
        limits = [Line(label, [at(p.gear, p.fidelity) for p in plans]) for label, at in lines.items()]
        kinds_of_cells = [[str(cell) for cell, _ in row] for row in cells]
        flags = [[flag for _, flag in row] for row in cells]
        axes = _label(x), _label(y), _displayed(x), _displayed(y)
        maps.append(StabilityMap(_title(plans, x), *axes, kinds_of_cells, flags, limits))
    return maps


def _title(plans: Sequence[ScenePlan], x: Axis) -> str:
    """Solver, contact and, if it is the same everywhere, speed."""
    fidelity, speed = plans[0].fidelity, plans[0].gear.test.speed * 30 / np.pi
    at = "" if "test.speed" in x.paths else f", {speed:.3g} rpm"
    return f"{fidelity.solver}, {fidelity.mesh}{', chain' if fidelity.bush == 'chain' else ''}{at}"


def cell_and_flag(plan: ScenePlan, methods: Sequence[Choices]) -> tuple[Cell, bool]:
    """Return what a plan gives unchecked, and whether the checks before or after a run object."""
    try:
        with cpu_time_limit(TIME_LIMIT):
            result, flagged = run_and_check(plan)
    except InputError:  # for instance a preload that the teeth do not carry
        return Cell.FAILED, True
    except TimeoutError:
        return Cell.FAILED, False
    try:
        with cpu_time_limit(TIME_LIMIT):
            true = reference(plan, methods)
    except TimeoutError:
        true = float("nan")
    return cell_of(plan, result, true), flagged


def _axis(path: str) -> Axis:
    """Axis of one parameter in its usual unit."""
    return Axis(path, (path,), "", None, "grid")


def _label(axis: Axis) -> str:
    return axis_quantity(axis).axis_label(axis.paths[0])


def _rising(axis: Axis) -> list[Any]:
    """Sorted values of an axis; a study file may begin with those that are cheap and safe."""
    return sorted(axis.values or ())


def _displayed(axis: Axis) -> list[float]:
    return [float(round(axis_quantity(axis).displayed(value), 12)) for value in _rising(axis)]


def two_steps_per_pitch(gear: SteeringGear, fidelity: Fidelity) -> float:
    """Step that the check before a run allows [deg]."""
    return 360 / gear.pinion.teeth / STEPS_PER_PITCH


PITCH_LIMIT: dict[str, Predict] = {"two steps per tooth pitch": two_steps_per_pitch}


def explicit_map(
    title: str,
    driven: str,
    path: str,
    x: Sequence[float],
    steps: Sequence[float],
    choices: Choices = MappingProxyType({}),
) -> StabilityMap:
    """Steps [us] over one parameter in its display unit.

    Of a driven gear the mean torque or force of 400 steps against equilibria; a held one must calm down, all
    of its friction sticking.
    """
    unit = 1 / axis_quantity(_axis(path)).displayed(1.0)
    gears = [DrivenGear.of(driven, path, value * unit, choices) for value in x]
    cell = _held_cell if driven == "nothing" else _driven_cell
    cells = [[str(cell(gear, 1e-6 * h)) for gear in gears] for h in steps]
    limits = 1e6 * np.array([(gear.predicted, *simple_limits(gear.motion)) for gear in gears])
    names = "linearised gear", "2.83 / omega_max", "2.79 / c_max"
    lines = [Line(name, list(column)) for name, column in zip(names, limits.T, strict=True)]
    return StabilityMap(title, _label(_axis(path)), "step [µs]", list(x), list(steps), cells, [], lines)


def _held_cell(gear: DrivenGear, step: float) -> Cell:
    return Cell.RIGHT if gear.calms(step) else Cell.WRONG


def _driven_cell(gear: DrivenGear, step: float) -> Cell:
    motion = gear.motion
    with np.errstate(all="ignore"):
        times, places, rates = runge_kutta(motion, motion.rate, step, STEPS, 4)
        if not np.isfinite(rates).all():
            return Cell.FAILED
        value = float(np.mean(motion.recorded(times, places, rates).drive))
    still = gear_forces(gear.gear, gear.fidelity).statics
    path = equilibrium_path(still, GearPair.of(gear.gear), motion.drive, times)
    true = float(np.mean(-motion.drive.sign * path.forces[:, motion.drive.coordinate]))
    error = abs(error_of(value, true))
    if not error <= WRONG:
        return Cell.WRONG
    return Cell.INACCURATE if error > INACCURATE else Cell.RIGHT


def chain_map(segments: Sequence[float], steps: Sequence[float]) -> StabilityMap:
    """Steps [us] of velocity Verlet; it calls every explosion a success."""
    kinds = {True: str(Cell.RIGHT), False: str(Cell.WRONG)}
    cells = [[kinds[chain_is_bounded(int(n), 1e-6 * h)] for n in segments] for h in steps]
    lines = [Line("2 / omega_max", [2e6 / chain_frequency(int(n)) for n in segments])]
    names = "Verlet, the chain alone", "bush.segments", "step [µs]"
    return StabilityMap(*names, list(segments), list(steps), cells, [], lines)


COMPILED_DEPTH = 2  # radii at which the compiled spheres pass, where Exudyn's pass at one


def depth_limit(gear: SteeringGear, fidelity: Fidelity) -> float:
    """Preload at which the deepest sphere is as deep as its radius [N]."""
    deepest = sphere_radius(GearPair.of(gear)) / DEEPEST
    return float(brentq(lambda p: deepest - mean_depth(gear.replace({"yoke.preload": p})), 0.0, 1e6))


def compiled_depth_limit(gear: SteeringGear, fidelity: Fidelity) -> float:
    """Preload at which it is two radii deep [N]."""
    return COMPILED_DEPTH**1.5 * depth_limit(gear, fidelity)


DEPTHS: dict[str, Predict] = {
    "deepest sphere at its radius": depth_limit,
    "at two radii": compiled_depth_limit,
}


def round_off(gear: SteeringGear, fidelity: Fidelity) -> float:
    """Round-off of the segments' places times the chain's largest stiffness, over the preload."""
    stiffest = max(connection.stiffness[0] for connection in bush_chain(gear).connections)
    return float(stiffest * np.finfo(float).eps * gear.bush.distance / gear.yoke.preload)


SAME_SPHERES = (STILL, STILL | SLOW)
US = [5.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 80.0]
STIFFNESSES = [1e12, 5e12, 2e13, 1e14, 5e14]
SPEEDS = [0.5, 3.0, 15.0, 60.0, 300.0]
ZONES = [0.001, 0.01, 0.1, 0.5, 1.0]
STUCK_US = [0.03, 0.1, 0.5, 2.0, 5.0, 20.0, 40.0, 60.0]
DENSITIES = [785.0, 2500.0, 7850.0, 78500.0, 785000.0]


MAPS: dict[str, Callable[[], list[StabilityMap]]] = {
    "step_stiffness": lambda: [
        *maps_of("step_stiffness", PITCH_LIMIT),
        explicit_map("Runge-Kutta, rack driven at 15 rpm", "rack", "mesh.stiffness", STIFFNESSES, US),
    ],
    "step_speed": lambda: [
        *maps_of("step_speed", PITCH_LIMIT),
        explicit_map("Runge-Kutta, pinion driven", "pinion", "test.speed", SPEEDS, US),
    ],
    "step_zone": lambda: [
        *maps_of("step_zone", PITCH_LIMIT),
        explicit_map("Runge-Kutta, pinion driven at 15 rpm", "pinion", "fidelity.zone_ratio", ZONES, US),
        explicit_map("Runge-Kutta, pinion held: stick", "nothing", "fidelity.zone_ratio", ZONES, STUCK_US),
    ],
    "step_inertia": lambda: [
        *maps_of("step_inertia", PITCH_LIMIT),
        explicit_map("Runge-Kutta, rack driven at 15 rpm", "rack", "pinion.density", DENSITIES, US),
    ],
    "step_segments": lambda: [
        *maps_of("step_segments", PITCH_LIMIT),
        chain_map([1, 2, 5, 10, 25], [0.5, 0.8, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0]),
    ],
    "step_stiffness_spheres": lambda: [
        *maps_of("step_stiffness_spheres", PITCH_LIMIT, SAME_SPHERES),
        explicit_map("Runge-Kutta, same spheres", "rack", "mesh.stiffness", STIFFNESSES[1:], US, SPHERES),
    ],
    "tolerance_segments": lambda: maps_of("tolerance_segments", {"round-off of the springs": round_off}),
    "preload_stiffness": lambda: [
        *maps_of("preload_stiffness", DEPTHS), *maps_of("preload_stiffness_exudyn", DEPTHS)
    ],
}  # fmt: skip


def toy_map() -> list[StabilityMap]:
    """Two values of each axis, and one explicit cell."""
    driven = maps_of("step_inertia", PITCH_LIMIT, (STILL,), Study.toy)
    return [*driven, explicit_map("toy", "rack", "mesh.stiffness", [2e13], [40.0])]


def run(folder: Path, maps: Mapping[str, Callable[[], list[StabilityMap]]] = MappingProxyType(MAPS)) -> None:
    """Compute these maps, each with its file and its picture."""
    for preset in ("quasi-static", "flank", "full"):  # compiles kernels, for which no cell has time
        simulate("free-pinion-torque", by_law(SteeringGear(), "area"), preset)
    for name, make in maps.items():
        start = process_time()
        found = [asdict(each) for each in make()]
        seconds = round(process_time() - start, 1)
        save_data(folder / f"{name}.json", {"name": name, "cpu_s": seconds, "maps": found})
        draw_maps(found, folder / f"{name}.png")
        print(name, f"{seconds:g} s", flush=True)


def cells_table(folder: Path) -> str:
    """Cells of every map of an offered solver, and how many wrong ones pass the checks; maps that are all
    right in one row."""
    rows, all_right, pictures = [], [], []
    for file in sorted(folder.glob("*_*.json")):
        content = load_data(file)
        for each in content.get("maps", ()):
            if not each["flagged"]:
                continue
            cells = [cell for row in each["cells"] for cell in row]
            flags = [flag for row in each["flagged"] for flag in row]
            unseen = sum(c == Cell.WRONG and not flag for c, flag in zip(cells, flags, strict=True))
            counts = [cells.count(kind) for kind in list(Cell)[:4]]
            picture = f"[{content['name']}]({content['name']}.png)"
            if counts[0] == len(cells):
                all_right.append(counts[0])
                pictures.append(picture)
            else:
                rows.append((picture, each["title"].partition(",")[0], *counts, unseen))
    if all_right:
        shown = " ".join(dict.fromkeys(each for each in pictures if each not in [row[0] for row in rows]))
        rows.append((f"{len(all_right)} others: {shown}", "both", sum(all_right), 0, 0, 0, 0))
    return markdown(("map", "method", *list(Cell)[:4], "wrong and not flagged"), rows)


TOPIC = Topic("15 min", "stability", run, {"maps": {"toy_map": toy_map}}, {"stability_maps": cells_table})
