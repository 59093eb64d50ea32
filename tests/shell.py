"""How tests call `rps-exudyn`, and what they look at afterwards."""

import json
from collections.abc import Callable, Sequence
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
