"""The process that does tasks: `python -m rps_exudyn.simulate.cases.worker`, started by `processes`.

It reads pickled objects from standard input: a call to warm up, then tasks with their time limits. It writes
others to standard output: "ready", what code is made (`Making`), and of each task "begun", how far its run is
(`Progress`) and an `Answer`.

The call to warm up comes before "ready": compiling and loading kernels is on no task's clock. When standard
input ends, because whoever started it has ended, so does the worker, at once.
"""

import os
import pickle
import queue
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from rps_exudyn.base.interrupts import arm
from rps_exudyn.simulate.cases.frames import frame_of, frames_in


def main() -> None:
    """Answer tasks until the input ends."""
    arm()  # also where a shell's background job ignores Ctrl-C
    say = _private_output()
    frames: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(frames,), daemon=True).start()
    first = frames.get()
    from dataclasses import replace

    from rps_exudyn.base.progress import following, makers
    from rps_exudyn.results.outcome import Interrupted
    from rps_exudyn.simulate.cases.task import Answer, answer_to, handing_over

    warm_up = pickle.loads(first)
    makers.append(say)
    if warm_up is not None:
        with suppress(Exception):  # the tasks' own answers hold what is wrong
            warm_up()
    say("ready")
    while True:
        task, time_limit = pickle.loads(frames.get())
        say("begun")  # its modules are imported
        try:
            with following(say), handing_over(say):
                answer = answer_to(task, time_limit)
        except Interrupted as interrupt:  # Ctrl-C, passed on
            answer = Answer(ended=interrupt.recorded.message, recorded=interrupt.recorded)
        try:
            say(answer)
        except Exception:  # an error that cannot be pickled
            say(replace(answer, error=RuntimeError(f"{type(answer.error).__name__}: {answer.error}")))


def _private_output() -> Callable[[Any], None]:
    """Return the channel for answers; what libraries print goes to standard error instead."""
    channel = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)

    def say(content: Any) -> None:
        channel.write(frame_of(content))
        channel.flush()

    return say


def _read(frames: "queue.SimpleQueue[bytes]") -> None:
    """Read frames in a separate thread, which detects the end of the input also during a task."""
    for frame in frames_in(sys.stdin.buffer):
        frames.put(frame)
    os._exit(0)


if __name__ == "__main__":
    main()
