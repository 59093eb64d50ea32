"""Terms of an error bar: causes that neighbouring levels of the ladder share, so that no change shows them.

    inertia          equilibria leave it out: by how much it changes a metric of steady motion
    unsettled start  the share of the force that depends on where the motion began
    open cycle       the share of its range by which a slow motion ends a swing elsewhere than it began
    work             missing in the balance of work, or taken along where loaded material passes a tooth edge
    model            formulas, spheres, reduced gear: what they leave out, measured against models with it
    facets           of surfaces from files, under the smooth flanks that they stand for

All are biases, so that they add up.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from rps_exudyn.analysis.rack_motion import transmission_error
from rps_exudyn.analysis.work_balance import largest_work, missing_work
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.quantities import (
    EXTREMES,
    FIRST_ORDERS,
    LOSS_SHARES,
    LOST_MOTIONS,
    RACK_RANGES,
    SUMMARY,
    VARIATIONS,
    WANDERING,
    metric_sizes,
)
from rps_exudyn.scenes.checks.neglected_inertia import (
    FREE_OF_RANGES,
    FREE_OF_SHARES,
    MovedMasses,
    beside_travel,
    ringing,
    with_inertia,
)
from rps_exudyn.scenes.error_bars import Metrics, sizes
from rps_exudyn.scenes.run_maneuver import drift_beside_travel
from rps_exudyn.scenes.scene import Scene
from rps_exudyn.scenes.scene_run import Signals
from rps_exudyn.tooth_contact.mean_depth import mean_depth
from rps_exudyn.tooth_contact.spheres import SHALLOWEST
from rps_exudyn.tooth_contact.triangles import facet_height

DRIVES = {
    "pinion_torque": {name for name in VARIATIONS | EXTREMES if name.startswith("torque_")}
    - {"torque_tooth_order"},
    "rack_force": {"push_force_peak_to_peak"},
}
"""Signal of a drive -> metrics of how it varies."""
ERROR = "transmission_error_peak_to_peak"
RINGS = 2  # times what one change of a rate excites, by which the transmission error changes: 0.2 to 2 ...
PRESSED = 5  # ... and times the share of inertia, by which the teeth's depth does: 2 to 13 are found
FORCES = {"N", "N*m", "J"}
"""Units of metrics that change as forces do."""
MODEL_BIAS = {"closed-form": 0.02, "general-contact": 0.003, "triangles": 0.001, "reduced": 0.025}
"""Model -> share of forces by which it may differ from equilibria with lines of contact: means of gears by
formulas differ by 1.7 % at most, those of spheres by 0.3 %, of triangles by 0.1 %; loops and dead bands of
the reduced gear by 2.4 % from those of the dynamics. Formulas leave out what varies."""

FACETS = 0.09
"""Share of forces by which facets change means and ranges, at a mean height of the flanks over them of one
mean depth of the teeth: 0.03 to 0.09 are found on pinions of five gears with chords of 0.3 to 10 um. The rack
lifts by up to the height over sin(alpha_n), and turns by that over the pitch radius."""

MISSED_TORQUE = 1e-3  # whose work is none: a gear without friction takes none [N m]
ROUNDING = 1e-9  # of the works of a gear that nothing moves [J]
MATTERS = 0.05  # of a range or of a share, that inertia changes at its limits of `neglected_inertia`
MAGNIFIED = 5  # times the same most of the time, that forces change: a rack that swings on yoke and teeth

Terms = Mapping[str, Any]


def bar_terms(
    scene: Scene,
    fidelity: Fidelity,
    metrics: Metrics,
    signals: Signals,
    values: Mapping[str, Any],
    findings: Mapping[str, Any],
    masses: MovedMasses,
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the sum of all terms of each metric's bar, in its unit, and what the rules of bars measure;
    numbers, or of many gears (n,).

    Arguments as of `error_bars`, what the run found out about its start, and the masses that it moves.
    """
    of_run = sizes(signals, values)
    missing, over_edges = _shares_of_work(signals)
    leaves_inertia_out = scene.steady and fidelity.solver == "equilibrium"
    size = metric_sizes(values, of_run)
    total: dict[str, Any] = dict.fromkeys(size, 0.0)
    terms = [
        _model(fidelity, size, of_run),
        _facets(masses, size, of_run),
        {name: (missing + over_edges) * each for name, each in size.items()},
        _start(findings, size, of_run),
        *([_inertia(masses, metrics, signals, values, size)] if leaves_inertia_out else []),
        *([_open_cycle(masses, signals, size)] if scene.swings else []),
    ]
    for term in terms:
        for name, share in term.items():
            total[name] = total[name] + share
    measured = {"work_missing": missing}
    if leaves_inertia_out:  # the share of the main metric, or of the forces of its run, that the terms are
        unit, main_metric = SUMMARY[scene.main_metric].unit, values.get(scene.main_metric, 0.0)
        main = np.maximum(np.abs(main_metric), of_run.get(unit, 0.0))
        measured["moved_by_inertia"] = total.get(scene.main_metric, 0.0) / np.where(main > 0, main, np.inf)
    return total, measured


def _model(fidelity: Fidelity, size: Terms, of_run: Terms) -> Terms:
    bias = MODEL_BIAS.get(fidelity.solver, MODEL_BIAS.get(fidelity.mesh, 0.0))
    return {
        name: bias * np.maximum(each, of_run.get(SUMMARY[name].unit, 0.0) if bias else 0.0)
        for name, each in size.items()
    }


def _facets(masses: MovedMasses, size: Terms, of_run: Terms) -> Terms:
    gear = masses.gears[0]
    if not (height := facet_height(gear)):
        return {}
    share, pair = FACETS * height / max(mean_depth(gear), SHALLOWEST), GearPair.of(gear)
    lift = height / float(np.sin(pair.alpha_n))
    moved = {"m": lift, "rad": lift / pair.reference_radius}
    return {
        name: share * np.maximum(each, of_run.get(unit, 0.0)) + moved.get(unit, 0.0)
        for name, each in size.items()
        for unit in (SUMMARY[name].unit,)
    }


def _shares_of_work(signals: Signals) -> tuple[Any, Any]:
    """Return what is missing in the balance of work and what passes the tooth edges, over what drive or load
    did; 0 of so little that it is none."""
    if "pinion_angle" not in signals:
        return 0.0, 0.0
    least = MISSED_TORQUE * np.abs(np.diff(signals["pinion_angle"])).sum(axis=-1) + ROUNDING
    missing = np.abs(missing_work(signals)) if "stored_energy" in signals else 0.0
    edges = np.abs(signals.get("work_mesh_edges", np.zeros(1))[..., -1])
    whole = np.maximum(largest_work(signals), least)
    missing, edges = ((np.where(work > least, work, 0.0) / whole)[()] for work in (missing, edges))
    return missing, edges


def _start(findings: Mapping[str, Any], size: Terms, of_run: Terms) -> Terms:
    """What the force of the record, and that over its first tooth pitch, depend on where the motion began."""
    mean, first = (findings.get(name, 0.0) for name in ("unsettled_mean", "start_unsettled"))
    varying = VARIATIONS | EXTREMES | FIRST_ORDERS

    def moved(name: str) -> Any:
        return (first if name in varying else mean) * np.maximum(
            size[name], of_run.get(SUMMARY[name].unit, 0.0)
        )

    return {name: moved(name) for name in size if SUMMARY[name].unit in FORCES} if mean or first else {}


def _inertia(
    masses: MovedMasses, metrics: Metrics, signals: Signals, values: Mapping[str, Any], size: Terms
) -> Terms:
    """What the drive overcomes along the travel changes as its metrics show; what varies by the range of that
    at most. Beside the travel, inertia presses on the yoke: all forces change by its usual share, ranges of
    the rack and shares of losses by its largest."""
    drive = next((name for name in DRIVES if name in signals), "")
    if not drive or "mesh_normal_force" not in signals:
        return {}
    (beside, usual), added = beside_travel(signals, masses), with_inertia(signals, masses)
    shifted = metrics(added)
    varies = np.ptp(added[drive] - signals[drive], axis=-1) + beside * np.abs(signals[drive]).mean(axis=-1)
    depth = PRESSED * beside * np.mean(signals["mesh_penetration"], axis=-1)

    def change(name: str, each: Any) -> Any:
        if name == ERROR:
            return np.maximum(depth, RINGS * ringing(signals, masses))
        if name in DRIVES[drive]:
            return varies
        if name in RACK_RANGES:
            return MATTERS * beside / FREE_OF_RANGES * each
        if name in LOSS_SHARES:
            return MATTERS * beside / FREE_OF_SHARES * each
        return np.abs(shifted.get(name, values[name]) - values[name])

    changes = {name: MAGNIFIED * usual * each + change(name, each) for name, each in size.items()}
    # a motion that inertia has changed has another inertia, by the same share
    return {name: each * (1 + each / size[name]) for name, each in changes.items()}


def _open_cycle(masses: MovedMasses, signals: Signals, size: Terms) -> Terms:
    gain = float(masses.gain)
    rule = GearPair.of(masses.gears[0]).travel_rule
    share = drift_beside_travel(signals, rule)
    moved = float(np.ptp(transmission_error(signals, rule)))
    lost = {"lost_motion": moved, "lost_motion_angle": moved / gain}
    return {
        name: share * np.maximum(each, lost.get(name, 0.0))
        for name, each in size.items()
        if name in WANDERING | LOST_MOTIONS
    }
