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
    from rps_exudyn.analysis.measured import compare_with_measured
    from rps_exudyn.assessment.requirements.window import window
    from rps_exudyn.base.errors import InputError
    from rps_exudyn.fmu.export import export
    from rps_exudyn.inference.fitting.fit import fit
    from rps_exudyn.inference.fitting.fitted import Fit
    from rps_exudyn.inference.measured.reading import read_measured_torque
    from rps_exudyn.inference.uncertainty.sensitivities import sensitivities
    from rps_exudyn.multibody.model import build_model
    from rps_exudyn.optimisation.optimise import optimise, tolerances
    from rps_exudyn.parameters.fidelity import Fidelity
    from rps_exudyn.parameters.gear import SteeringGear
    from rps_exudyn.results.outcome import Status
    from rps_exudyn.results.result import Result
    from rps_exudyn.scenes import add_scene
    from rps_exudyn.scenes.scene import Scene
    from rps_exudyn.simulate.batch import Batch, batch
    from rps_exudyn.simulate.run import run
    from rps_exudyn.study.case_blocks import load
    from rps_exudyn.study.dataset import open_study, study_frame

__all__ = [
    "Batch",
    "Fidelity",
    "Fit",
    "InputError",
    "Result",
    "Scene",
    "Status",
    "SteeringGear",
    "add_scene",
    "batch",
    "build_model",
    "compare_with_measured",
    "export",
    "fit",
    "load",
    "open_study",
    "optimise",
    "read_measured_torque",
    "run",
    "sensitivities",
    "study_frame",
    "tolerances",
    "window",
]

_HOME = {
    "Fidelity": "parameters.fidelity",
    "InputError": "base.errors",
    "Scene": "scenes.scene",
    "Status": "results.outcome",
    "add_scene": "scenes",
    "build_model": "multibody.model",
    "compare_with_measured": "analysis.measured",
    "read_measured_torque": "inference.measured.reading",
    "export": "fmu.export",
    "Fit": "inference.fitting.fitted",
    "fit": "inference.fitting.fit",
    "SteeringGear": "parameters.gear",
    "Result": "results.result",
    "load": "study.case_blocks",
    "Batch": "simulate.batch",
    "batch": "simulate.batch",
    "optimise": "optimisation.optimise",
    "run": "simulate.run",
    "sensitivities": "inference.uncertainty.sensitivities",
    "open_study": "study.dataset",
    "study_frame": "study.dataset",
    "tolerances": "optimisation.optimise",
    "window": "assessment.requirements.window",
}

# Exudyn reads this when it is imported: a user's own settings file would silently change results.
os.environ.setdefault("EXUDYN_NO_USER_SETTINGS", "1")


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(f"rps_exudyn.{_HOME[name]}"), name)
    raise AttributeError(f"module 'rps_exudyn' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
