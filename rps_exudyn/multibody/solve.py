"""One guarded way to run Exudyn: every setting explicit, every outcome named.

`SolveDynamic` calls runs a success that blew up, lost the contact, or stopped early. Here a run is a
success only when it passes its own checks; the scene adds those that need its physics.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from time import process_time
from typing import Any

import exudyn as exu
import numpy as np

from rps_exudyn.base.errors import raise_wrapped
from rps_exudyn.results.outcome import Code, Outcome, Status

LARGEST_STATE = 1e6  # in SI: far beyond every coordinate and rate of a steering gear

RESTARTED = {Code.NO_STEP, Code.NOT_FINITE, Code.OUT_OF_BOUNDS, Code.RACK_OUT_OF_MESH}
MOST_RESTARTS = 12  # of a run ...
MOST_DIVISIONS = 3  # ... and about one place, each in a quarter of the steps and from twice as far back
RESTART_PARTS, RESTART_SPAN = 4, 8  # parts of a step, and planned steps before the place, at first
COUNTS = {
    "steps": "currentStepIndex",
    "newton_iterations": "newtonStepsCount",
    "jacobians": "newtonJacobiCount",
}
PATIENT = 40  # iterations of Newton's method in a restart: with friction near rest they converge slowly


class StepRefusedError(ArithmeticError):
    """Raised after a step that must be the last; it has the status and code of the run that ends."""

    def __init__(self, message: str, status: Status, code: Code) -> None:
        super().__init__(message)
        self.status, self.code = status, code


@dataclass(frozen=True)
class SolverPlan:
    """Everything that decides how Exudyn integrates."""

    end_time: float  # [s]
    steps: int
    start_time: float = 0.0  # [s]
    spectral_radius: float = 0.7
    absolute_tolerance: float = 0.01  # of Newton's method, on the root mean square of the residual [N, N m]
    relative_tolerance: float = 1e-12  # on the residual over that of the step's first guess
    max_iterations: int = 12  # then the step is halved; 20 take 5 to 8 % more time, in one swing twice
    contractivity: float = 0.5  # residual over that before, above which Newton's method takes a new Jacobian
    initial_accelerations: bool = True  # found from the forces at the start; without them 0
    discontinuous_tolerance: float = 1e-4
    adaptive_step: bool = True
    minimum_step: float = 1e-7  # [s]
    recovery_steps: int = 3  # that converge in shortened steps before these are lengthened again ...
    recovery_iterations: int = 12  # ... of Newton's method, which such a step may take

    @property
    def step(self) -> float:
        """Return the length of a step [s]."""
        return (self.end_time - self.start_time) / self.steps

    def as_dict(self) -> dict[str, Any]:
        """Return all settings by their names, for the result's file."""
        return {"name": "generalized-alpha", **asdict(self)}


def solve_one_after_another(
    mbs: exu.MainSystem,
    plans: Sequence[SolverPlan],
    rewind: Callable[[float], float] | None = None,
    begun: float = 0.0,
) -> Outcome:
    """Integrate by plans each of which begins where the one before ends, until one fails.

    Where no step converges, or a step leads out of all bounds or the rack out of its teeth, the run is
    restarted a few steps before, in shorter ones: a step may have skipped a snap. What fails there as well
    ends the run. The outcome counts all plans and the restarts; its settings are those of the first with all
    steps.

    `rewind` makes the last state kept at a time [s], or before, the initial one, and returns its time; plans
    are done up to `begun` [s].
    """
    outcomes: list[Outcome] = []
    ahead, restarts, divisions, shortened_to = _shortened(plans, begun, begun, 1), 0, 0, -np.inf
    while ahead:
        plan = ahead.pop(0)
        outcomes.append(solve(mbs, plan))
        if outcomes[-1].status is Status.OK:
            continue
        reached = outcomes[-1].time_reached
        divisions = divisions + 1 if reached <= shortened_to else 1
        hopeless = restarts == MOST_RESTARTS or divisions > MOST_DIVISIONS
        if rewind is None or hopeless or not RESTARTED.issuperset(outcomes[-1].codes):
            break
        restarts += 1
        step = next(each for each in plans if reached <= each.end_time * (1 + 1e-9)).step
        back = RESTART_SPAN * 2 ** (divisions - 1) * step
        shortened_to = reached + back
        ahead = _shortened(plans, rewind(reached - back), shortened_to, RESTART_PARTS**divisions)
    whole = replace(plans[0], end_time=plans[-1].end_time, steps=sum(plan.steps for plan in plans))
    counters = dict(sum((Counter(each.counters) for each in outcomes), Counter()))
    return replace(
        outcomes[-1],
        cpu_s=sum(each.cpu_s for each in outcomes),
        counters={**counters, "restarts": restarts} if restarts else counters,
        settings=whole.as_dict(),
    )


def _shortened(plans: Sequence[SolverPlan], begin: float, end: float, parts: int) -> list[SolverPlan]:
    """What is left of plans from a time [s] on, each step divided into parts up to another time."""
    pieces = []
    for plan in plans:
        for first, last, divided in ((plan.start_time, end, parts), (end, plan.end_time, 1)):
            first, last = max(first, begin, plan.start_time), min(last, plan.end_time)
            steps = int(np.ceil((last - first) / plan.step * divided * (1 - 1e-9)))
            if steps > 0:
                piece = replace(plan, start_time=first, end_time=last, steps=steps)
                pieces.append(piece if divided == 1 else replace(piece, max_iterations=PATIENT))
    return pieces


def solve(mbs: exu.MainSystem, plan: SolverPlan) -> Outcome:
    """Integrate an assembled system by generalised alpha with modified Newton.

    Never raises for a failed run: the outcome states what happened, and how far it got. Ctrl-C and the end of
    the process, which Exudyn takes for failures of a force, pass through.
    """
    start = process_time()
    message, code, cause, said = "", Code.NO_STEP, None, ""
    try:
        with silent():
            finished = bool(
                mbs.SolveDynamic(
                    settings_of(plan),
                    solverType=exu.DynamicSolverType.GeneralizedAlpha,
                    updateInitialValues=True,  # the next plan begins there
                )
            )
    except exu.ExudynError as error:
        finished, cause = False, error.__cause__  # what a force in Python raised, or None
        said = str(error).strip().partition("\n")[0]
        raise_wrapped(cause)
        if isinstance(cause, SystemExit):
            raise cause from None
    cpu = process_time() - start

    solver = mbs.sys.get("dynamicSolver")
    reached = float(mbs.systemData.GetTime())
    state = np.concatenate([mbs.systemData.GetODE2Coordinates(), mbs.systemData.GetODE2Coordinates_t()])
    if isinstance(cause, StepRefusedError):
        status, code, message = cause.status, cause.code, str(cause)
    elif not np.isfinite(state).all():
        status, code = Status.DIVERGED, Code.NOT_FINITE
        message = f"the state is not finite at {reached:.6g} s"
    elif np.abs(state).max() > LARGEST_STATE:
        status, code = Status.DIVERGED, Code.OUT_OF_BOUNDS
        message = f"a coordinate or rate is {np.abs(state).max():.3g} at {reached:.6g} s"
    elif cause is not None:
        status, code = Status.NO_CONVERGENCE, Code.FORCE_FAILED
        message = f"{type(cause).__name__} at {reached:.6g} s: {cause}"
    elif not finished:
        status = Status.NO_CONVERGENCE
        message = f"no step down to {plan.minimum_step:g} s converged at {reached:.6g} s"
        if said:  # after an iteration that ran away to numbers that no Jacobian has
            message = f"Exudyn stopped at {reached:.6g} s: {said}"
    elif reached < plan.end_time * (1 - 1e-9):
        status, code = Status.TIMEOUT, Code.INTERRUPTED
        message = f"stopped at {reached:.6g} s of {plan.end_time:.6g} s"
    else:
        status = Status.OK
    counters = {name: int(getattr(solver.it, count)) for name, count in COUNTS.items()} if solver else {}
    return Outcome(
        status,
        message,
        (code,) if message else (),
        time_reached=reached,
        cpu_s=cpu,
        counters=counters,
        settings=plan.as_dict(),
    )


@contextmanager
def silent() -> Iterator[None]:
    """Keep Exudyn off the console: the outcome states what a failure means."""
    before = exu.config.printToConsole, exu.config.suppressWarnings
    exu.config.printToConsole, exu.config.suppressWarnings = False, True
    try:
        yield
    finally:
        exu.config.printToConsole, exu.config.suppressWarnings = before


def settings_of(plan: SolverPlan) -> exu.SimulationSettings:
    """Translate a plan into Exudyn's settings. What decides a result is set here even where it is the
    default: defaults change between releases."""
    settings = exu.SimulationSettings()
    settings.parallel.numberOfThreads = 1
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = plan.step

    time = settings.timeIntegration
    time.startTime, time.endTime, time.numberOfSteps = plan.start_time, plan.end_time, plan.steps
    time.adaptiveStep, time.minimumStepSize = plan.adaptive_step, plan.minimum_step
    time.adaptiveStepRecoverySteps = plan.recovery_steps
    time.adaptiveStepRecoveryIterations = plan.recovery_iterations
    time.stepInformation = time.verboseMode = 0
    time.computeLoadsJacobian = 0
    time.generalizedAlpha.spectralRadius = plan.spectral_radius
    time.generalizedAlpha.useNewmark = time.generalizedAlpha.useIndex2Constraints = False
    time.generalizedAlpha.computeInitialAccelerations = plan.initial_accelerations

    newton = time.newton
    newton.useModifiedNewton = True
    newton.maxIterations, newton.modifiedNewtonContractivity = plan.max_iterations, plan.contractivity
    newton.relativeTolerance, newton.absoluteTolerance = plan.relative_tolerance, plan.absolute_tolerance
    newton.numericalDifferentiation.doSystemWideDifferentiation = False
    newton.numericalDifferentiation.forODE2 = False

    time.discontinuous.iterationTolerance = plan.discontinuous_tolerance
    time.discontinuous.maxIterations = 5
    time.discontinuous.ignoreMaxIterations = True
    return settings
