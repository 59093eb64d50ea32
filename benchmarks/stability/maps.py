"""Stability maps: where each method stops being right, and what theory predicts. results/stability/.

    python studies/stability_maps.py                  all maps
    python studies/stability_maps.py step_speed       one of them

The plans are those of studies/stability_*.toml, which `rps-exudyn study` runs too; here each is run without
guards and judge, and compared with the same maneuver in small steps. Beside them stand explicit
methods: classical Runge-Kutta on the gear, Exudyn's velocity Verlet on the bush's chain.
"""

import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from time import process_time
from types import MappingProxyType
from typing import Any
from unittest.mock import patch

import numpy as np
from stability_explicit import GEAR, SPHERES, DrivenGear, chain_frequency, chain_is_bounded, simple_limits

from benchmarks.stability.chart import draw_maps
from rps_exudyn.base.errors import InputError
from rps_exudyn.checks import before_run as guards
from rps_exudyn.checks.before_run import DEEPEST, STEPS_PER_PITCH, predicted_depth
from rps_exudyn.forces.bush import bush_chain
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.mesh_contact import spheres as general_contact
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.provenance import provenance
from rps_exudyn.solvers.equilibrium import equilibrium_path
from rps_exudyn.solvers.gear_forces import gear_forces
from rps_exudyn.study.cases import setup_of
from rps_exudyn.study.description import Axis, Case
from rps_exudyn.study.study_file import read_study
from rps_exudyn.study.table import axis_quantity
from rps_exudyn.verification.explicit_limit import STEPS
from rps_exudyn.verification.runge_kutta import runge_kutta
from rps_exudyn.verification.stability import (
    INACCURATE,
    REFERENCES,
    SLOW,
    STILL,
    WRONG,
    Cell,
    Choices,
    Line,
    Plan,
    StabilityMap,
    cell_of,
    error_of,
    processor_time,
    reference,
    run_and_check,
)

STUDIES = Path(__file__).parent
OUT = STUDIES.parent / "results" / "stability"
TIME_LIMIT = 30.0  # CPU time of a cell, and of its reference [s]

Predict = Callable[[SteeringGear, Fidelity], float]


# --- studies ----------------------------------------------------------------------------------------
def maps_of(
    file: str, lines: dict[str, Predict], methods: Sequence[Choices] = REFERENCES
) -> list[StabilityMap]:
    """The maps of a study over two axes; of a third, its first, one map for each value.

    `lines` are predicted values of y, in its display unit, for the cell's gear and fidelity.
    """
    study = read_study(STUDIES / f"stability_{file}.toml")
    *kinds, x, y = study.axes
    maps = []
    for kind in kinds[0].values or () if kinds else [None]:
        fixed = {kinds[0].name: kind} if kinds else {}

        def plan_of(a: Any, b: Any, fixed: dict[str, Any] = fixed) -> Plan:
            setup = setup_of(study, Case("", fixed | {x.name: a, y.name: b}))
            return Plan(study.scene, setup.steering_gear, setup.fidelity)

        cells = [[cell_and_told(plan_of(a, b), methods) for a in _rising(x)] for b in _rising(y)]
        plans = [plan_of(a, _rising(y)[0]) for a in _rising(x)]
        maps.append(
            StabilityMap(
                _title(plans, x),
                *(_label(axis) for axis in (x, y)),
                *(_displayed(axis) for axis in (x, y)),
                [[str(cell) for cell, _ in row] for row in cells],
                [[told for _, told in row] for row in cells],
                [Line(label, [at(p.gear, p.fidelity) for p in plans]) for label, at in lines.items()],
            )
        )
    return maps


def _title(plans: Sequence[Plan], x: Axis) -> str:
    """Solver, contact and, if it is the same everywhere, speed."""
    fidelity, speed = plans[0].fidelity, plans[0].gear.test.speed * 30 / np.pi
    at = "" if "test.speed" in x.paths else f", {speed:.3g} rpm"
    return f"{fidelity.solver}, {fidelity.mesh}{', chain' if fidelity.bush == 'chain' else ''}{at}"


def cell_and_told(plan: Plan, methods: Sequence[Choices]) -> tuple[Cell, bool]:
    """What a plan gives when nobody checks it, and whether guards or judge would object."""
    try:
        with processor_time(TIME_LIMIT):
            result, told = run_and_check(plan)
    except InputError:  # for instance a preload that the teeth do not carry
        return Cell.FAILED, True
    except TimeoutError:
        return Cell.FAILED, False
    try:
        with processor_time(TIME_LIMIT):
            true = reference(plan, plan.figure(result), methods)
    except TimeoutError:
        true = float("nan")
    return cell_of(plan, result, true), told


def _axis(path: str) -> Axis:
    """Of one parameter, in its usual unit."""
    return Axis(path, (path,), "", None, "grid")


def _label(axis: Axis) -> str:
    return axis_quantity(axis).axis_label(axis.paths[0])


def _rising(axis: Axis) -> list[Any]:
    """Its values; a study file may begin with those that are cheap and safe to try."""
    return sorted(axis.values or ())


def _displayed(axis: Axis) -> list[float]:
    return [float(round(axis_quantity(axis).displayed(value), 12)) for value in _rising(axis)]


def two_steps_per_pitch(gear: SteeringGear, fidelity: Fidelity) -> float:
    """What the guard allows [deg]."""
    return 360 / gear.pinion.teeth / STEPS_PER_PITCH


GUARD: dict[str, Predict] = {"two steps per tooth pitch": two_steps_per_pitch}


# --- Runge and Kutta on the gear --------------------------------------------------------------------
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
    judge = _calm_cell if driven == "nothing" else _driven_cell
    cells = [[str(judge(gear, 1e-6 * h)) for gear in gears] for h in steps]
    limits = 1e6 * np.array([(gear.predicted, *simple_limits(gear.motion)) for gear in gears])
    names = "linearised gear", "2.83 / omega_max", "2.79 / c_max"
    lines = [Line(name, list(column)) for name, column in zip(names, limits.T, strict=True)]
    return StabilityMap(title, _label(_axis(path)), "step [µs]", list(x), list(steps), cells, [], lines)


def _calm_cell(gear: DrivenGear, step: float) -> Cell:
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


# --- the bush's chain in Exudyn ---------------------------------------------------------------------
def chain_map(segments: Sequence[float], steps: Sequence[float]) -> StabilityMap:
    """Steps [us] of velocity Verlet; it calls every explosion a success."""
    cells = [
        [str(Cell.RIGHT if chain_is_bounded(int(n), 1e-6 * h) else Cell.WRONG) for n in segments]
        for h in steps
    ]
    limits = [2e6 / chain_frequency(int(n)) for n in segments]
    return StabilityMap(
        "Verlet, the chain alone",
        "bush.segments",
        "step [µs]",
        list(segments),
        list(steps),
        cells,
        [],
        [Line("2 / omega_max", limits)],
    )


# --- spheres ----------------------------------------------------------------------------------------
RADII, PRELOADS = [0.01, 0.02, 0.05, 0.1, 0.2], [100.0, 200.0, 500.0, 1000.0, 2000.0]  # [mm], [N]
PRESSED = {"mesh.stiffness": 1e13, "yoke.clearance": 1e-3}
COMPILED_DEPTH = 2  # radii at which the compiled spheres pass, where Exudyn's pass at one


def depth_limit(gear: SteeringGear, fidelity: Fidelity) -> float:
    """Preload at which the deepest sphere is as deep as its radius [N]."""
    one = predicted_depth(gear.replace({"yoke.preload": 1.0}))
    return float((general_contact.SPHERE_RADIUS / (DEEPEST * one)) ** 1.5)


def compiled_depth_limit(gear: SteeringGear, fidelity: Fidelity) -> float:
    """The same for a depth of two radii [N]."""
    return COMPILED_DEPTH**1.5 * depth_limit(gear, fidelity)


DEPTHS: dict[str, Predict] = {
    "deepest sphere at its radius": depth_limit,
    "at two radii": compiled_depth_limit,
}


def radius_preload(title: str, turns: float, choices: Choices) -> StabilityMap:
    """The spheres' radius, which no parameter of the gear is, over the preload."""
    cells: list[list[tuple[Cell, bool]]] = [[] for _ in PRELOADS]
    limits: dict[str, list[float]] = {label: [] for label in DEPTHS}
    for radius in 1e-3 * np.array(RADII):
        with (
            patch.object(general_contact, "SPHERE_RADIUS", float(radius)),
            patch.object(guards, "SPHERE_RADIUS", float(radius)),
        ):
            for row, preload in zip(cells, PRELOADS, strict=True):
                gear = GEAR.replace(PRESSED | {"yoke.preload": preload, "test.turns": turns})
                fidelity = Fidelity().replace({"mesh": "general-contact"} | dict(choices))
                row.append(cell_and_told(Plan("free-pinion-torque", gear, fidelity), REFERENCES))
            for label, at in DEPTHS.items():
                limits[label].append(at(gear, fidelity))
    return StabilityMap(
        title,
        "radius of the spheres [mm]",
        "yoke.preload [N]",
        RADII,
        PRELOADS,
        [[str(cell) for cell, _ in row] for row in cells],
        [[told for _, told in row] for row in cells],
        [Line(label, values) for label, values in limits.items()],
    )


# --- all --------------------------------------------------------------------------------------------
def round_off(gear: SteeringGear, fidelity: Fidelity) -> float:
    """What the chain's stiffest spring makes of the round-off of the segments' places, over the preload."""
    stiffest = max(connection.stiffness[0] for connection in bush_chain(gear).connections)
    return float(stiffest * np.finfo(float).eps * gear.bush.distance / gear.yoke.preload)


SAME_SPHERES = (STILL, STILL | SLOW)
STILL_SPHERES = {"solver": "equilibrium", "step_angle": np.deg2rad(3)}
MOVING_SPHERES = {"step_angle": np.deg2rad(1)}
US = [5.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 80.0]
STIFFNESSES = [1e12, 5e12, 2e13, 1e14, 5e14]
SPEEDS = [0.5, 3.0, 15.0, 60.0, 300.0]
ZONES = [0.001, 0.01, 0.1, 0.5, 1.0]
STUCK_US = [0.03, 0.1, 0.5, 2.0, 5.0, 20.0, 40.0, 60.0]
DENSITIES = [785.0, 2500.0, 7850.0, 78500.0, 785000.0]


MAPS: dict[str, Callable[[], list[StabilityMap]]] = {
    "step_stiffness": lambda: [
        *maps_of("step_stiffness", GUARD),
        explicit_map("Runge-Kutta, rack driven at 15 rpm", "rack", "mesh.stiffness", STIFFNESSES, US),
    ],
    "step_speed": lambda: [
        *maps_of("step_speed", GUARD),
        explicit_map("Runge-Kutta, pinion driven", "pinion", "test.speed", SPEEDS, US),
    ],
    "step_zone": lambda: [
        *maps_of("step_zone", GUARD),
        explicit_map("Runge-Kutta, pinion driven at 15 rpm", "pinion", "fidelity.zone_ratio", ZONES, US),
        explicit_map("Runge-Kutta, pinion held: stick", "nothing", "fidelity.zone_ratio", ZONES, STUCK_US),
    ],
    "step_inertia": lambda: [
        *maps_of("step_inertia", GUARD),
        explicit_map("Runge-Kutta, rack driven at 15 rpm", "rack", "pinion.density", DENSITIES, US),
    ],
    "step_segments": lambda: [
        *maps_of("step_segments", GUARD),
        chain_map([1, 2, 5, 10, 25], [0.5, 0.8, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0]),
    ],
    "step_stiffness_spheres": lambda: [
        *maps_of("step_stiffness_spheres", GUARD, SAME_SPHERES),
        explicit_map("Runge-Kutta, same spheres", "rack", "mesh.stiffness", STIFFNESSES[1:], US, SPHERES),
    ],
    "tolerance_segments": lambda: maps_of("tolerance_segments", {"round-off of the springs": round_off}),
    "preload_stiffness": lambda: maps_of("preload_stiffness", DEPTHS),
    "radius_preload": lambda: [
        radius_preload("equilibrium, compiled spheres, 1e13 N/m³", 1 / 6, STILL_SPHERES),
        radius_preload("generalized-alpha, Exudyn's spheres, 1e13 N/m³", 1 / 60, MOVING_SPHERES),
    ],
}  # fmt: skip


def main() -> None:
    for name in sys.argv[1:] or MAPS:
        start = process_time()
        maps = [asdict(found) for found in MAPS[name]()]
        seconds = round(process_time() - start, 1)
        content = {"name": name, "cpu_s": seconds, "origin": provenance(), "maps": maps}
        (OUT / f"{name}.json").write_text(json.dumps(content, indent=1))
        draw_maps(maps, OUT / f"{name}.png")
        print(name, f"{seconds:g} s", flush=True)
        for found in maps:
            print(
                " ",
                found["title"],
                *(" ".join(cell[:5] for cell in row) for row in found["cells"]),
                sep="\n    ",
            )


if __name__ == "__main__":
    main()
