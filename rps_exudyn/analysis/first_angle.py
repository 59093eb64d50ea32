"""Where in a record something first holds, for a reader."""

import numpy as np

from rps_exudyn.analysis.passes import Signals


def first_angle(signals: Signals, where: np.ndarray) -> str:
    """Return the pinion angle at which something first holds, for a reader; `where` has shape (n,)."""
    return f"{round(np.degrees(signals['pinion_angle'][np.argmax(where)]), 6) + 0.0:.4g} deg"
