"""The page's server: this machine only, its own files only, one computation at a time.

A request whose Host is another name is refused (an address of the internet may be made to point here), and so
is one that is no JSON (which pages of other sites could send without being asked).
"""

import json
import socket
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.metadata import version
from pathlib import Path
from threading import Lock
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import pretty
from rps_exudyn.pages.explore.sliders import SLIDERS, Answer, answer, settings_of
from rps_exudyn.parameters.gear import SteeringGear, gear_file

LOOPBACK = ("127.0.0.1", "localhost", "::1")
LARGEST_REQUEST = 20_000  # [bytes]
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

    def __init__(self, gear: SteeringGear, host: str = "127.0.0.1", port: int = 0) -> None:
        """Bind the address; `port` 0 takes a free one.

        Raises:
            InputError: the address cannot be bound.
        """
        self.gear, self.lock, self.newest = gear, Lock(), dict[str, int]()
        self.local = host in LOOPBACK
        if ":" in host:
            self.address_family = socket.AF_INET6
        try:
            super().__init__((host, port), _Handler)
        except (OSError, OverflowError, TypeError) as error:
            no_name = isinstance(error, TypeError)  # so Python says it
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

    def computed(self, state: Any, tab: str, number: int) -> Answer:
        """One state's answer; "stale" where the same tab has asked for another meanwhile."""
        self.newest[tab] = max(number, self.newest.get(tab, 0))
        with self.lock:
            if number < self.newest[tab]:
                return {"stale": True}
            return answer(self.gear, state) | {"number": number}


class _Handler(BaseHTTPRequestHandler):
    server: Explorer
    server_version, sys_version = f"rps-exudyn/{version('rps-exudyn')}", ""
    timeout = 20  # of a connection that says nothing [s]

    def do_GET(self) -> None:
        if not self.server.allows(self.headers.get("Host", "")):
            self._refuse(HTTPStatus.MISDIRECTED_REQUEST, "this server answers its own address only")
        elif self.path == "/sliders":
            self._send(HTTPStatus.OK, "application/json", json.dumps(_sliders(self.server.gear)).encode())
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
        elif self.path not in ("/curve", "/gear"):
            self._refuse(HTTPStatus.NOT_FOUND, "there is no such page")
        else:
            self._answer()

    def _answer(self) -> None:
        try:
            length = int(self.headers.get("Content-Length", ""))
            if not 0 < length <= LARGEST_REQUEST:
                raise ValueError
            asked = json.loads(self.rfile.read(length))
            state, tab, number = asked["state"], str(asked.get("tab", ""))[:40], int(asked.get("number", 0))
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError, OverflowError):
            self._refuse(HTTPStatus.BAD_REQUEST, "a request must be JSON with a state")
            return
        if self.path == "/curve":
            content = self.server.computed(state, tab, number)
            self._send(HTTPStatus.OK, "application/json", json.dumps(content, allow_nan=False).encode())
            return
        try:
            text = gear_file(self.server.gear.replace(settings_of(state)))
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
        """Say nothing: the terminal is the user's."""


def _sliders(gear: SteeringGear) -> Any:
    """What the page builds itself from."""
    items = {item.path: item for item in gear.declared()}
    return [
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
