"""Bad inputs: of command line, files, disk, signals, cache, environment, explorer; what becomes of each.

Right is: no traceback, the sound result in the same folder unharmed (or kept under a number), nothing of a
file that was not named in what is printed, written or sent, and no process alive more than two seconds beyond
a time limit.
"""

import atexit
import os
import signal
import socket
import subprocess
import sys
import tempfile
import traceback
from contextlib import chdir, redirect_stderr, redirect_stdout, suppress
from functools import cache
from io import StringIO
from pathlib import Path
from threading import Thread
from time import monotonic, sleep

from benchmarks.bad_inputs.inputs import SECRET, BadInput, corpus, stands_in
from benchmarks.topic import Topic, load_rows, markdown, save_rows
from rps_exudyn.base.files import printable
from rps_exudyn.cli.main import main
from rps_exudyn.pages.explore.server import Explorer
from rps_exudyn.pages.explore.sliders import Wish
from rps_exudyn.parameters.gear import SteeringGear

DATA = "bad_inputs.csv"
COLUMNS = (
    "topic", "arguments", "status", "traceback", "lost", "beyond_limit_s", "left_alive", "outside", "said",
)  # fmt: skip
LATE = 2.0  # [s] that nothing may be alive beyond its limit
LIMITED = """
import resource, signal, sys
sys.dont_write_bytecode = True  # a write that is cut short there would spoil the modules of this installation
from rps_exudyn.cli.main import main
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, ({bytes}, {bytes}))
raise SystemExit(main())
"""


def run(folder: Path, every: int = 1, alone: bool = True) -> None:
    """Try every n-th input, also those that need a process of their own, and write what became of it."""
    precious = precious_file()
    chosen = [bad for bad in corpus(precious)[::every] if alone or not bad.is_alone]
    save_rows(folder / DATA, COLUMNS, [tried(bad, precious) for bad in chosen])


@cache
def precious_file() -> bytes:
    """The file of a sound result, as bytes."""
    with tempfile.TemporaryDirectory() as folder, chdir(folder), redirect_stdout(StringIO()):
        main(["run", "--fidelity", "closed-form", "--out", "precious.h5"])
        return Path("precious.h5").read_bytes()


def tried(bad: BadInput, precious: bytes) -> tuple[object, ...]:
    """Run one input beside the sound result `precious`; return its row of `COLUMNS`."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        stands_in(folder, bad, precious)
        way = _in_process if bad.is_alone else _served if bad.request is not None else _here
        status, said, beyond, left = way(bad, folder)
        lost = precious not in [path.read_bytes() for path in folder.glob("precious*.h5")]
        given = {"secret.txt", *bad.files, *bad.special}
        written = [path for path in folder.glob("*") if path.is_file() and path.name not in given]
        texts = said.encode("utf-8", "replace"), *map(Path.read_bytes, written)
        outside = any(SECRET in text for text in texts)
    first = repr((bad.request or b"").split(b"\r\n")[0]) if bad.request is not None else ""
    special = "".join(f" ({name} -> {place})" for name, place in bad.special.items())
    arguments = " ".join((*bad.arguments, first))[:200] + special
    about = " ".join(f"{name}={value}" for name, value in bad.environment.items())
    last = printable(said.strip().splitlines()[-1][:200]).replace("\0", r"\0") if said.strip() else ""
    shown = f"{about} {arguments} {bad.signal}".strip().encode("ascii", "backslashreplace").decode()
    return bad.topic, shown, status, "Traceback" in said, lost, f"{beyond:.2f}", left, outside, last


def _here(bad: BadInput, folder: Path) -> tuple[int, str, float, int]:
    """Exit status and what was said, by a call in this process."""
    said = StringIO()
    with chdir(folder), redirect_stdout(said), redirect_stderr(said):
        try:
            status = main(list(bad.arguments))
        except SystemExit as end:
            status = int(end.code or 0)
        except BaseException as error:
            return -1, f"Traceback: {type(error).__name__}: {error}", 0.0, 0
    return status, said.getvalue(), 0.0, 0


def _served(bad: BadInput, folder: Path) -> tuple[int, str, float, int]:
    """Send a request to an explorer; 2 if it is refused, -1 if a sound one has no answer afterwards."""
    server = _explorer()
    server.errors.seek(0)
    server.errors.truncate()
    with chdir(folder), socket.create_connection(("127.0.0.1", server.server_port), timeout=60) as link:
        with suppress(OSError):  # refused before it was read to its end
            link.sendall(bad.request or b"")
            link.shutdown(socket.SHUT_WR)
        reply = b""
        with suppress(ConnectionResetError):
            while part := link.recv(65536):
                reply += part
    answers = "curves" in server.answering.computed(Wish({}), bad.topic, 0)
    refused = not reply.startswith(b"HTTP/1.0 200") or b'"problems"' in reply
    said = server.errors.getvalue() + reply.decode("utf-8", "replace").rpartition("\r\n")[2]
    return (2 * refused if answers else -1), said, 0.0, 0


class WatchedExplorer(Explorer):
    """An explorer that keeps the tracebacks of its requests."""

    def __init__(self, gear: SteeringGear) -> None:
        self.errors = StringIO()
        super().__init__(gear)

    def handle_error(self, *_: object) -> None:
        """Write the traceback of a request that failed."""
        self.errors.write(traceback.format_exc())


@cache
def _explorer() -> WatchedExplorer:
    """A server in a thread."""
    server = WatchedExplorer(SteeringGear())
    server.answering.warm_up()
    Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True).start()
    atexit.register(server.server_close)
    return server


def _in_process(bad: BadInput, folder: Path) -> tuple[int, str, float, int]:
    """The same in a process of its own; how long it lived beyond its limit, and how many it left alive."""
    code = (
        ["-m", "rps_exudyn"] if bad.largest_file is None else ["-c", LIMITED.format(bytes=bad.largest_file)]
    )
    begun = monotonic()
    process = subprocess.Popen(
        [sys.executable, *code, *bad.arguments],
        cwd=folder,
        env={**os.environ, **bad.environment},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    children: set[int] = set()
    if bad.signal:
        sleep(bad.after)
        children = _children(process.pid)
        process.send_signal(signal.Signals[bad.signal])
    try:
        _, said = process.communicate(timeout=(bad.limit or 0) + 120)
    except subprocess.TimeoutExpired:
        process.kill()
        _, said = process.communicate()
    beyond = monotonic() - begun - bad.limit if bad.limit else 0.0
    end = monotonic() + LATE
    while (left := [pid for pid in children if Path(f"/proc/{pid}").exists()]) and monotonic() < end:
        sleep(0.05)
    return process.returncode, said, beyond, len(left)


def _children(pid: int) -> set[int]:
    try:
        return set(map(int, Path(f"/proc/{pid}/task/{pid}/children").read_text().split()))
    except OSError:
        return set()


def inputs_table(folder: Path) -> str:
    """What became of the inputs of each topic."""
    rows = load_rows(folder / DATA)

    def line(name: str, rows: list[dict[str, str]]) -> tuple[str | int, ...]:
        refused = sum(row["status"] == "2" for row in rows)
        faults = (sum(row[fault] == "True" for row in rows) for fault in ("traceback", "lost", "outside"))
        late = sum(float(row["beyond_limit_s"]) > LATE or int(row["left_alive"]) > 0 for row in rows)
        return name, len(rows), refused, *faults, late

    topics = dict.fromkeys(row["topic"] for row in rows)
    lines = [line(topic, [row for row in rows if row["topic"] == topic]) for topic in topics]
    head = ("bad", "inputs", "refused", "tracebacks", "lost", "read outside", "alive 2 s beyond limit")
    return markdown(head, [*(each for each in lines if any(each[3:])), line("**all**", rows)])


TOPIC = Topic("10 min", "bad_inputs", run, {"every": 25, "alone": False}, {"bad_inputs": inputs_table})
