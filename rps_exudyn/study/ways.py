"""Which way the cases of a study go: singly, in groups, or in groups whose gears are followed together."""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes import scene_named
from rps_exudyn.simulate.together import UNSUPPORTED, can_exist, fewest, unsupported_reason
from rps_exudyn.study.definition import FIDELITY, Study
from rps_exudyn.study.description import Description, settings_of

FEWEST = 64  # missing cases, from which groups pay
QUANTILES = 65  # of a parameter's values, which say how it varies


@dataclass(frozen=True)
class Ways:
    """How the missing cases of a study are done.

    Attributes:
        grouped: in groups, by `batch`; else singly.
        ranges: path -> over what it varies in the whole design; None where no gears are followed together.
            All groups are given the same, so that a case ends the same in whichever group it is.
        alone: why none are followed together; "" if they are, or for so few cases or such a model that they
            are done singly.
    """

    grouped: bool
    ranges: Mapping[str, list[float]] | None = field(default=None)
    alone: str = ""


def ways_of(study: Study, description: Description, missing: int) -> Ways:
    """Return which way so many missing cases of a design go."""
    if not in_groups(study, description, missing):
        return Ways(False)
    gear, fidelity, scene = study.base.steering_gear, study.base.fidelity, description.scene
    if reason := unsupported_reason(scene, gear, fidelity, {}):
        return Ways(True, alone=reason)
    settings = [settings_of(study.axes, case.values) for case in description.cases]
    table = {path: np.array([each[path] for each in settings]) for path in settings[0]}
    if reason := unsupported_reason(scene, gear, fidelity, table):
        return Ways(True, alone=reason)
    ranges = {path: _allowed(gear, fidelity, path, values) for path, values in table.items()}
    if not all(ranges.values()) or len(settings) < fewest(table):
        return Ways(True, alone=UNSUPPORTED["few"])
    return Ways(True, ranges)


def _allowed(gear: SteeringGear, fidelity: Fidelity, path: str, values: np.ndarray) -> list[float]:
    """Quantiles of a parameter's values, without those at the ends that no gear can have."""
    some = deque(np.unique(np.quantile(values, np.linspace(0, 1, QUANTILES))).tolist())
    while some and not can_exist(gear, fidelity, {path: some[0]}):
        some.popleft()
    while some and not can_exist(gear, fidelity, {path: some[-1]}):
        some.pop()
    return list(some)


def in_groups(study: Study, description: Description, cases: int) -> bool:
    """Tell whether cases go through `batch`: many of one model, each of them steady and cheap."""
    paths = [path for axis in study.axes for path in (*axis.paths, *axis.along)]
    model = study.base.fidelity
    return (
        cases >= FEWEST
        and scene_named(description.scene).steady
        and model.solver in ("equilibrium", "closed-form")
        and model.mesh != "general-contact"
        and not any(path.startswith(FIDELITY) for path in paths)
    )
