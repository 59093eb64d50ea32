"""Stability maps: where each method stops being right, and what theory predicts. results/stability/.

    python studies/stability_maps.py            all maps, about ten minutes
    python studies/stability_maps.py chain      one of them

Cells are runs without guards and without judge, against the same trip in small steps. The limits of explicit
integration (`ball`, `chain`) are bisected to 5 % and stand beside 2 / omega_max of the linearised system.
"""

import json
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rps_exudyn.analysis.stability import Cell, Plan, bisected, cell_of, naked, reference
from rps_exudyn.charts.stability import draw_limits, draw_map
from rps_exudyn.errors import InputError
from rps_exudyn.fidelity import Fidelity
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.solids import bush_segment_solid
from rps_exudyn.guards import DEEPEST, predicted_depth
from rps_exudyn.mesh_contact.general_contact import SPHERE_RADIUS
from rps_exudyn.parameters import SteeringGear
from rps_exudyn.parts.bush import add_chain, bush_chain, resting_segments

OUT = Path(__file__).parents[1] / "results" / "stability"
GEAR = SteeringGear().replace({"test.turns": 1 / 6})


# --- explicit integration against omega_max ---------------------------------------------------------
@dataclass(frozen=True)
class Limit:
    """A bisected limit of the step and the predicted one [s]."""

    name: str
    measured: float
    predicted: float


def ball() -> list[Limit]:
    """A ball of 10 g on a plate in GeneralContact, by velocity Verlet."""
    limits = []
    for stiffness in (1e5, 1e6, 1e7, 1e8):
        limit = bisected(
            lambda h, k=stiffness: _bounded(_ball(k), h, 400),
            *(s / np.sqrt(stiffness / 0.01) for s in (1, 4)),
        )
        limits.append(Limit(f"ball, k = {stiffness:g} N/m", limit, 2 / np.sqrt(stiffness / 0.01)))
    return limits


def chain() -> list[Limit]:
    """The bush's chain alone, by velocity Verlet."""
    limits = []
    for segments in (1, 2, 5, 10, 25):
        predicted = 2 / _largest_frequency(_chain(segments))
        limit = bisected(lambda h, n=segments: _bounded(_chain(n), h, 2000), 0.5 * predicted, 2 * predicted)
        limits.append(Limit(f"chain of {segments}", limit, predicted))
    return limits


def _ball(stiffness: float) -> Any:
    import exudyn as exu
    from exudyn.itemInterface import (
        MarkerBodyPosition,
        MarkerBodyRigid,
        NodePoint,
        ObjectGround,
        ObjectMassPoint,
    )

    exu.config.printToConsole, exu.config.suppressWarnings = False, True
    mbs = exu.SystemContainer().AddSystem()
    plate = mbs.AddMarker(MarkerBodyRigid(bodyNumber=mbs.AddObject(ObjectGround())))
    contact = mbs.AddGeneralContact()
    contact.verboseMode, contact.sphereSphereContact = 0, False
    contact.SetFrictionPairings(np.zeros((1, 1)))
    contact.SetSearchTreeBox(pMin=[-1, -1, -1], pMax=[3, 3, 1])
    contact.SetSearchTreeCellSize(numberOfCells=[4, 4, 4])
    corners = np.array([[-1.0, -1, 0], [3, -1, 0], [-1, 3, 0]])
    contact.AddTrianglesRigidBodyBased(plate, 1e6 * stiffness, 0.0, 0, corners, [[0, 1, 2]])
    node = mbs.AddNode(NodePoint(referenceCoordinates=[0.1, 0.1, 0.6e-3], initialVelocities=[0, 0, 1e-9]))
    body = mbs.AddObject(ObjectMassPoint(mass=0.01, nodeNumber=node))
    contact.AddSphereWithMarker(mbs.AddMarker(MarkerBodyPosition(bodyNumber=body)), 1e-3, stiffness, 0.0, 0)
    from exudyn.itemInterface import Force, MarkerNodePosition

    marker = mbs.AddMarker(MarkerNodePosition(nodeNumber=node))
    mbs.AddLoad(Force(markerNumber=marker, loadVector=[0, 0, -0.4e-3 * stiffness]))  # which holds it there
    mbs.Assemble()
    return mbs


def _chain(segments: int) -> Any:
    import exudyn as exu

    exu.config.printToConsole, exu.config.suppressWarnings = False, True
    gear = GEAR.replace({"bush.segments": segments})
    mbs, parts = exu.SystemContainer().AddSystem(), bush_chain(gear)
    rest = resting_segments(gear, parts, np.array([1e-3, 1e-3, 1e-3, 1e-5, 1e-5, 1e-5]), parts.end_station)
    solid = bush_segment_solid(gear).mass_properties
    height = GearPair.of(gear).bar_axis_height
    add_chain(mbs, gear, parts, rest, mass=solid.mass, inertia=solid.inertia, axis_height=height)
    mbs.Assemble()
    return mbs


def _largest_frequency(mbs: Any) -> float:
    from scipy.linalg import eigh

    mass, stiffness, _ = mbs.ComputeLinearizedSystem()
    return float(np.sqrt(eigh((stiffness + stiffness.T) / 2, (mass + mass.T) / 2, eigvals_only=True)[-1]))


def _bounded(mbs: Any, step: float, steps: int) -> bool:
    """Whether what was disturbed a little stays small."""
    import exudyn as exu

    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    settings.timeIntegration.endTime, settings.timeIntegration.numberOfSteps = step * steps, steps
    try:
        mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.VelocityVerlet)
    except exu.ExudynError:  # a mass matrix of nan
        return False
    state = mbs.systemData.GetODE2Coordinates()
    return bool(np.isfinite(state).all() and np.abs(state).max() < 1e-4)


# --- maps of the gear -------------------------------------------------------------------------------
@dataclass(frozen=True)
class Map:
    """Cells over two axes; `predicted` is a limit of y at each x, or nan."""

    title: str
    x_name: str
    y_name: str
    x: list[float]
    y: list[float]
    cells: list[list[str]]  # [y][x]
    predicted: list[float]
    prediction: str


def mapped(
    title: str,
    x: tuple[str, list[float]],
    y: tuple[str, list[float]],
    plan_at: Callable[[float, float], Plan],
    predicted: Callable[[float], float] = lambda x: float("nan"),
    prediction: str = "",
) -> Map:
    cells = [[str(_cell(plan_at(a, b))) for a in x[1]] for b in y[1]]
    limits = [predicted(a) for a in x[1]]
    return Map(title, x[0], y[0], x[1], y[1], cells, limits, prediction)


def _cell(plan: Plan) -> Cell:
    try:
        result = naked(plan)
    except InputError:
        return Cell.NOT_COMPUTED
    return cell_of(plan, result, reference(plan, plan.figure(result)))


def plan_of(settings: dict[str, Any], choices: dict[str, Any], turns: float = 1 / 6) -> Plan:
    gear = GEAR.replace({"test.turns": turns} | settings)
    return Plan("free-pinion-torque", gear, Fidelity().replace(choices))


STEPS = [0.25, 1.0, 4.0, 12.0, 30.0, 40.0]  # [deg]


def step_stiffness() -> Map:
    return mapped(
        "generalized-alpha, flank: step and contact stiffness",
        ("mesh.stiffness [N/m^3]", [1e12, 5e12, 2e13, 1e14, 5e14]),
        ("step [deg]", STEPS),
        lambda k, h: plan_of({"mesh.stiffness": k}, {"step_angle": np.deg2rad(h)}),
        lambda k: 30.0,
        "two steps per tooth pitch",
    )


def step_speed() -> Map:
    return mapped(
        "generalized-alpha, flank: step and test speed",
        ("test.speed [rpm]", [0.5, 3.0, 15.0, 60.0, 300.0]),
        ("step [deg]", STEPS),
        lambda n, h: plan_of({"test.speed": n * np.pi / 30}, {"step_angle": np.deg2rad(h)}),
        lambda n: 30.0,
        "two steps per tooth pitch",
    )


def step_zone() -> Map:
    return mapped(
        "generalized-alpha, flank: step and friction zone",
        ("zone over the least sliding speed", [0.001, 0.01, 0.1, 0.5, 1.0]),
        ("step [deg]", STEPS),
        lambda z, h: plan_of({}, {"step_angle": np.deg2rad(h), "zone_ratio": z}),
        lambda z: 30.0,
        "two steps per tooth pitch",
    )


def tolerance_segments() -> Map:
    return mapped(
        "generalized-alpha, chain: tolerance and segments, steps of 1 deg",
        ("bush.segments", [1.0, 5.0, 25.0]),
        ("Newton's relative tolerance", [1e-2, 1e-3, 1e-4, 1e-6, 1e-7]),
        lambda n, t: plan_of({"bush.segments": int(n)}, {"bush": "chain", "tolerance": t}, 1 / 60),
        lambda n: 5e-8,
        "round-off of the springs",
    )


def preload_stiffness() -> Map:
    """A sphere passes through where it is deeper than its radius."""

    def preload(stiffness: float) -> float:
        one = predicted_depth(GEAR.replace({"yoke.preload": 1.0, "mesh.stiffness": stiffness}))
        return float((SPHERE_RADIUS / (DEEPEST * one)) ** 1.5)

    spheres = {"mesh": "general-contact", "solver": "equilibrium", "step_angle": np.deg2rad(3)}
    return mapped(
        "spheres of 0.1 mm: preload and contact stiffness",
        ("mesh.stiffness [N/m^3]", [1e11, 3e11, 1e12, 3e12, 2e13]),
        ("yoke.preload [N]", [30.0, 100.0, 300.0, 1000.0, 3000.0]),
        lambda k, p: plan_of({"mesh.stiffness": k, "yoke.preload": p, "yoke.clearance": "1 mm"}, spheres),
        preload,
        "deepest sphere at its radius",
    )


MAPS = {
    map_.__name__: map_
    for map_ in (step_stiffness, step_speed, step_zone, tolerance_segments, preload_stiffness)
}


def main() -> None:
    asked = sys.argv[1:] or ["ball", "chain", *MAPS]
    for name in asked:
        if name in MAPS:
            found = MAPS[name]()
            (OUT / f"{name}.json").write_text(json.dumps(asdict(found), indent=1))
            draw_map(asdict(found), OUT / f"{name}.png")
            print(name, *found.cells, sep="\n  ", flush=True)
        else:
            limits = [asdict(limit) for limit in {"ball": ball, "chain": chain}[name]()]
            (OUT / f"{name}.json").write_text(json.dumps(limits, indent=1))
            for limit in limits:
                print(limit, limit["measured"] / limit["predicted"], flush=True)
    files = [OUT / "ball.json", OUT / "chain.json"]
    if all(file.exists() for file in files):
        draw_limits([limit for file in files for limit in json.loads(file.read_text())], OUT / "explicit.png")


if __name__ == "__main__":
    main()
