"""The folder of a study's blocks: DIR/blocks/00000.h5, each with up to `CASES` cases.

A block is written whole: when it is full, when the runner ends, and often until then, in its own place. A
runner that is killed loses no more than the cases since. Where a case stands in several blocks, the
last one counts.
"""

from collections import OrderedDict
from collections.abc import Callable, Iterable
from functools import lru_cache
from pathlib import Path
from time import monotonic

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import as_path, replacing
from rps_exudyn.results.block import AxisColumns, Block, CaseRecord, packed
from rps_exudyn.results.result import Result, read_result

CASES = 512  # in a block: 1e5 cases are 196 files
IN_MEMORY = 4  # blocks read whole
SECONDS = 5.0  # of work that may be lost, where a block is not full before
SHARE = 0.05  # of the time that writing takes at most: while that is quick, less work may be lost


class Blocks:
    """The blocks in one study's folder, and those cases that wait for the next one."""

    def __init__(
        self, folder: Path, cases: int = CASES, axes: Callable[[Iterable[str]], AxisColumns] | None = None
    ) -> None:
        """`axes` returns the values of a study's axes in the cases of these hashes; only writers need it."""
        self.folder = folder
        self._cases = cases
        self._axes = axes
        self._waiting: dict[str, CaseRecord] = {}
        self._filling: Path | None = None  # where those that wait have been written already
        self._written = float("-inf")
        self._took = 0.0  # to write [s]
        self._homes: dict[str, Path] = {}
        self._seen = 0  # when the folder had changed, for `_homes`
        self._read: OrderedDict[tuple[Path, int, int, int], Block] = OrderedDict()

    @property
    def exist(self) -> bool:
        """Return whether the study keeps its cases in blocks."""
        return self.folder.is_dir()

    @property
    def paths(self) -> list[Path]:
        """Files of the blocks, in the order in which they were written."""
        return sorted(path for path in self.folder.glob("*.h5") if path.stem.isdigit())

    def add(self, record: CaseRecord) -> None:
        """Take a case; write the block if that fills it, or if it has not been written for long.

        Raises:
            InputError: the block cannot be written; its cases wait on.
        """
        self._waiting[record.hash] = record
        full = len(self._waiting) >= self._cases
        if full or monotonic() - self._written > min(SECONDS, self._took / SHARE):
            self.flush()
        if full:
            self._waiting.clear()
            self._filling = None

    def flush(self) -> None:
        """Write the cases of the block that is being filled.

        Raises:
            InputError: the block cannot be written.
        """
        if not self._waiting:
            return
        if self._filling is None:
            taken = (
                path.name.split(".")[0] for path in self.folder.glob("[0-9]*")
            )  # also of those set aside
            last = max((int(number) for number in taken if number.isdigit()), default=-1)
            self._filling = self.folder / f"{last + 1:05d}.h5"
        begun = monotonic()
        with replacing(self._filling) as partial:
            partial.write_bytes(
                packed(list(self._waiting.values()), self._axes and self._axes(self._waiting))
            )
        self._written, self._seen = monotonic(), 0
        self._took = self._written - begun

    def home_of(self, case_hash: str) -> Path | None:
        """Return the file that holds a case, None if there is none."""
        if not self.exist:
            return None
        if (changed := self.folder.stat().st_mtime_ns) != self._seen:
            self._homes, self._seen = {}, changed
            for path in self.paths:
                try:
                    self._homes |= dict.fromkeys(Block.read(path, ()).places, path)
                except InputError:  # `rows` names it
                    continue
        return self._homes.get(case_hash)

    def block_of(self, case_hash: str) -> Block:
        """Return the block that holds a case; the last few are kept in memory.

        Raises:
            InputError: no block holds it, or the one that does is damaged.
        """
        path = self.home_of(case_hash)
        if path is None:
            raise InputError(f"{self.folder} holds no case {case_hash}.")
        stat = path.stat()
        version = path, stat.st_mtime_ns, stat.st_ino, stat.st_size  # one that is filled is replaced
        if version not in self._read:
            self._read[version] = Block.read(path)
            if len(self._read) > IN_MEMORY:
                self._read.popitem(last=False)
        return self._read[version]


def blocks_beside(case: Path) -> Blocks:
    """Return the blocks of the study to which a case's path DIR/cases/HASH.h5 belongs, to read from."""
    return _cached_blocks(case.absolute().parents[1] / "blocks")


_cached_blocks = lru_cache(maxsize=4)(Blocks)


def beside(result: Path, name: str) -> Path:
    """Return the path of a new file beside a result's; in the current folder if the result is in a block."""
    return (result.parent if result.parent.is_dir() else Path()) / name


def load(path: str | Path) -> Result:
    """Read a result from its HDF5 file, or a case of a study that is kept in blocks.

    Such a case has the path of the file that it would be: DIR/cases/HASH.h5, with the `hash` of the study's
    table.

    Raises:
        InputError: no such file or case, not a result of this package, damaged, or of a newer format.

    Examples:
        >>> rps.run("free-pinion-torque", fidelity="closed-form").save("result.h5")
        >>> rps.load("result.h5").scene
        'free-pinion-torque'
    """
    path = as_path(path)
    if path.parent.name == "cases" and not path.exists() and (blocks := blocks_beside(path)).exist:
        return blocks.block_of(path.stem).result(path.stem)
    return read_result(path)
