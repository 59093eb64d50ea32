"""What the paper states, beside what the default gear gives: agreement and contradiction are computed.

The paper's figures have no numbers to read off, its text has some. Each statement is one function that
computes what it says about, and whether that holds; a statement that can be read in two ways is two.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

import rps_exudyn as rps
from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.analysis.efficiency import LoadTest
from rps_exudyn.forces.bush import bush_chain
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import Result
from rps_exudyn.solvers.closed_form import load_test
from rps_exudyn.tooth_contact.mean_depth import mean_depth

GEAR = SteeringGear()
PAIR = GearPair.of(GEAR)
DATA = "paper.json"
TRAVEL, TURNS = 0.140, 4.0  # lock to lock [m], revolutions
TIP_DIAMETERS = 0.018, 0.020  # [m]
LARGEST_TORQUE = 1.5  # of the gear alone [N m]
RATIO, LOAD = 0.9, 10.0  # reverse over forward efficiency; weight [kg]
RUNOUT = "40 um"
CUT = np.deg2rad(3.6)  # angle between cuts of the generation [rad]
VISIBLE = 0.1  # share of the ripple from which an order shows in a curve
NEAR = 0.02  # by which numbers that the paper rounds may differ


@dataclass(frozen=True)
class Finding:
    """One statement of the paper and what became of it."""

    figure: str  # of the paper, or its section
    states: str
    found: str
    agrees: bool


def free_torque(settings: Mapping[str, object] | None = None) -> Result:
    """Return one turn without load, in equilibrium."""
    return _done("free-pinion-torque", tuple((settings or {}).items()))


@cache
def _done(scene: str, settings: tuple[tuple[str, object], ...]) -> Result:
    result = rps.run(scene, GEAR.replace(dict(settings)), fidelity="quasi-static")
    if result.status != "ok":
        raise SystemExit(f"{scene}, {settings}: {result.status}, {result.message}")
    return result


# --- geometry ----------------------------------------------------------------------------------------
def travel() -> Finding:
    """Travel over turns."""
    gain, wanted = 2 * np.pi * PAIR.gain, TRAVEL / TURNS
    return Finding(
        "2.1",
        f"{1e3 * TRAVEL:g} mm of travel in about {TURNS:g} turns, {1e3 * wanted:g} mm per turn",
        f"{1e3 * gain:.2f} mm per turn",
        abs(gain / wanted - 1) < NEAR,
    )


def diameter_as_pitch_diameter() -> Finding:
    """Major diameter of the pinion, if it were that of the pitch circle."""
    low, high = (np.pi * d * np.cos(PAIR.beta_p) / np.cos(PAIR.beta_r) for d in TIP_DIAMETERS)
    return Finding(
        "2.1",
        _diameters("pitch"),
        f"{1e3 * low:.0f} to {1e3 * high:.0f} mm of travel per turn",
        low <= TRAVEL / TURNS <= high,
    )


def diameter_as_tip_diameter() -> Finding:
    """Major diameter of the pinion as that of its tips."""
    tip = 2 * PAIR.tip_radius
    return Finding(
        "2.1",
        _diameters("tip"),
        f"tips at {1e3 * tip:.1f} mm with the travel as stated",
        TIP_DIAMETERS[0] <= tip <= TIP_DIAMETERS[1],
    )


def _diameters(kind: str) -> str:
    low, high = (1e3 * d for d in TIP_DIAMETERS)
    return f"major diameter {low:g} to {high:g} mm, read as the {kind} diameter"


def point_contact() -> Finding:
    """Point or line contact: how far one generator of the helicoid leaves the rack's plane."""
    flank = Flank(PAIR, 0, 1)
    Z = np.linspace(-PAIR.face_width / 2, PAIR.face_width / 2, 101)
    middle = flank.generator(np.array(PAIR.reference_radius * np.sin(PAIR.alpha_t)), np.array(0.0))
    points = flank.point(np.broadcast_to(middle, Z.shape), Z)
    gap = float(np.ptp(points @ flank.normal(middle)))
    length = float(np.linalg.norm(points[-1] - points[0]))
    return Finding(
        "3",
        "crossed helical gears: contact in a point",
        f"a line: over {1e3 * length:.1f} mm the flank leaves the plane by {1e6 * gap:.1g} um",
        gap > 0.01 * mean_depth(GEAR),
    )


def facets() -> Finding:
    """Facets of the generation against the depth of the contact."""
    roll = max(PAIR.active_path[1] + PAIR.reference_radius * np.sin(PAIR.alpha_t), 0)
    height = roll * (CUT * np.cos(PAIR.beta_b)) ** 2 / 8 / np.cos(PAIR.beta_b)
    depth = mean_depth(GEAR)
    return Finding(
        "3",
        f"pinion cut in steps of {np.rad2deg(CUT):g} degrees, taken as its flank",
        f"material of up to {1e6 * height:.1f} um is left, contact is {1e6 * depth:.1f} um deep",
        height < VISIBLE * depth,
    )


def bush_segments() -> Finding:
    """Segments of the bush, the first locked and springs between centres, against the exact beam."""
    chain = bush_chain(GEAR)
    link = replace(chain, connections=chain.connections[1:])  # without the one to the housing
    exact, adams = (each.compliance_at(GEAR.bush.length)[1, 1] for each in (chain, link))
    return Finding(
        "4",
        f"{GEAR.bush.segments} segments of the bush, the far one locked, bend as the bush does",
        f"its end gives way by {100 * (adams / exact - 1):+.1f} % more than the beam's",
        abs(adams / exact - 1) < NEAR,
    )


# --- Figure 16: free pinion torque --------------------------------------------------------------------
def level() -> Finding:
    """Level of the free torque."""
    mean = free_torque().summary["torque_mean"]
    return Finding(
        "Figure 16",
        f"torque of the gear alone up to {LARGEST_TORQUE:g} N m",
        f"{mean:.3f} N m",
        0 < mean <= LARGEST_TORQUE,
    )


# --- Figure 17: load test -----------------------------------------------------------------------------
def loaded(mass: float, scale: float = 1.0) -> LoadTest:
    """Return the load test by formulas, the free torque scaled by preload, bush and bearings together."""
    parts = ("yoke.preload", "bush.drag", "bearing.friction_torque")
    values = (GEAR.yoke.preload, GEAR.bush.drag, GEAR.bearing.friction_torque)
    gear = GEAR.replace({part: scale * value for part, value in zip(parts, values, strict=True)})
    return load_test(gear, mass)


def ratio_at_load() -> Finding:
    """Ratio of efficiencies with the paper's weight."""
    summary = _done("load-test", ()).summary
    ratio = summary["efficiency_ratio"]
    return Finding(
        "Figure 17",
        f"{LOAD:g} kg give a reverse efficiency of about {RATIO:g} of the forward one",
        f"{ratio:+.2f}: {summary['torque_forward']:.3f} N m raise, {summary['torque_reverse']:+.3f} hold",
        abs(ratio - RATIO) < NEAR,
    )


def torque_for_ratio() -> Finding:
    """Free torque at which the paper's weight has the paper's ratio."""
    scale = brentq(lambda s: loaded(LOAD, s).efficiency_ratio - RATIO, 0.01, 1.0, xtol=1e-6)
    torque = loaded(LOAD, scale).free_torque
    return Finding(
        "Figures 16, 17",
        f"that ratio with {LOAD:g} kg, and torques up to {LARGEST_TORQUE:g} N m, of one gear",
        f"the ratio needs a free torque of {torque:.2f} N m at most; with {LARGEST_TORQUE:g} N m the gear "
        f"locks itself below {_locking_mass():.0f} kg",
        torque >= LARGEST_TORQUE,
    )


def _locking_mass() -> float:
    scale = brentq(lambda s: loaded(LOAD, s).free_torque - LARGEST_TORQUE, 0.5, 5.0, xtol=1e-6)
    return float(brentq(lambda m: loaded(m, scale).torque_reverse, 1.0, 200.0, xtol=1e-3))


def weight_for_ratio() -> Finding:
    """Weight at which the default gear has the paper's ratio."""
    mass = brentq(lambda m: loaded(m).efficiency_ratio - RATIO, LOAD, 200.0, xtol=1e-3)
    return Finding(
        "Figure 17",
        f"a ratio of {RATIO:g} asks for {LOAD:g} kg",
        f"{mass:.1f} kg with the default gear",
        abs(mass / LOAD - 1) < NEAR,
    )


def forward_is_lowering() -> Finding:
    """Forward as lowering, as one section has it, in the equation for the forward efficiency."""
    test = _done("load-test", ()).summary
    ideal = LOAD * 9.80665 * PAIR.gain
    raising, lowering = ideal / test["torque_forward"], ideal / test["torque_reverse"]
    return Finding(
        "6.1, equation (1)",
        "forward is lowering of the weight (2.1: raising)",
        f"lowering, the equation gives {100 * lowering:+.0f} %; raising, {100 * raising:.0f} %",
        0 < lowering <= 1,
    )


# --- Figure 18: runout --------------------------------------------------------------------------------
def runout_seen() -> Finding:
    """Order of a runout beside that of the teeth."""
    return _runout(RUNOUT, "as the eccentricity")


def runout_as_reading() -> Finding:
    """The same, read as the total indicator reading, twice the eccentricity."""
    return _runout("20 um", "as the indicator's reading, twice the eccentricity")


def _runout(eccentricity: str, reading: str) -> Finding:
    summary = free_torque({"pinion.runout": eccentricity}).summary
    first, teeth = summary["torque_first_order"], summary["torque_tooth_order"]
    return Finding(
        "Figure 18",
        f"{RUNOUT} of runout, read {reading}, shows once per turn",
        f"{1e3 * first:.1f} N mm once per turn, {1e3 * teeth:.1f} at the teeth's order",
        first > VISIBLE * teeth,
    )


def runout_keeps_mean() -> Finding:
    """Mean torque with and without runout."""
    plain, eccentric = (
        free_torque(settings).summary["torque_mean"] for settings in ({}, {"pinion.runout": RUNOUT})
    )
    off = eccentric / plain - 1
    return Finding(
        "Figure 18",
        "runout adds to the variation, not to the level",
        f"the mean moves by {100 * off:+.2f} %",
        abs(off) < NEAR,
    )


STATEMENTS: tuple[Callable[[], Finding], ...] = (
    travel,
    diameter_as_tip_diameter,
    diameter_as_pitch_diameter,
    point_contact,
    facets,
    bush_segments,
    level,
    ratio_at_load,
    weight_for_ratio,
    torque_for_ratio,
    forward_is_lowering,
    runout_seen,
    runout_as_reading,
    runout_keeps_mean,
)


def run(folder: Path, statements: Sequence[Callable[[], Finding]] = STATEMENTS) -> None:
    """Compute what each statement says about."""
    found = [asdict(statement()) for statement in statements]
    save_data(folder / DATA, {"findings": [row | {"agrees": bool(row["agrees"])} for row in found]})


def findings_table(folder: Path) -> str:
    """Statements, what was found, and whether they agree."""
    rows = [
        (row["figure"], row["states"], row["found"], "holds" if row["agrees"] else "**does not hold**")
        for row in load_data(folder / DATA)["findings"]
    ]
    return markdown(("paper", "states", "this gear", ""), rows)


TOPIC = Topic(
    "what the paper states beside what the default gear gives, contradictions computed",
    "10 s",
    "scenes",
    run,
    {"statements": STATEMENTS[:4]},
    {"paper": findings_table},
)
