"""A run with a time limit that holds: in a process of its own, for at most that time from its start.

Loading, compiling and settling count. When the limit is over the run is interrupted and hands over what it
has recorded; `GRACE` later its process is ended. Exudyn's own limit ends with a success flag, and some of its
solvers never look at it.
"""

import json
import os
import queue
import signal
import subprocess
import sys
import threading
from base64 import b64decode
from collections.abc import Mapping
from contextlib import suppress
from time import monotonic
from typing import Any

from rps_exudyn.base.compiling import Step, publish
from rps_exudyn.base.progress import Progress, passed_on
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Interrupted, Status
from rps_exudyn.results.result import Result, failed, loads
from rps_exudyn.simulate.processes import Done, cpu_of, environment, how_it_ended
from rps_exudyn.simulate.time_limit import GRACE, TimeLimit, sentence

Answer = Mapping[str, Any]


def isolated_run(
    scene: str, gear: SteeringGear, fidelity: Fidelity, limit: TimeLimit, *, robust: bool = False
) -> Result:
    """Simulate in another process until the limit is over.

    The outcome is `timeout` if the time was over, with what was recorded until then; `crashed` if the process
    ended otherwise.

    Raises:
        InputError: a gear or test that cannot exist.
        Interrupted: Ctrl-C; it carries what was recorded.
    """
    task = {
        "scene": scene,
        "gear": gear.model_dump(),
        "fidelity": fidelity.model_dump(),
        "keep": {"signals": None, "samples": None},
        "robust": robust,
        "time_limit": limit.seconds,
        "begun": limit.begun,
    }
    with _Child(task) as child:
        try:
            answer = child.answer(limit.remaining + GRACE)
        except KeyboardInterrupt:
            if (answer := child.interrupted()) is None:
                raise
            recorded = loads(b64decode(answer["content"]), "the run")
            if not recorded.signals:
                raise
            raise Interrupted(recorded) from None
    if answer is not None:
        return loads(b64decode(answer["content"]), "the run")
    elapsed = monotonic() - limit.begun
    status, message = Status.CRASHED, how_it_ended(child.code)
    if limit.remaining < 0:
        status, message = Status.TIMEOUT, sentence(limit.seconds, child.place, child.cpu_s, elapsed)
    return failed(scene, gear, fidelity, status, message, child.cpu_s, elapsed)


class _Child:
    """The process `alone`; use it in a `with` block, which ends it."""

    def __init__(self, task: Mapping[str, Any]) -> None:
        self.place = "while libraries were loaded"
        self.cpu_s = 0.0
        self._lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-X", "faulthandler", "-m", "rps_exudyn.simulate.alone"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            encoding="utf-8",
            env=environment(),
            start_new_session=True,  # Ctrl-C is for whoever started it, who passes it on
        )
        threading.Thread(target=self._listen, daemon=True).start()
        assert self._process.stdin
        with suppress(OSError):  # it has ended, which its reader reports
            self._process.stdin.write(json.dumps(task) + "\n")
            self._process.stdin.flush()

    def __enter__(self) -> "_Child":
        return self

    def __exit__(self, *_: object) -> None:
        self.cpu_s = cpu_of(self._process.pid)
        self._process.kill()
        self._process.wait()
        assert self._process.stdin
        with suppress(OSError):
            self._process.stdin.close()

    @property
    def code(self) -> int | None:
        """How the process ended."""
        return self._process.returncode

    def _listen(self) -> None:
        assert self._process.stdout
        with self._process.stdout as lines, suppress(ValueError, OSError):
            for line in lines:
                self._lines.put(line)
        self._lines.put(None)

    def answer(self, seconds: float) -> Answer | None:
        """Return the answer, if one comes within this time; note where the run is meanwhile."""
        end = monotonic() + seconds
        while True:
            try:
                line = self._lines.get(timeout=max(end - monotonic(), 0.001))
            except queue.Empty:
                return None
            if line is None:
                with suppress(subprocess.TimeoutExpired):
                    self._process.wait(1.0)
                return None
            answer = json.loads(line)
            if "progress" in answer:
                passed_on(Progress(**answer["progress"]))
                continue
            if "step" in answer:
                publish(Step(*answer["step"]))
                continue
            if "place" not in answer:
                return dict(answer)
            self.place = answer["place"]

    def interrupted(self) -> Answer | None:
        """Pass Ctrl-C on; return what the run hands over."""
        with suppress(OSError):
            os.kill(self._process.pid, signal.SIGINT)
        return self.answer(GRACE)


def result_of_ended_process(
    done: Done, scene: str, gear: SteeringGear, fidelity: Fidelity, time_limit: float
) -> Result:
    """Return what stands for a study's case whose process came to an end over it; the limit in seconds."""
    status, message = Status.CRASHED, done.ended
    if done.timeout:
        status, message = Status.TIMEOUT, sentence(time_limit, "in compiled code", done.cpu_s, done.wall_s)
    return failed(scene, gear, fidelity, status, message, done.cpu_s, done.wall_s)
