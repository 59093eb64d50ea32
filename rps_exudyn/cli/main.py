"""The command line `rps-exudyn`: its commands, and what becomes of their errors.

Each command is a function in a file of its name, which is imported when it is asked for. What it needs is
imported inside the function, so that `--help` and `describe` are quick.
"""

import atexit
import gc
import os
import sys
from collections.abc import Iterable, Sequence
from io import TextIOWrapper
from pathlib import Path

from cyclopts import App, CycloptsError, UnusedCliTokensError

from rps_exudyn.base.errors import InputError, unwrapped_interrupts
from rps_exudyn.base.files import printable
from rps_exudyn.base.interrupts import INTERRUPTED
from rps_exudyn.cli.output import DONE, WRONG_INPUT, say

COMMANDS = (
    *("run", "study", "show", "diff", "rerun", "geometry", "export", "describe", "collect", "report", "fit"),
    *("plan-tests", "judge-batch", "check", "window", "optimise", "validate", "animate", "view", "explore"),
    *("doctor", "init", "schema"),
)
MOVED = {
    "--plan": "plan-tests",
    "--minutes": "plan-tests",
    "--batch": "judge-batch",
    "--tolerance": "judge-batch",
}
"""Option that `fit` had -> the command that does this."""

SELDOM = (500_000, 100, 1000)
"""Thresholds of the search for unused objects: as often as Python's own it is a fourteenth of a short run."""


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
for command in COMMANDS:
    module = command.replace("-", "_")
    app.command(f"rps_exudyn.cli.{module}:{module}", name=command)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the exit status.

    0 done; 1 the simulation failed (its file states how); 2 wrong input, one sentence for each problem on
    standard error; 130 interrupted.
    """
    prepare_process()
    try:
        _check_folder()
        given = sys.argv[1:] if arguments is None else arguments
        if not given or given[0] not in COMMANDS:
            for command in COMMANDS:
                app[command]  # is imported by that, and the help describes it
        if given[:1] == ["fit"] and (moved := [each for each in MOVED if each in given]):
            raise InputError(
                f"fit has no option {moved[0]}; use rps-exudyn {MOVED[moved[0]]}, see its --help."
            )
        with unwrapped_interrupts():
            status = app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
        sys.stdout.flush()
        return status or DONE
    except BrokenPipeError:  # whoever reads the output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except OSError as error:
        what = f"{error.filename} cannot be used" if error.filename else "the output cannot be written"
        return _refuse([f"{what}: {error.strerror or error}."])
    except MemoryError:
        return _refuse(["there is not enough memory; nothing was written."])
    except InputError as error:
        return _refuse(error.problems)
    except CycloptsError as error:
        if isinstance(error, UnusedCliTokensError):
            surplus = " ".join(error.unused_tokens or ())
            return _refuse([f"{surplus} is not an argument of this command; see --help."])
        return _refuse([" ".join(str(error).split())])
    except KeyboardInterrupt as interrupt:
        say(str(interrupt) or "interrupted; nothing was written.")
        return INTERRUPTED


def prepare_process() -> None:
    """Set what must be set before a command loads anything."""
    gc.set_threshold(*SELDOM)
    atexit.register(gc.freeze)  # the system takes all memory back: to free each object takes a quarter second
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")  # of a terminal without Greek letters
    # As in the processes of studies, so that numbers are the same; a thread that waits costs CPU time
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    os.environ["MPLBACKEND"] = "agg"  # pictures are files; a user's own choice may not exist here
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # to look for some opens every package


def _check_folder() -> None:
    try:
        Path.cwd()
    except FileNotFoundError:
        raise InputError("the current folder does not exist any more; change to another one.") from None


def _refuse(problems: Iterable[str]) -> int:
    for problem in problems:
        say(printable(problem))
    return WRONG_INPUT
