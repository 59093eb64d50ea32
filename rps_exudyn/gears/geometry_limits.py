"""Limits of a gear: each with the parameter that should change and its nearest admissible value.

Later limits make sense only if earlier ones hold, so they come in stages: the cutter, the teeth, the
mesh, the parts around it. `report.check_gear` puts the sentences before the user.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from functools import lru_cache, partial

import numpy as np

from rps_exudyn.base import units
from rps_exudyn.base.units import factor
from rps_exudyn.gears.basic_rack import (
    crest_width,
    cutter_tip_centre,
    half_angle,
    straight_depth,
    tip_radius_for_crest,
    undercut_limit,
)
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.generated_rack import GeneratedRack
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.trochoid import form_point
from rps_exudyn.parameters.gear import SteeringGear

mm = partial(units.mm, digits=4)  # computed lengths, of which a reader needs no more

LEAST_CREST = 0.05  # narrowest crest, in modules; below it a tooth counts as pointed
# ISO 53 rounds rho_fP: its flank ends 0.00003 m_n before the rack's tips do
STANDARD_ROUNDING = 1e-4  # in modules
LARGEST_HELIX = np.deg2rad(45)  # that is named where teeth need one [rad]
ROUNDING = 1e-9  # a limit met to a nanometre is met [m]


@dataclass(frozen=True)
class Violation:
    """One limit that a gear does not keep."""

    gear: SteeringGear
    what: str  # "The crest is -0.2 mm wide; it must be at least 0.09 mm"
    path: str  # the parameter that should change
    limit: float | None  # its value at the limit; None if this parameter alone cannot mend it
    sense: int  # in which values beyond the limit are admissible: +1 larger, -1 smaller ones
    forgivable: bool = False  # a gear with it can be built all the same

    @property
    def nearest(self) -> float | None:
        """The limit with four decimals of its display unit, rounded into what is admissible; None if there is
        none that the parameter's own declaration allows."""
        unit = self.gear.declared_at(self.path)[0].unit
        assert unit is not None
        if self.limit is None:
            return None
        scale = factor(unit.display, unit.si) if unit.si else 1.0
        rounding = ROUND_CEILING if self.sense > 0 else ROUND_FLOOR
        shown = float(Decimal(float(self.limit) / scale).quantize(Decimal("1e-4"), rounding))
        try:
            self.gear.replace({self.path: shown * scale})
        except ValueError:
            return None
        return shown * scale

    @property
    def sentence(self) -> str:
        """The message: what is wrong, the parameter's value, and its nearest admissible value."""
        show, nearest = self.gear.declared_at(self.path)[0].show, self.nearest
        mend = f"the nearest admissible value is {show(nearest)}" if nearest is not None else NO_HELP
        return f"{self.what}; {self.path} is {show(self.gear.value_at(self.path))}, {mend}."


NO_HELP = "and changing this parameter does not help"


def violations(gear: SteeringGear, force: bool = False) -> list[Violation]:
    """All limits of the first stage that fails; with `force` forgivable ones do not end the search."""
    found: list[Violation] = []
    bar = RackBar.of(gear)
    for stage in (_cutter, _teeth, _course, _mesh, _parts):
        found += stage(gear, bar)
        if any(not (force and item.forgivable) for item in found):
            break
    return found


# --- the stages ----------------------------------------------------------------------------------
def _cutter(gear: SteeringGear, bar: RackBar) -> Iterator[Violation]:
    pair = bar.pair
    m, alpha, overlap = pair.module, pair.alpha_n, -2 * cutter_tip_centre(pair)[0]
    if overlap > 0:
        # pi/4 - (h - rho) tan(alpha) - rho / cos(alpha) = 0, solved for rho
        rho = (np.pi / 4 - pair.rack_dedendum / m * np.tan(alpha)) / (1 / np.cos(alpha) - np.tan(alpha))
        what = f"The cutter's tip would be pointed: its tip radii overlap by {mm(overlap)}, and may not"
        yield Violation(gear, what, "basic_rack.fillet_radius", rho if rho >= 0 else None, -1)
    if rack_tip_interference(pair) > STANDARD_ROUNDING * m:
        needed = (pair.rack_addendum + pair.fillet_radius * (1 - np.sin(alpha))) / m
        what = (
            f"The cutter does not reach: its straight flank ends {mm(straight_depth(pair))} from the "
            f"reference line, and the rack's tips, {mm(pair.rack_addendum)} from it, cut into the root"
        )
        yield Violation(gear, what, "basic_rack.dedendum", needed, +1)
    if pair.root_radius <= 0.1 * m:
        least = max((pair.rack_dedendum - pair.reference_radius) / m + 0.1, undercut_limit(pair))
        what = f"The root radius is {mm(pair.root_radius)}; it must be at least {mm(0.1 * m)}"
        yield Violation(gear, what, "pinion.profile_shift", least, +1)


def _teeth(gear: SteeringGear, bar: RackBar) -> Iterator[Violation]:
    pair = bar.pair
    least_shift = undercut_limit(pair)
    if pair.profile_shift < least_shift - 1e-9:
        what = (
            f"The teeth are undercut: the profile shift coefficient is {pair.profile_shift:.4g}; it must be "
            f"at least {least_shift:.4g}"
        )
        yield Violation(gear, what, "pinion.profile_shift", least_shift, +1, forgivable=True)
    try:
        form = form_point(pair).radius
    except ValueError:
        what = "Undercut leaves nothing of the involute"
        yield Violation(gear, what, "pinion.profile_shift", least_shift, +1)
        return
    if pair.tip_radius <= form * (1 + 1e-6):
        what = (
            f"The tip diameter is {mm(2 * pair.tip_radius)}; it must be above the form diameter "
            f"{mm(2 * form)}, where the involute begins"
        )
        yield Violation(gear, what, "pinion.tip_diameter", 2 * form * (1 + 2e-6), +1)
        return
    crest, least = crest_width(pair, pair.tip_radius), LEAST_CREST * pair.module
    if crest < least:
        what = f"The teeth are pointed: the crest is {mm(crest)} wide; it must be at least {mm(least)}"
        largest = 2 * tip_radius_for_crest(pair, least) if crest_width(pair, form) > least else None
        yield Violation(gear, what, "pinion.tip_diameter", largest, -1)
    elif 2 * gear.pinion.tip_relief > crest:
        what = f"The tip relief takes more than the crest, which is {mm(crest)} wide"
        yield Violation(gear, what, "pinion.tip_relief", crest / 2, -1)
    crest = np.pi * pair.module / 2 - 2 * pair.rack_addendum * np.tan(pair.alpha_n)
    if crest < least and pair.course is None:
        addendum = (np.pi / 2 - LEAST_CREST) / (2 * np.tan(pair.alpha_n))
        what = (
            f"The rack's teeth are pointed: their crest is {mm(crest)} wide; it must be at least {mm(least)}"
        )
        yield Violation(gear, what, "basic_rack.addendum", addendum, -1)


def _course(gear: SteeringGear, bar: RackBar) -> Iterator[Violation]:
    """Undercut and pointed teeth of a rack of variable ratio, and what its tips need."""
    pair = bar.pair
    if pair.course is None:
        return
    rack, mesh, ratio = GeneratedRack.of(pair), pair.design_mesh, gear.rack.ratio
    steepest = rack.steepest
    if steepest >= 1:
        what = (
            f"The ratio changes too fast: q_a/Q is {steepest:.3g}, and undercuts the rack's teeth from 1 on"
        )
        least = mesh.least_turn(float(pair.gain_at(0.0)), float(pair.gain_at(ratio.to))) * (1 + 1e-6)
        if ratio.angle:
            yield Violation(gear, what, "rack.ratio.travel_per_turn", None, -1)
        else:
            yield Violation(gear, what, "rack.ratio.to", getattr(ratio, "from") + least, +1)
    form, lowest = form_point(pair).radius, rack.tip_height
    if form > lowest + STANDARD_ROUNDING * pair.module:
        what = f"The rack's tips reach {mm(form - lowest)} below the pinion's form circle"
        most = (pair.reference_line_height - form) / pair.module
        yield Violation(gear, what, "basic_rack.addendum", most, -1)
    if steepest < 1 and (land := float(rack.tip_land(np.array(bar.teeth)).min())) < LEAST_CREST * pair.module:
        what = f"The rack's teeth are pointed: a crest is {mm(land)} wide along the rack"
        yield Violation(gear, what, "basic_rack.addendum", None, -1)


def _mesh(gear: SteeringGear, bar: RackBar) -> Iterator[Violation]:
    pair = bar.pair
    yield from _contact(gear, pair)
    at_rack, at_pinion = rack_root_clearance(pair), pinion_root_clearance(pair)
    room, cut = min(at_rack, at_pinion), pinion_tip_interference(pair)
    if at_rack < 0 or cut > ROUNDING:
        what = f"The pinion's tips reach {mm(-at_rack)} into the rack's root"
        if at_rack >= 0:
            what = f"The pinion's tips cut {mm(cut)} into the fillets of the rack's root"
        yield Violation(gear, what, "pinion.tip_diameter", 2 * _largest_tip_radius(pair), -1)
    elif pair.runout > room:
        what = f"The runout is {mm(pair.runout)}; it must be at most the smaller root clearance, {mm(room)}"
        yield Violation(gear, what, "pinion.runout", room, -1)
    rack_tips = pair.reference_line_height - pair.rack_addendum
    if gear.pinion.shaft_diameter / 2 + pair.runout > rack_tips:
        what = f"The rack's tips cut into the pinion's shaft: they come to {mm(rack_tips)} from its axis"
        yield Violation(gear, what, "pinion.shaft_diameter", 2 * (rack_tips - pair.runout), -1)


def _contact(gear: SteeringGear, pair: GearPair) -> Iterator[Violation]:
    q0, qa = path_on_involute(pair)
    transverse = transverse_contact_ratio(pair)
    total = transverse + pair.overlap_ratio
    if qa <= q0:
        radius = float(np.hypot(pair.base_radius, q0 + pair.reference_radius * np.sin(pair.alpha_t)))
        what = "The teeth do not meet: the pinion's tips end below the rack's"
        yield Violation(gear, what, "pinion.tip_diameter", 2 * radius + 1e-6, +1)
    elif total < 1:
        helix, hand = abs(np.sin(pair.beta_p)), -1 if pair.beta_p < 0 else 1
        width = (1 - transverse) * np.pi * pair.module / helix if helix > 0 else np.inf
        what = (
            f"The teeth lose contact between one pair and the next: the total contact ratio is {total:.4g} "
            f"(transverse {transverse:.4g}, overlap {pair.overlap_ratio:.4g}); it must be at least 1"
        )
        if width < 10 * pair.tip_radius:  # else the helix is what the overlap lacks
            yield Violation(gear, what, "pinion.face_width", width, +1)
        else:
            yield Violation(gear, what, "pinion.helix_angle", _least_helix(gear, hand), hand)
    elif gear.pinion.tip_relief > 0 and gear.pinion.tip_relief_length > qa - q0 + ROUNDING:
        what = f"The tip relief reaches beyond the active flank, which is {mm(qa - q0)} of roll long"
        yield Violation(gear, what, "pinion.tip_relief_length", qa - q0, -1)


def _parts(gear: SteeringGear, bar: RackBar) -> Iterator[Violation]:
    yoke, radius = gear.yoke, gear.rack.bar_diameter / 2
    missing = bar.x_min - bar.toothed_ends[0]
    if missing > 0:
        what = f"The rack's teeth need {mm(missing)} more than the bar offers on the side away from the bush"
        yield Violation(gear, what, "rack.length", gear.rack.length + missing, +1)
    seat_half_width, plunger = radius * np.sin(yoke.seat_angle), yoke.plunger_diameter / 2
    corner = float(np.hypot(seat_half_width, yoke.seat_length / 2))
    if corner > plunger:
        room = plunger**2 - seat_half_width**2
        what = f"The seat's corners reach {mm(corner)} from the plunger's axis; its radius is {mm(plunger)}"
        yield Violation(gear, what, "yoke.seat_length", 2 * np.sqrt(room) if room > 0 else None, -1)
    depth = radius * (1 - np.cos(yoke.seat_angle))
    if yoke.plunger_length <= depth:
        what = f"The seat is {mm(depth)} deep; the plunger must be longer than that"
        yield Violation(gear, what, "yoke.plunger_length", depth + 1e-3, +1)


# --- nearest values --------------------------------------------------------------------------------
def _largest_tip_radius(pair: GearPair) -> float:
    """Bisection for the largest tip circle that keeps out of the rack's root and fillets [m]."""
    inside, outside = form_point(pair).radius, pair.tip_radius + min(rack_root_clearance(pair), 0)
    while outside - inside > ROUNDING:
        middle = (inside + outside) / 2
        if pinion_tip_interference(replace(pair, tip_radius=middle)) > 0:
            outside = middle
        else:
            inside = middle
    return inside


def _least_helix(gear: SteeringGear, hand: int) -> float | None:
    """Return the smallest helix angle of a hand with which one pair of teeth takes over from the other [rad];
    None if there is none. The overlap rises with it, the transverse contact ratio falls."""
    from scipy.optimize import brentq, minimize_scalar  # loads in a third of a second

    def lacking(angle: float) -> float:
        pair = GearPair.of(gear.replace({"pinion.helix_angle": hand * float(angle)}))
        return 1 - transverse_contact_ratio(pair) - pair.overlap_ratio

    with suppress(ValueError):  # another parameter does not allow the angle
        most = float(minimize_scalar(lacking, bounds=(0.0, LARGEST_HELIX), method="bounded").x)
        if lacking(most) <= 0:
            return float(hand * brentq(lacking, 0.0, most))
    return None


# --- Clearances of pinion and rack away from the flanks, and where they would cut into each other
#
# All in the pinion's transverse section: the rack's section there is the basic rack, stretched by
# 1 / cos beta_p along X, for any shaft angle. Runout takes away from every clearance.


def largest_lift(gear: SteeringGear) -> float:
    """Return how far the rack may lie from where the pinion's axis puts it, half a tooth's depth in contact
    [m]: beyond, the teeth are out of mesh."""
    return gear.basic_rack.addendum * gear.pinion.normal_module / 2


def pinion_root_clearance(pair: GearPair) -> float:
    """Clearance of the rack's tips from the pinion's root circle [m]."""
    return pair.rack_dedendum - pair.rack_addendum


def rack_root_clearance(pair: GearPair) -> float:
    """Clearance of the pinion's tip circle from the rack's root [m]."""
    if pair.course is not None:
        return GeneratedRack.of(pair).root_height - pair.tip_radius
    return pair.reference_line_height + pair.rack_dedendum - pair.tip_radius


def rack_tip_interference(pair: GearPair) -> float:
    """Reach of the rack's tips beyond the end of the cutter's straight flank, if positive [m].

    A rack tooth inside the cutter's outline only sweeps room that the cutter swept before. Beyond C1 the
    cutter is rounded and the rack is not: its corners then cut into the pinion's root.
    """
    return pair.rack_addendum - straight_depth(pair)


def pinion_tip_interference(pair: GearPair) -> float:
    """Depth to which the pinion's tip corners cut into the rack's root fillets, across the teeth [m].

    Negative: the least room; minus infinity if the corners never come as deep as the fillets, or generate
    these.
    """
    if pair.course is not None:
        return -np.inf
    return _pinion_tip_interference(pair.design)


@lru_cache(maxsize=64)
def _pinion_tip_interference(pair: GearPair) -> float:
    r, ra, half = pair.reference_radius, pair.tip_radius, half_angle(pair, pair.tip_radius)
    from_centre = np.linspace(-0.5, 0.5, 2001) * np.pi  # of the corner, from the line pinion to rack
    turn = from_centre + half  # of its tooth; the rack's space is at X = -r turn
    depth = ra * np.cos(from_centre) - pair.reference_line_height
    across = np.abs(-ra * np.sin(from_centre) + r * turn) * np.cos(pair.beta_p)
    u, y = cutter_tip_centre(pair)
    in_fillet = (depth > straight_depth(pair)) & (depth < pair.rack_dedendum)
    if not in_fillet.any():
        return -np.inf
    half_space = u + np.sqrt(pair.fillet_radius**2 - (depth[in_fillet] + y) ** 2)
    return float((across[in_fillet] - half_space).max())


def path_on_involute(pair: GearPair) -> tuple[float, float]:
    """q0, qa: ends from the pitch point of the active path of contact where the involute exists [m]."""
    q0, qa = pair.active_path
    if pair.course is not None:  # the shortest along the travel
        return GeneratedRack.of(pair).shortest_path
    return max(q0, form_point(pair).tangent_length - pair.reference_radius * float(np.sin(pair.alpha_t))), qa


def transverse_contact_ratio(pair: GearPair) -> float:
    """Transverse contact ratio epsilon_alpha; negative if the teeth do not meet."""
    q0, qa = path_on_involute(pair)
    return (qa - q0) * float(np.cos(pair.beta_b)) / pair.normal_base_pitch
