"""What stands in the pages for a reader to run, and fresh processes that run it."""

import importlib.util
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any, NamedTuple

from shell import in_fresh_process, reader_environment

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "studies" / "examples"
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md")),
    *sorted((ROOT / "docs").rglob("*.md")),
    *sorted(EXAMPLES.rglob("*.md")),
]
SHELLS = ("sh", "shell")
FENCE = re.compile(r"^```(?P<language>\w*)\n(?P<text>.*?)^```$", re.S | re.M)
INDENTED = re.compile(r"(?<=\n\n)((?: {4}[^\n]*\n)+)")
PROGRAMS = r"(?:rps-exudyn|python3?|pip|pytest|mkdocs|dask)"
IN_TEXT = re.compile(rf"`({PROGRAMS} [^`]+|\.venv/bin/[^`]+|\.ci/run)`")
STARTED = 300.0  # [s] that a server may take on a busy machine until it answers


class Printed(NamedTuple):
    """Something to run: a command line, or a block of another language."""

    line: int  # of the page
    language: str  # "sh", or that of the block
    text: str


def module_of(name: str) -> Any:
    """Return a module by which the site makes its pages; docs/ is no package."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "docs" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def filled(markdown: str) -> str:
    """Return the text of a page with the tables that the site generates."""
    return str(module_of("hooks").filled(markdown))


def printed_in(page: Path) -> list[Printed]:
    """Return the command lines and blocks of a page, in their order; blocks of the shell line by line."""
    text = page.read_text(encoding="utf-8")
    found: list[tuple[int, str, str]] = []
    prose = text
    for block in [*FENCE.finditer(text), *INDENTED.finditer(text)]:
        language = block.groupdict().get("language", "")
        start = block.start("text") if language else block.start()
        found += _of_block(start, language, block["text"] if language else block[0])
        prose = prose[: block.start()] + re.sub(r"[^\n]", " ", block[0]) + prose[block.end() :]
    found += [(each.start(), "sh", " ".join(each[1].split())) for each in IN_TEXT.finditer(prose)]
    return [Printed(text.count("\n", 0, at) + 1, language, what) for at, language, what in sorted(found)]


def _of_block(start: int, language: str, text: str) -> Iterator[tuple[int, str, str]]:
    if language and language not in SHELLS:
        yield start, language, text
        return
    at = start
    for line in text.splitlines(keepends=True):
        command, _, comment = line.partition(" #")
        assert not command.endswith("\\\n"), f"a command on several lines: {line}"
        if (command := command.strip()) and (language or re.match(f"{PROGRAMS} ", command)):
            yield at, "sh", command
            yield from ((at + 1, "sh", each[1]) for each in IN_TEXT.finditer(comment))
        at += len(line)


class Terminal:
    """A shell in a folder: each line is a process of its own; `cd` holds for the next ones."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._where = folder / ".where"

    def run(self, line: str) -> "subprocess.CompletedProcess[str]":
        """Run a line and wait for its end."""
        remembered = f'{line}\nstatus=$?\npwd > "{self._where}"\nexit $status'
        done = in_fresh_process(remembered, self.folder)
        self.folder = Path(self._where.read_text().strip())
        return done


class Server:
    """A command that goes on until it is ended, in a process group of its own.

    Args:
        line: the command.
        folder: where it runs.
        ready: pattern of what it prints when it answers.
        environment: variables beside those of a reader.
    """

    def __init__(self, line: str, folder: Path, ready: str, **environment: str) -> None:
        with NamedTemporaryFile(dir=folder, prefix=".server", delete=False) as log:
            self._log = Path(log.name)
            self._process = subprocess.Popen(
                f"exec {line}",
                shell=True,
                cwd=folder,
                env={**reader_environment(), **environment},
                stdout=log,
                stderr=log,
                start_new_session=True,
                preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
            )
        try:
            self.answer = self._when_ready(ready)
        except BaseException:
            self.end()
            raise

    def _when_ready(self, ready: str) -> "re.Match[str]":
        end = time.monotonic() + STARTED
        while not (found := re.search(ready, self.said)):
            assert self._process.poll() is None, f"it has ended: {self.said}"
            assert time.monotonic() < end, f"it does not answer: {self.said}"
            time.sleep(0.05)
        return found

    @property
    def said(self) -> str:
        """All that it has printed."""
        return self._log.read_text(encoding="utf-8", errors="replace")

    def interrupt(self) -> int:
        """Press Ctrl-C and return the exit status."""
        self._process.send_signal(signal.SIGINT)
        return self._process.wait()

    def end(self) -> None:
        """End it with all its processes."""
        if self._process.poll() is None:
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()


class Session:
    """A Python that is fed block by block, as at a prompt or in a notebook."""

    FED = """
import json, sys
names = {"__name__": "__main__"}
for line in sys.stdin:
    where, text = json.loads(line)
    exec(compile(text, where, "exec"), names)
    print(end="\\x04", flush=True)
"""

    def __init__(self, folder: Path) -> None:
        self._errors = folder / ".session.log"
        with self._errors.open("wb") as errors:
            self._process = subprocess.Popen(
                [sys.executable, "-c", self.FED],
                cwd=folder,
                env=reader_environment(),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=errors,
                text=True,
            )

    def run(self, text: str, where: str) -> str:
        """Run a block and return what it printed.

        Raises:
            AssertionError: an exception, or a warning, which the message has.
        """
        assert self._process.stdin
        assert self._process.stdout
        self._process.stdin.write(json.dumps([where, text]) + "\n")
        self._process.stdin.flush()
        printed = ""
        while (character := self._process.stdout.read(1)) not in ("", "\x04"):
            printed += character
        errors = self._errors.read_text(encoding="utf-8", errors="replace")
        assert character, f"{where}: {errors}"
        assert "Warning" not in errors, f"{where}: {errors}"
        return printed

    def end(self) -> int:
        """Leave it and return the exit status."""
        assert self._process.stdin
        assert self._process.stdout
        self._process.stdin.close()
        self._process.stdout.close()
        return self._process.wait()
