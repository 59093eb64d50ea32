"""The application that the commands of `rps-exudyn` register with, and what they share.

Exit status: 0 done; 1 the simulation failed (its file says how); 2 wrong input, one sentence for each problem
on standard error; 130 interrupted.
"""

from typing import Annotated

from cyclopts import App, Parameter

from rps_exudyn.cli.options import GearOptions, SetupOptions

DONE, FAILED, WRONG_INPUT, INTERRUPTED = 0, 1, 2, 130


def _version() -> str:
    from importlib.metadata import version  # loads what reads the heads of mails, too

    return version("rps-exudyn")


app = App(
    name="rps-exudyn",
    help="Rack-and-pinion steering gears: pinion torque, its variation, and how far to trust it.",
    version=_version,
    suppress_keyboard_interrupt=False,  # `main` reports which files remain
)

app.register_install_completion_command(add_to_startup=False)

Flag = Annotated[bool, Parameter(negative=(), show_default=False)]

PAPER_GEAR, PAPER_SETUP = GearOptions(), SetupOptions()
