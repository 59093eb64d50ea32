"""How often tests must be run until preload and friction of the teeth are known as well as is wanted.

Repeats help twice: the scatter of a mean falls with the root of their number, and from three runs on they
measure the scatter themselves, whose Student's t then counts instead of what is declared.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from rps_exudyn.fitting.noise import FEWEST_RUNS

WANTED = {"yoke.preload": 0.05, "mesh.friction": 0.15}
"""Path -> half of the 95 % interval that is wanted, of the value."""

MOST_RUNS = 30  # that a bench may be asked for


@dataclass(frozen=True)
class MoreRuns:
    """What repeats of all tests would reach."""

    now: Mapping[str, float]  # path -> half of the 95 % interval, of the value, as it is
    runs: Mapping[
        str, int | None
    ]  # path -> runs of each test for what is wanted; None: more than `MOST_RUNS`


def more_runs(
    halves: Mapping[str, float], runs: int, tests: int, deviations: Callable[[int], Mapping[str, float]]
) -> MoreRuns | None:
    """Return what repeats would reach; None where all that is wanted is reached.

    Args:
        halves: path -> half of the 95 % interval as it is, of the value.
        runs: of each test that there are.
        tests: number of tests.
        deviations: of the logarithms after so many runs of each test.
    """
    missed = {path: half for path, half in halves.items() if half > WANTED[path]}
    if not missed:
        return None
    needed: dict[str, int | None] = dict.fromkeys(missed)
    for count in range(max(runs + 1, FEWEST_RUNS), MOST_RUNS + 1):
        expected = deviations(count)
        for path in missed:
            if needed[path] is None and students(tests * (count - 1)) * expected[path] <= WANTED[path]:
                needed[path] = count
        if all(needed.values()):
            break
    return MoreRuns(missed, needed)


def students(freedom: int) -> float:
    """Return the quantile of 97.5 % of Student's t."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.975))
