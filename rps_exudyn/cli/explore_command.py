"""The command `explore`: a server that ends with Ctrl-C."""

import webbrowser
from contextlib import suppress

from rps_exudyn.base.errors import InputError
from rps_exudyn.cli.kept import say
from rps_exudyn.cli.progress import shown_progress
from rps_exudyn.explore.answer import answer
from rps_exudyn.explore.server import Explorer
from rps_exudyn.parameters.gear import SteeringGear


def do_explore(gear: SteeringGear, host: str, port: int, browser: bool) -> None:
    """Serve until Ctrl-C.

    Raises:
        InputError: a port that does not exist, or an address that cannot be used.
    """
    if not host.strip():
        raise InputError("--host is empty; give an address, for instance 127.0.0.1 for this machine alone.")
    if not 0 <= port <= 65535:
        raise InputError(f"--port is {port}; it must be from 0 to 65535, 0 for a free one.")
    with Explorer(gear, host, port) as server:
        if not server.local:
            say(f"anyone who reaches {host} can compute on this machine now; there is no password.")
        with shown_progress():
            answer(gear, {})
        print(f"serving: {server.address} (Ctrl-C ends it)", flush=True)
        if browser:
            with suppress(webbrowser.Error):
                webbrowser.open(server.address)
        with suppress(KeyboardInterrupt):
            server.serve_forever(poll_interval=0.2)
