"""The largest step of explicit methods along single lines, bisected to 5 %, beside the predicted one.

A small disturbance must not grow. Predicted from the system linearised where it stands, that of the gear by
differences of its forces. In Exudyn's own solvers a ball on a plate and the bush's chain; on the gear itself
classical Runge-Kutta (`verification.runge_kutta`): explicit solvers of Exudyn hold a driven gear still.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.stability.chart import draw_limits
from benchmarks.topic import Topic, load_data, markdown, save_data, shown
from rps_exudyn.forces.bush import bush_chain, resting_segments
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.solids import bush_segment_solid
from rps_exudyn.multibody.bodies import add_chain
from verification.stability import bisected
from verification.stable_step import GEAR, DrivenGear, explicit_euler, runge_kutta_4, stable_step

DATA = "explicit.json"
RPM = np.pi / 30


Limit = dict[str, Any]


def limit_of(line: str, at: str, holds: Callable[[float], bool], predicted: float) -> Limit:
    """Bisect a limit of the step, beside the predicted one [s], from powers of four: where it looks first is
    not the prediction's choice."""
    low, high = np.log([predicted / 1.5, predicted * 1.5]) / np.log(4)
    measured = bisected(holds, 4.0 ** np.floor(low), 4.0 ** np.ceil(high))
    return {"line": line, "at": at, "measured": measured, "predicted": predicted}


# --- Exudyn's explicit solvers ----------------------------------------------------------------------
def ball_pressed() -> Iterator[Limit]:
    """A ball of 10 g on a plate in GeneralContact, by velocity Verlet: 2 / omega."""
    for stiffness in (1e5, 1e6, 1e7, 1e8):
        holds, predicted = partial(_ball_is_bounded, stiffness), 2 / np.sqrt(stiffness / BALL)
        yield limit_of("Verlet, ball on a plate", f"{stiffness:g} N/m", holds, predicted)


STICK_ZONE = 1e-3  # [m/s]
STICK_LIMITS = {"ExplicitEuler": explicit_euler, "VelocityVerlet": explicit_euler, "RK44": runge_kutta_4}


def ball_held_by_friction() -> Iterator[Limit]:
    """The same ball within the friction zone, where Coulomb's law is a damper: h mu N / (m v_zone)."""
    stiffness, friction = 1e5, 0.5
    rate = friction * 0.4e-3 * stiffness / (BALL * STICK_ZONE)
    for solver, growth in STICK_LIMITS.items():

        def sticks(h: float, solver: str = solver) -> bool:
            mbs = _ball(stiffness, friction, 0.01 * STICK_ZONE)
            _march(mbs, h, 400, solver)
            return bool(abs(mbs.systemData.GetODE2Coordinates_t()[0]) < 0.01 * STICK_ZONE)

        yield limit_of("stick of a ball", solver, sticks, stable_step(np.array([[-rate]]), growth))


def chain_alone() -> Iterator[Limit]:
    """The bush's chain alone, by velocity Verlet: 2 / omega_max."""
    for segments in (1, 2, 5, 10, 25):
        holds, predicted = partial(chain_is_bounded, segments), 2 / chain_frequency(segments)
        yield limit_of("Verlet, bush as a chain", f"{segments} segments", holds, predicted)


BALL = 0.01  # [kg]


def _ball(stiffness: float, friction: float = 0.0, slip: float = 0.0) -> Any:
    """Pressed 0.4 mm deep; it slides along x with `slip` [m/s]."""
    from exudyn import itemInterface as items

    mbs = _system()
    plate = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=mbs.AddObject(items.ObjectGround())))
    contact = mbs.AddGeneralContact()
    contact.verboseMode, contact.sphereSphereContact = 0, False
    contact.frictionProportionalZone = STICK_ZONE
    contact.SetFrictionPairings(friction * np.eye(1))
    contact.SetSearchTreeBox(pMin=[-1, -1, -1], pMax=[3, 3, 1])
    contact.SetSearchTreeCellSize(numberOfCells=[4, 4, 4])
    corners = np.array([[-1.0, -1, 0], [3, -1, 0], [-1, 3, 0]])
    contact.AddTrianglesRigidBodyBased(plate, 1e6 * stiffness, 0.0, 0, corners.tolist(), [[0, 1, 2]])
    rates = [slip, 0, 1e-9]
    node = mbs.AddNode(items.NodePoint(referenceCoordinates=[0.1, 0.1, 0.6e-3], initialVelocities=rates))
    body = mbs.AddObject(items.ObjectMassPoint(mass=BALL, nodeNumber=node))
    on_body = mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=body))
    contact.AddSphereWithMarker(on_body, 1e-3, stiffness, 0.0, 0)
    marker = mbs.AddMarker(items.MarkerNodePosition(nodeNumber=node))
    held = [0, 0, -0.4e-3 * stiffness]
    mbs.AddLoad(items.Force(markerNumber=marker, loadVector=held))
    mbs.Assemble()
    return mbs


def _system() -> Any:
    import exudyn as exu

    exu.config.printToConsole, exu.config.suppressWarnings = False, True
    return exu.SystemContainer().AddSystem()


def _chain(segments: int) -> Any:
    gear = GEAR.replace({"bush.segments": segments})
    mbs, parts = _system(), bush_chain(gear)
    rest = resting_segments(gear, parts, np.array([1e-3, 1e-3, 1e-3, 1e-5, 1e-5, 1e-5]), parts.end_station)
    solid = bush_segment_solid(gear).mass_properties
    height = GearPair.of(gear).bar_axis_height
    add_chain(mbs, gear, parts, rest, mass=solid.mass, inertia=solid.inertia, axis_height=height)
    mbs.Assemble()
    return mbs


def chain_frequency(segments: int) -> float:
    """Return omega_max of the chain as Exudyn linearises it [rad/s]."""
    from scipy.linalg import eigh

    mass, stiffness, _ = _chain(segments).ComputeLinearizedSystem()
    return float(np.sqrt(eigh((stiffness + stiffness.T) / 2, (mass + mass.T) / 2, eigvals_only=True)[-1]))


def chain_is_bounded(segments: int, step: float) -> bool:
    """Return whether a chain that was bent a little stays so for 2000 steps of velocity Verlet."""
    return _bounded(_chain(segments), step, 2000, "VelocityVerlet")


def _ball_is_bounded(stiffness: float, step: float) -> bool:
    return _bounded(_ball(stiffness), step, 400, "VelocityVerlet")


def _bounded(mbs: Any, step: float, steps: int, solver: str) -> bool:
    """Return whether a small disturbance stays small."""
    import exudyn as exu

    try:
        _march(mbs, step, steps, solver)
    except exu.ExudynError:  # a mass matrix of nan
        return False
    state = mbs.systemData.GetODE2Coordinates()
    return bool(np.isfinite(state).all() and np.abs(state).max() < 1e-4)


def _march(mbs: Any, step: float, steps: int, solver: str) -> None:
    import exudyn as exu

    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    time = settings.timeIntegration
    time.endTime, time.numberOfSteps = step * steps, steps
    time.adaptiveStep = time.automaticStepSize = False
    mbs.SolveDynamic(settings, solverType=getattr(exu.DynamicSolverType, solver))


@dataclass(frozen=True)
class Gears:
    """One parameter of a driven gear at several values."""

    varied: str
    driven: str  # "pinion", "rack", whose pinion is free, or "nothing": the pinion is held
    path: str  # of the gear's parameter or, after "fidelity.", of a choice
    values: tuple[float, ...]
    show: str = "{:g}"
    unit: float = 1.0
    choices: Mapping[str, Any] = field(default_factory=dict)  # of the fidelity besides


OF_SLIDING = "{:g} of the sliding speed"
SPHERES = {"mesh": "general-contact", "profile_samples": 20, "axial_samples": 14}
SOFT = (5e12, 2e13, 1e14)
LINES = (
    Gears("contact stiffness", "rack", "mesh.stiffness", (1e12, 5e12, 2e13, 1e14, 5e14), "{:g} N/m³"),
    Gears("spheres, contact stiffness", "rack", "mesh.stiffness", SOFT, "{:g} N/m³", choices=SPHERES),
    Gears("seat stiffness", "pinion", "yoke.seat_stiffness", (2e7, 2e8, 2e9), "{:g} N/m"),
    Gears("plunger mass", "pinion", "yoke.plunger_mass", (0.006, 0.06, 0.6), "{:g} g", 1e-3),
    Gears("pinion density", "rack", "pinion.density", (785.0, 2500.0, 7850.0, 78500.0), "{:g} kg/m³"),
    Gears("mesh damping", "rack", "mesh.damping", (1e-6, 1e-5, 1e-4, 1e-3), "{:g} µs", 1e-6),
    Gears("speed", "pinion", "test.speed", tuple(n * RPM for n in (0.5, 3, 15, 60, 300)), "{:g} rpm", RPM),
    Gears("friction zone", "pinion", "fidelity.zone_ratio", (0.01, 0.1, 1.0), OF_SLIDING),
    Gears("friction zone", "nothing", "fidelity.zone_ratio", (0.01, 0.03, 0.1, 0.3, 1.0), OF_SLIDING),
)
DRIVES = {"rack": "rack driven", "pinion": "pinion driven", "nothing": "pinion held"}


def on_the_gear(lines: Sequence[Gears] = LINES) -> Iterator[Limit]:
    """Limits of every line by RK4."""
    for line in lines:
        for value in line.values:
            driven = DrivenGear.of(line.driven, line.path, value, line.choices)
            at = line.show.format(round(value / line.unit, 9))
            yield limit_of(f"{DRIVES[line.driven]}, {line.varied}", at, driven.calms, driven.predicted)


PARTS = (ball_pressed, ball_held_by_friction, chain_alone, on_the_gear)


def run(folder: Path, parts: Sequence[Callable[[], Iterator[Limit]]] = PARTS) -> None:
    """Bisect all limits of these parts."""
    limits = shown(limit for part in parts for limit in part())
    save_data(folder / DATA, {"limits": limits})
    draw_limits(limits, folder / "explicit.png")


def limits_table(folder: Path) -> str:
    """Each line: predicted steps, and measured ones compared with them."""
    limits, rows = load_data(folder / DATA)["limits"], []
    for line in dict.fromkeys(limit["line"] for limit in limits):
        own = [limit for limit in limits if limit["line"] == line]
        ratios = [limit["measured"] / limit["predicted"] for limit in own]
        rows.append((line, f"{min(ratios):.2f} to {max(ratios):.2f}"))
    return markdown(("line", "measured / predicted"), rows)


TOPIC = Topic("7 min", "stability", run, {"parts": (ball_pressed,)}, {"explicit_limits": limits_table})
