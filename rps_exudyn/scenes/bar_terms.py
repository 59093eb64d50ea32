"""Terms of an error bar: causes that neighbouring levels of the ladder share, so that no change shows them.

    inertia          equilibria leave it out: by how much it changes a metric of steady motion
    unsettled start  the share of the force that depends on where the motion began
    open cycle       the share of its range by which a slow motion ends a swing elsewhere than it began
    work             missing in the balance of work, or taken along where loaded material passes a tooth edge
    model            formulas and spheres: what they leave out, measured against models that have it

All are biases, so that they add up.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from rps_exudyn.analysis.passes import number_of
from rps_exudyn.analysis.rack_motion import transmission_error
from rps_exudyn.analysis.work_balance import largest_work, missing_work
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.quantities import EXTREMES, FIRST_ORDERS, LOST_MOTIONS, SPREADS, SUMMARY, WANDERING
from rps_exudyn.scenes.checks.after_run import least_work
from rps_exudyn.scenes.checks.neglected_inertia import MovedMasses, beside_travel
from rps_exudyn.scenes.error_bars import Metrics
from rps_exudyn.scenes.metric_confirmation import by_inertia
from rps_exudyn.scenes.run_maneuver import left_open
from rps_exudyn.scenes.scene import Scene
from rps_exudyn.scenes.scene_run import Signals
from rps_exudyn.scenes.sizes import size_of, sizes

FORCES = {"N", "N*m", "J"}
"""Units of metrics that change as forces do."""
MODEL_BIAS = {"closed-form": 0.02, "general-contact": 0.003}
"""Model -> share of its metrics by which 95 % of random gears differ from one with equilibria and strips."""

MOST_OF_WORK = 0.05  # that may be missing in the balance: more is no error, but another motion
MOST_OF_TERMS = 0.2  # of the scene's main metric that inertia may change: more is another motion, too

Terms = Mapping[str, Any]


def bar_terms(
    scene: Scene,
    fidelity: Fidelity,
    metrics: Metrics,
    signals: Signals,
    values: Mapping[str, Any],
    findings: Mapping[str, Any],
    masses: MovedMasses,
) -> dict[str, Any]:
    """Return the sum of all terms of each metric's bar, in its unit; arguments as of `error_bars`, what the
    run found out about its start, and the masses that it moves."""
    of_run = sizes(signals, values)
    size = {name: size_of(name, values[name], of_run) for name in values if SUMMARY[name].confirmed}
    total: dict[str, Any] = dict.fromkeys(size, 0.0)
    terms = [
        _model(fidelity, size),
        _work(signals, size),
        _start(findings, size, of_run),
        *([_inertia(masses, metrics, signals, values, size)] if leaves_inertia_out(scene, fidelity) else []),
        *([_open_cycle(masses, signals, size)] if scene.swings else []),
    ]
    for term in terms:
        for name, share in term.items():
            total[name] = total[name] + share
    return total


def leaves_inertia_out(scene: Scene, fidelity: Fidelity) -> bool:
    """Return whether equilibria follow a steady motion."""
    return scene.steady and fidelity.solver == "equilibrium"


def _model(fidelity: Fidelity, size: Terms) -> Terms:
    bias = MODEL_BIAS.get(fidelity.solver, MODEL_BIAS.get(fidelity.mesh, 0.0))
    return {name: bias * each for name, each in size.items()}


def _work(signals: Signals, size: Terms) -> Terms:
    share = number_of(work_error(signals))
    return {name: share * each for name, each in size.items()}


def work_error(signals: Signals) -> Any:
    """Return the share of the work that is missing in its balance, or lost at tooth edges, where it is not so
    little that it is none. A number, or of many gears (n,)."""
    if "stored_energy" not in signals or "pinion_angle" not in signals:
        return 0.0
    largest, least = largest_work(signals), least_work(signals)
    edges = signals.get("work_mesh_edges", np.zeros(1))[..., -1]
    wrong = sum(np.where(each > least, each, 0.0) for each in (np.abs(missing_work(signals)), np.abs(edges)))
    return wrong / np.maximum(largest, least)


def _start(findings: Mapping[str, Any], size: Terms, of_run: Terms) -> Terms:
    """What the force of the record, and that over its first tooth pitch, depend on where the motion began."""
    mean, first = (findings.get(name, 0.0) for name in ("unsettled_mean", "start_unsettled"))
    varying = SPREADS | EXTREMES | FIRST_ORDERS

    def moved(name: str) -> Any:
        return (first if name in varying else mean) * np.maximum(
            size[name], of_run.get(SUMMARY[name].unit, 0.0)
        )

    return {name: moved(name) for name in size if SUMMARY[name].unit in FORCES} if mean or first else {}


def _inertia(
    masses: MovedMasses, metrics: Metrics, signals: Signals, values: Mapping[str, Any], size: Terms
) -> Terms:
    if "mesh_normal_force" not in signals:
        return {}
    changed = by_inertia(lambda each: dict(metrics(each)), signals, values, masses)
    _, usual = beside_travel(signals, masses)
    return {name: (usual + changed.get(name, 0.0) * _tolerance(name)) * each for name, each in size.items()}


def _tolerance(name: str) -> float:
    how = SUMMARY[name].confirmed
    return how.tolerance if how else 0.0


def _open_cycle(masses: MovedMasses, signals: Signals, size: Terms) -> Terms:
    gain = float(masses.gain)
    share = left_open(signals, gain)
    moved = float(np.ptp(transmission_error(signals, gain)))
    lost = {"lost_motion": moved, "lost_motion_angle": moved / gain}
    return {
        name: share * np.maximum(each, lost.get(name, 0.0))
        for name, each in size.items()
        if name in WANDERING | LOST_MOTIONS
    }
