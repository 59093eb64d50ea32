"""The page's server: this machine only, its own files only, computations in processes beside it.

A request whose Host is another name is refused (an address of the internet may be made to point here), and so
is one that is no JSON (which pages of other sites could send without being asked). A state that takes longer
than `LONGEST` is given up; until then, it holds one process, and the others answer all other tabs.
"""

import json
import socket
from dataclasses import replace
from functools import partial
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.metadata import version
from pathlib import Path
from queue import SimpleQueue
from threading import Thread
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import pretty
from rps_exudyn.pages.explore.on_request import KINDS, on_request
from rps_exudyn.pages.explore.sliders import SLIDERS, Answer, Wish, answer, scenes
from rps_exudyn.parameters.gear import SteeringGear, gear_file
from rps_exudyn.scenes.free_pinion_torque import SCENE
from rps_exudyn.simulate.cases.processes import Processes
from rps_exudyn.simulate.cases.run_cases import Task, available_processors

LOOPBACK = ("127.0.0.1", "localhost", "::1")
LARGEST_REQUEST = 20_000  # [bytes]
LARGEST_FILE = 4_000_000  # of a request with a measured file [bytes]
LONGEST = 10.0  # that a state may take [s]
LONGEST_REQUESTED = 120.0  # that a band, a sheet or a fit may take [s]
MOST_WAITING = 1024  # connections that wait to be accepted
MOST_TABS = 4096  # of which the number of the last request is kept
TOO_LONG = (
    f"This state takes longer than {LONGEST:.0f} s; download its gear file and compute it by "
    "rps-exudyn run --gear."
)
FILES = {
    "/": ("page.html", "text/html; charset=utf-8"),
    "/explore.css": ("explore.css", "text/css; charset=utf-8"),
    "/explore.js": ("explore.js", "text/javascript; charset=utf-8"),
}
HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}
_FOLDER = Path(__file__).parent / "web"


class Explorer(ThreadingHTTPServer):
    """A server of one gear."""

    daemon_threads = True
    request_queue_size = MOST_WAITING

    def __init__(self, gear: SteeringGear, host: str = "127.0.0.1", port: int = 0) -> None:
        """Bind the address; `port` 0 takes a free one.

        Raises:
            InputError: the address cannot be bound.
        """
        self.gear, self.newest = gear, dict[str, int]()
        self._processes = [Processes(1, LONGEST) for _ in range(max(2, available_processors()))]
        self._free: SimpleQueue[Processes] = SimpleQueue()
        self._patient: dict[str, SimpleQueue[Processes]] = {kind: SimpleQueue() for kind in KINDS}
        self._begun_by_clicks = [Processes(1, LONGEST_REQUESTED) for _ in KINDS]
        for queue, processes in zip(self._patient.values(), self._begun_by_clicks, strict=True):
            queue.put(processes)
        self.local = host in LOOPBACK
        if ":" in host:
            self.address_family = socket.AF_INET6
        try:
            super().__init__((host, port), _Handler)
        except (OSError, OverflowError, TypeError) as error:
            no_name = isinstance(error, TypeError)  # Python's own error for it
            why = "it is no name of a host" if no_name else getattr(error, "strerror", None) or error
            raise InputError(f"--host {host} --port {port} cannot be used: {why}.") from None

    @property
    def address(self) -> str:
        """The page's address."""
        host, port = str(self.server_address[0]), self.server_address[1]
        return f"http://{f'[{host}]' if ':' in host else host}:{port}/"

    def allows(self, host: str) -> bool:
        """Return whether a request's Host is a name of this machine; any is if the user asked for others."""
        name = host.rsplit(":", 1)[0] if not host.endswith("]") else host
        return not self.local or name.strip("[]") in LOOPBACK

    def warm_up(self) -> None:
        """Compile here if need be, where a command shows it; the processes start in the background."""
        answer(SteeringGear(), Wish({}))
        for processes in self._processes:
            arguments = (processes, self._free, self.task(Wish({})))
            Thread(target=self._ask, args=arguments, daemon=True).start()

    def task(self, wish: Wish) -> Task:
        """The call that answers a state."""
        return Task(partial(answer, self.gear, wish), warm_up=partial(answer, self.gear, Wish({})))

    def requested(self, wish: Wish, kind: str) -> Answer:
        """The answer to a click, one after the other."""
        usual = replace(wish, state={})  # what is compiled for it has no time limit
        warm_up = partial(on_request, self.gear, usual, kind)
        task = Task(partial(on_request, self.gear, wish, kind), warm_up=warm_up)
        queue = self._patient[kind]
        return self._ask(queue.get(), queue, task)

    def computed(self, wish: Wish, tab: str, number: int) -> Answer:
        """One state's answer; "stale" where the same tab has asked for another meanwhile."""
        self.newest[tab] = max(number, self.newest.pop(tab, 0))
        while len(self.newest) > MOST_TABS:
            del self.newest[next(iter(self.newest))]
        processes = self._free.get()
        if number < self.newest.get(tab, number):
            self._free.put(processes)
            return {"stale": True}
        return self._ask(processes, self._free, self.task(wish)) | {"number": number}

    def _ask(self, processes: Processes, free: "SimpleQueue[Processes]", task: Task) -> Answer:
        """The answer of a process, which is free afterwards."""
        try:
            ((_, found),) = processes.run(iter([task]))
            if found.timeout:
                return {"problems": [TOO_LONG]}
            return dict(found.returned())
        except InputError as error:
            return {"problems": list(error.problems)}
        finally:
            free.put(processes)

    def server_close(self) -> None:
        """End the processes, too."""
        super().server_close()
        for processes in [*self._processes, *self._begun_by_clicks]:
            processes.__exit__()


class _Handler(BaseHTTPRequestHandler):
    server: Explorer
    server_version, sys_version = f"rps-exudyn/{version('rps-exudyn')}", ""
    timeout = 20  # of a connection without data [s]

    def do_GET(self) -> None:
        if not self.server.allows(self.headers.get("Host", "")):
            self._refuse(HTTPStatus.MISDIRECTED_REQUEST, "this server answers its own address only")
        elif self.path == "/sliders":
            self._send(HTTPStatus.OK, "application/json", json.dumps(_controls(self.server.gear)).encode())
        elif self.path in FILES:
            name, kind = FILES[self.path]
            self._send(HTTPStatus.OK, kind, (_FOLDER / name).read_bytes())
        else:
            self._refuse(HTTPStatus.NOT_FOUND, "there is no such page")

    def do_POST(self) -> None:
        if not self.server.allows(self.headers.get("Host", "")):
            self._refuse(HTTPStatus.MISDIRECTED_REQUEST, "this server answers its own address only")
        elif self.headers.get_content_type() != "application/json":
            self._refuse(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "a request must be JSON")
        elif self.path.removeprefix("/") not in ("curve", "gear", *KINDS):
            self._refuse(HTTPStatus.NOT_FOUND, "there is no such page")
        else:
            self._answer()

    def _answer(self) -> None:
        try:
            length = int(self.headers.get("Content-Length", ""))
            largest = LARGEST_FILE if self.path in ("/measured", "/fit") else LARGEST_REQUEST
            if not 0 < length <= largest:
                raise ValueError
            asked = json.loads(self.rfile.read(length))
            scene, both_ways = str(asked.get("scene", SCENE.name)), bool(asked.get("both_ways"))
            wish = Wish(asked["state"], scene, both_ways, str(asked.get("measured", "")))
            tab, number = str(asked.get("tab", ""))[:40], int(asked.get("number", 0))
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError, OverflowError):
            self._refuse(HTTPStatus.BAD_REQUEST, "a request must be JSON with a state")
            return
        if self.path == "/gear":
            self._answer_gear(wish)
            return
        if self.path == "/curve":
            content = self.server.computed(wish, tab, number)
        else:
            content = self.server.requested(wish, self.path.removeprefix("/"))
        self._send(HTTPStatus.OK, "application/json", json.dumps(content, allow_nan=False).encode())

    def _answer_gear(self, wish: Wish) -> None:
        try:
            text = gear_file(Wish(wish.state).gear(self.server.gear))
        except InputError as error:
            self._refuse(HTTPStatus.UNPROCESSABLE_ENTITY, " ".join(error.problems))
            return
        self._send(HTTPStatus.OK, "application/toml; charset=utf-8", text.encode())

    def _refuse(self, status: HTTPStatus, why: str) -> None:
        self.close_connection = True
        self._send(status, "application/json", json.dumps({"problems": [why]}).encode())

    def _send(self, status: HTTPStatus, kind: str, content: bytes) -> None:
        self.send_response(status)
        for name, value in (HEADERS | {"Content-Type": kind, "Content-Length": str(len(content))}).items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *_: Any) -> None:
        """Print nothing: the terminal is the user's."""


def _controls(gear: SteeringGear) -> Any:
    """What the page builds itself from."""
    items = {item.path: item for item in gear.declared()}
    sliders = [
        {
            "path": slider.path,
            "name": slider.name,
            "low": min(slider.low, slider.of(gear)),
            "high": max(slider.high, slider.of(gear)),
            "step": slider.step,
            "unit": pretty(slider.unit),
            "value": slider.of(gear),
            "meaning": items[slider.path].meaning,
        }
        for slider in SLIDERS
    ]
    return {"sliders": sliders, "scenes": scenes()}
