"""Figures of many gears in a loop, by the functions that describe single runs, and remarks on each."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from rps_exudyn.analysis.efficiency import LoadTest, describe_load_test, free_torque_of, measured_load_test
from rps_exudyn.analysis.resolution import LEAST_FOR_PEAKS
from rps_exudyn.mesh_contact.steel import BEARABLE_PRESSURE
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.figures import figures_of_rack, figures_of_torque, without
from rps_exudyn.scenes.load_test import oriented
from rps_exudyn.scenes.rack_push import push_figures
from rps_exudyn.scenes.remarks import remarks
from rps_exudyn.simulate.loop_legs import LOAD_TEST, RACK_PUSH
from rps_exudyn.simulate.loop_signals import LegRecord, joined
from rps_exudyn.solvers.gear_numbers import COLUMN, LOAD

Figures = dict[str, np.ndarray]


def figures_of(
    scene: str, records: Sequence[LegRecord], signals: dict[str, np.ndarray]
) -> tuple[Figures, list[list[str]]]:
    """Return figures (n,) each, and what they themselves remark on each gear.

    Args:
        scene: one that the loop knows.
        records: of all legs.
        signals: of the legs that the scene records, joined; (n, m), angle and time may be (m,).
    """
    gear, numbers = records[0].design.gear, records[0].rows.numbers
    gain = numbers[:, COLUMN["mesh", "gain"]]
    told: list[list[str]] = [[] for _ in numbers]
    if scene == LOAD_TEST:
        test = _load_test(gear, numbers[:, LOAD], gain, signals, records[-1])
        own, told = describe_load_test(test), [list(each.remarks()) for each in _each(test)]
    elif scene == RACK_PUSH:
        coarse = records[0].design.fidelity.step_angle > 2 * np.pi / gear.pinion.teeth / LEAST_FOR_PEAKS
        own = without(push_figures(signals), ("push_force_peak_to_peak",) if coarse else ())
    else:
        own = figures_of_torque(signals, gear)
    figures: dict[str, Any] = {**own, **figures_of_rack(signals, gain), **_shares(records)}
    return {name: np.broadcast_to(values, len(numbers)) for name, values in figures.items()}, told


def _load_test(
    gear: SteeringGear, pull: np.ndarray, gain: np.ndarray, signals: dict[str, np.ndarray], free: LegRecord
) -> LoadTest:
    """The load tests of all gears; each of its numbers is an array (n,)."""
    pitch = 2 * np.pi / gear.pinion.teeth
    free_torque = free_torque_of(free.whole(), pitch)
    return measured_load_test(oriented(signals, gear), np.abs(pull), gain, free_torque, pitch)


def _each(test: LoadTest) -> list[LoadTest]:
    """The load test of each gear."""
    columns = test.load, test.ideal_torque, test.torque_forward, test.torque_reverse, test.free_torque
    return [LoadTest(*row) for row in np.transpose(columns).tolist()]


def _shares(records: Sequence[LegRecord]) -> Figures:
    """The summary's loss fractions."""
    recorded = [each.works for each in records if each.design.leg.recorded]

    def lost(*names: str) -> np.ndarray:
        return np.sum([works[name] for works in recorded for name in names], axis=0)

    places = {"mesh": lost("mesh", "damping", "edges")}
    places |= {name: lost(name) for name in ("seat", "bush", "bearing")}
    whole = np.sum(list(places.values()), axis=0)
    return {f"loss_share_{name}": work / whole for name, work in places.items()}


def remarks_on(records: Sequence[LegRecord]) -> list[str]:
    """Return remarks on each gear at the loop's angles, by the function that remarks on single runs."""
    gear = records[0].design.gear
    seen = joined([each.seen() for each in records if each.design.leg.recorded])
    pressed = np.minimum(seen["mesh_normal_force_drive"], seen["mesh_normal_force_coast"]).min(axis=1)
    overloaded = seen["mesh_pressure"].max(axis=1) > BEARABLE_PRESSURE
    said = (pressed <= 0) | overloaded | (seen["yokenut_force"].max(axis=1) > 0)
    clearance = records[0].number("nut", "clearance")[:, 0]
    messages = [""] * len(said)
    for i in np.flatnonzero(said).tolist():
        yoke = gear.yoke.model_copy(update={"clearance": float(clearance[i])})
        signals = {name: column[i] for name, column in seen.items()}
        told = remarks(gear.model_copy(update={"yoke": yoke}), signals)
        messages[i] = "; ".join(remark for remark in told if remark)
    return messages
