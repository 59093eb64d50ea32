"""Make a run again, finer each time, until it asks for no more or the finer one changes nothing.

    refined = refine(run, finer, 4, asks=needs_shorter_steps)               # by its own record
    refined = refine(run, finer, 2, change=difference, allowed=0.01)        # the finer run confirms it

What is finer is up to the caller: halved steps, finer strips, a longer approach, safer settings.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

Run = TypeVar("Run")


@dataclass(frozen=True)
class Refined(Generic[Run]):
    """Runs of one plan, each finer than the one before.

    Attributes:
        runs: those that can be used, the coarsest first.
        failed: a finer run that cannot be used, which ended the refinement.
        change: by how much the last refinement changed the run; nan if that was not looked at.
        confirmed: whether that is no more than allowed.
    """

    runs: tuple[Run, ...]
    failed: Run | None = None
    change: float = float("nan")
    confirmed: bool = False

    @property
    def finest(self) -> Run:
        """The last run that can be used."""
        return self.runs[-1]

    @property
    def times(self) -> int:
        """How often the first run was refined."""
        return len(self.runs) - 1


def refine(
    first: Run,
    finer: Callable[[Run, int], Run],
    most: int,
    *,
    usable: Callable[[Run], bool] = lambda run: True,
    asks: Callable[[Run], bool] = lambda run: True,
    change: Callable[[Run, Run], float] | None = None,
    allowed: float = 0.0,
) -> Refined[Run]:
    """Refine a run at most so many times.

    Args:
        first: the coarsest run; it is not refined if it cannot be used.
        finer: (run, how often the first was refined then) -> the run after it.
        most: refinements.
        usable: whether a run can be used.
        asks: whether a run's own record asks for a finer one.
        change: (run, finer one) -> by how much they differ; without it nothing confirms a run.
        allowed: change by which the coarser run is confirmed.
    """
    runs = [first]
    for times in range(1, most + 1):
        if not (usable(runs[-1]) and asks(runs[-1])):
            break
        runs.append(finer(runs[-1], times))
        if not usable(runs[-1]):
            return Refined(tuple(runs[:-1]), failed=runs[-1])
        if change is not None:
            changed = change(runs[-2], runs[-1])
            if changed <= allowed or times == most:
                return Refined(tuple(runs), change=changed, confirmed=changed <= allowed)
    return Refined(tuple(runs))
