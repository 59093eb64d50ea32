"""One way to run many cases: in this process, in processes beside it, on a cluster.

    tasks = [Task(partial(simulate, "free-pinion-torque", gear, "flank")) for gear in gears]
    for task, answer in run_cases(tasks, jobs=2):
        print(answer.returned().summary)

A task is a call, and an executor does tasks: `Here`, `Processes` or `Cluster`. With each of them a time limit
that is over, a process that ends and an error are answers; Ctrl-C ends the iteration.
"""

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from time import monotonic, process_time
from typing import TYPE_CHECKING, Any, Protocol

from rps_exudyn.base.errors import InputError, raise_wrapped
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Interrupted, Status
from rps_exudyn.results.result import Result, failed
from rps_exudyn.simulate.cases.time_limit import alarm, place_of, sentence

if TYPE_CHECKING:
    from rps_exudyn.simulate.cases.processes import Processes

STARTING = 3.0  # [s] of CPU time until a process is ready, its kernels loaded
MOST_JOBS = 1024


@dataclass(frozen=True, eq=False)
class Task:
    """A call that an executor does.

    Attributes:
        call: a function of a module, or a `functools.partial` of one; it goes to other processes.
        warm_up: the same for a small case: a new process makes it before the clock of its first task runs.
        begun: instant of `time.monotonic` since when the task's time runs; None: since it is begun.
    """

    call: Callable[[], Any]
    warm_up: Callable[[], Any] | None = None
    begun: float | None = None


@dataclass(frozen=True)
class Answer:
    """What became of a task; times in seconds.

    Attributes:
        value: what the call returned.
        error: what it raised instead.
        ended: where it was interrupted, or how its process ended; "" if the call returned or raised.
        timeout: its time limit, where that was over; else 0.
        recorded: what an interrupted run had recorded by then.
        wall_s: elapsed time.
        cpu_s: CPU time.
    """

    value: Any = None
    error: Exception | None = None
    ended: str = ""
    timeout: float = 0.0
    recorded: Result | None = None
    wall_s: float = 0.0
    cpu_s: float = 0.0

    def returned(self) -> Any:
        """Return the value of the call.

        Raises:
            Exception: what the call raised.
            InputError: it did not end.
        """
        if self.error is not None:
            raise self.error
        if self.ended:
            raise InputError(f"a run did not end: {self.ended}.")
        return self.value

    def failure(self, scene: str, gear: SteeringGear, fidelity: Fidelity) -> Result:
        """Return the result of a run that returned none: its status, its cause, and what was recorded."""
        status, message = Status.CRASHED, self.ended
        if self.timeout:
            status, message = Status.TIMEOUT, sentence(self.timeout, self.ended, self.cpu_s, self.wall_s)
        elif self.recorded is not None:
            status = self.recorded.status
        elif isinstance(self.error, InputError):  # a gear that cannot be built, a test that leaves the rack
            status, message = Status.INVALID, " ".join(self.error.problems)
        elif self.error is not None:
            message = f"{type(self.error).__name__}: {self.error}"
        if self.recorded is not None:
            return replace(self.recorded, message=message, cpu_s=self.cpu_s, wall_s=self.wall_s)
        return failed(scene, gear, fidelity, status, message, self.cpu_s, self.wall_s)


class Executor(Protocol):
    """Whoever does tasks."""

    @property
    def workers(self) -> int:
        """How many tasks are done at the same time."""

    @property
    def group_seconds(self) -> float:
        """Work that is worth a task of its own [s]."""

    def run(self, tasks: Iterator[Task]) -> Iterator[tuple[Task, Answer]]:
        """Do tasks, taken from the iterator as needed; answers come in the order in which the tasks end."""


def answer_to(task: Task, time_limit: float) -> Answer:
    """Do a task in this process; the time limit in seconds.

    Raises:
        Interrupted: Ctrl-C during a run that had recorded something.
        KeyboardInterrupt: Ctrl-C otherwise.
    """
    begun, cpu = monotonic() if task.begun is None else task.begun, process_time()
    answer = Answer()
    try:
        with alarm(begun + time_limit - monotonic()):
            answer = Answer(task.call())
    except KeyboardInterrupt as interrupt:
        if monotonic() - begun < time_limit:
            raise
        if isinstance(interrupt, Interrupted):
            answer = Answer(ended=interrupt.recorded.message, timeout=time_limit, recorded=interrupt.recorded)
        else:
            answer = Answer(ended=f"interrupted {place_of(interrupt.__traceback__)}", timeout=time_limit)
    except Exception as error:
        raise_wrapped(error)
        answer = Answer(error=error)
    return replace(answer, wall_s=monotonic() - begun, cpu_s=process_time() - cpu)


@dataclass(frozen=True)
class Here:
    """Does tasks one after the other in this process, each for at most so many seconds."""

    time_limit: float = float("inf")
    workers: int = 1
    group_seconds: float = 2.0

    def run(self, tasks: Iterator[Task]) -> Iterator[tuple[Task, Answer]]:
        """Do tasks; see `Executor`."""
        for task in tasks:
            yield task, answer_to(task, self.time_limit)


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
                    from rps_exudyn.simulate.cases.processes import Processes

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


def available_processors() -> int:
    """Return the number of processors that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except (AttributeError, OSError):
        return os.cpu_count() or 1
