"""The command `view`: the gear in Exudyn's own viewer, where there is a display."""

import os
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.output import DONE


def view(file: Path, /) -> int:
    """Play the gear of a result in Exudyn's own viewer, where there is a display.

    Args:
        file: HDF5 file that `run` wrote; its motion is computed again.
    """
    from rps_exudyn.parameters.fidelity import Fidelity
    from rps_exudyn.study.case_blocks import load

    result = load(file)
    if not has_display():
        raise InputError(
            f"Exudyn's viewer needs a display; rps-exudyn animate {file} makes a page for any browser."
        )
    fidelity = Fidelity.from_tables(result.fidelity, where=str(file))
    if fidelity.solver != "generalized-alpha":
        fidelity = Fidelity.preset("flank")
    from rps_exudyn.multibody.viewer import play, solved_model

    with TemporaryDirectory() as folder:
        motion = Path(folder) / "motion.txt"
        with shown_progress():
            model = solved_model(result.gear, fidelity, motion)
        play(model, motion)
    return DONE


def has_display() -> bool:
    """Return whether windows can be opened here."""
    return sys.platform in ("win32", "darwin") or bool(
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    )
