"""Cases in processes of their own, each with a hard time limit; no process can harm more than its case.

A case whose time is over is interrupted by its own process, which answers with what was recorded; where it
does not, its process is ended `GRACE` later.

A process is started once and given many cases, because starting one costs seconds. It has its own pipes and
shares nothing, no lock, with the others, so that it may be killed at any instant. Cheap cases are handed over
several at a time, which the processes answer one by one: the clock runs for each case alone.
"""

import contextlib
import json
import os
import queue
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import IO, Any

from rps_exudyn.base.compiling import Step, publish
from rps_exudyn.base.errors import InputError
from rps_exudyn.simulate.time_limit import GRACE

START_LIMIT = 900.0  # [s] until a process must be ready, all its kernels compiled
FAILED_STARTS = 8  # in a row, after which no more are made ...
FIRST_PAUSE, LONGEST_PAUSE = 0.25, 10.0  # [s] ... with pauses between them that double
ATTEMPTS = 2  # at a case whose process dies: it may have been killed from outside
BATCH_SECONDS = 0.5  # of work handed over at once
LARGEST_BATCH = 32
PINNED = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "NUMEXPR_NUM_THREADS",
    "NUMBA_NUM_THREADS",
)

Task = Mapping[str, Any]
"""What `worker` understands, and "hash"."""


@dataclass(frozen=True)
class Done:
    """A case that was answered, or whose process came to an end over it."""

    task: Task
    answer: Mapping[str, Any] | None  # None: no answer came
    ended: str = ""  # then how the process ended
    timeout: bool = False
    wall_s: float = 0.0
    cpu_s: float = 0.0


class StorageError(InputError):
    """Raised where a result could not be written, so that there is no use in going on."""


class StartError(InputError):
    """Raised where one process after the other ends before it has done anything."""


@dataclass(eq=False)
class _Worker:
    """One process, and the cases it has been given."""

    process: subprocess.Popen[str]
    tasks: deque[Task] = field(default_factory=deque)
    ready: bool = False
    since: float = field(default_factory=monotonic)  # the clock of its start, or of its first task
    cpu_before: float = 0.0  # CPU time when it began its first task [s]

    def give(self, tasks: list[Task]) -> None:
        """Hand over cases."""
        if not self.tasks:
            self.since, self.cpu_before = monotonic(), cpu_of(self.process.pid)
        self.tasks.extend(tasks)
        with contextlib.suppress(OSError):  # it has just died, which its reader reports
            self._write("".join(json.dumps(task) + "\n" for task in tasks))

    def warm_up(self, task: Task) -> None:
        """Hand over a case that is run at a small size and discarded."""
        with contextlib.suppress(OSError):
            self._write(json.dumps(task) + "\n")

    def _write(self, text: str) -> None:
        assert self.process.stdin
        self.process.stdin.write(text)
        self.process.stdin.flush()

    def end(self) -> None:
        """Kill it and wait until it is gone."""
        self.process.kill()
        self.process.wait()
        assert self.process.stdin
        with contextlib.suppress(OSError):  # what it can no longer read
            self.process.stdin.close()


def compiled_before() -> bool:
    """Tell whether a cache holds kernels of gears."""
    from rps_exudyn.base.kernel_cache import cache_folders, files_of  # loads numba
    from rps_exudyn.solvers import gear_model  # noqa: F401, the modules of a gear's kernels

    return any(True for folder in cache_folders() for _ in files_of(folder))


class Processes:
    """`jobs` processes that do tasks; use it in a `with` block, which ends them."""

    def __init__(self, jobs: int, time_limit: float, messages: Path | None = None) -> None:
        """`time_limit` is one case's [s]; what the processes print goes to the file `messages`."""
        self._jobs = jobs
        self.time_limit = time_limit
        self._messages = messages
        self._workers: list[_Worker] = []
        self._events: queue.SimpleQueue[tuple[_Worker, str | None]] = queue.SimpleQueue()
        self._again: deque[Task] = deque()
        self._attempts: dict[str, int] = {}
        self._failed_starts = 0
        self._next_start = 0.0  # when one may be started again
        self._cost = BATCH_SECONDS  # running mean of what a case takes [s]
        self._compiled = compiled_before()  # before this process compiles anything itself

    def __enter__(self) -> "Processes":
        return self

    def __exit__(self, *_: object) -> None:
        while self._workers:
            self._workers.pop().end()

    def run(self, tasks: Iterator[Task]) -> Iterator[Done]:
        """Do the tasks, taken from the iterator as needed; in the order in which they end.

        Raises:
            StorageError: a result could not be written.
            StartError: processes end before they are ready.
        """
        waiting = _Waiting(tasks, self._again)
        while waiting or any(worker.tasks for worker in self._workers):
            self._hand_out(waiting)
            yield from self._next_event()

    def _hand_out(self, waiting: "_Waiting") -> None:
        """Keep every process busy, and start one more if there is work for it.

        The first one starts alone until the kernels are known to be compiled, so that this is done once.
        """
        for worker in self._workers:
            if worker.ready and len(worker.tasks) <= self._batch // 2 and waiting:
                tasks = waiting.take(self._batch - len(worker.tasks))
                worker.give([{**task, "time_limit": self.time_limit} for task in tasks])
        missing = self._jobs - len(self._workers) if self._compiled else 1 - len(self._workers)
        for _ in range(missing):
            if monotonic() < self._next_start or (first := waiting.peek()) is None:
                return
            self._start(first)

    @property
    def _batch(self) -> int:
        return max(1, min(LARGEST_BATCH, int(BATCH_SECONDS / self._cost)))

    def _start(self, warm_up: Task) -> None:
        messages: IO[bytes] | int = subprocess.DEVNULL
        if self._messages:
            messages = self._messages.open("ab")
        try:
            process = subprocess.Popen(
                [sys.executable, "-P", "-X", "faulthandler", "-m", "rps_exudyn.simulate.worker"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=messages,
                text=True,
                encoding="utf-8",
                env=environment(),
                start_new_session=True,  # Ctrl-C is for whoever started it
            )
        finally:
            if not isinstance(messages, int):
                messages.close()
        worker = _Worker(process)
        self._workers.append(worker)
        threading.Thread(target=self._listen, args=(worker,), daemon=True).start()
        worker.warm_up(warm_up)

    def _listen(self, worker: _Worker) -> None:
        """Queue the lines of one process, and None when it has ended; runs in a thread of its own."""
        assert worker.process.stdout
        with worker.process.stdout as lines, contextlib.suppress(ValueError, OSError):
            for line in lines:
                self._events.put((worker, line))
        self._events.put((worker, None))

    def _next_event(self) -> Iterator[Done]:
        """Return what happens next: an answer, the end of a process, or the end of a case's time."""
        try:
            worker, line = self._events.get(timeout=self._until_deadline())
        except queue.Empty:
            yield from self._out_of_time()
            return
        if worker not in self._workers:
            return
        try:
            answer = json.loads(line) if line is not None else None
        except ValueError:  # half a line of a process that is dying
            return
        if answer is None:
            yield from self._ended(worker)
        elif "step" in answer:
            publish(Step(*answer["step"]))
        elif "ready" in answer:
            worker.ready = self._compiled = True
            self._failed_starts = 0
        elif "again" in answer:  # nothing of an interrupted case shall be left in it
            self._remove(worker)
            self._again.extendleft(reversed(worker.tasks))
        elif "error" in answer:
            raise StorageError(f"A result cannot be stored: {answer['error']}")
        else:
            yield self._answered(worker, answer)

    def _answered(self, worker: _Worker, answer: Mapping[str, Any]) -> Done:
        now = monotonic()
        wall, worker.since = now - worker.since, now
        worker.cpu_before = cpu_of(worker.process.pid)
        self._cost += 0.2 * (wall - self._cost)
        return Done(worker.tasks.popleft(), answer, wall_s=wall)

    def _deadline(self, worker: _Worker) -> float:
        if not worker.ready:
            return worker.since + START_LIMIT
        return worker.since + self.time_limit + GRACE if worker.tasks else float("inf")

    def _until_deadline(self) -> float:
        begins = [self._next_start] if len(self._workers) < self._jobs else []
        ahead = [*(self._deadline(worker) for worker in self._workers), *begins]
        nearest = min((instant for instant in ahead if instant > 0), default=0.0)
        return min(max(nearest - monotonic(), 0.001), 3600.0)

    def _out_of_time(self) -> Iterator[Done]:
        for worker in list(self._workers):
            if monotonic() < self._deadline(worker):
                continue
            cpu = cpu_of(worker.process.pid) - worker.cpu_before
            self._remove(worker)
            if worker.ready:
                self._again.extendleft(reversed(list(worker.tasks)[1:]))
                wall, why = monotonic() - worker.since, "its time limit was over"
                yield Done(worker.tasks[0], None, why, timeout=True, wall_s=wall, cpu_s=cpu)
            else:
                self._count_failed_start("is not ready")

    def _ended(self, worker: _Worker) -> Iterator[Done]:
        """The process died: the case it was at is tried once more, those behind it were not begun."""
        self._remove(worker)
        how = how_it_ended(worker.process.returncode)
        if not worker.ready:
            self._count_failed_start(how)
        if not worker.tasks:
            return
        culprit = worker.tasks.popleft()
        self._again.extendleft(reversed(worker.tasks))
        attempts = self._attempts[culprit["hash"]] = self._attempts.get(culprit["hash"], 0) + 1
        if attempts < ATTEMPTS:
            self._again.appendleft(culprit)
        else:
            yield Done(culprit, None, how, wall_s=monotonic() - worker.since)

    def _remove(self, worker: _Worker) -> None:
        self._workers.remove(worker)
        worker.end()

    def _count_failed_start(self, how: str) -> None:
        self._failed_starts += 1
        if self._failed_starts >= FAILED_STARTS:
            where = f"; {self._messages} holds what they said" if self._messages else ""
            raise StartError(
                f"{FAILED_STARTS} processes in a row ended before they had done anything ({how}){where}."
            )
        self._next_start = monotonic() + min(FIRST_PAUSE * 2**self._failed_starts, LONGEST_PAUSE)


class _Waiting:
    """Tasks not yet handed out: those to be done again first."""

    def __init__(self, tasks: Iterator[Task], again: deque[Task]) -> None:
        self._tasks, self._again = tasks, again

    def peek(self) -> Task | None:
        """Return the next task, left where it is."""
        if not self._again and (task := next(self._tasks, None)) is not None:
            self._again.append(task)
        return self._again[0] if self._again else None

    def __bool__(self) -> bool:
        return self.peek() is not None

    def take(self, count: int) -> list[Task]:
        """Take up to `count` tasks."""
        taken: list[Task] = []
        while len(taken) < count and self.peek() is not None:
            taken.append(self._again.popleft())
        return taken


def environment() -> dict[str, str]:
    """One thread per process, and the very package that started it."""
    home = str(Path(__file__).parents[2])
    paths = [home, *filter(None, [os.environ.get("PYTHONPATH")])]
    return {**os.environ, **dict.fromkeys(PINNED, "1"), "PYTHONPATH": os.pathsep.join(paths)}


def cpu_of(pid: int) -> float:
    """Return the CPU time of a process that runs [s]; 0 where the system does not tell."""
    try:
        ticks = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[11:13]
        return sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")
    except (OSError, ValueError, AttributeError):
        return 0.0


def how_it_ended(code: int | None) -> str:
    """Say how a process ended, by its exit code."""
    if code is None or code >= 0:
        return f"its process ended with status {code}"
    import signal

    try:
        return f"its process was ended by {signal.Signals(-code).name}"
    except ValueError:
        return f"its process was ended by signal {-code}"


Run = Callable[[Iterator[Task]], Iterator[Done]]
"""How tasks are done: here, or on a cluster."""
