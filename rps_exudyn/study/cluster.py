"""Cases done on a Dask cluster, which its own commands start (`dask scheduler`, `dask worker`).

Every thread of a Dask worker keeps one process of `processes`, so that time limits and crashes are handled
as on the local machine. Contents of files come back to the submitting side: workers need no common disk, only
the same rps-exudyn. Dask hands the cases of a lost worker to others.
"""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.simulate.processes import Done, Processes, Run, Task
from rps_exudyn.study.cases import MODEL_VERSION

if TYPE_CHECKING:
    from distributed import Client

CONNECTING = 20  # [s]
AHEAD = 2  # tasks submitted per thread of the cluster: none waits, and few are lost with a worker
SECONDS = 7.0  # of work in a group: Dask takes a millisecond for each task, and its connections some more

_own = threading.local()


@contextmanager
def cluster(address: str, time_limit: float) -> Iterator[tuple[Run, int]]:
    """A function that does tasks on the cluster whose scheduler has this address (tcp://10.0.0.1:8786), and
    how many it does at the same time.

    Raises:
        InputError: no cluster there, no workers, or workers with another rps-exudyn.
    """
    with _connected(address) as client:
        threads = _threads(client, address)

        def run(tasks: Iterator[Task]) -> Iterator[Done]:
            return _run(client, tasks, time_limit, AHEAD * threads)

        yield run, threads


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
        raise InputError(f"--cluster {address}: no scheduler answers there ({_first_line(error)}).") from None
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


def _run(client: "Client", tasks: Iterator[Task], time_limit: float, ahead: int) -> Iterator[Done]:
    """Submit `ahead` tasks at a time, and yield the answers in the order in which they come."""
    from distributed import as_completed

    given: dict[Any, Task] = {}
    completed = as_completed(loop=client.loop)

    def submit_next() -> None:
        if (task := next(tasks, None)) is not None:
            future = client.submit(do_case, task, time_limit, pure=False)
            given[future.key] = task
            completed.add(future)

    for _ in range(ahead):
        submit_next()
    for future in completed:
        task = given.pop(future.key)
        error = future.exception()
        if error is None:
            answer, ended, timeout, wall = future.result()
            yield Done(task, answer, ended, timeout, wall)
        else:
            yield Done(task, None, f"the cluster gave it up: {_first_line(error)}")
        future.release()
        submit_next()


def do_case(task: dict[str, Any], time_limit: float) -> tuple[Any, str, bool, float]:
    """Do one case in this thread's process, on the cluster; returns the fields of `Done`."""
    processes = getattr(_own, "processes", None)
    if processes is None:
        processes = _own.processes = Processes(1, time_limit)
    processes.time_limit = time_limit
    (done,) = processes.run(iter([task]))
    return done.answer, done.ended, done.timeout, done.wall_s


def _first_line(error: BaseException) -> str:
    return (str(error).strip().splitlines() or [type(error).__name__])[0]
