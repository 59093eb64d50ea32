"""The axes of the design `uncertain`: one for each parameter that carries a distribution."""

from collections.abc import Mapping, Sequence
from typing import Any

from rps_exudyn.inference.uncertainty.input_sets import uncertain_inputs
from rps_exudyn.parameters.carried import carried
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.study.description import Axis


def uncertain_axes(
    gear: Mapping[str, Any], settings: Mapping[str, Any], inputs: str, others: Sequence[Axis]
) -> tuple[Axis, ...]:
    """Return an axis for each distribution of the gear's file, of settings, and of a set of inputs.

    Args:
        gear: tables of the gear's file.
        settings: path -> value of single parameters.
        inputs: name of the set; "" for `own` where a parameter carries a distribution, else `series`.
        others: axes of the study's own tables, whose parameters are left to them.

    Raises:
        InputError: a distribution that cannot be, or no such set.
    """
    own = carried(gear, settings)
    given = {path for axis in others for path in (*axis.paths, *axis.along)}
    nominal = SteeringGear.from_tables(gear, settings)
    found = uncertain_inputs(nominal, inputs, own, bool(others))
    declared = {item.path: item for item in SteeringGear.declared()}
    axes = []
    for path, each in found.items():
        if path not in given:
            unit = declared[path].unit
            distribution = {"kind": each.kind, "numbers": [each.first, each.second]}
            name, shown = path, unit.display if unit else ""
            axes.append(Axis(name, (path,), shown, None, "sampled", distribution=distribution))
    return tuple(axes)
