"""Remarks on a run that is all right: which limits of the gear it met, with the numbers."""

from collections.abc import Iterator

import numpy as np

from rps_exudyn.checks.after_run import first_angle
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.scene_run import Signals

LIFTED, STOPPED = "carry nothing", "is used up"
"""Words of a remark on a contact that opens or closes, beyond which numbers follow another law."""


def met_limit(message: str) -> bool:
    """Tell whether the remarks on a run speak of a contact that opened or closed."""
    return LIFTED in message or STOPPED in message


def remarks(gear: SteeringGear, signals: Signals) -> Iterator[str]:
    """Yield remarks on a record, sentences without a full stop."""
    if signals:
        yield from _flank_lifted(signals)
        yield from _yoke_stopped(gear, signals)


def _flank_lifted(signals: Signals) -> Iterator[str]:
    for side, loaded in (("drive", "coast"), ("coast", "drive")):
        force = signals.get(f"mesh_normal_force_{side}", np.ones(1))
        free = force <= 0
        if free.any():
            yield (
                f"the {side} flanks {LIFTED} in {free.mean():.0%} of the record, first at "
                f"{first_angle(signals, free)}; all load is on the {loaded} flanks"
            )


def _yoke_stopped(gear: SteeringGear, signals: Signals) -> Iterator[str]:
    force = signals.get("yokenut_force", np.zeros(1))
    if (force > 0).any():
        yield (
            f"yoke.clearance = {1e6 * gear.yoke.clearance:.4g} um {STOPPED}, first at "
            f"{first_angle(signals, force > 0)}; the yokenut carries up to {force.max():.4g} N"
        )
