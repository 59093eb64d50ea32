"""The order in which the coordinates of the bodies are stacked."""

from collections.abc import Sequence

import numpy as np

COORDINATE_BLOCKS = {
    "pinion": slice(0, 1),
    "rack": slice(1, 7),
    "plunger": slice(7, 8),
    "segment": slice(8, 14),
}
PINION, RACK, PLUNGER = (COORDINATE_BLOCKS[body].start for body in ("pinion", "rack", "plunger"))


def stacked(bodies: Sequence[str]) -> np.ndarray:
    """Indices of some bodies' coordinates in the stack, in the order of the bodies."""
    return np.concatenate([np.r_[COORDINATE_BLOCKS[body]] for body in bodies])
