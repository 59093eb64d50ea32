"""Checks of a plan before it is run: limits of its method, and the memory that its record needs.

    for breach in breaches(gear, fidelity, motion="steady"):
        breach.sentence          which quantity, its value, the limit, why
        breach.repair            the choice that meets the limit

Each limit is a formula of `predicted` quantities; docs/stability.md shows them in the measured maps. What can
only be seen in what came out is checked in after_run.
"""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.pitch_errors import rack_errors
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.closed_form import closed_form
from rps_exudyn.tooth_contact.mean_depth import mean_depth
from rps_exudyn.tooth_contact.spheres import sphere_radius

Motion = Literal["steady", "to and fro", "stopping", "at rest"]
"""Whether everything slides at a constant speed, goes to and fro in whole cycles, stops, or does not move."""

STEPS_PER_PITCH = 2  # fewer cannot show the tooth frequency; after_run sees whether more are needed
REPAIRED_STEPS_PER_PITCH = 20
DEEPEST = 1.5  # deepest contact over the mean one, measured on the paper's gear
LEAST_STATIONS = {"area": 2, "line": 2, "teeth": 3}  # 3.5 % of the hysteresis by two teeth that bend
LEAST_ROWS = 8  # of spheres along the face width
NARROW_ZONE = 0.1  # which takes 0.8 % of the work of any friction law
LOST_IN_ZONE = 0.013  # of the friction's work in a swing, predicted; runs lose about as much
SPACING = 2.5  # of spheres along the profile, over the width of the strip that touches: 1 % of the torque


@dataclass(frozen=True)
class Breach:
    """One limit that a plan does not meet."""

    quantity: str  # path of the choice
    value: float
    limit: float
    why: str
    repair: dict[str, Any]  # choices of the fidelity that meet it; {} if none does
    show: str = "{:.3g}"

    @property
    def sentence(self) -> str:
        """Sentence without a full stop: quantity, value, reason, limit."""
        value, limit = (self.show.format(number) for number in (self.value, self.limit))
        side = "at most" if self.value > self.limit else "at least"
        return f"{self.quantity} is {value}; {self.why} asks for {side} {limit}"


def breaches(gear: SteeringGear, fidelity: Fidelity, *, motion: Motion) -> Iterator[Breach]:
    """Yield all limits that a plan does not meet.

    A motion to and fro is made again with half its zone of friction, which shows what the zone takes. At rest
    friction has crept away, whatever its zone, and a chain of segments yields as the condensed bush.
    """
    if fidelity.solver == "closed-form":
        return
    if motion == "steady":
        yield from _tooth_pitch_resolved(gear, fidelity)
    elif motion == "stopping":
        yield from _zone_narrow(gear, fidelity)
    elif motion == "at rest":
        fidelity = fidelity.with_condensed_chain()
    yield from _straight_where_rigid(gear, fidelity)
    yield from _contact_integrated(gear, fidelity)
    yield from _spheres_deep_enough(gear, fidelity)


def refused(gear: SteeringGear, fidelity: Fidelity, *, motion: Motion) -> list[str]:
    """Return the sentences about them."""
    return [breach.sentence for breach in breaches(gear, fidelity, motion=motion)]


def _tooth_pitch_resolved(gear: SteeringGear, fidelity: Fidelity) -> Iterator[Breach]:
    pitch = 2 * np.pi / gear.pinion.teeth
    if fidelity.step_angle > pitch / STEPS_PER_PITCH * (1 + 1e-9):
        yield Breach(
            "fidelity.step_angle",
            np.degrees(fidelity.step_angle),
            np.degrees(pitch / STEPS_PER_PITCH),
            f"a tooth pitch of {np.degrees(pitch):.4g} deg, which needs {STEPS_PER_PITCH} steps,",
            {"step_angle": float(pitch / REPAIRED_STEPS_PER_PITCH)},
            "{:.4g} deg",
        )


def _zone_narrow(gear: SteeringGear, fidelity: Fidelity) -> Iterator[Breach]:
    """Full friction over most of a motion that stops and turns."""
    if fidelity.zone_ratio > NARROW_ZONE and work_in_zone(gear, fidelity.zone_ratio) > LOST_IN_ZONE:
        from scipy.optimize import brentq  # loads in a third of a second

        widest = float(
            brentq(lambda ratio: work_in_zone(gear, ratio) - LOST_IN_ZONE, 0.0, fidelity.zone_ratio)
        )
        why = "a motion that stops, where friction is too small within the zone,"
        repair = {"zone_ratio": 0.99 * widest}
        yield Breach("fidelity.zone_ratio", fidelity.zone_ratio, widest, why, repair)


def work_in_zone(gear: SteeringGear, ratio: float) -> float:
    """Return the share of the friction's work in a sinusoidal swing that a zone takes away.

    Friction is mu N v / zone below it. Of a part whose zone is r times its largest speed of sliding v,
    integrals of v^2 / r instead of v lose 1 - sqrt(1 - r^2) / 2 - arcsin(r) / (2 r), about r^2 / 6. Bristles
    have no zone; Stribeck's friction is larger there than in motion.
    """
    pair, losses = GearPair.of(gear), closed_form(gear).forward
    slowest, along = pair.least_sliding, np.array([pair.gain])
    parts = {  # zone of a ratio of 1, sliding speeds over the pinion's, loss
        "mesh": (slowest, pair.friction_levers, losses.mesh_loss),
        "yoke": (slowest, along, losses.plunger_loss),
        "bush": (slowest, along, losses.bush_loss),
        "bearing": (1.0, np.ones(1), losses.bearing_loss),
    }
    lost = 0.0
    for part, (zone, speeds, loss) in parts.items():
        law = getattr(gear, part)
        if ratio > 0 and not law.facts.has_state:
            r = np.clip(ratio * zone / speeds, 1e-9, 1.0)
            share = 1 - np.sqrt(1 - r**2) / 2 - np.arcsin(r) / (2 * r)
            lost += loss * np.average(share, weights=speeds) * (1 + law.surplus)
    return float(lost / losses.losses) if losses.losses > 0 else 0.0


def _straight_where_rigid(gear: SteeringGear, fidelity: Fidelity) -> Iterator[Breach]:
    """No bow where a part holds for straight bars only."""
    chain, contact = fidelity.bush == "chain", fidelity.mesh == "general-contact"
    if gear.rack.bow and (chain or contact):
        part = "fidelity.mesh = general-contact" if contact else f"fidelity.bush = {fidelity.bush}"
        repair = ({"bush": "condensed"} if chain else {}) | ({"mesh": "flank"} if contact else {})
        why = f"{part}, which holds for straight bars only,"
        yield Breach("rack.bow", 1e6 * gear.rack.bow, 0.0, why, repair, "{:.4g} um")
    if gear.rack.pitch_errors and contact:
        why = "fidelity.mesh = general-contact, whose racks have teeth without errors,"
        size = 1e6 * float(np.abs(rack_errors(gear)).max())
        yield Breach("the largest of rack.pitch_errors", size, 0.0, why, {"mesh": "flank"}, "{:.4g} um")


def _contact_integrated(gear: SteeringGear, fidelity: Fidelity) -> Iterator[Breach]:
    """Enough lines or spheres that the teeth's contact is an integral and not a few points."""
    limits: dict[str, int] = {}
    if fidelity.mesh == "flank":
        limits = {"strip_points": 2, "strip_stations": LEAST_STATIONS[gear.mesh.contact_law]}
    elif fidelity.mesh == "general-contact":
        limits = {"profile_samples": least_profile_samples(gear), "axial_samples": LEAST_ROWS}
    for choice, limit in limits.items():
        value = getattr(fidelity, choice)
        if value < limit:
            why = "the integral over the contact"
            yield Breach(f"fidelity.{choice}", value, limit, why, {choice: limit}, "{:.0f}")


def _curvature_radius(pair: GearPair) -> float:
    return float(pair.reference_radius * np.sin(pair.alpha_t) / np.cos(pair.beta_p) ** 2)


def least_profile_samples(gear: SteeringGear) -> int:
    """Return the spheres along the path of contact such that `SPACING` strips of contact lie between two of
    them."""
    pair = GearPair.of(gear)
    strip = 2 * np.sqrt(2 * _curvature_radius(pair) * max(mean_depth(gear), 1e-9))
    path = abs(pair.active_path[1] - pair.active_path[0])
    return max(LEAST_ROWS, int(np.ceil(path / (SPACING * strip))))


def _spheres_deep_enough(gear: SteeringGear, fidelity: Fidelity) -> Iterator[Breach]:
    """A sphere deeper than its radius passes through the triangles unnoticed."""
    if fidelity.mesh != "general-contact":
        return
    depth = DEEPEST * mean_depth(gear)
    radius = sphere_radius(GearPair.of(gear))
    if depth > radius:
        yield Breach(
            "the deepest contact predicted from yoke.preload and the teeth's stiffness",
            1e6 * depth,
            1e6 * radius,
            "general contact, through whose flanks a sphere passes that is deeper than its radius,",
            {"mesh": "flank"},
            "{:.0f} um",
        )


# --- Plans whose record no memory holds, refused before they start

BYTES_PER_STEP = 1500  # of a run: states, forces, signals, and the file made of them; measured 1200
BYTES_PER_SPHERE = 200  # of a sphere on the flanks: coordinates, and its row in the contact's search
SMALL = 16e6  # [bytes]: less than the package itself takes, once it runs
SHARE = 0.7  # of the free memory that a run may take


def check_memory(steps: int, spheres: int = 0) -> None:
    """Check that the record of so many steps, and so many spheres on the flanks, fit into the free memory.

    Raises:
        InputError: they do not.
    """
    needed = BYTES_PER_STEP * steps + BYTES_PER_SPHERE * spheres
    if needed < SMALL:
        return
    free = free_memory()
    if needed > SHARE * free:
        size = f"{steps:.3g} steps" + (f" and {spheres:.3g} spheres" if spheres else "")
        cure = "a larger fidelity.step_angle or a shorter test" + (" or fewer spheres" if spheres else "")
        raise InputError(
            f"the test has {size}, which take about {needed / 1e9:.3g} GB of memory; {free / 1e9:.3g} GB are "
            f"free: choose {cure}."
        )


def free_memory() -> float:
    """Return the memory that a process may still take [bytes]; infinite where the system reports none."""
    return min(_of_machine(), _of_group(), _of_process())


def _of_machine() -> float:
    try:
        lines = dict(line.split(":") for line in Path("/proc/meminfo").read_text().splitlines())
        return 1024.0 * int(lines["MemAvailable"].split()[0])
    except (OSError, ValueError, KeyError):
        pass
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, OSError, ValueError):
        return float("inf")


def _of_group() -> float:
    """What a container allows."""
    group = Path("/sys/fs/cgroup")
    try:
        return float(int((group / "memory.max").read_text()) - int((group / "memory.current").read_text()))
    except (OSError, ValueError):  # no such group, or "max"
        return float("inf")


def _of_process() -> float:
    try:
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        return (
            float(limit - pages * resource.getpagesize()) if limit != resource.RLIM_INFINITY else float("inf")
        )
    except (ImportError, OSError, ValueError):
        return float("inf")


# --- The pinion on the rack's teeth


def check_travel(gear: SteeringGear, angles: Sequence[float], test: str) -> None:
    """Check that the pinion stays on the rack's teeth at these angles [rad]; `test` names what leads there.

    Raises:
        InputError: it would not.
    """
    allowed = largest_angle(gear)
    farthest = max(abs(angle) for angle in angles)
    if farthest > allowed:
        raise InputError(
            f"{test} leads to a pinion angle of {degrees_shown(farthest)}; the teeth for "
            f"rack.travel = {gear.rack.travel * 1e3:g} mm allow {degrees_shown(allowed)} either way "
            f"({allowed / (2 * np.pi):.4g} turns from the centre)."
        )


def largest_angle(gear: SteeringGear) -> float:
    """Return how far the pinion may turn either way from the rack's middle [rad]."""
    bar = RackBar.of(gear)
    return float(bar.largest_displacement / bar.pair.gain)


def degrees_shown(angle: float) -> str:
    """Return an angle [rad] in degrees as text."""
    return f"{np.degrees(angle):.6g} deg"
