"""Where the work of the drive went."""

from rps_exudyn.result import Result


def work_shares(result: Result) -> dict[str, float]:
    """Each loss as a share of the drive's work over the whole record; the names are those of the signals.

    Empty if the result has no work signals, or the drive did no work (a single instant).
    """
    losses = {
        name: float(values[-1] - values[0])
        for name, values in result.signals.items()
        if name.startswith("work_") and values.size
    }
    drive = losses.pop("work_drive", 0.0)
    return {name: loss / drive for name, loss in losses.items()} if drive else {}
