"""Remarks on a run that is all right: which limits of the gear it met, with the numbers."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from rps_exudyn.analysis.curve import UNRESOLVED, unresolved
from rps_exudyn.analysis.passes import Signals, first_angle, passes, spread
from rps_exudyn.gears.tooth_stiffness import BEARABLE_PRESSURE
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import RUBBING_PARTS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Remark
from rps_exudyn.results.quantities import EXTREMES, FIRST_ORDERS, SPREADS
from rps_exudyn.scenes.scene_run import SceneRun

LIMITS = frozenset({Code.FLANK_LIFTED, Code.YOKE_STOPPED})
"""Codes of a contact that opens or closes, beyond which numbers follow another law."""

GROWN = 0.7  # power of e by which a vibration may grow over a way unseen
DIED = 1.0  # power of e by which what began before a way, or with it, should die over it ...
UNRESOLVED_UNDAMPED = 0.015  # ... or else steps may miss no more of the mean than that
UNSETTLED = 0.05  # of the force's variation, which may depend on where the motion began
LEFT_OUT = "peak to peak values and ranges are omitted"
ORDERS_TOO = "peak to peak values, ranges and orders are omitted"
EXTREMES_TOO = "peak to peak values, ranges, largest and smallest values are omitted"
STATIONS_FOR_MOTIONS = 4  # on a line; two leave motions up to 28 % off ...
STATIONS_OF_TEETH = 8  # ... and of teeth that bend six up to 11 %, four up to 30 %
JUMP = 0.05  # of the mean between equilibria whose steps were halved as often as makes sense


def met_limit(codes: Iterable[str]) -> bool:
    """Return whether the remarks on a run are about a contact that opened or closed."""
    return not LIMITS.isdisjoint(codes)


def remarks(gear: SteeringGear, signals: Signals) -> Iterator[Remark]:
    """Yield remarks on a record."""
    if signals:
        yield from _flank_lifted(signals)
        yield from _yoke_stopped(gear, signals)
        yield from _teeth_overloaded(signals)


def _teeth_overloaded(signals: Signals) -> Iterator[Remark]:
    pressure = signals.get("mesh_pressure", np.zeros(1))
    if (over := pressure > BEARABLE_PRESSURE).any():
        yield Remark(
            Code.TEETH_OVERLOADED,
            f"the contact pressure is up to {1e-6 * pressure.max():.4g} MPa (limit of case-hardened steel "
            f"{1e-6 * BEARABLE_PRESSURE:.4g} MPa, ISO 6336-5), first exceeded at "
            f"{first_angle(signals, over)}; the model stays elastic",
        )


def _flank_lifted(signals: Signals) -> Iterator[Remark]:
    for side, loaded in (("drive", "coast"), ("coast", "drive")):
        force = signals.get(f"mesh_normal_force_{side}", np.ones(1))
        free = force <= 0
        if free.any():
            yield Remark(
                Code.FLANK_LIFTED,
                f"the {side} flanks carry no load in {free.mean():.0%} of the record, first at "
                f"{first_angle(signals, free)}; all load is on the {loaded} flanks",
            )


def _yoke_stopped(gear: SteeringGear, signals: Signals) -> Iterator[Remark]:
    force = signals.get("yokenut_force", np.zeros(1))
    if (force > 0).any():
        yield Remark(
            Code.YOKE_STOPPED,
            f"yoke.clearance = {1e6 * gear.yoke.clearance:.4g} um is closed, first at "
            f"{first_angle(signals, force > 0)}; the yokenut carries up to {force.max():.4g} N; "
            "the error of the contact law is unknown there",
        )


def unresolved_peaks(
    fidelity: Fidelity, run: SceneRun, signal: str, place: str
) -> tuple[Remark, frozenset[str]] | None:
    """Return a remark on a run whose steps or whose start do not show how far its signal varies over a
    place, and the metrics that it lacks for that."""
    if fidelity.solver == "closed-form" or signal not in run.signals:
        return None
    if fidelity.mesh == "general-contact":  # +23 % of the default gear's ripple, factors of other ranges
        text = (
            f"{LEFT_OUT}: spheres on a grid show means, but these 20 % and more off "
            "(fidelity.mesh = flank shows them)"
        )
        return Remark(Code.PEAKS_UNRESOLVED, text), SPREADS
    ways = [each.signals for each in passes(run.signals)]
    depends = run.outcome.findings.get("start_unsettled", 0.0)
    varies = max((spread(way[signal]) for way in ways), default=0.0) / np.abs(run.signals[signal]).max()
    if depends > UNSETTLED * varies:
        text = (
            f"up to {depends:.2%} of the force over the first tooth pitch depends on where the motion began, "
            f"beside a ripple of {varies:.2%}, so that {ORDERS_TOO}"
        )
        return Remark(Code.PEAKS_UNRESOLVED, text), SPREADS | FIRST_ORDERS
    size = max((abs(float(np.mean(way[signal]))) for way in ways), default=0.0)
    share = max((unresolved(way[place], way[signal], size) for way in ways), default=0.0)
    seen = f"{signal} deviates from the curve through its neighbours by up to {share:.1%} of its mean: "
    if fidelity.solver == "equilibrium":
        why = f"{seen}the gear snaps through; equilibria cannot follow that" if share > JUMP else ""
        repair = ""
    else:
        why = _unresolved_vibration(run.outcome.findings, share, seen)
        repair = "; lower fidelity.step_angle, or choose the fidelity quasi-static, which has no vibration"
    if not why:
        return None
    return Remark(Code.PEAKS_UNRESOLVED, f"{why}, so that {EXTREMES_TOO}{repair}"), SPREADS | EXTREMES


def _unresolved_vibration(found: dict[str, Any], share: float, seen: str) -> str:
    """Return what a dynamic run does not show, "" where it shows everything."""
    if (grown := found.get("vibration_grows", 0.0)) > GROWN:
        times = np.exp(min(grown, 20.0))
        return (
            f"friction excites a vibration that grows {times:.3g} times over a pass and that the steps damp"
        )
    undamped = found.get("vibration_dies", np.inf) < DIED
    if share > (UNRESOLVED_UNDAMPED if undamped else UNRESOLVED):
        return f"{seen}vibration that the steps do not resolve"
    return ""


def part_of_pitch(gear: SteeringGear, fidelity: Fidelity, signals: Signals) -> Remark | None:
    """Return a remark on spheres whose record shows less than a tooth pitch, over which they share the load
    otherwise than lines of contact: the teeth's part of the losses and the yoke's largest force differ by
    7 %."""
    angle = signals.get("pinion_angle")
    whole = angle is None or np.ptp(angle) > (1 - 1e-6) * 2 * np.pi / gear.pinion.teeth
    if fidelity.mesh != "general-contact" or whole:
        return None
    return Remark(
        Code.METRIC_NOT_CONFIRMED,
        "loss shares, largest and smallest values are omitted: spheres show them over whole tooth pitches, "
        "and the record shows less than a pitch",
    )


def stations_for_motions(gear: SteeringGear) -> int:
    """Return how many stations a line of contact needs to show the motions of the rack beside its travel."""
    return STATIONS_OF_TEETH if gear.mesh.contact_law == "teeth" else STATIONS_FOR_MOTIONS


def few_stations(gear: SteeringGear, fidelity: Fidelity) -> Remark | None:
    """Return a remark on lines of contact with few stations, which miss up to a third of the motions that the
    rack makes beside its travel, while forces are right to a percent."""
    has, least = fidelity.strip_stations, stations_for_motions(gear)
    if fidelity.mesh != "flank" or has >= least:
        return None
    lines = "teeth that bend ask" if gear.mesh.contact_law == "teeth" else "a line of contact asks"
    return Remark(
        Code.FEW_STATIONS,
        "the rack's motions beside its travel, the transmission error, the tooth order and the difference of "
        f"directions are omitted: fidelity.strip_stations is {has}, and {lines} for {least} to show them",
    )


def wide_zone(gear: SteeringGear, fidelity: Fidelity, numbers: str, widest: float) -> Remark | None:
    """Return a remark on numbers that depend on the friction zone, in which what should rest creeps, where
    its ratio is above the widest with which they are right; bristles have none."""
    if fidelity.solver == "closed-form" or fidelity.zone_ratio <= widest:
        return None
    if all(getattr(gear, part).facts.has_state for part in RUBBING_PARTS):
        return None
    return Remark(
        Code.FRICTION_ZONE,
        f"{numbers} on the friction zone, in which a part at rest creeps: fidelity.zone_ratio is "
        f"{fidelity.zone_ratio:.3g} (limit {widest:g})",
    )
