"""Tasks in processes of their own, each with a hard time limit; no process can harm more than its task.

A task whose time is over is interrupted by its own process; where that does not answer, it is ended `GRACE`
later. A process is started once and given many tasks, because starting one costs seconds; cheap ones several
at a time. It has its own pipes and shares no lock with the others: it may be killed at any instant.
"""

import contextlib
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import monotonic
from typing import IO

from rps_exudyn.base.child_process import child_environment
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.progress import Making, Progress, passed_on, publish
from rps_exudyn.results.result import Result
from rps_exudyn.simulate.cases.frames import frame_of, frames_in
from rps_exudyn.simulate.cases.task import Answer, Task
from rps_exudyn.simulate.cases.time_limit import GRACE

START_LIMIT = 900.0  # [s] until a process must be ready, all its machine code made
FAILED_STARTS = 8  # in a row, after which no more are made ...
FIRST_PAUSE, LONGEST_PAUSE = 0.25, 10.0  # [s] ... with pauses between them that double
ATTEMPTS = 2  # at a task whose process dies: it may have been killed from outside
BATCH_SECONDS = 0.5  # of work handed over at once
LARGEST_BATCH = 32
COMPILING = "while force laws were compiled, which later runs do not repeat"
HANDING_OVER = 5.0  # [s] for an interrupted run to hand over what it has recorded
RUNNING = "in compiled code"  # where a process is that does not hear its alarm


class StartError(InputError):
    """Raised where one process after the other ends before it has done anything."""


@dataclass(eq=False)
class _Worker:
    """One process, and the tasks it has been given."""

    process: subprocess.Popen[bytes]
    tasks: deque[Task] = field(default_factory=deque)
    ready: bool = False
    place: str = "while libraries were loaded"
    since: float = field(default_factory=monotonic)  # the clock of its start, or of its first task
    cpu_before: float = 0.0  # CPU time when it began its first task [s]
    best: Result | None = None  # of its first task, so far

    def give(self, tasks: list[Task], time_limit: float) -> None:
        """Hand over tasks, each for at most so many seconds."""
        if not self.tasks:
            self.since, self.cpu_before = monotonic(), cpu_of(self.process.pid)
        self.tasks.extend(tasks)
        self.write(b"".join(frame_of((task, time_limit)) for task in tasks))

    def write(self, frames: bytes) -> None:
        """Write to its standard input."""
        assert self.process.stdin
        with contextlib.suppress(OSError, ValueError):  # it died, which its reader reports, or was ended
            self.process.stdin.write(frames)
            self.process.stdin.flush()

    def end(self) -> None:
        """Kill it and wait until it is gone."""
        self.process.kill()
        self.process.wait()
        assert self.process.stdin
        with contextlib.suppress(OSError):  # what it can no longer read
            self.process.stdin.close()


class Processes:
    """So many processes that do tasks; use it in a `with` block, which ends them."""

    group_seconds = 2.0

    def __init__(self, workers: int, time_limit: float, messages: Path | None = None) -> None:
        """`time_limit` is that of a task [s]; what the processes print goes to the file `messages`."""
        from rps_exudyn.base.kernel_code import object_files  # with LLVM, which formulas do without

        self.workers = workers
        self.time_limit = time_limit
        self._messages = messages
        self._running: list[_Worker] = []
        self._events: queue.SimpleQueue[tuple[_Worker | None, bytes | None]] = queue.SimpleQueue()
        self._tasks: Iterator[Task] = iter(())
        self._again: deque[Task] = deque()  # to be done before these
        self._attempts: dict[Task, int] = {}
        self._failed_starts = 0
        self._next_start = 0.0  # when one may be started again
        self._cost = BATCH_SECONDS  # running mean of what a task takes [s]
        self._compiled = workers == 1 or bool(object_files())  # before this process makes any itself
        self.is_cancelled = False

    def __enter__(self) -> "Processes":
        return self

    def __exit__(self, *_: object) -> None:
        while self._running:
            self._running.pop().end()

    def run(self, tasks: Iterator[Task]) -> Iterator[tuple[Task, Answer]]:
        """Do tasks; see `Executor`.

        Raises:
            StartError: processes end before they are ready.
        """
        self._tasks = tasks
        while self._next_task() or any(worker.tasks for worker in self._running):
            if self.is_cancelled:
                self.__exit__()
                return
            self._hand_out()
            try:
                event = self._events.get(timeout=self._until_deadline())
            except queue.Empty:
                yield from self._out_of_time()
            else:
                yield from self._happened(*event)

    def cancel(self) -> None:
        """End what `run` does, which another thread iterates; these processes do nothing any more."""
        self.is_cancelled = True
        self._events.put((None, None))

    def interrupted(self) -> Iterator[tuple[Task, Answer]]:
        """Pass Ctrl-C on to the processes; yield what their tasks hand over within `HANDING_OVER`."""
        for worker in self._running:
            with contextlib.suppress(OSError, ValueError):  # Windows sends Ctrl-C to them itself
                worker.process.send_signal(signal.SIGINT)
        end = monotonic() + HANDING_OVER
        while any(worker.tasks for worker in self._running) and monotonic() < end:
            with contextlib.suppress(queue.Empty):
                yield from self._happened(*self._events.get(timeout=max(end - monotonic(), 0.001)))

    def _next_task(self) -> Task | None:
        """Return the next task, left where it is: those to be done again first."""
        if not self._again and (task := next(self._tasks, None)) is not None:
            self._again.append(task)
        return self._again[0] if self._again else None

    def _give(self, worker: _Worker, most: int) -> None:
        """Hand the next tasks over to a process."""
        taken: list[Task] = []
        while len(taken) < most and self._next_task():
            taken.append(self._again.popleft())
        worker.give(taken, self.time_limit)

    def _hand_out(self) -> None:
        """Keep every process busy, and start one more if there is work for it.

        The first one starts before the others, until machine code is made, so that this is done once.
        """
        for worker in self._running:
            if worker.ready and len(worker.tasks) <= self._batch // 2 and self._next_task():
                self._give(worker, self._batch - len(worker.tasks))
        missing = self.workers - len(self._running) if self._compiled else 1 - len(self._running)
        for _ in range(missing):
            if monotonic() < self._next_start or (first := self._next_task()) is None:
                return
            self._start(first)
            if first.begun is not None:  # its time runs already: it does not wait until the process is ready
                self._give(self._running[-1], 1)

    @property
    def _batch(self) -> int:
        return max(1, min(LARGEST_BATCH, int(BATCH_SECONDS / self._cost)))

    def _start(self, first: Task) -> None:
        messages: IO[bytes] | int = subprocess.DEVNULL
        if self._messages:
            messages = self._messages.open("ab")
        try:
            process = subprocess.Popen(
                [sys.executable, "-P", "-X", "faulthandler", "-m", "rps_exudyn.simulate.cases.worker"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=messages,
                env=child_environment(),
                start_new_session=True,  # Ctrl-C is for whoever started it
            )
        finally:
            if not isinstance(messages, int):
                messages.close()
        worker = _Worker(process)
        self._running.append(worker)
        threading.Thread(target=self._listen, args=(worker,), daemon=True).start()
        worker.write(frame_of(first.warm_up))

    def _listen(self, worker: _Worker) -> None:
        """Queue the messages of one process, and None when it has ended; runs in a thread of its own."""
        assert worker.process.stdout
        with worker.process.stdout as output, contextlib.suppress(ValueError, OSError):
            for frame in frames_in(output):
                self._events.put((worker, frame))
        self._events.put((worker, None))

    def _happened(self, worker: _Worker | None, frame: bytes | None) -> Iterator[tuple[Task, Answer]]:
        if worker is None or worker not in self._running:
            return
        if frame is None:
            yield from self._ended(worker)
            return
        match pickle.loads(frame):
            case Answer() as answer:
                yield self._answered(worker, answer)
            case Making() as step:
                worker.place = COMPILING if step.sentence else RUNNING
                publish(step)
            case Progress() as progress:
                if self.workers == 1:  # of several tasks at the same time none stands for all
                    passed_on(progress)
            case "begun":
                worker.place, worker.best = RUNNING, None
            case Result() as result:
                worker.best = result
            case "ready":
                worker.ready = self._compiled = True
                self._failed_starts = 0

    def _answered(self, worker: _Worker, answer: Answer) -> tuple[Task, Answer]:
        task, now = worker.tasks.popleft(), monotonic()
        self._attempts.pop(task, None)
        wall, worker.since = now - worker.since, now
        worker.cpu_before = cpu_of(worker.process.pid)
        self._cost += 0.2 * (wall - self._cost)
        if answer.timeout:  # of what was interrupted nothing shall be left in it
            self._remove(worker)
            self._again.extendleft(reversed(worker.tasks))
        return task, answer

    def _deadline(self, worker: _Worker) -> float:
        if worker.tasks and (begun := worker.tasks[0].begun) is not None:
            return begun + self.time_limit + GRACE
        if not worker.ready:
            return worker.since + START_LIMIT
        return worker.since + self.time_limit + GRACE if worker.tasks else float("inf")

    def _until_deadline(self) -> float:
        begins = [self._next_start] if len(self._running) < self.workers else []
        ahead = [*(self._deadline(worker) for worker in self._running), *begins]
        nearest = min((instant for instant in ahead if instant > 0), default=0.0)
        return min(max(nearest - monotonic(), 0.001), 3600.0)

    def _out_of_time(self) -> Iterator[tuple[Task, Answer]]:
        for worker in list(self._running):
            if monotonic() < self._deadline(worker):
                continue
            cpu = cpu_of(worker.process.pid) - worker.cpu_before
            self._remove(worker)
            if worker.tasks:
                task = worker.tasks.popleft()
                self._again.extendleft(reversed(worker.tasks))
                wall = monotonic() - (worker.since if task.begun is None else task.begun)
                ended = worker.place if worker.best is None else worker.best.message
                answer = Answer(ended=ended, timeout=self.time_limit, wall_s=wall, cpu_s=cpu)
                yield task, replace(answer, recorded=worker.best)
            else:
                self._count_failed_start("is not ready")

    def _ended(self, worker: _Worker) -> Iterator[tuple[Task, Answer]]:
        """The process died: the task it was at is tried once more, those behind it were not begun."""
        self._remove(worker)
        how = how_it_ended(worker.process.returncode)
        if not worker.ready:
            self._count_failed_start(how)
        if not worker.tasks:
            return
        culprit = worker.tasks.popleft()
        self._again.extendleft(reversed(worker.tasks))
        attempts = self._attempts[culprit] = self._attempts.get(culprit, 0) + 1
        if attempts < ATTEMPTS:
            self._again.appendleft(culprit)
        else:
            yield culprit, Answer(ended=how, wall_s=monotonic() - worker.since)

    def _remove(self, worker: _Worker) -> None:
        self._running.remove(worker)
        worker.end()

    def _count_failed_start(self, how: str) -> None:
        self._failed_starts += 1
        if self._failed_starts >= FAILED_STARTS:
            where = f"; {self._messages} holds their output" if self._messages else ""
            raise StartError(
                f"{FAILED_STARTS} processes in a row ended before they had done anything ({how}){where}."
            )
        self._next_start = monotonic() + min(FIRST_PAUSE * 2**self._failed_starts, LONGEST_PAUSE)


def cpu_of(pid: int) -> float:
    """Return the CPU time of a process that runs [s]; 0 where the system does not report it."""
    try:
        ticks = Path(f"/proc/{pid}/stat").read_text("utf-8").rpartition(")")[2].split()[11:13]
        return sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")
    except (OSError, ValueError, AttributeError):
        return 0.0


def how_it_ended(code: int | None) -> str:
    """Return how a process ended, by its exit code."""
    if code is None or code >= 0:
        return f"its process ended with status {code}"
    try:
        return f"its process was ended by {signal.Signals(-code).name}"
    except ValueError:
        return f"its process was ended by signal {-code}"
