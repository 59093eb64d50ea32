"""How tests call `rps-exudyn`, in their own process or in a fresh one, and what they look at afterwards."""

import json
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple


class Answer(NamedTuple):
    """What a command left behind."""

    status: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        return json.loads(self.out)


Command = Callable[[Sequence[str]], Answer]


def refusal_of(answer: Answer) -> str:
    """Return what a command has said on standard error, which must have refused its input."""
    assert answer.status == 2, answer
    assert "Traceback" not in answer.err
    return answer.err


def reader_environment() -> dict[str, str]:
    """Return the variables of a reader's terminal: home, language, and this Python's commands in the path."""
    commands = Path(sys.executable).parent
    kept = {name: os.environ[name] for name in ("HOME", "LANG") if name in os.environ}
    return {**kept, "PATH": f"{commands}{os.pathsep}{os.environ['PATH']}"}


def in_fresh_process(line: str, folder: Path, **environment: str) -> "subprocess.CompletedProcess[str]":
    """Run a line of a shell in a folder, in a reader's environment and these variables."""
    variables = {**reader_environment(), **environment}
    return subprocess.run(
        line, shell=True, cwd=folder, env=variables, capture_output=True, text=True, check=False
    )
