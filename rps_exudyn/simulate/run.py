"""Run one scene on one gear, whatever its outcome, and keep what came out."""

from collections.abc import Callable
from dataclasses import replace
from time import perf_counter, process_time
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.checks.before_run import refused
from rps_exudyn.gears.report import geometry_report
from rps_exudyn.parameters.fidelity import PRESETS, Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result, failed
from rps_exudyn.scenes.free_pinion_torque import free_pinion_torque
from rps_exudyn.scenes.load_test import load_test
from rps_exudyn.scenes.rack_push import rack_push
from rps_exudyn.scenes.reversal import reversal
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.scenes.yoke_impact import yoke_impact

SCENES: dict[str, Callable[[SteeringGear, Fidelity], SceneRun]] = {
    "free-pinion-torque": free_pinion_torque,
    "load-test": load_test,
    "rack-push": rack_push,
    "reversal": reversal,
    "yoke-impact": yoke_impact,
}


def run(
    scene: str,
    gear: SteeringGear | None = None,
    *,
    fidelity: str | Fidelity | None = None,
    accuracy: str | None = None,
    **test: Any,
) -> Result:
    """Simulate a scene, by default with the preset `flank`; keyword arguments replace settings of the test,
    for instance `turns=1`.

    With `accuracy`, for instance "1%", the cheapest model that keeps this error is taken, of all or of the
    preset named by `fidelity`; `result.solver["accuracy"]` says which and why.

    A plan that would end in a wrong number (`guards`) is not run: its status is `invalid`.

    Look at the result's `status` before you use its numbers.

    Raises:
        InputError: no such scene or fidelity, parameters that are not allowed, or a gear that cannot exist.
    """
    if scene not in SCENES:
        raise InputError(f"SCENE is {scene!r}; it must be one of {', '.join(SCENES)}.")
    if gear is not None and not isinstance(gear, SteeringGear):
        raise InputError(
            f"gear is a {type(gear).__name__}; it must be a SteeringGear, for instance "
            'SteeringGear().replace({"yoke.preload": "400 N"}).'
        )
    if not isinstance(fidelity, str | Fidelity | None):
        raise InputError(f"fidelity is {fidelity!r}; it must be one of {', '.join(PRESETS)}, or a Fidelity.")
    gear = (gear or SteeringGear()).replace({f"test.{name}": value for name, value in test.items()})
    if accuracy is not None:
        return _run_at(scene, gear, fidelity, accuracy)
    chosen = fidelity if isinstance(fidelity, Fidelity) else Fidelity.preset(fidelity or "flank")
    return _guarded(scene, gear, chosen)


def _run_at(scene: str, gear: SteeringGear, preset: str | Fidelity | None, accuracy: str) -> Result:
    """By the cheapest model of this accuracy."""
    from rps_exudyn.simulate.by_accuracy import beyond_promise, choose, percent

    if isinstance(preset, Fidelity):
        raise InputError(
            "accuracy chooses the model itself; give fidelity by the name of a preset, or leave it out."
        )
    choice = choose(scene, gear, percent(accuracy), preset)
    result = _guarded(scene, gear, choice.fidelity)
    told = choice.why + beyond_promise(gear, result.signals).removeprefix(beyond_promise(gear))
    return replace(result, solver={**result.solver, "accuracy": told})


def _guarded(scene: str, gear: SteeringGear, chosen: Fidelity) -> Result:
    """Not run if its numbers would be wrong."""
    if sentences := refused(scene, gear, chosen):
        return _refused(scene, gear, chosen, "; ".join(sentences))
    return unguarded(scene, gear, chosen)


def _refused(scene: str, gear: SteeringGear, chosen: Fidelity, message: str) -> Result:
    """Of a plan that was not run, because its numbers would be wrong."""
    nothing = failed(scene, gear, chosen, Status.INVALID, f"not run: {message}")
    return replace(nothing, solver={"refused": message}, geometry=geometry_report(gear).numbers)


def unguarded(scene: str, gear: SteeringGear, chosen: Fidelity) -> Result:
    """The same without a look at the plan before: for studies of what goes wrong then.

    Raises:
        InputError: a gear that cannot exist, or a test that it does not allow.
    """
    wall, cpu = perf_counter(), process_time()
    report = geometry_report(gear)
    done = SCENES[scene](gear, chosen)
    return Result(
        scene=scene,
        gear=gear,
        fidelity=chosen.model_dump(),
        solver=done.outcome.settings,
        status=done.outcome.status,
        message=done.outcome.message,
        signals=done.signals,
        summary=done.summary,
        counters={**done.outcome.counters, "solver_cpu": done.outcome.cpu_s},
        geometry=report.numbers,
        cpu_s=process_time() - cpu,
        wall_s=perf_counter() - wall,
    )
