"""A model played in Exudyn's own viewer."""

from pathlib import Path

from rps_exudyn.multibody.solve import SolverPlan, settings_of
from rps_exudyn.multibody.steering_model import SteeringModel


def solved(model: SteeringModel, seconds: float, steps: int, file: Path, frames: int) -> None:
    """Solve the model and write its coordinates to a file.

    Args:
        model: built, not yet assembled.
        seconds: length of the motion [s].
        steps: of the solver, at least.
        file: Exudyn's solution file.
        frames: that are written.
    """
    import exudyn as exu

    model.mbs.Assemble()
    settings = settings_of(SolverPlan(end_time=seconds, steps=steps))
    settings.solution.file.write = True
    settings.solution.file.name = str(file)
    settings.solution.file.writePeriod = seconds / frames
    model.mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.GeneralizedAlpha)


def played(model: SteeringModel, file: Path) -> None:
    """Open the player with the coordinates in Exudyn's solution file, until its window is closed."""
    from exudyn.interactive import SolutionViewer  # type: ignore[import-untyped, unused-ignore]
    from exudyn.utilities import LoadSolutionFile  # type: ignore[import-untyped, unused-ignore]

    SolutionViewer(model.mbs, LoadSolutionFile(str(file)))
