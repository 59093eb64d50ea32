"""State of the bristle friction along a motion: an array (2, m), start and end of a step.

Columns are the time, the coordinates of the stack, and three for each patch of bristles (see `friction`).
Kernels read the start and write the end at each evaluation; the solver sets the end's time before, and copies
the end to the next start once the step is found. Slip is then what the coordinates moved over the step.
"""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.base.compiled import inline

TIME, PLACES = 0, 1
MOST_COORDINATES = 88  # of a rack with as many modes as `rack.modes` allows
PATCHES = PLACES + MOST_COORDINATES
ROOM = 32
MEMORY_SIZE = PATCHES + ROOM


@dataclass(eq=False)
class Patches:
    """Columns of one gear's patches of bristles; `needed` once a part has some."""

    _used: int = PATCHES

    def taken(self, columns: int) -> int:
        """Return the first of some new columns."""
        first = self._used
        self._used += columns
        return first

    @property
    def needed(self) -> bool:
        """Return whether any part has bristles."""
        return self._used > PATCHES


def reset(memory: np.ndarray) -> None:
    """Reset to steady sliding at the rates of the next evaluation."""
    memory[:] = 0.0
    memory[0, TIME] = -np.inf


@inline
def begin_step(memory, begin, time):  # type: ignore[no-untyped-def]
    """Go to a step that begins with the state `begin` and ends at a time [s]."""
    for i in range(begin.size):
        memory[0, i] = begin[i]
    memory[1, TIME] = time


@inline
def duration(memory):  # type: ignore[no-untyped-def]
    """Duration of the step over which slip is a mean [s]; 0 where rates are those given."""
    h = memory[1, TIME] - memory[0, TIME]
    return h if 0 < h < np.inf else 0.0
