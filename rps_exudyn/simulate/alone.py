"""The process of one run with a time limit: `python -m rps_exudyn.simulate.alone`, started by `isolated_run`.

It reads one task as one line of JSON from standard input and answers on standard output:

    {"place": "..."}                    where the run is, for the case that it is ended there
    {"progress": {...}}                 how far it is
    {"step": [...]}                     what it compiles
    {"status", ..., "content"}          the case's row, and the bytes of its file
"""

import base64
import json
import queue
import signal
import threading
from collections.abc import Callable
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from rps_exudyn.simulate.worker import private_output, read_lines

if TYPE_CHECKING:
    from rps_exudyn.base.compiling import Step

Say = Callable[[dict[str, Any]], None]


def main() -> None:
    """Do the task."""
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
    say = private_output()
    lines: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=read_lines, args=(lines,), daemon=True).start()
    task = json.loads(lines.get())
    from rps_exudyn.simulate.case_run import CaseRunner

    say({"place": "in compiled code"})
    from rps_exudyn.base.compiling import listening
    from rps_exudyn.base.progress import following

    with following(lambda progress: say({"progress": asdict(progress)})), listening(_Steps(say)):
        row, content = CaseRunner().run(task)
    say(row | {"content": base64.b64encode(content).decode()})


class _Steps:
    """Pass on what is compiled, and that an alarm has to wait until then."""

    def __init__(self, say: Say) -> None:
        self._say, self._compiles = say, False

    def __call__(self, step: "Step") -> None:
        self._say({"step": step})
        if (compiles := step.done < step.total) == self._compiles:
            return
        self._compiles = compiles
        if compiles:
            self._say({"place": "while kernels were compiled, which later runs need not do"})
        else:
            self._say({"place": "in compiled code"})


if __name__ == "__main__":
    main()
