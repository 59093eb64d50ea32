"""A task, the answer to it, and whoever does tasks.

    task = Task(partial(simulate, "free-pinion-torque", SteeringGear(), "quasi-static"))
    answer_to(task, time_limit=60.0).returned()

A time limit that is over and an error are answers, too.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from time import monotonic, process_time
from typing import Any, Protocol

from rps_exudyn.base.errors import InputError, raise_wrapped
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Interrupted, Status
from rps_exudyn.results.result import Result, failed
from rps_exudyn.simulate.cases.time_limit import alarm, place_of, sentence


@dataclass(frozen=True, eq=False)
class Task:
    """A call that an executor does."""

    # a function of a module, or a `functools.partial` of one; it goes to other processes
    call: Callable[[], Any]
    # the same for a small case: a new process makes it before the clock of its first task runs
    warm_up: Callable[[], Any] | None = None
    # instant of `time.monotonic` since when the task's time runs; None: since it is begun
    begun: float | None = None


_receiver: ContextVar[Callable[[Result], None] | None] = ContextVar("receiver", default=None)


@contextmanager
def handing_over(receiver: Callable[[Result], None]) -> Iterator[None]:
    """Give the receiver what calls in the block hand over before they return."""
    before = _receiver.set(receiver)
    try:
        yield
    finally:
        _receiver.reset(before)


def hand_over(best: Result) -> None:
    """Hand over the best result so far: it is kept where the process is ended."""
    if (receiver := _receiver.get()) is not None:
        receiver(best)


@dataclass(frozen=True)
class Answer:
    """What became of a task; times in seconds."""

    value: Any = None  # what the call returned
    error: Exception | None = None  # what it raised instead
    ended: str = ""  # where it was interrupted, or how its process ended; "" if the call returned or raised
    timeout: float = 0.0  # its time limit, where that was over; else 0
    recorded: Result | None = None  # what an interrupted run had recorded by then
    wall_s: float = 0.0  # elapsed time
    cpu_s: float = 0.0  # CPU time

    @property
    def failed_by_itself(self) -> bool:
        """Whether its time was over or the call raised; another process may have been ended from outside."""
        return bool(self.timeout) or self.error is not None

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

    def result(self, scene: str, gear: SteeringGear, fidelity: Fidelity) -> Result:
        """Return the result of a run, whatever became of it."""
        return self.failure(scene, gear, fidelity) if self.value is None else self.value

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


def answer_to(task: Task, time_limit: float = float("inf")) -> Answer:
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
