"""One way to run many cases: in this process, in processes beside it, on a cluster.

    tasks = [Task(partial(simulate, "free-pinion-torque", gear, "flank")) for gear in gears]
    for task, answer in run_cases(tasks, jobs=2):
        print(answer.returned().summary)

A task is a call. A time limit that is over, a process that ends and an error are answers; Ctrl-C ends the
iteration.
"""

import os
from collections.abc import Iterator, Sequence

from rps_exudyn.base.errors import InputError
from rps_exudyn.simulate.cases.processes import Processes
from rps_exudyn.simulate.cases.task import Answer, Task, answer_to

STARTING = 3.0  # [s] of CPU time until a process is ready, its kernels loaded
MOST_JOBS = 1024


class CaseRunner:
    """Does tasks here, or in `jobs` processes as soon as that is quicker; to be used in a `with` block.

    Processes stay for the next call. What earlier calls took is expected once more, so that many short calls
    start processes as a long one does.
    """

    def __init__(self, jobs: int = 1, time_limit: float = float("inf")) -> None:
        """`time_limit` is that of each task [s]."""
        self.jobs, self.time_limit = jobs, time_limit
        self._before = 0.0  # what earlier calls took here [s]
        self._processes: Processes | None = None

    def __enter__(self) -> "CaseRunner":
        return self

    def __exit__(self, *error: object) -> None:
        if self._processes is not None:
            self._processes.__exit__(*error)
        self.jobs, self._processes = 1, None

    def run(self, tasks: Sequence[Task], expected: float | None = None) -> Iterator[tuple[Task, Answer]]:
        """Do tasks; answers come in the order in which these end.

        Args:
            tasks: calls.
            expected: CPU time of all tasks [s]; None: what the first ones take is measured.

        Raises:
            InputError: one process after the other ends before it has done anything.
        """
        ahead, spent, done = iter(tasks), 0.0, 0
        while self._processes is None and (left := len(tasks) - done):
            if self.jobs > 1:
                seconds = self._before if expected is None else expected
                if expected is None and done:
                    seconds = max(seconds, spent / done * left)
                if seconds * (1 - 1 / self.jobs) > STARTING:
                    self._processes = Processes(self.jobs, self.time_limit)
                    break
            task = next(ahead)
            answer = answer_to(task, self.time_limit)
            spent, done = spent + answer.wall_s, done + 1
            yield task, answer
        self._before += spent
        if self._processes is not None:
            yield from self._processes.run(ahead)


def run_cases(
    tasks: Sequence[Task], jobs: int = 1, time_limit: float = float("inf"), expected: float | None = None
) -> Iterator[tuple[Task, Answer]]:
    """Do tasks by a `CaseRunner` of their own, whose arguments these are."""
    with CaseRunner(jobs, time_limit) as runner:
        yield from runner.run(tasks, expected)


def checked_jobs(jobs: int | None) -> int:
    """Return a number of processes; None stands for one for each processor of this process.

    Raises:
        InputError: it is not from 1 to `MOST_JOBS`.
    """
    jobs = available_processors() if jobs is None else jobs
    if not 1 <= jobs <= MOST_JOBS:
        raise InputError(f"--jobs is {jobs}; it must be a whole number from 1 to {MOST_JOBS}.")
    return jobs


def cpu_time() -> float:
    """Return the CPU time of this process and of all that it has started and seen ending [s]."""
    return sum(os.times()[:4])


def available_processors() -> int:
    """Return the number of processors that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except (AttributeError, OSError):
        return os.cpu_count() or 1
