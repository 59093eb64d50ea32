"""Checks of a finished run: what it must satisfy before it may be called ok.

Wrong runs end with success flags and plausible torques, so every run is compared with what must be true of
it: teeth in mesh, contact within the range in which its law holds, work that adds up.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from rps_exudyn.analysis.curve import every_second, lag
from rps_exudyn.analysis.passes import first_angle
from rps_exudyn.analysis.work_balance import largest_work, missing_work
from rps_exudyn.forces.force_element import ENERGY_TERMS, Part
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_limits import largest_lift
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Outcome, Status
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.scenes.checks.neglected_inertia import turn_slow
from rps_exudyn.solvers.equilibrium import Start
from rps_exudyn.solvers.record import Record, contact_disagreement
from rps_exudyn.tooth_contact.mean_depth import mean_depth, rack_approach

ENERGY_BOUND = 2e-3  # of the drive's or the load's work; 1e-5 is usual ...
# What loaded material takes along or leaves behind where it passes an edge of the rack: 0.04 % on the paper's
# gear, more with much friction, and where an error of the shaft angle lets the teeth bear on an edge.
# By law; a line ends under its full load, which by law "line" leaves more behind.
EDGE_BOUND = {"area": 1.5e-2, "line": 6e-2, "teeth": 6e-2}  # likewise ...
EDGE_FRACTION = 1.5e-2  # ... and that per degree of the shaft angle's error ...
MISSED_TORQUE = 1e-3  # ... or what a torque that small would do: a gear without friction takes no work [N m]
# Up to n samples: fraction of their range that may hide between them
HIDDEN = ((2, np.inf), (4, 1 / 2), (5, 1 / 6), (7, 1 / 16), (12, 1 / 32))
RESOLVED_BOUND = 0.03  # change of the mean when every second step is left out
ROLLING_BOUND = 0.06  # of the travel; over whole periods a settled gear does not roll at all
UNSETTLED_BOUND = 0.01  # of the mean force over the record
LAG_BOUND = 0.015  # of the rack's travel, half a step late; the torque's error is about as large
ROUNDING = 1e-9  # of the works of a gear that nothing moves [J]
LEAST_TOUCHING = 15  # spheres of general contact; fewer miss up to 8 % of the torque
# Spheres end where the rack's tips are under the preload; elsewhere 8 % too many were 2.7 % of the torque
OUT_OF_PLACE = 0.06  # of the path of contact
# Of the force on the seat that the nut carries; means by spheres are up to 2 % off then
AT_NUT = 0.08
AGREEMENT_BOUND = 1e-6  # of Exudyn's contact forces with the compiled samples; 1e-9 is usual


def validated(
    outcome: Outcome,
    gear: SteeringGear,
    record: Record,
    signals: dict[str, np.ndarray],
    friction_zone: float | None,
) -> Outcome:
    """Return the outcome of a run after all checks; the first that fails is its cause.

    Of equilibria that end before the motion does, those which show why: a rack that left its place, teeth
    that carry nothing or more than their law holds for.

    `friction_zone` [m/s], given for a steady motion, is the sliding speed below which friction is not fully
    developed.
    """
    checks: tuple[Failure, ...] = _of_contacts(gear, record, signals)
    if outcome.status is Status.OK:
        checks += _of_a_whole_record(outcome, gear, record, signals, friction_zone)
    return _first_failure(outcome, checks) or outcome


def physical(
    outcome: Outcome,
    gear: SteeringGear,
    record: Record,
    signals: dict[str, np.ndarray],
    friction_zone: float | None,
) -> Outcome:
    """Return the outcome of a run of the ladder after the checks of its physics alone: what discretisation
    misses, and what is left of the start, is in the bars of its metrics. Arguments as of `validated`."""
    checks: tuple[Failure, ...] = _of_contacts(gear, record, signals)
    if outcome.status is Status.OK:
        checks += _of_general_contact(gear, record, signals)
    if failed := _first_failure(outcome, checks):
        return failed
    share = unsettled_share(record.start, signals)
    return replace(outcome, findings={**outcome.findings, "unsettled_mean": share}) if share else outcome


def _first_failure(outcome: Outcome, checks: tuple["Failure", ...]) -> Outcome | None:
    """Return the outcome with the first check that fails as its cause; None if none does."""
    for check in checks:
        for status, code, message in check:
            return replace(outcome, status=status, codes=(code,), message=message)
    return None


def _of_contacts(gear: SteeringGear, record: Record, signals: dict[str, np.ndarray]) -> tuple["Failure", ...]:
    """The checks of what ends a run where the gear left its contacts."""
    return (
        finite(signals),
        rack_in_mesh(signals, gear.installation.axis_offset, largest_lift(gear)),
        *([] if record.pulse_power is not None else [teeth_loaded(signals)]),  # a pulse may part them
        law_valid(record.forces.valid_to, signals),
    )


def _of_general_contact(
    gear: SteeringGear, record: Record, signals: dict[str, np.ndarray]
) -> tuple["Failure", ...]:
    """The checks of Exudyn's contact and of spheres."""
    return (
        contact_agreed(contact_disagreement(record)),
        spheres_enough(record, _on_an_edge(gear, signals)),
        spheres_in_place(record, gear, signals),
        *([] if record.pulse_power is not None else [yoke_off_nut(record, signals)]),
    )


def _of_a_whole_record(
    outcome: Outcome,
    gear: SteeringGear,
    record: Record,
    signals: dict[str, np.ndarray],
    friction_zone: float | None,
) -> tuple["Failure", ...]:
    """The checks of a run that reached its end, besides those of its contacts."""
    equilibria = outcome.settings.get("name") == "equilibrium"
    return (
        *([] if friction_zone is None else [friction_developed(signals, friction_zone, GearPair.of(gear))]),
        *([] if friction_zone is None else [torque_resolved(signals)]),
        *([] if friction_zone is None or record.settled else [settled(signals, gear)]),
        start_settled(record.start, signals, gear),
        *([] if friction_zone is None or not equilibria else [rolling_followed(signals, gear)]),
        *([turn_slow(signals, gear)] if equilibria and friction_zone is not None else []),
        *_of_general_contact(gear, record, signals),
        work_balanced(signals, ENERGY_BOUND),
        edges_spared(signals, edge_bound(gear)),
    )


Failure = Iterator[tuple[Status, Code, str]]
"""Status, code and message of a check that fails."""


def finite(signals: dict[str, np.ndarray]) -> Failure:
    """Check that every value is a finite number."""
    if np.isfinite(np.concatenate(list(signals.values()))).all():
        return
    for name, values in signals.items():
        if not np.isfinite(values).all():
            yield Status.DIVERGED, Code.NOT_FINITE, f"{name} is not finite"


def rack_in_mesh(signals: dict[str, np.ndarray], place: float, allowed: float) -> Failure:
    """Check that the rack's lift [m] from where the pinion's axis puts it stays below half a tooth."""
    lift = np.abs(signals["rack_y"] - place)
    if (lift > allowed).any():
        yield (
            Status.CONTACT_LOST,
            Code.RACK_OUT_OF_MESH,
            f"the rack is {1e6 * lift.max():.4g} um out of its place, first above {1e6 * allowed:.4g} um "
            f"at {first_angle(signals, lift > allowed)}",
        )


def teeth_loaded(signals: dict[str, np.ndarray]) -> Failure:
    """Check that the teeth touch at every instant."""
    free = signals.get("mesh_normal_force", np.ones(1)) <= 0
    if free.any():
        yield (
            Status.CONTACT_LOST,
            Code.TEETH_UNLOADED,
            f"the teeth carry no load, first at {first_angle(signals, free)}",
        )


def law_valid(valid_to: Mapping[str, float], signals: dict[str, np.ndarray]) -> Failure:
    """Check that the contact does not leave the range in which its law holds: signals below their bounds."""
    for name, bound in valid_to.items():
        beyond = signals[name] > bound
        if beyond.any():
            quantity = SIGNALS[name]
            yield (
                Status.INVALID,
                Code.BEYOND_LAW,
                f"{name} is {quantity.show(signals[name].max())}, first above the {quantity.show(bound)} "
                f"to which the contact's law holds at {first_angle(signals, beyond)}",
            )


def friction_developed(signals: dict[str, np.ndarray], zone: float, pair: GearPair) -> Failure:
    """Check that the teeth slide fast enough for Coulomb's law, at the slowest angle and place."""
    slowest = np.abs(np.diff(signals["pinion_angle"]) / np.diff(signals["time"])) * pair.least_sliding
    if slowest.min() < zone * (1 - 1e-3):
        yield (
            Status.INVALID,
            Code.FRICTION_ZONE,
            f"the teeth slide at {1e3 * slowest.min():.3g} mm/s, first below the friction zone of "
            f"{1e3 * zone:.3g} mm/s at {first_angle(signals, slowest < zone)}",
        )


def torque_resolved(signals: dict[str, np.ndarray]) -> Failure:
    """Check that the record's steps are fine enough for its mean."""
    share = missed_mean(signals)
    if not share <= RESOLVED_BOUND:
        steps = len(signals["pinion_angle"]) - 1
        yield (
            Status.INVALID,
            Code.STEPS_TOO_COARSE,
            f"{steps} steps are too few: the mean may be wrong by {share:.1%} (limit "
            f"{RESOLVED_BOUND:.0%}); lower fidelity.step_angle",
        )


def missed_mean(signals: dict[str, np.ndarray]) -> float:
    """Return how much of the drive's mean may hide between the steps: leaving out every second one shows it.

    The error itself is a third of this difference where torque bends gently, and more where it jumps.
    """
    force, path = driven_along(signals)
    work, missed = map(float, every_second(path, force))
    missed = max(missed, float(np.ptp(force) * np.ptp(path)) * hidden_share(len(force)))
    beyond = max(missed - least_work(signals), 0.0)
    return beyond / abs(work) if work else np.inf if beyond else 0.0


def hidden_share(instants: int) -> float:
    """Return what may hide between few instants, over the range of their values: anything as large as their
    differences."""
    return next((share for n, share in HIDDEN if instants <= n), 0.0)


def driven_along(signals: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return the drive's torque [N m] over the pinion's angle [rad], or its force [N] over the rack's place
    [m]."""
    if "pinion_torque" in signals:
        return signals["pinion_torque"], signals["pinion_angle"]
    return signals["rack_force"], signals["rack_displacement"]


def settled(signals: dict[str, np.ndarray], gear: SteeringGear) -> Failure:
    """Check that the rack has rolled into its place: before, the torque is not that of steady sliding."""
    share = rolling_fraction(signals, gear)
    if share > ROLLING_BOUND:
        yield (
            Status.INVALID,
            Code.RACK_NOT_SETTLED,
            f"the rack is not settled: over the record its surface rolls by {share:.1%} of its travel "
            f"(limit {ROLLING_BOUND:.0%}); begin earlier or record longer",
        )


def start_settled(start: Start, signals: dict[str, np.ndarray], gear: SteeringGear) -> Failure:
    """Check that the start does not matter: the gear could settle before the start, on teeth that
    the rack has, or what is left hardly moves the mean over the record."""
    share = unsettled_share(start, signals)
    if share > UNSETTLED_BOUND:
        pitch = 2 * np.pi / gear.pinion.teeth / gear.test.speed
        needed, teeth = start.settles_in / pitch, start.approach_time / pitch
        asks = f"in {needed:.3g} tooth pitches" if np.isfinite(needed) else "within any travel tried"
        ends = f", the rack has teeth for {teeth:.3g} before the start" if np.isfinite(teeth) else ""
        yield (
            Status.INVALID,
            Code.START_MATTERS,
            f"the gear does not settle: {start.unsettled:.1%} of the force at the start depends on where "
            f"the motion began; it would settle {asks}{ends}",
        )


def unsettled_share(start: Start, signals: dict[str, np.ndarray]) -> float:
    """Return the share of the mean force over a record that depends on where the motion began."""
    recorded = float(signals["time"][-1])
    return start.unsettled * min(1.0, start.settles_in / recorded) if start.unsettled else 0.0


def rolling_fraction(signals: dict[str, np.ndarray], gear: SteeringGear) -> float:
    """Return how far the bar's surface rolls over the record, over the rack's travel."""
    rolled = abs(float(signals["rack_roll"][-1] - signals["rack_roll"][0])) * gear.rack.bar_diameter / 2
    return rolled / max(float(np.abs(np.diff(signals["rack_displacement"])).sum()), 1e-12)


def rolling_followed(signals: dict[str, np.ndarray], gear: SteeringGear) -> Failure:
    """Check that the angles are close enough for the rack's rolling."""
    share, matters = rolling_lag(signals, gear)
    if matters > LAG_BOUND:
        yield (
            Status.INVALID,
            Code.ROLLING_TOO_COARSE,
            f"the steps are too long for the rack's rolling: its rate is wrong by {share:.1%} of the "
            f"travel; lower fidelity.step_angle or choose generalized-alpha",
        )


def rolling_lag(signals: dict[str, np.ndarray], gear: SteeringGear) -> tuple[float, float]:
    """Return by how much equilibria miss the rate of the rack's rolling, over its travel, and the share of
    the drive's mean that this may move.

    They take the rate by backward differences, half a step late; a torque that does not vary minds little.
    """
    late = lag(signals["time"], signals["rack_roll"]) * gear.rack.bar_diameter / 2
    share = float(late) / max(float(np.abs(np.diff(signals["rack_displacement"])).sum()), 1e-12)
    force, _ = driven_along(signals)
    return share, share * min(1.0, float(np.ptp(force)) / max(abs(float(force.mean())), 1e-12))


def contact_agreed(disagreement: float) -> Failure:
    """Check that the solver's own contact forces are those of the compiled law."""
    if not disagreement <= AGREEMENT_BOUND:
        yield (
            Status.INVALID,
            Code.CONTACT_DISAGREES,
            f"two evaluations of the contact forces differ by {disagreement:.2g} (limit "
            f"{AGREEMENT_BOUND:.0g})",
        )


def spheres_enough(record: Record, on_an_edge: bool) -> Failure:
    """Check that enough spheres touch: that their sum is an integral over the contact."""
    mesh = _mesh_of(record)
    if record.forces.spheres is None:
        return
    column = mesh.size + ENERGY_TERMS + mesh.outputs.index("mesh_touching")
    touching = float(np.median(record.outputs(mesh)[:, column]))
    least = LEAST_TOUCHING * (2 if on_an_edge else 1)
    if touching < least:
        yield (
            Status.INVALID,
            Code.FEW_SPHERES,
            f"{touching:g} spheres touch, of {least} needed: raise fidelity.profile_samples or axial_samples",
        )


def spheres_in_place(record: Record, gear: SteeringGear, signals: dict[str, np.ndarray]) -> Failure:
    """Check that the rack stands about where the spheres end with its tips: pressed in by the mean depth."""
    if record.forces.spheres is None:
        return
    pair = GearPair.of(gear)
    axis = pair.axis_offset + pair.runout * np.cos(signals["pinion_angle"] + pair.runout_angle)
    raised = float(np.mean(signals["rack_y"] - axis)) + rack_approach(pair, mean_depth(gear))
    path = (pair.active_path[1] - pair.active_path[0]) * np.sin(pair.alpha_t)
    if abs(raised) > OUT_OF_PLACE * path:
        yield (
            Status.INVALID,
            Code.SPHERES_OUT_OF_PLACE,
            f"the rack is displaced {1e6 * raised:.3g} um from its preloaded position, "
            f"{abs(raised) / path:.1%} of the path of contact (limit of general contact "
            f"{OUT_OF_PLACE:.0%}): choose fidelity.mesh = flank",
        )


def yoke_off_nut(record: Record, signals: dict[str, np.ndarray]) -> Failure:
    """Check that under spheres the nut carries little of the yoke's force: it follows from micrometres, by
    which a grid of spheres leaves the flank."""
    if record.forces.spheres is None:
        return
    carried = float(signals["yokenut_force"].mean())
    share = carried / float(signals["seat_force"].mean()) if carried > 0 else 0.0
    if share > AT_NUT:
        yield (
            Status.INVALID,
            Code.SPHERES_AT_NUT,
            f"the yokenut carries {share:.0%} of the yoke's force on average, which spheres on a grid show "
            f"8 % and more off (limit of general contact {AT_NUT:.0%}): choose fidelity.mesh = flank",
        )


def _mesh_of(record: Record) -> Part:
    return next(part for part in record.forces.parts if part.name == "mesh")


def _on_an_edge(gear: SteeringGear, signals: dict[str, np.ndarray]) -> bool:
    """Return whether the teeth may bear on an edge, one row of spheres: shafts askew, or the yoke at its
    nut."""
    stopped = (signals.get("yokenut_force", np.zeros(1)) > 0).any()
    return bool(gear.installation.angle_error) or bool(stopped)


def work_balanced(signals: dict[str, np.ndarray], bound: float) -> Failure:
    """Check that the work that is missing is a small fraction of what drive or load did."""
    missing = missing_work(signals)
    if not _is_small(missing, bound, signals):
        residual = missing / largest_work(signals)
        yield (
            Status.INVALID,
            Code.WORK_MISSING,
            f"the error of the work balance is {residual:.2%} (limit {bound:.1%}); lower fidelity.step_angle",
        )


def edge_bound(gear: SteeringGear) -> float:
    """Return the share of the work that may go over the rack's edges by the gear's contact law.

    By law "line" 5 % of random gears exceed 2 %, and one of 200 reaches 5 %, in the smallest steps as well.
    """
    return EDGE_BOUND[gear.mesh.contact_law] + EDGE_FRACTION * float(
        np.degrees(abs(gear.installation.angle_error))
    )


def edges_spared(signals: dict[str, np.ndarray], bound: float) -> Failure:
    """Check that little work goes with material over the rack's edges, where too long steps end up as
    well."""
    taken = float(signals.get("work_mesh_edges", np.zeros(1))[-1])
    if not _is_small(taken, bound, signals):
        share = taken / largest_work(signals)
        yield (
            Status.INVALID,
            Code.EDGES_LOADED,
            f"{share:.2%} of the work is lost at the tooth edges (limit {bound:.1%})",
        )


def _is_small(work: float, bound: float, signals: dict[str, np.ndarray]) -> bool:
    return abs(work) <= max(bound * largest_work(signals), least_work(signals))


def least_work(signals: Mapping[str, np.ndarray]) -> Any:
    """Return the work below which none counts [J]; of many gears (n,)."""
    return MISSED_TORQUE * np.abs(np.diff(signals["pinion_angle"])).sum(axis=-1) + ROUNDING
