"""`python -m rps_exudyn` is `rps-exudyn`: a command, which Ctrl-C ends in a sentence."""

import signal
import sys

from rps_exudyn.base.interrupts import INTERRUPTED, arm, disarm


def main() -> int:
    """Run the command of `sys.argv` and return the exit status."""
    try:
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # a background job ignores it
            arm()
        from rps_exudyn.cli.main import main as command

        status = command()
        if disarm() and status != INTERRUPTED:
            raise KeyboardInterrupt("interrupted at the end, when all was done.")
    except KeyboardInterrupt as interrupt:
        print(f"rps-exudyn: {str(interrupt) or 'interrupted; nothing was written.'}", file=sys.stderr)
        status = INTERRUPTED
    return status


if __name__ == "__main__":
    sys.exit(main())
