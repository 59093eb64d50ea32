"""One run of one plan: checked before it, and its record after it."""

from dataclasses import replace
from time import perf_counter, process_time

from rps_exudyn.gears.geometry_report import geometry_report
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Interrupted, Status, each_once
from rps_exudyn.results.result import Result, failed
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.checks.before_run import refused
from rps_exudyn.scenes.scene import DEFAULT_OPTIONS, RunOptions
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.solvers.operating_gear import operating_gear


def run_checked(scene: str, gear: SteeringGear, fidelity: Fidelity) -> Result:
    """Run a plan unless its numbers would be wrong.

    Raises:
        InputError: a gear that cannot exist, or a test that it does not allow.
    """
    tested = in_operation.gear if (in_operation := operating_gear(gear)) else gear
    sentences = refused(tested, fidelity, steady=scene_named(scene).steady)
    if not sentences:
        return run_unchecked(scene, gear, fidelity)
    message = "; ".join(sentences)
    nothing = failed(scene, gear, fidelity, Status.INVALID, f"not run: {message}")
    return replace(
        nothing,
        codes=(Code.REFUSED.value,),
        findings={"refused": message},
        geometry=geometry_report(gear).numbers,
    )


def run_unchecked(
    scene: str, gear: SteeringGear, fidelity: Fidelity, options: RunOptions = DEFAULT_OPTIONS
) -> Result:
    """Run a plan without a check before it, for studies of what goes wrong then.

    Raises:
        InputError: a gear that cannot exist, or a test that it does not allow.
        Interrupted: Ctrl-C; it carries what was recorded.
    """
    wall, cpu = perf_counter(), process_time()
    report, in_operation = geometry_report(gear), operating_gear(gear)
    tested, numbers = (in_operation.gear, in_operation.numbers) if in_operation else (gear, {})

    def result_of(done: SceneRun) -> Result:
        return Result(
            scene=scene,
            gear=gear,
            fidelity=fidelity.model_dump(),
            solver=done.outcome.settings,
            findings=done.outcome.findings,
            status=done.outcome.status,
            message=done.outcome.message,
            codes=each_once(done.outcome.codes),
            signals=done.signals,
            summary=done.summary | numbers,
            counters={**done.outcome.counters, "solver_cpu": done.outcome.cpu_s},
            geometry=report.numbers,
            cpu_s=process_time() - cpu,
            wall_s=perf_counter() - wall,
        )

    try:
        return result_of(scene_named(scene).run(tested, fidelity, options))
    except Interrupted as interrupt:
        raise Interrupted(result_of(interrupt.recorded)) from None
