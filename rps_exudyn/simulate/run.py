"""Run one scene on one gear, whatever its outcome, and keep what came out.

`run` is Python's way in, with settings of the test as keywords; command line, studies and benchmarks call
`simulate` with a gear that is ready. Both give a `Result`:

    plain                the plan is checked, run, and its record is checked
    robust=True          where that fails, the next safer settings (run_plan.py)
    time_limit=20.0      the same in a process that is killed after that time (isolated_run)
    accuracy="1%"        by the cheapest model that keeps this error (by_accuracy.py, accuracy_check.py)
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.progress import Listener, following
from rps_exudyn.gears.geometry_report import geometry_report
from rps_exudyn.parameters.fidelity import Fidelity, check_fidelity
from rps_exudyn.parameters.gear import SteeringGear, check_gear
from rps_exudyn.results.outcome import Code, Interrupted, Status, each_once
from rps_exudyn.results.result import Result, failed
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.checks.rules import refused
from rps_exudyn.scenes.ladder import valid_level
from rps_exudyn.scenes.law_by_scene import with_law
from rps_exudyn.scenes.scene import DEFAULT_OPTIONS, RunOptions
from rps_exudyn.simulate.accuracy_check import Wanted, kept_by
from rps_exudyn.simulate.by_accuracy import Choice, beyond_in_run, choose, percent
from rps_exudyn.simulate.cases.task import Task
from rps_exudyn.simulate.cases.time_limit import TimeLimit
from rps_exudyn.simulate.run_plan import run_unchecked, run_with_fallback
from rps_exudyn.solvers.temperature_and_wear import tested_gear


def run(
    scene: str,
    gear: SteeringGear | None = None,
    *,
    fidelity: str | Fidelity | None = None,
    level: int | None = None,
    accuracy: str | None = None,
    robust: bool = False,
    time_limit: str | float | None = None,
    progress: Listener | None = None,
    **test: Any,
) -> Result:
    """Simulate a scene; look at the result's `status` before you use its numbers.

    A plan that would end in a wrong number (`checks.before_run`) is not run: its status is `invalid`.

    Args:
        scene: one of `scenes.SCENE_NAMES`.
        gear: without it the default gear, the paper's.
        fidelity: name of a preset, or a `Fidelity`; `flank` by default.
        level: of the ladder, 1 by default: each has half the steps of the one below, and finer contacts. The
            error bars come from it and the level below.
        accuracy: error allowed, for instance "1%": takes the cheapest model that keeps it, of all or of the
            preset named by `fidelity`; `result.findings["accuracy"]` states which and why.
        robust: takes the next safer settings where the run fails; `result.findings["tries"]` lists them.
        time_limit: ends the run after this time [s], or for instance "20 s", whatever it does then; its
            status is `timeout`, and what it has recorded is kept.
        progress: called now and then with a `base.progress.Progress`, from the third second of a run on.
        test: settings of the test, for instance turns=1.

    Raises:
        InputError: no such scene or fidelity, parameters that are not allowed, or a gear that cannot exist.

    Examples:
        >>> result = rps.run("free-pinion-torque", fidelity="closed-form")
        >>> result.status.value, round(result.summary["torque_mean"], 2)
        ('ok', 0.62)
    """
    limit = None if time_limit is None else TimeLimit.of(time_limit)
    gear = SteeringGear() if gear is None else gear
    check_gear(gear)
    if fidelity is not None:
        check_fidelity(fidelity)
    if test:
        gear = gear.replace({f"test.{name}": value for name, value in test.items()})
    with following(progress):
        return simulate(
            scene, gear, fidelity, level=level, accuracy=accuracy, robust=robust, time_limit=limit
        )


def simulate(
    scene: str,
    gear: SteeringGear,
    fidelity: str | Fidelity | None = None,
    *,
    level: int | None = None,
    accuracy: str | None = None,
    robust: bool = False,
    time_limit: TimeLimit | None = None,
    options: RunOptions = DEFAULT_OPTIONS,
) -> Result:
    """Simulate a scene of a gear; arguments as of `run`. The options are of runs of a model that is given,
    without a time limit.

    Raises:
        InputError: no such scene or fidelity, or a gear or test that cannot exist.
    """
    needed = scene_named(scene).law
    if accuracy is not None:
        if level is not None:
            raise InputError("accuracy chooses the level itself; leave out level.")
        if isinstance(fidelity, Fidelity):
            raise InputError(
                "accuracy chooses the model itself; give fidelity by the name of a preset, or leave it out."
            )
        limited = partial(simulate, scene, robust=robust, time_limit=time_limit)
        gear = with_law(gear, Fidelity.preset("flank" if fidelity is None else fidelity), needed)
        return _by_accuracy(limited, scene, gear, percent(accuracy), fidelity)
    fidelity = "flank" if fidelity is None else fidelity
    chosen = fidelity if isinstance(fidelity, Fidelity) else Fidelity.preset(fidelity)
    if level is not None:
        options = replace(options, level=valid_level(level, chosen))
    gear = with_law(gear, chosen, needed)
    if time_limit is not None:
        return isolated_run(scene, gear, chosen, time_limit, robust=robust, options=options)
    if robust:
        return run_with_fallback(scene, gear, chosen, options)
    if not (sentences := refused(tested_gear(gear), chosen, motion=scene_named(scene).motion)):
        return run_unchecked(scene, gear, chosen, options)
    message = "; ".join(sentences)
    return replace(
        failed(scene, gear, chosen, Status.INVALID, f"not run: {message}"),
        codes=(Code.REFUSED.value,),
        findings={"refused": message},
        geometry=geometry_report(gear).numbers,
    )


def isolated_run(
    scene: str,
    gear: SteeringGear,
    fidelity: Fidelity,
    limit: TimeLimit,
    *,
    robust: bool = False,
    options: RunOptions = DEFAULT_OPTIONS,
) -> Result:
    """Simulate in another process until the limit is over: loading, compiling and settling count.

    The outcome is `timeout` if the time was over, with what was recorded until then; `crashed` if the process
    ended otherwise. Exudyn's own limit ends with a success flag, and some of its solvers never look at it.

    Raises:
        InputError: a gear or test that cannot exist.
        Interrupted: Ctrl-C; it carries what was recorded.
    """
    from rps_exudyn.simulate.cases.processes import Processes

    run = Task(partial(simulate, scene, gear, fidelity, robust=robust, options=options), begun=limit.begun)
    with Processes(1, limit.seconds) as processes:
        try:
            ((_, answer),) = processes.run(iter([run]))
        except KeyboardInterrupt:
            for _, answer in processes.interrupted():
                if answer.recorded is not None and answer.recorded.signals:
                    raise Interrupted(answer.recorded) from None
            raise
    if isinstance(answer.error, InputError):
        raise answer.error
    if answer.value is None:
        return answer.failure(scene, gear, fidelity)
    result: Result = answer.value
    return result


def _by_accuracy(
    run: Callable[[SteeringGear, Fidelity], Result],
    scene: str,
    gear: SteeringGear,
    wanted: float,
    preset: str | None,
) -> Result:
    """Run by the cheapest setting that promises an error [%]; where equilibria do not run, the cheapest with
    inertia, unless a preset is named.

    Raises:
        InputError: nothing promises it.
    """
    choice = choose(scene, gear, wanted, preset)
    result, why = _kept(run, scene, gear, wanted, choice), choice.why
    if result.status is not Status.OK and preset is None and choice.fidelity.solver == "equilibrium":
        failed, cause = choice, f"{result.status}: {result.message}"
        with suppress(InputError):  # then the failed run stands
            choice = choose(scene, gear, wanted, without={failed.setting.preset})
            result = _kept(run, scene, gear, wanted, choice)
            why = f"{failed.setting.preset} ends {cause}; instead {choice.why}"
    beyond = beyond_in_run(scene, result.signals)
    findings = {**result.findings, "accuracy": why + beyond + choice.beside}
    codes = [Code.ACCURACY_NOT_PROMISED] if beyond or not choice.promised else []
    return replace(result, findings=findings, codes=each_once([*result.codes, *codes]))


def _kept(
    run: Callable[[SteeringGear, Fidelity], Result],
    scene: str,
    gear: SteeringGear,
    wanted: float,
    choice: Choice,
) -> Result:
    return kept_by(run, Wanted(scene, choice.quantity, wanted), gear, choice.fidelity)
