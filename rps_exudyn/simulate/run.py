"""Run one scene on one gear, whatever its outcome, and keep what came out.

`run` is Python's way in, with settings of the test as keywords; command line, studies and benchmarks call
`simulate` with a gear that is ready. Both give a `Result`:

    plain                the plan is checked, run, and its record is checked
    robust=True          where that fails, the next safer settings (run_plan.py)
    time_limit=20.0      the same in a process that is killed after that time (isolated_run)
    accuracy="1%"        up the ladder until the error bars are within it (by_accuracy.py)
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.progress import Listener, following
from rps_exudyn.parameters.fidelity import Fidelity, check_fidelity
from rps_exudyn.parameters.gear import SteeringGear, check_gear
from rps_exudyn.results.outcome import Interrupted
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.contact_law import resolve_contact_law
from rps_exudyn.scenes.ladder import valid_level
from rps_exudyn.scenes.scene import DEFAULT_OPTIONS, RunOptions
from rps_exudyn.simulate.by_accuracy import AccuracyGoal, climb
from rps_exudyn.simulate.cases.task import Task
from rps_exudyn.simulate.cases.time_limit import TimeLimit
from rps_exudyn.simulate.run_plan import Plan, run_with_fallback


def run(
    scene: str,
    gear: SteeringGear | None = None,
    *,
    fidelity: str | Fidelity | None = None,
    level: int | None = None,
    accuracy: str | None = None,
    metrics: Sequence[str] | None = None,
    robust: bool = False,
    time_limit: str | float | None = None,
    progress: Listener | None = None,
    **test: Any,
) -> Result:
    """Simulate a scene; look at the result's `status` before you use its numbers.

    A plan that would end in a wrong number (`checks.rules`) is not run: its status is `invalid`.

    Args:
        scene: one of `scenes.SCENE_NAMES`.
        gear: without it the default gear, the paper's.
        fidelity: name of a preset, or a `Fidelity`; `flank` by default.
        level: of the ladder, 1 by default: each has half the steps of the one below, and finer contacts. The
            error bars come from it and the level below.
        accuracy: error allowed, for instance "1%": climbs the levels, by the cheapest preset first or by the
            one named by `fidelity`, until the error bars are within it; `result.findings["accuracy"]` states
            level, bar, and what the next level would cost.
        metrics: names of those whose bars the accuracy limits; by default the scene's own.
        robust: takes the next safer settings where the run fails; `result.findings["tries"]` lists them. A
            climb takes the next preset anyway.
        time_limit: ends the run after this time [s], or for instance "20 s", whatever it does then; its
            status is `timeout`, and what it has recorded is kept.
        progress: called now and then with a `base.progress.Progress`, from the third second of a run on.
        test: settings of the test, for instance turns=1.

    Raises:
        InputError: no such scene, fidelity or metric, parameters that are not allowed, or a gear that cannot
            exist.

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
            scene,
            gear,
            fidelity,
            level=level,
            accuracy=accuracy,
            metrics=metrics,
            robust=robust,
            time_limit=limit,
        )


def simulate(
    scene: str,
    gear: SteeringGear,
    fidelity: str | Fidelity | None = None,
    *,
    level: int | None = None,
    accuracy: str | None = None,
    metrics: Sequence[str] | None = None,
    robust: bool = False,
    time_limit: TimeLimit | None = None,
) -> Result:
    """Simulate a scene of a gear; arguments as of `run`.

    Raises:
        InputError: no such scene or fidelity, or a gear or test that cannot exist.
    """
    if accuracy is not None:
        if level is not None:
            raise InputError("accuracy chooses the level itself; leave out level.")
        goal = AccuracyGoal.of(accuracy, metrics, fidelity)
        model = Fidelity.preset(goal.presets(scene_named(scene))[-1])
        climbing = partial(climb, scene, gear, goal, time_limit)
        return isolated_run(climbing, scene, gear, model, time_limit) if time_limit else climbing()
    if metrics is not None:
        raise InputError("metrics are those that accuracy keeps; give accuracy, or leave out metrics.")
    fidelity = "flank" if fidelity is None else fidelity
    chosen = fidelity if isinstance(fidelity, Fidelity) else Fidelity.preset(fidelity)
    options = DEFAULT_OPTIONS if level is None else RunOptions(level=valid_level(level, chosen))
    if time_limit is not None:
        plain = partial(simulate, scene, gear, chosen, level=level, robust=robust)
        return isolated_run(
            plain, scene, resolve_contact_law(gear, chosen, scene_named(scene).law), chosen, time_limit
        )
    if robust:
        return run_with_fallback(scene, gear, chosen, options)
    plan = Plan(scene, gear, chosen)
    return plan.refusal or plan.run(options)


def isolated_run(
    run: Callable[[], Result], scene: str, gear: SteeringGear, fidelity: Fidelity, limit: TimeLimit
) -> Result:
    """Make a run in another process until the limit is over: loading, compiling and settling count.

    The outcome is `timeout` if the time was over, with what was recorded until then; `crashed` if the process
    ended otherwise. Exudyn's own limit ends with a success flag, and some of its solvers never look at it.

    Raises:
        InputError: a gear or test that cannot exist.
        Interrupted: Ctrl-C; it carries what was recorded.
    """
    from rps_exudyn.simulate.cases.processes import Processes

    task = Task(run, begun=limit.begun)
    with Processes(1, limit.seconds) as processes:
        try:
            ((_, answer),) = processes.run(iter([task]))
        except KeyboardInterrupt:
            for _, answer in processes.interrupted():
                if answer.recorded is not None and answer.recorded.signals:
                    raise Interrupted(answer.recorded) from None
            raise
    if isinstance(answer.error, InputError):
        raise answer.error
    return answer.result(scene, gear, fidelity)
