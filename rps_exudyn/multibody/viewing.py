"""A model played in Exudyn's own viewer."""

from pathlib import Path

from rps_exudyn.multibody.solve import SolverPlan, settings_of
from rps_exudyn.multibody.steering_model import SteeringModel


def played(model: SteeringModel, seconds: float, steps: int, file: Path, frames: int) -> None:
    """Solve the model, its coordinates written to `file`, and open the player with them.

    Args:
        model: built, not yet assembled.
        seconds: length of the motion [s].
        steps: of the solver, at least.
        file: Exudyn's solution file.
        frames: that are written.
    """
    import exudyn as exu
    from exudyn.interactive import SolutionViewer  # type: ignore[import-untyped, unused-ignore]
    from exudyn.utilities import LoadSolutionFile  # type: ignore[import-untyped, unused-ignore]

    model.mbs.Assemble()
    settings = settings_of(SolverPlan(end_time=seconds, steps=steps))
    settings.solution.file.write = True
    settings.solution.file.name = str(file)
    settings.solution.file.writePeriod = seconds / frames
    model.mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.GeneralizedAlpha)
    SolutionViewer(model.mbs, LoadSolutionFile(str(file)))
