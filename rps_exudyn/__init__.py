"""Rack-and-pinion steering gears on the Exudyn multibody code.

    import rps_exudyn as rps

    gear = rps.SteeringGear.from_toml("studies/gears/paper.toml")
    result = rps.run("free-pinion-torque", gear)
    result["pinion_torque"]  # [N m], one value per result["time"] [s]
    result.summary["torque_mean"]
    result.save("free-pinion-torque.h5")

The names are loaded when first used, so that importing the package costs nothing.
"""

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rps_exudyn.base.errors import InputError
    from rps_exudyn.parameters.gear import SteeringGear
    from rps_exudyn.results.result import Result, load
    from rps_exudyn.simulate.run import run
    from rps_exudyn.study.dataset import open_study, study_frame

__all__ = ["InputError", "Result", "SteeringGear", "load", "open_study", "run", "study_frame"]

_HOME = {
    "InputError": "base.errors",
    "SteeringGear": "parameters.gear",
    "Result": "results.result",
    "load": "results.result",
    "run": "simulate.run",
    "open_study": "study.dataset",
    "study_frame": "study.dataset",
}

# Exudyn reads this when it is imported: a user's own settings file would silently change results.
os.environ.setdefault("EXUDYN_NO_USER_SETTINGS", "1")


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(f"rps_exudyn.{_HOME[name]}"), name)
    raise AttributeError(f"module 'rps_exudyn' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
