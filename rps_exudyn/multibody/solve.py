"""One guarded way to run Exudyn: every setting explicit, every outcome named.

`SolveDynamic` calls runs a success that blew up, lost the contact, or stopped early. Here a run is a
success only when it passes its own checks; the scene adds those that need its physics.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING, Any

import numpy as np

from rps_exudyn.base.errors import InputError, raise_wrapped
from rps_exudyn.multibody.steering_model import SteeringModel
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Outcome, Status

if TYPE_CHECKING:
    import exudyn


LARGEST_STATE = 1e6  # in SI: far beyond every coordinate and rate of a steering gear


class StepsUsedUpError(ArithmeticError):
    """Raised after a step where a run goes on in ever shorter ones, and would hardly end."""


@dataclass(frozen=True)
class SolverPlan:
    """Everything that decides how Exudyn integrates."""

    end_time: float  # [s]
    steps: int
    start_time: float = 0.0  # [s]
    spectral_radius: float = 0.7
    absolute_tolerance: float = 0.01  # of Newton's method, on the root mean square of the residual [N, N m]
    relative_tolerance: float = 1e-12  # on the residual over that of the step's first guess
    max_iterations: int = 20
    contractivity: float = 0.5  # residual over that before, above which Newton's method takes a new Jacobian
    initial_accelerations: bool = True  # found from the forces at the start; without them 0
    discontinuous_tolerance: float = 1e-4
    adaptive_step: bool = True
    minimum_step: float = 1e-7  # [s]
    recovery_steps: int = 3  # that converge in shortened steps before these are lengthened again ...
    recovery_iterations: int = 12  # ... of Newton's method, which such a step may take

    def as_dict(self) -> dict[str, Any]:
        """Return all settings by their names, for the result's file."""
        return {"name": "generalized-alpha", **asdict(self)}


def solve_one_after_another(mbs: "exudyn.MainSystem", plans: Sequence[SolverPlan]) -> Outcome:
    """Integrate by plans each of which begins where the one before ends, until one fails.

    The outcome counts them all; its settings are those of the first with all steps.
    """
    outcomes: list[Outcome] = []
    for plan in plans:
        outcomes.append(solve(mbs, plan))
        if outcomes[-1].status is not Status.OK:
            break
    whole = replace(plans[0], end_time=plans[-1].end_time, steps=sum(plan.steps for plan in plans))
    return replace(
        outcomes[-1],
        cpu_s=sum(each.cpu_s for each in outcomes),
        counters=dict(sum((Counter(each.counters) for each in outcomes), Counter())),
        settings=whole.as_dict(),
    )


def solve(mbs: "exudyn.MainSystem", plan: SolverPlan) -> Outcome:
    """Integrate an assembled system by generalised alpha with modified Newton.

    Never raises for a failed run: the outcome states what happened, and how far it got. Ctrl-C and the end of
    the process, which Exudyn takes for failures of a force, pass through.
    """
    import exudyn as exu

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
    if not np.isfinite(state).all():
        status, code = Status.DIVERGED, Code.NOT_FINITE
        message = f"the state is not finite at {reached:.6g} s"
    elif np.abs(state).max() > LARGEST_STATE:
        status, code = Status.DIVERGED, Code.OUT_OF_BOUNDS
        message = f"a coordinate or rate is {np.abs(state).max():.3g} at {reached:.6g} s"
    elif cause is not None:
        named = "" if isinstance(cause, StepsUsedUpError) else f"{type(cause).__name__} at {reached:.6g} s: "
        status, message = Status.NO_CONVERGENCE, f"{named}{cause}"
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
    counters = (
        {
            "steps": int(solver.it.currentStepIndex),
            "newton_iterations": int(solver.it.newtonStepsCount),
            "jacobians": int(solver.it.newtonJacobiCount),
        }
        if solver
        else {}
    )
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
    import exudyn as exu

    before = exu.config.printToConsole, exu.config.suppressWarnings
    exu.config.printToConsole, exu.config.suppressWarnings = False, True
    try:
        yield
    finally:
        exu.config.printToConsole, exu.config.suppressWarnings = before


def settings_of(plan: SolverPlan) -> "exudyn.SimulationSettings":
    """Translate a plan into Exudyn's settings. What decides a result is set here even where it is the
    default: defaults change between releases."""
    import exudyn as exu

    settings = exu.SimulationSettings()
    settings.parallel.numberOfThreads = 1
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = (plan.end_time - plan.start_time) / plan.steps

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


# --- The gear in Exudyn's own viewer: solved anew, then played until the window is closed

FRAMES, STEPS_PER_SECOND = 200, 500


def solved_model(gear: SteeringGear, fidelity: Fidelity, file: Path) -> SteeringModel:
    """Turn the gear by its test, and write the motion to Exudyn's solution file.

    Raises:
        InputError: no equilibrium to start from.
    """
    import exudyn as exu

    from rps_exudyn.multibody.model import build_model

    model = build_model(gear, fidelity)
    if not model.start.converged:
        raise InputError("There is no equilibrium to start from; change preload or clearance.")
    model.mbs.Assemble()
    seconds = 2 * np.pi * gear.test.turns / gear.test.speed
    settings = settings_of(SolverPlan(end_time=seconds, steps=int(np.ceil(STEPS_PER_SECOND * seconds))))
    settings.solution.file.write = True
    settings.solution.file.name = str(file)
    settings.solution.file.writePeriod = seconds / FRAMES
    model.mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.GeneralizedAlpha)
    return model


def play(model: SteeringModel, file: Path) -> None:
    """Open the player with the coordinates in Exudyn's solution file, until its window is closed."""
    from exudyn.interactive import SolutionViewer  # type: ignore[import-untyped, unused-ignore]
    from exudyn.utilities import LoadSolutionFile  # type: ignore[import-untyped, unused-ignore]

    SolutionViewer(model.mbs, LoadSolutionFile(str(file)))


# --- Newton's method where friction turns about within a step
PLAIN_TANGENTS = 2  # in one time step, before the next ones are corrected
KEPT = 24  # evaluations of a time step that may correct them


class Secant:
    """Broyden's correction of the tangents in a time step that Newton's method does not solve at once.

    Where friction turns about within one iteration, tangents of both sides lead to and fro without end. With
    the change dF of force between the last place and an earlier one of the step, x apart, the tangent becomes

        T + (dF - T x) (W x)' / (x' W x),        W = |diag T|

    (C. G. Broyden, Math. Comp. 19 (1965), 577, in coordinates scaled by their own stiffnesses): with that one
    against which forces resist most, and only if they resist more than by the tangent.
    """

    def __init__(self) -> None:
        self.time, self.tangents = np.nan, 0
        self.rates: list[np.ndarray] = []
        self.forces: list[np.ndarray] = []

    def noted(self, time: float, rates: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """Keep the forces (n,) at rates (n,) in the step that ends at a time [s]; return them."""
        if time != self.time:
            self.time, self.tangents = time, 0
            self.rates, self.forces = [], []
        self.rates, self.forces = [*self.rates[-KEPT:], rates], [*self.forces[-KEPT:], forces]
        return forces

    def corrected(self, tangent: np.ndarray, time: float, factor_v: float) -> np.ndarray:
        """Return the tangent (n, n) where the forces were found last, by the iteration's unknowns, of which
        one unit changes a rate by `factor_v`."""
        self.tangents += 1
        if self.tangents <= PLAIN_TANGENTS or time != self.time or len(self.rates) < 2:
            return tangent
        moves = (self.rates[-1] - np.array(self.rates[:-1])) / factor_v
        changes = self.forces[-1] - np.array(self.forces[:-1])
        sizes = moves**2 @ np.abs(np.diag(tangent))
        known = np.isfinite(changes).all(axis=1) & (sizes > 0) & (sizes < np.inf)
        if not known.any():
            return tangent
        moves, changes, sizes = moves[known], changes[known], sizes[known]
        k = int(np.argmin(np.einsum("ij,ij->i", moves, changes) / sizes))
        move, lacking = moves[k], changes[k] - tangent @ moves[k]
        if move @ lacking >= 0:
            return tangent
        return np.asarray(tangent + np.outer(lacking, np.abs(np.diag(tangent)) * move / sizes[k]))
