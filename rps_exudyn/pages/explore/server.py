"""The page's server: this machine only, its own files only, computations in processes beside it.

A request whose Host is another name is refused (an address of the internet may be made to point here), and so
is one that is no JSON (which pages of other sites could send without being asked). A request that has not
come as a whole within the server's limit is dropped, however steadily its bytes come: it holds a thread.
"""

import json
import re
import socket
import sys
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.metadata import version
from io import BufferedReader, RawIOBase
from time import monotonic
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.pages.animation.animation_page import admitted
from rps_exudyn.pages.explore.answering import Answering, Request
from rps_exudyn.pages.explore.on_request import FindWindow
from rps_exudyn.pages.explore.widget import page_file
from rps_exudyn.parameters.gear import SteeringGear

LOOPBACK = ("127.0.0.1", "localhost", "::1")
LARGEST_REQUEST = 20_000  # [bytes]
LARGEST_FILE = 16_000_000  # of a request with a measured file [bytes]
REQUEST_LIMIT = 30.0  # of a request: the largest file comes at 4 Mbit/s [s]
MOST_WAITING = 1024  # connections that wait to be accepted
FILES = {
    "/": ("page.html", "text/html; charset=utf-8"),
    "/explore.css": ("explore.css", "text/css; charset=utf-8"),
    "/explore.js": ("explore.js", "text/javascript; charset=utf-8"),
}
_STYLE, _SCRIPT = admitted()  # of the gear in three dimensions
HEADERS = {
    "Content-Security-Policy": f"default-src 'none'; script-src 'self' 'sha256-{_SCRIPT}'; style-src 'self' "
    f"'sha256-{_STYLE}'; connect-src 'self'; img-src data:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}
_HOST = re.compile(r"(\[[0-9a-f:.]+\]|[^@/:\[\]\s]+)(:[0-9]*)?")  # RFC 9112, 3.2: without a user part


class Explorer(ThreadingHTTPServer):
    """A server of one gear."""

    daemon_threads = True
    request_queue_size = MOST_WAITING

    def __init__(
        self,
        gear: SteeringGear,
        host: str = "127.0.0.1",
        port: int = 0,
        request_limit: float = REQUEST_LIMIT,
        find_window: FindWindow | None = None,
    ) -> None:
        """Bind the address.

        Args:
            gear: what the sliders change.
            host: name or number of the address.
            port: 0 takes a free one.
            request_limit: time within which a request must come as a whole, and its answer be taken [s].
            find_window: by which the page has a button for windows.

        Raises:
            InputError: the address cannot be bound.
        """
        self.request_limit = request_limit
        self.answering = Answering(gear, find_window)
        self.local = host in LOOPBACK
        if ":" in host:
            self.address_family = socket.AF_INET6
        try:
            super().__init__((host, port), _Handler)
        except (OSError, OverflowError, TypeError) as error:
            no_name = isinstance(error, TypeError)  # Python's own error for it
            why = "it is not a host name" if no_name else getattr(error, "strerror", None) or error
            raise InputError(f"--host {host} --port {port} cannot be used: {why}.") from None

    @property
    def address(self) -> str:
        """The page's address."""
        host, port = str(self.server_address[0]), self.server_address[1]
        return f"http://{f'[{host}]' if ':' in host else host}:{port}/"

    def allows(self, host: str) -> bool:
        """Return whether a request's Host is a name of this machine, or any name if the user asked for
        others."""
        parts = _HOST.fullmatch(host)
        return parts is not None and (not self.local or parts[1].strip("[]") in LOOPBACK)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Print no traceback where a page closed its connection."""
        if not isinstance(sys.exc_info()[1], ConnectionError):
            super().handle_error(request, client_address)

    def server_close(self) -> None:
        """End the processes, too."""
        super().server_close()
        self.answering.__exit__()


class _TimedReader(RawIOBase):
    """The bytes that a connection brings within a time limit [s]; reading on raises TimeoutError."""

    def __init__(self, connection: socket.socket, limit: float) -> None:
        self._connection, self._ends = connection, monotonic() + limit

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        if (remaining := self._ends - monotonic()) <= 0:
            raise TimeoutError
        self._connection.settimeout(remaining)
        return self._connection.recv_into(buffer)


class _Handler(BaseHTTPRequestHandler):
    server: Explorer
    server_version, sys_version = f"rps-exudyn/{version('rps-exudyn')}", ""

    def setup(self) -> None:
        """Let the whole request be read within the server's limit."""
        super().setup()
        self.rfile.close()
        self.rfile = BufferedReader(_TimedReader(self.connection, self.server.request_limit))

    def do_GET(self) -> None:
        if not self.server.allows(self.headers.get("Host", "")):
            self._refuse(HTTPStatus.MISDIRECTED_REQUEST, "this server answers its own address only")
        elif self.path in FILES:
            name, kind = FILES[self.path]
            self._send(HTTPStatus.OK, kind, page_file(name).encode())
        else:
            self._refuse(HTTPStatus.NOT_FOUND, "there is no such page")

    def do_POST(self) -> None:
        if not self.server.allows(self.headers.get("Host", "")):
            self._refuse(HTTPStatus.MISDIRECTED_REQUEST, "this server answers its own address only")
        elif self.headers.get_content_type() != "application/json":
            self._refuse(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "a request must be JSON")
        elif self.path.removeprefix("/") not in self.server.answering.paths:
            self._refuse(HTTPStatus.NOT_FOUND, "there is no such page")
        else:
            self._answer()

    def _answer(self) -> None:
        try:
            length = int(self.headers.get("Content-Length", ""))
            largest = LARGEST_FILE if self.path in ("/measured", "/fit") else LARGEST_REQUEST
            if length > largest:
                why = f"a request of {length} bytes is too large (limit {largest}); use rps-exudyn fit"
                self._refuse(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, why)
                return
            if length <= 0:
                raise ValueError
            asked = Request.from_page(json.loads(self.rfile.read(length)))
        except (InputError, ValueError, RecursionError):
            self._refuse(HTTPStatus.BAD_REQUEST, "a request must be JSON with a state")
            return
        content = self.server.answering.reply(self.path.removeprefix("/"), asked)
        self._send(HTTPStatus.OK, "application/json", json.dumps(content, allow_nan=False).encode())

    def _refuse(self, status: HTTPStatus, why: str) -> None:
        self.close_connection = True
        self._send(status, "application/json", json.dumps({"problems": [why]}).encode())

    def _send(self, status: HTTPStatus, kind: str, content: bytes) -> None:
        self.connection.settimeout(self.server.request_limit)  # reading has left the rest of it
        self.send_response(status)
        for name, value in (HEADERS | {"Content-Type": kind, "Content-Length": str(len(content))}).items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *_: Any) -> None:
        """Print nothing: the terminal is the user's."""
