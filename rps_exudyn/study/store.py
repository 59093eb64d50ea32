"""A study's folder: its description, and its finished cases.

    DIR/study.toml   the study file, verbatim      DIR/blocks/        many cases in a file
    DIR/study.json   the `Description`             DIR/cases/HASH.h5  on request: instead a file for each case
    DIR/study.log    one line per finished case

A case's file, or block, is complete or absent. Other files in cases/ are not touched; files that cannot be
read are listed in `Store.skipped`, and their cases count as not done.
"""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import as_path, check_writable, number_existing, replacing
from rps_exudyn.results.block import CaseRecord, CaseRow, summaries
from rps_exudyn.results.result import Result, read_result
from rps_exudyn.study.case_blocks import Blocks
from rps_exudyn.study.definition import Case, Description

# What a runner that was stopped at its start may leave, and one that was killed
BEGUN = {".lock", "cases", "blocks", "study.toml"}
HALF_WRITTEN = "cases/.*.h5", "blocks/.*.h5", ".study.*.json", ".study.*.toml"


class Store:
    """One study's folder. Reading it computes nothing and executes nothing that is stored in it."""

    def __init__(self, path: Path, description: Description) -> None:
        self.path = path
        self.description = description
        self.blocks = Blocks(path / "blocks", axes=description.axis_columns)
        self._read: dict[tuple[str, int, int], CaseRow] = {}  # by hash, size and time of change of a file
        self.skipped: list[tuple[Path, str]] = []
        """Files in cases/ and blocks/ that cannot be used, and why; filled by `rows` and `results`."""

    @classmethod
    def open(cls, path: str | Path) -> "Store":
        """The study in a folder.

        Raises:
            InputError: no study there, a damaged one, or one of another format version.
        """
        folder = as_path(path)
        if not folder.is_dir():
            raise InputError(f"{path} is no study's folder: there is no such folder.")
        return cls(folder, Description.read(folder / "study.json"))

    @classmethod
    def of(cls, path: str | Path, description: Description) -> "Store":
        """A folder for the study, new or the one in which it was begun; nothing is written yet."""
        _check_folder(Path(path), description)
        return cls(Path(path), description)

    def set_aside(self) -> None:
        """Rename the files in `skipped` to HASH.set-aside: someone may still need them."""
        for path, _ in self.skipped:
            with suppress(OSError, InputError):
                number_existing(aside := path.with_suffix(".set-aside"))
                path.replace(aside)

    def make_folders(self, blocks: bool | None = None) -> None:
        """Make the folder and its blocks/; or its cases/, if it was begun so, or if `blocks` is False.

        Raises:
            InputError: they cannot be made or written to.
        """
        in_files = blocks is False or next((self.path / "cases").glob("*.h5"), None) is not None
        folder = self.path / ("cases" if in_files and not self.blocks.exist else "blocks")
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"{self.path} cannot be written: {error.strerror or error}.") from None
        check_writable(folder / "any.h5")

    def write_description(self) -> None:
        """Write study.json."""
        with replacing(self.path / "study.json") as partial:
            partial.write_text(self.description.to_json(), encoding="utf-8")

    # --- cases ---------------------------------------------------------------------------------

    def path_of(self, case_hash: str) -> Path:
        """The path of the case's file, whether it exists or not."""
        return self.path / "cases" / f"{case_hash}.h5"

    def result(self, case: Case) -> Result:
        """The case's whole result."""
        path = self.path_of(case.hash)
        if not path.exists() and (home := self.blocks.home_of(case.hash)) is not None:
            path, result = home, self.blocks.block_of(case.hash).result(case.hash)
        else:
            result = read_result(path)
        self._check_content(path, case, result)
        return result

    def add(self, record: CaseRecord) -> None:
        """Write a case's file, or add the case to the next block.

        Raises:
            InputError: the file, or the block that is full, cannot be written.
        """
        if self.blocks.exist:
            self.blocks.add(record)
        else:
            record.result().save(self.path_of(record.hash))

    def rows(self) -> Iterator[tuple[Case, CaseRow]]:
        """Every finished case once, in the order of the design, failed simulations too."""
        files, in_blocks = self._files(), self._rows_in_blocks()
        for case in self.description.hashes.values():
            if (stamp := files.get(case.hash)) is not None:
                with self._skipping(case):
                    if (key := (case.hash, *stamp)) not in self._read:
                        self._read[key] = CaseRow.of(CaseRecord.of(case.hash, self.result(case)))
                    yield case, self._read[key]
            elif case.hash in in_blocks:
                yield case, in_blocks[case.hash]

    def results(self) -> Iterator[tuple[Case, Result]]:
        """Every finished case with its signals, one at a time."""
        files, in_blocks = self._files(), self._rows_in_blocks()
        for case in self.description.hashes.values():
            if case.hash in files or case.hash in in_blocks:
                with self._skipping(case):
                    yield case, self.result(case)

    @contextmanager
    def _skipping(self, case: Case) -> Iterator[None]:
        try:
            yield
        except InputError as error:
            self.skipped.append((self.path_of(case.hash), " ".join(error.problems)))

    def _files(self) -> dict[str, tuple[int, int]]:
        """Hash -> size and time of change of each case's file; begins `skipped` anew."""
        self.skipped = []
        try:
            with os.scandir(self.path / "cases") as entries:
                files = (item for item in entries if not item.name.startswith("."))  # not half written
                found = {item.name[:-3]: item.stat() for item in files if item.name.endswith(".h5")}
                return {name: (stat.st_size, stat.st_mtime_ns) for name, stat in found.items()}
        except FileNotFoundError:
            return {}

    def _rows_in_blocks(self) -> dict[str, CaseRow]:
        """Hash -> row of the cases in blocks."""
        found: dict[str, CaseRow] = {}
        for path in self.blocks.paths:
            try:
                found |= {case.hash: case for case in summaries(path)}
            except InputError as error:
                self.skipped.append((path, " ".join(error.problems)))
        return found

    def _check_content(self, path: Path, case: Case, result: Result) -> None:
        """Check that a file under a case's name holds that case."""
        if result.scene != self.description.scene:
            raise InputError(f"{path} holds {result.scene}, not this study's {self.description.scene}.")
        expected = {**self.description.base, **self.description.settings(case)}
        for parameter, value in expected.items():
            if parameter.startswith("fidelity."):
                found = result.fidelity.get(parameter.removeprefix("fidelity."), value)
            else:
                found = result.gear.value_at(parameter)
            if found != value:
                raise InputError(f"{path} holds another case: {parameter} is {found}, not {value}.")

    # --- one runner at a time ------------------------------------------------------------------

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Lock the folder for other runners; the lock ends with the process, however that ends.

        Raises:
            InputError: another runner is at work on the folder.
        """
        try:
            lock = (self.path / ".lock").open("a+", encoding="utf-8")
        except OSError as error:
            raise InputError(f"{self.path} cannot be written: {error.strerror or error}.") from None
        with lock as file:
            if _try_lock(file.fileno()):
                file.truncate(0)
                file.write(f"process {os.getpid()} on {socket.gethostname()}")
                file.flush()
                for partial in (path for name in HALF_WRITTEN for path in self.path.glob(name)):
                    with suppress(OSError):
                        partial.unlink()
                yield
            else:
                file.seek(0)
                raise InputError(
                    f"{self.path} is in use by {file.read() or 'another runner'}; "
                    "wait for it, or choose another folder by --out."
                )


def _try_lock(descriptor: int) -> bool:
    """Return whether the lock was free.

    Where there are no locks (Windows, some network disks) it always is: then two runners do work twice, but
    each file is still written whole.
    """
    try:
        import fcntl
    except ImportError:
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        pass
    return True


def _check_folder(folder: Path, description: Description) -> None:
    """Check that the folder is new, is empty or belongs to this study."""
    if not folder.is_dir():
        if folder.exists():
            raise InputError(f"{folder} cannot be a study's folder: it is a file.")
        return
    if not (folder / "study.json").exists():
        if all(item.name in BEGUN or any(map(item.match, HALF_WRITTEN)) for item in folder.iterdir()):
            return
        raise InputError(f"{folder} is no study's folder, and not empty; choose another one by --out.")
    existing = Description.read(folder / "study.json")
    if existing.name != description.name or existing.scene != description.scene:
        raise InputError(
            f"{folder} holds the study {existing.name} ({existing.scene}), not {description.name} "
            f"({description.scene}); choose another folder by --out."
        )
    if existing.signals != description.signals:
        raise InputError(
            f"{folder} holds this study with another [keep] table; choose another folder by --out."
        )
