"""How many of the kernels that a work needs are compiled, and the time left."""

from collections import Counter
from time import monotonic

from rps_exudyn.base.compiling import Step, compiled_names
from rps_exudyn.base.kernel_table import KernelTable, kernel_table
from rps_exudyn.base.progress import duration

UNKNOWN = 0.1  # of a kernel that is not in the table [s]
TRUSTED = 3.0  # time of the table after which this machine's own speed counts as much as the table's [s]
OPEN = 0.1  # of the time of kernels that have begun, which they take still at least
PAUSE = 1.0  # without a kernel, after which the work itself goes on [s]


class CompilingProgress:
    """A count of kernels with its total, which never is less than the count.

    The total is that of the table, without what was compiled before. Where a kernel comes that the table does
    not expect, the latest work is taken for the likeliest one that has it.
    """

    def __init__(self, table: KernelTable | None = None, before: Counter[str] | None = None) -> None:
        """`before` are kernels that need not be compiled; without it those in the cache."""
        self._table, self._before = table, before
        self._works: list[str] = []
        self._expected: list[Counter[str]] = []  # by the works
        self._begun: Counter[str] = Counter()
        self._since_work: Counter[str] = Counter()  # begun since the latest work
        self._done: Counter[str] = Counter()
        self._open, self._latest = 0, 0.0
        self._first: float | None = None
        self._spent = 0.0  # in kernels that are done [s]
        self._compiling = 0.0  # until the latest step, without pauses [s]

    def take(self, step: Step) -> None:
        """Count a step."""
        self._compiling, self._latest = self._so_far, monotonic()
        if step.what == "work":
            self._since_work = Counter()
            if step.name not in self._works:
                self._works.append(step.name)
                if self._table is not None:
                    self._expected.append(self._table.kernels(step.name))
        elif step.what == "begun":
            self._begin(step.name)
        else:
            self._open = max(self._open - 1, 0)
            self._done[step.name] += 1
            self._spent += step.seconds

    def _begin(self, name: str) -> None:
        if self._first is None:
            self._first = self._latest
            self._table = self._table or kernel_table()
            self._before = compiled_names() if self._before is None else self._before
            self._expected = [self._table.kernels(work) for work in self._works]
        self._open += 1
        self._begun[name] += 1
        self._since_work[name] += 1
        if any(self._expected) and not self._begun <= self._needed():
            assert self._table is not None
            if likeliest := self._table.likeliest(self._since_work, self._expected[-1]):
                self._expected[-1] = likeliest

    def _needed(self) -> Counter[str]:
        """Kernels that the works are expected to compile."""
        whole: Counter[str] = Counter()
        for each in self._expected:
            whole |= each
        return whole - (self._before or Counter())

    @property
    def any(self) -> bool:
        """Whether anything has been compiled."""
        return self._first is not None

    @property
    def done(self) -> int:
        """Number of kernels compiled."""
        return self._done.total()

    @property
    def total(self) -> int:
        """Number of kernels that are compiled in the end."""
        return (self._needed() | self._begun).total()

    @property
    def elapsed(self) -> float:
        """Time since the first kernel began [s]."""
        return 0.0 if self._first is None else self._latest - self._first

    @property
    def left(self) -> float:
        """Expected time until the last kernel is done [s]."""
        every, so_far = self._needed() | self._begun, self._so_far
        done, begun = self._seconds(self._done), self._seconds(self._begun)
        of_done = (self._spent + TRUSTED) / (done + TRUSTED)
        of_begun = so_far / begun if begun else 0.0  # which are not all done yet
        slowness = max(of_done, of_begun)
        least = self._seconds(every - self._begun) + OPEN * (begun - done)
        return max(slowness * self._seconds(every) - so_far, slowness * least)

    @property
    def _so_far(self) -> float:
        """Time in which kernels were compiled [s]."""
        return self._compiling + (monotonic() - self._latest if self._open else 0.0)

    def _seconds(self, kernels: Counter[str]) -> float:
        known = self._table.seconds if self._table else {}
        return sum(count * known.get(name, UNKNOWN) for name, count in kernels.items())

    # --- as a row of the screen ---

    @property
    def fraction(self) -> float | None:
        """Share of the kernels that is done; None of a work that is not in the table."""
        return self.done / max(self.total, 1) if any(self._expected) else None

    @property
    def text(self) -> str:
        """For instance "Compiling force laws, once: 46 of 146, 18 s left"."""
        count = f"{self.done}" if self.fraction is None else f"{self.done} of {self.total}"
        if not self._open and monotonic() - self._latest > PAUSE:
            return f"computing; force laws compiled: {count}"
        left = "" if self.fraction is None else f", {duration(round(self.left))} left"
        return f"Compiling force laws, once: {count}{left}"
