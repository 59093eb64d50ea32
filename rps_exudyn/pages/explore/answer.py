"""What the page shows of one state: torque over a turn, losses, geometry; or why there is none."""

from time import perf_counter
from typing import Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.interrupts import raise_wrapped
from rps_exudyn.base.units import words
from rps_exudyn.gears.geometry_report import geometry_report
from rps_exudyn.pages.explore.sliders import settings_of
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.law_error import law_error
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import GEOMETRY, SIGNALS, SUMMARY
from rps_exudyn.results.result import Result
from rps_exudyn.scenes.free_pinion_torque import SCENE
from rps_exudyn.simulate.run import simulate

FIDELITY = "quasi-static"
NUMBERS = (
    "torque_mean",
    "torque_peak_to_peak",
    "torque_first_order",
    "rack_gain",
    "rack_lift_range",
    "yoke_force_max",
)
LOSSES = ("loss_share_mesh", "loss_share_seat", "loss_share_bush", "loss_share_bearing")
SIZES = (
    "transverse_contact_ratio",
    "overlap_ratio",
    "tip_diameter",
    "root_diameter",
    "undercut_margin",
    "crest_width",
)
Answer = dict[str, Any]


def answer(gear: SteeringGear, state: Any) -> Answer:
    """Compute one state of the sliders; whatever it is, the answer is a table for the page.

    Args:
        gear: what the sliders change.
        state: path -> number in the slider's unit.

    Returns:
        "problems": sentences, if this gear cannot exist or be computed; else curve, numbers and remarks.
    """
    began = perf_counter()
    try:
        chosen = gear.replace(settings_of(state))
        report = geometry_report(chosen)
        result = simulate(SCENE.name, chosen, FIDELITY)
    except InputError as error:
        return {"problems": list(error.problems)}
    except Exception as error:  # whatever a state nobody has tried does to a solver: the page goes on
        raise_wrapped(error)
        return {"problems": [f"This state cannot be computed: {type(error).__name__}: {error}."]}
    shown = {
        "gear": repr(chosen).strip("<>"),
        "geometry": {
            words(name): GEOMETRY[name].show(getattr(report, name))
            for name in SIZES  # without masses, which need solids
        },
        "warnings": list(report.warnings),
    }
    if result.status is not Status.OK:
        return shown | {"problems": [f"{result.status}: {result.message} {result.status.remedy}".strip()]}
    return shown | _curve(result) | {"ms": 1e3 * (perf_counter() - began)}


def _curve(result: Result) -> Answer:
    angle = SIGNALS["pinion_angle"].displayed(result["pinion_angle"])
    torque = SIGNALS["pinion_torque"].displayed(result["pinion_torque"])
    summary = result.summary
    error = law_error(result.gear, result.fidelity)
    return {
        "angle": np.round(angle, 3).tolist(),
        "torque": np.round(torque, 6).tolist(),
        "numbers": {words(name): SUMMARY[name].show(summary[name]) for name in NUMBERS if name in summary},
        "losses": {
            words(name.removeprefix("loss_share_")): round(100 * summary[name], 2)
            for name in LOSSES
            if name in summary
        },
        "error": error.largest if error else None,
        "accuracy": (error.sentence if error else "")
        + " Quasi-static: equilibria at each angle, without inertia; friction coefficients are yours.",
        "remarks": result.message,
    }
