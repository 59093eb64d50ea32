"""Where the work of the drive went, and whether it all went somewhere."""

from collections.abc import Mapping

import numpy as np


def losses(signals: Mapping[str, np.ndarray]) -> dict[str, float]:
    """Work lost over the whole record [J]; the names are those of the signals."""
    return {
        name: float(values[-1] - values[0])
        for name, values in signals.items()
        if name.startswith("work_") and name != "work_drive" and values.size
    }


def drive_work(signals: Mapping[str, np.ndarray]) -> float:
    """Work of the drive over the whole record [J]; 0 without work signals."""
    work = signals.get("work_drive", np.zeros(1))
    return float(work[-1] - work[0]) if work.size else 0.0


def work_shares(signals: Mapping[str, np.ndarray]) -> dict[str, float]:
    """Each loss as a share of the drive's work; empty if the drive did none (a single instant)."""
    drive = drive_work(signals)
    return {name: loss / drive for name, loss in losses(signals).items()} if drive else {}


def energy_residual(signals: Mapping[str, np.ndarray]) -> float:
    """(drive's work - work lost - change of stored energy) / drive's work; nan if the drive did none."""
    drive = drive_work(signals)
    stored = float(signals["stored_energy"][-1] - signals["stored_energy"][0])
    return (drive - sum(losses(signals).values()) - stored) / drive if drive else float("nan")
