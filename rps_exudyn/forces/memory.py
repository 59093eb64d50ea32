"""What friction with memory remembers of a motion: one array of two rows, the begin and the end of a step.

Columns are the time, the coordinates of the stack, and three for each patch of bristles (see `friction`).
Kernels read the begin and write the end at each evaluation; who steps sets the end's time before, and keeps
the end as the next begin once the step is found. Slip is then what the coordinates moved over the step.
"""

from dataclasses import dataclass, field

import numpy as np

from rps_exudyn.base.compiled import kernel

TIME, PLACES = 0, 1
MOST_COORDINATES = 88  # of a rack with as many modes as `rack.modes` allows
PATCHES = PLACES + MOST_COORDINATES
NO_MEMORY = np.zeros((2, 0))
ROOM = 32


@dataclass(eq=False)
class Memory:
    """The memory of one gear; `rows` (2, .) is empty until something remembers."""

    _rows: np.ndarray = field(default_factory=lambda: np.zeros((2, PATCHES + ROOM)))
    _used: int = PATCHES

    def taken(self, columns: int) -> int:
        """Return the first of some new columns."""
        first = self._used
        self._used += columns
        return first

    @property
    def needed(self) -> bool:
        """Tell whether any part remembers."""
        return self._used > PATCHES

    @property
    def rows(self) -> np.ndarray:
        """Begin and end of the step, for the laws that remember."""
        return self._rows

    @property
    def array(self) -> np.ndarray:
        """The same, or nothing where no part remembers."""
        return self._rows if self.needed else NO_MEMORY


def forget(memory: np.ndarray) -> None:
    """Begin anew: what is evaluated next has slid for long at its rates."""
    memory[:] = 0.0
    memory[0, :1] = -np.inf


@kernel
def begin_step(memory, begin, time):  # type: ignore[no-untyped-def]
    """Go to a step that begins with what is remembered in `begin` and ends at a time [s]."""
    for i in range(memory.shape[1]):
        memory[0, i] = begin[i]
    if memory.shape[1] > 0:
        memory[1, 0] = time


@kernel
def duration(memory):  # type: ignore[no-untyped-def]
    """Duration of the step over which slip is a mean [s]; 0 where rates are those given."""
    if memory.shape[1] == 0:
        return 0.0
    h = memory[1, 0] - memory[0, 0]
    return h if 0 < h < np.inf else 0.0


@kernel
def slip_rates(q, v, memory):  # type: ignore[no-untyped-def]
    """Rates with which bodies slip: without memory those given, with it the means over the step."""
    if memory.shape[1] == 0:
        return v
    h = duration(memory)
    for i in range(q.size):
        memory[1, 1 + i] = q[i]
    if h == 0:
        return v
    rates = np.empty(q.size)
    for i in range(q.size):
        rates[i] = (q[i] - memory[0, 1 + i]) / h
    return rates
