"""The unknowns of a fit, each with its prior: a declared standard deviation.

Parameters that set the level of the torque are positive: their logarithms are fitted. The runout has a size
and a direction, and the direction means nothing where the size is 0: its components are fitted, and so are
those of the rack's bow. The angle error has a sign. Bow and angle error let the teeth touch at their edges:
the torque is no straight line of them, so they are fitted in damped steps (`nonlinear`).
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.gear import SteeringGear

SMALLEST = 1e-9  # of a length, so that a vector of none has a period of a turn as well [m]


class Prior(NamedTuple):
    """What is known of a parameter before any measurement; SI, or relative where its logarithm is fitted."""

    sd: float  # standard deviation
    step: float  # of a forward difference: above the solver's noise, below what bends the curve


LEVEL = {
    "yoke.preload": Prior(0.4, 0.02),
    "mesh.friction": Prior(0.4, 0.02),
    "yoke.friction": Prior(0.5, 0.02),
    "bush.drag": Prior(0.4, 0.03),
    "bearing.friction_torque": Prior(0.4, 0.03),
}
"""Parameters of the torque's level; deviations of the logarithm. Sources: spread of service manuals and of
tables of friction coefficients, docs/measured-curves.md."""

MOST = 1.0  # of a coefficient of friction
LARGEST = 27.0  # logarithm to which steps may lead: 1e12 [SI], or its inverse, of what curves contradict

VECTORS = {"pinion.runout": Prior(20e-6, 2e-6), "rack.bow": Prior(100e-6, 5e-6)}
"""Sizes of vectors, each with the direction at `<path>_angle`; deviations of either component [m]."""

SIGNED = {"installation.angle_error": Prior(np.radians(0.05), np.radians(0.004))}
"""Errors of either sign; deviations [rad]."""

SHAPE_PARAMETERS = ("rack.bow", "installation.angle_error")
"""Unknowns of which the torque is no straight line, not even nearly."""

BY_LOAD, WITHOUT_YOKE = "friction under 150 kg", "drag without yoke"
NUISANCES = {BY_LOAD: 0.10, WITHOUT_YOKE: 0.25}
"""What tests compare although nobody measured it; deviations of logarithms. Both coefficients of friction
change by exp(beta m / 150 kg) under a weight m; a rack without yoke has another drag."""
LOAD_OF_NUISANCE = 150.0  # [kg]

USUAL = (*LEVEL, "pinion.runout")
FREEABLE = (*LEVEL, *VECTORS, *SIGNED)


@dataclass(frozen=True)
class Unknown:
    """One number that is fitted."""

    path: str  # of the parameter
    component: str  # "" or of a vector: "cos", "sin"
    before: float  # expected: logarithm of the SI value, or SI
    sd: float  # of that expectation
    step: float

    @property
    def is_nuisance(self) -> bool:
        return self.path in NUISANCES

    @property
    def is_level(self) -> bool:
        """Return whether it sets the level of the torque, for which the shape is not trusted."""
        return self.path in LEVEL

    @property
    def needs_shape_fit(self) -> bool:
        """Return whether the torque is no straight line of it."""
        return self.path in SHAPE_PARAMETERS


def unknowns_of(
    gear: SteeringGear, free: Iterable[str], priors: Mapping[str, tuple[float, float]]
) -> list[Unknown]:
    """Return the unknowns of the freed parameters; `priors` is path -> (value, deviation), SI.

    Raises:
        InputError: a parameter of which no deviation is declared, or a prior that cannot be.
    """
    free = list(dict.fromkeys(free))
    for path in (*free, *priors):
        if path not in FREEABLE:
            choice = ", ".join(FREEABLE)
            raise InputError(f"{path} cannot be fitted, because it has no prior; choose from {choice}.")
    found: list[Unknown] = []
    for path in sorted(free, key=FREEABLE.index):
        value = float(gear.value_at(path))
        if path in LEVEL:
            found.append(_positive(path, value, priors.get(path)))
            continue
        usual = (VECTORS | SIGNED)[path]
        value, sd = priors.get(path, (value, usual.sd))
        if path in VECTORS:
            angle = gear.value_at(f"{path}_angle")
            found.append(Unknown(path, "cos", value * np.cos(angle), sd, usual.step))
            found.append(Unknown(path, "sin", value * np.sin(angle), sd, usual.step))
        else:
            found.append(Unknown(path, "", value, sd, usual.step))
    return found


def _positive(path: str, value: float, prior: tuple[float, float] | None) -> Unknown:
    sd = LEVEL[path].sd
    if prior is not None:
        value, sd = prior[0], prior[1] / prior[0] if prior[0] > 0 else 0.0
    if not value > 0:
        raise InputError(f"{path} is {value:g}; a fitted parameter must start above 0.")
    return Unknown(path, "", float(np.log(value)), sd, LEVEL[path].step)


def nuisance_unknowns(names: Iterable[str]) -> list[Unknown]:
    return [Unknown(name, "", 0.0, NUISANCES[name], 0.02) for name in names]


def nuisances_of(unknowns: list[Unknown], u: np.ndarray) -> dict[str, float]:
    """Return name -> logarithm of the nuisances among the unknowns."""
    return {each.path: float(value) for each, value in zip(unknowns, u, strict=True) if each.is_nuisance}


def settings_of(unknowns: list[Unknown], u: np.ndarray) -> dict[str, float]:
    """Return path -> SI value for the values `u`, within the limits of the parameters."""
    settings: dict[str, float] = {}
    for unknown, value in zip(unknowns, u.tolist(), strict=True):
        if unknown.is_nuisance:
            continue
        if unknown.is_level:
            most = MOST if "friction" in unknown.path[-9:] else np.inf
            settings[unknown.path] = min(float(np.exp(np.clip(value, -LARGEST, LARGEST))), most)
        elif unknown.component == "sin":
            size = float(np.hypot(settings[unknown.path], value))
            settings[f"{unknown.path}_angle"] = float(np.arctan2(value, settings[unknown.path]))
            settings[unknown.path] = max(size, SMALLEST)
        else:
            settings[unknown.path] = value
    return settings
