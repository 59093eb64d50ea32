"""The process of one run with a time limit: `python -m rps_exudyn.simulate.alone`, started by `isolated_run`.

It reads one task as one line of JSON from standard input and answers on standard output:

    {"place": "..."}                    where the run is, for the case that it is ended there
    {"progress": {...}}                 how far it is
    {"status", ..., "content"}          the case's row, and the bytes of its file
"""

import base64
import json
import queue
import signal
import threading
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

from rps_exudyn.simulate.worker import private_output, read_lines

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
    _tell_of_compiling(say)
    from rps_exudyn.base.progress import following

    with following(lambda progress: say({"progress": asdict(progress)})):
        row, content = CaseRunner().run(task)
    say(row | {"content": base64.b64encode(content).decode()})


def _tell_of_compiling(say: Say) -> None:
    """Say when a kernel is compiled, which no alarm interrupts."""
    from numba.core import event

    class Listener(event.Listener):
        depth = 0

        def on_start(self, event: Any) -> None:
            self.depth += 1
            if self.depth == 1:
                say({"place": "while kernels were compiled, which later runs need not do"})

        def on_end(self, event: Any) -> None:
            self.depth -= 1
            if self.depth == 0:
                say({"place": "in compiled code"})

    event.register("numba:compile", Listener())


if __name__ == "__main__":
    main()
