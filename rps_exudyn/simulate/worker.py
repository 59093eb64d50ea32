"""The process that simulates cases: `python -m rps_exudyn.simulate.worker`, started by `processes`.

It reads one JSON object per line from standard input and answers each by one on standard output:

    {"scene", "gear", "fidelity", "keep", "path" or null}  ->  {"status", "message", "cpu_s", ..., "content"}

A group of cases, its "members", is answered by {"cases": one answer each}, or by {"cases": null} where they
are to be done singly. With a `path` the result's file is written there, else its bytes come back. Between
answers {"step": ...} says what is compiled.

The first line is warmed up at a small size before the worker calls itself ready, so that compiling and
loading the kernels is on no case's clock. A process that compiled kernels asks for another one in its place.
When standard input ends, because whoever started it has ended, so does the worker, at once.
"""

import base64
import json
import os
import queue
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from rps_exudyn.simulate.case_run import CaseRunner

Answer = Callable[[dict[str, Any]], None]

WARM_UP_TURNS = 0.05


def main() -> None:
    """Answer lines until the input ends."""
    answer = private_output()
    lines: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=read_lines, args=(lines,), daemon=True).start()
    first = json.loads(lines.get())
    from rps_exudyn.base.compiling import listeners
    from rps_exudyn.base.errors import InputError
    from rps_exudyn.simulate.case_run import CaseRunner

    listeners.append(lambda step: answer({"step": step}))
    runner = CaseRunner()
    runner.warm_up(first, WARM_UP_TURNS)
    answer({"ready": os.getpid()})
    while True:
        task = json.loads(lines.get())
        try:
            row = _group(runner, task, answer) if "members" in task else _case(runner, task, answer)
        except InputError as error:  # of storing: the simulation's own are outcomes
            answer({"error": str(error)})
        except Exception as error:
            answer({"error": f"{type(error).__name__}: {error}"})
        else:
            answer(row)
            if row.get("status") == "timeout" or row.get("cases", ()) is None:
                _begin_again(answer)  # of what was interrupted nothing shall be left


def _case(runner: "CaseRunner", task: dict[str, Any], answer: Answer) -> dict[str, Any]:
    """Return the answer to a single case."""
    row, content = runner.run(task)
    return row | _store(task["path"], content)


def _group(runner: "CaseRunner", task: dict[str, Any], answer: Answer) -> dict[str, Any]:
    """Return the answers to the members of a group."""
    found = runner.run_group(task)
    if found is None:
        return {"cases": None}
    paths = [member["path"] for member in task["members"]]
    rows = [row | _store(path, content) for path, (row, content) in zip(paths, found, strict=True)]
    return {"cases": rows}


def _begin_again(answer: Answer) -> NoReturn:
    """End, and leave what is still to be done to another process."""
    answer({"again": os.getpid()})
    os._exit(0)


def _store(path: str | None, content: bytes) -> dict[str, Any]:
    from rps_exudyn.base.files import replacing

    if path is None:
        return {"content": base64.b64encode(content).decode()}
    with replacing(Path(path)) as partial:
        partial.write_bytes(content)
    return {}


def private_output() -> Callable[[dict[str, Any]], None]:
    """Return the channel for answers; what libraries print goes to standard error instead."""
    channel = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)

    def answer(content: dict[str, Any]) -> None:
        channel.write(json.dumps(content) + "\n")
        channel.flush()

    return answer


def read_lines(lines: "queue.SimpleQueue[str]") -> None:
    """Read lines in a thread of its own, so that the end of the input is seen during a simulation too."""
    for line in sys.stdin:
        lines.put(line)
    os._exit(0)


if __name__ == "__main__":
    main()
