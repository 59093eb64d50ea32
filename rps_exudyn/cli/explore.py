"""The command `explore`: a server that ends with Ctrl-C."""

import webbrowser
from contextlib import suppress

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.interrupts import took
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import PAPER_GEAR, GearOptions
from rps_exudyn.cli.output import DONE, say


def explore(
    *, gear: GearOptions = PAPER_GEAR, host: str = "127.0.0.1", port: int = 0, browser: bool = True
) -> int:
    """Open a page with sliders in the browser: curve, sheet, gear and limits follow the sliders.

    Args:
        host: Address of the server; any address other than 127.0.0.1 opens it to the network.
        port: Port of the server; 0: any free port.
        browser: Open the page in the browser.
    """
    from rps_exudyn.assessment.requirements.window_page import window_sheet
    from rps_exudyn.pages.explore.server import Explorer

    chosen = gear.load()
    if not host.strip():
        raise InputError("--host is empty; give an address, for instance 127.0.0.1 for this machine alone.")
    if not 0 <= port <= 65535:
        raise InputError(f"--port is {port}; it must be from 0 to 65535, 0 for a free one.")
    with Explorer(chosen, host, port, find_window=window_sheet) as server:
        if not server.local:
            say(f"anyone who reaches {host} can compute on this machine; there is no password.")
        with shown_progress():
            server.answering.warm_up()
        print(f"server: {server.address} (Ctrl-C ends it)", flush=True)
        if browser:
            with suppress(webbrowser.Error):
                webbrowser.open(server.address)
        with suppress(KeyboardInterrupt):
            server.serve_forever(poll_interval=0.2)
        took()
    return DONE
