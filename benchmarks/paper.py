"""What the paper states, beside what the default gear gives: agreement and contradiction are computed.

The paper's figures have no numbers to read off, its text has some. Each statement is one function that
computes what it says about, and whether that holds; a statement that can be read in two ways is two.
"""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache, wraps
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

from benchmarks.efficiency_map import scaled
from benchmarks.measure import run_ok
from benchmarks.topic import Columns, Topic, rows_table, save_data
from rps_exudyn.analysis.efficiency import LoadTest
from rps_exudyn.forces.bush import bush_chain
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.closed_form import GRAVITY, load_test
from rps_exudyn.tooth_contact.mean_depth import mean_depth

GEAR = SteeringGear()
PAIR = GearPair.of(GEAR)
DATA = "paper.json"
TRAVEL, TURNS = 0.140, 4.0  # lock to lock [m], revolutions
TIP_DIAMETERS = 0.018, 0.020  # [m]
MAJOR = "major diameter 18 to 20 mm, read as the"
LARGEST_TORQUE = 1.5  # of the gear alone [N m]
RATIO, LOAD = 0.9, 10.0  # reverse over forward efficiency; weight [kg]
RUNOUT = "40 um"
CUT = np.deg2rad(3.6)  # angle between cuts of the generation [rad]
VISIBLE = 0.1  # share of the ripple from which an order shows in a curve
NEAR = 0.02  # by which numbers that the paper rounds may differ

Computed = Callable[[], tuple[str, bool]]
"""Returns what was found, and whether the paper's statement agrees with it."""


@dataclass(frozen=True)
class Finding:
    """One statement of the paper and what became of it."""

    figure: str  # of the paper, or its section
    states: str
    found: str
    agrees: bool


STATEMENTS: list[Callable[[], Finding]] = []
"""All of them, in the order of the paper."""


def paper(figure: str, states: str) -> Callable[[Computed], Callable[[], Finding]]:
    """Take a function for what it computes of a statement."""

    def taken(compute: Computed) -> Callable[[], Finding]:
        @wraps(compute)
        def finding() -> Finding:
            found, agrees = compute()
            return Finding(figure, states, found, bool(agrees))

        STATEMENTS.append(finding)
        return finding

    return taken


@cache
def summary_of(scene: str, runout: str = "0 um") -> dict[str, float]:
    """Numbers of a scene in equilibrium, with a runout of the pinion."""
    return dict(run_ok(scene, GEAR.replace({"pinion.runout": runout}), "quasi-static").summary)


# --- geometry ----------------------------------------------------------------------------------------
@paper("2.1", f"140 mm of travel in about {TURNS:g} turns, {1e3 * TRAVEL / TURNS:g} mm per turn")
def travel() -> tuple[str, bool]:
    """Travel over turns."""
    gain = 2 * np.pi * PAIR.gain
    return f"{1e3 * gain:.2f} mm per turn", abs(gain / (TRAVEL / TURNS) - 1) < NEAR


@paper("2.1", f"{MAJOR} tip diameter")
def diameter_as_tip_diameter() -> tuple[str, bool]:
    """Major diameter of the pinion as that of its tips."""
    tip = 2 * PAIR.tip_radius
    low, high = TIP_DIAMETERS
    return f"tips at {1e3 * tip:.1f} mm with the travel as stated", low <= tip <= high


@paper("2.1", f"{MAJOR} pitch diameter")
def diameter_as_pitch_diameter() -> tuple[str, bool]:
    """Major diameter of the pinion, if it were that of the pitch circle."""
    low, high = (np.pi * d * np.cos(PAIR.beta_p) / np.cos(PAIR.beta_r) for d in TIP_DIAMETERS)
    return f"{1e3 * low:.0f} to {1e3 * high:.0f} mm of travel per turn", low <= TRAVEL / TURNS <= high


@paper("3", "crossed helical gears: contact in a point")
def point_contact() -> tuple[str, bool]:
    """Point or line contact: how far one generator of the helicoid leaves the rack's plane."""
    flank = Flank(PAIR, 0, 1)
    Z = np.linspace(-PAIR.face_width / 2, PAIR.face_width / 2, 101)
    middle = flank.generator(np.array(PAIR.reference_radius * np.sin(PAIR.alpha_t)), np.array(0.0))
    points = flank.point(np.broadcast_to(middle, Z.shape), Z)
    gap = float(np.ptp(points @ flank.normal(middle)))
    length = float(np.linalg.norm(points[-1] - points[0]))
    found = f"a line: over {1e3 * length:.1f} mm the flank leaves the plane by {1e6 * gap:.1g} um"
    return found, gap > 0.01 * mean_depth(GEAR)


@paper("3", f"pinion cut in steps of {np.rad2deg(CUT):g} degrees, taken as its flank")
def facets() -> tuple[str, bool]:
    """Facets of the generation against the depth of the contact."""
    roll = max(PAIR.active_path[1] + PAIR.reference_radius * np.sin(PAIR.alpha_t), 0)
    height = roll * (CUT * np.cos(PAIR.beta_b)) ** 2 / 8 / np.cos(PAIR.beta_b)
    depth = mean_depth(GEAR)
    found = f"material of up to {1e6 * height:.1f} um is left, contact is {1e6 * depth:.1f} um deep"
    return found, height < VISIBLE * depth


@paper("4", f"{GEAR.bush.segments} segments of the bush, the far one locked, bend as the bush does")
def bush_segments() -> tuple[str, bool]:
    """Segments of the bush, the first locked and springs between centres, against the exact beam."""
    chain = bush_chain(GEAR)
    link = replace(chain, connections=chain.connections[1:])  # without the one to the housing
    exact, adams = (each.compliance_at(GEAR.bush.length)[1, 1] for each in (chain, link))
    off = adams / exact - 1
    return f"its end gives way by {100 * off:+.1f} % more than the beam's", abs(off) < NEAR


# --- Figure 16: free pinion torque --------------------------------------------------------------------
@paper("Figure 16", f"torque of the gear alone up to {LARGEST_TORQUE:g} N m")
def level() -> tuple[str, bool]:
    """Level of the free torque."""
    mean = summary_of("free-pinion-torque")["torque_mean"]
    return f"{mean:.3f} N m", 0 < mean <= LARGEST_TORQUE


# --- Figure 17: load test -----------------------------------------------------------------------------
def loaded(mass: float, scale: float = 1.0) -> LoadTest:
    """Return the load test by formulas, the free torque scaled by preload, bush and bearings together."""
    return load_test(scaled(scale), mass)


@paper("Figure 17", f"{LOAD:g} kg give a reverse efficiency of about {RATIO:g} of the forward one")
def ratio_at_load() -> tuple[str, bool]:
    """Ratio of efficiencies with the paper's weight."""
    found = summary_of("load-test")
    ratio, raising, holding = (
        found[name] for name in ("efficiency_ratio", "torque_forward", "torque_reverse")
    )
    return f"{ratio:+.2f}: {raising:.3f} N m raise, {holding:+.3f} hold", abs(ratio - RATIO) < NEAR


@paper("Figure 17", f"a ratio of {RATIO:g} asks for {LOAD:g} kg")
def weight_for_ratio() -> tuple[str, bool]:
    """Weight at which the default gear has the paper's ratio."""
    mass = brentq(lambda m: loaded(m).efficiency_ratio - RATIO, LOAD, 200.0, xtol=1e-3)
    return f"{mass:.1f} kg with the default gear", abs(mass / LOAD - 1) < NEAR


@paper(
    "Figures 16, 17", f"that ratio with {LOAD:g} kg, and torques up to {LARGEST_TORQUE:g} N m, of one gear"
)
def torque_for_ratio() -> tuple[str, bool]:
    """Free torque at which the paper's weight has the paper's ratio."""
    scale = brentq(lambda s: loaded(LOAD, s).efficiency_ratio - RATIO, 0.01, 1.0, xtol=1e-6)
    torque = loaded(LOAD, scale).free_torque
    large = brentq(lambda s: loaded(LOAD, s).free_torque - LARGEST_TORQUE, 0.5, 5.0, xtol=1e-6)
    locking = float(brentq(lambda m: loaded(m, large).torque_reverse, 1.0, 200.0, xtol=1e-3))
    found = (
        f"the ratio needs a free torque of {torque:.2f} N m at most; with {LARGEST_TORQUE:g} N m the gear "
        f"locks itself below {locking:.0f} kg"
    )
    return found, torque >= LARGEST_TORQUE


@paper("6.1, equation (1)", "forward is lowering of the weight (2.1: raising)")
def forward_is_lowering() -> tuple[str, bool]:
    """Forward as lowering, as one section has it, in the equation for the forward efficiency."""
    test, ideal = summary_of("load-test"), LOAD * GRAVITY * PAIR.gain
    raising, lowering = ideal / test["torque_forward"], ideal / test["torque_reverse"]
    found = f"lowering, the equation gives {100 * lowering:+.0f} %; raising, {100 * raising:.0f} %"
    return found, 0 < lowering <= 1


# --- Figure 18: runout --------------------------------------------------------------------------------
@paper("Figure 18", f"{RUNOUT} of runout, read as the eccentricity, shows once per turn")
def runout_seen() -> tuple[str, bool]:
    """Order of a runout beside that of the teeth."""
    return _orders(RUNOUT)


@paper(
    "Figure 18",
    f"{RUNOUT} of runout, read as the indicator's reading, twice the eccentricity, shows once per turn",
)
def runout_as_reading() -> tuple[str, bool]:
    """The same, read as the total indicator reading, twice the eccentricity."""
    return _orders("20 um")


def _orders(eccentricity: str) -> tuple[str, bool]:
    found = summary_of("free-pinion-torque", eccentricity)
    first, teeth = found["torque_first_order"], found["torque_tooth_order"]
    text = f"{1e3 * first:.1f} N mm once per turn, {1e3 * teeth:.1f} at the teeth's order"
    return text, first > VISIBLE * teeth


@paper("Figure 18", "runout adds to the variation, not to the level")
def runout_keeps_mean() -> tuple[str, bool]:
    """Mean torque with and without runout."""
    plain, eccentric = (summary_of("free-pinion-torque", e)["torque_mean"] for e in ("0 um", RUNOUT))
    off = eccentric / plain - 1
    return f"the mean moves by {100 * off:+.2f} %", abs(off) < NEAR


def run(folder: Path, statements: Sequence[Callable[[], Finding]] = STATEMENTS) -> None:
    """Compute what each statement says about."""
    save_data(folder / DATA, {"findings": [asdict(statement()) for statement in statements]})


FINDINGS: Columns = {
    "paper": "{figure}",
    "states": "{states}",
    "this gear": "{found}",
    "": lambda row: "holds" if row["agrees"] else "**does not hold**",
}
TOPIC = Topic(
    "10 s", "scenes", run, {"statements": STATEMENTS[:4]}, {"paper": rows_table(DATA, "findings", FINDINGS)}
)
