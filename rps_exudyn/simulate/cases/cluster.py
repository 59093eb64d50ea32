"""Tasks done on a Dask cluster, which its own commands start (`dask scheduler`, `dask worker`).

Every thread of a Dask worker keeps one process of `processes`. So time limits and crashes are handled as on
the local machine. Results come back to the submitting side: workers need no common disk, only the same
rps-exudyn. Dask hands the tasks of a lost worker to others.
"""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.results.provenance import MODEL_VERSION
from rps_exudyn.simulate.cases.processes import Processes
from rps_exudyn.simulate.cases.task import Answer, Task

if TYPE_CHECKING:
    from distributed import Client

CONNECTING = 20  # [s]
AHEAD = 2  # tasks submitted per thread of the cluster: none waits, and few are lost with a worker
GROUP_SECONDS = 7.0  # of work: Dask takes a millisecond for each task, and its connections some more

_own = threading.local()


@dataclass(frozen=True)
class Cluster:
    """The cluster of a scheduler, each task for at most so many seconds."""

    client: "Client"
    workers: int
    time_limit: float
    group_seconds: float = GROUP_SECONDS

    @classmethod
    @contextmanager
    def at(cls, address: str, time_limit: float) -> "Iterator[Cluster]":
        """The cluster whose scheduler has this address, for instance tcp://10.0.0.1:8786, during a block.

        Raises:
            InputError: no cluster there, no workers, or workers with another rps-exudyn.
        """
        with _connected(address) as client:
            yield cls(client, _threads(client, address), time_limit)

    def run(self, tasks: Iterator[Task]) -> Iterator[tuple[Task, Answer]]:
        """Submit some tasks at a time, and yield the answers in the order in which they come."""
        from distributed import as_completed

        given: dict[Any, Task] = {}
        completed = as_completed(loop=self.client.loop)

        def submit_next() -> None:
            if (task := next(tasks, None)) is not None:
                future = self.client.submit(do_task, task, self.time_limit, pure=False)
                given[future.key] = task
                completed.add(future)

        for _ in range(AHEAD * self.workers):
            submit_next()
        for future in completed:
            task, error = given.pop(future.key), future.exception()
            if error is None:
                yield task, future.result()
            else:
                yield task, Answer(ended=f"the cluster gave it up: {_first_line(error)}")
            future.release()
            submit_next()


@contextmanager
def _connected(address: str) -> "Iterator[Client]":
    try:
        from distributed import Client
        from distributed.comm.addressing import get_address_host_port
    except ImportError:
        raise InputError("--cluster needs Dask: pip install 'rps-exudyn[cluster]'.") from None
    try:
        get_address_host_port(address)  # a client that fails at it prints a traceback much later
        client = Client(address, timeout=CONNECTING, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise InputError(f"--cluster {address}: no scheduler answers ({_first_line(error)}).") from None
    with client:
        yield client


def _threads(client: "Client", address: str) -> int:
    """The number of threads of the cluster, after a check that its workers have this rps-exudyn."""
    try:
        client.wait_for_workers(1, timeout=CONNECTING)
    except TimeoutError:
        raise InputError(
            f"--cluster {address}: the scheduler has no workers; start some by dask worker."
        ) from None
    own = _identity()
    for worker, other in client.run(_identity).items():
        if other != own:
            raise InputError(f"--cluster {address}: the worker {worker} has {other}, and this is {own}.")
    return max(1, sum(client.nthreads().values()))


def _identity() -> str:
    return f"rps-exudyn {version('rps-exudyn')}, model {MODEL_VERSION}, exudyn {version('exudyn')}"


def do_task(task: Task, time_limit: float) -> Answer:
    """Do one task in this thread's process, on the cluster."""
    processes = getattr(_own, "processes", None)
    if processes is None:
        processes = _own.processes = Processes(1, time_limit)
    processes.time_limit = time_limit
    ((_, answer),) = processes.run(iter([task]))
    return answer


def _first_line(error: BaseException) -> str:
    return (str(error).strip().splitlines() or [type(error).__name__])[0]
