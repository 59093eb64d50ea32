"""What is wrong with parameters: which ones, and a sentence that says what is allowed."""

from collections.abc import Iterable
from typing import NamedTuple


class Problem(NamedTuple):
    """One thing that is wrong: the parameters' paths, and a sentence that says what is allowed."""

    paths: tuple[str, ...]
    sentence: str

    def concerns(self, settings: Iterable[str]) -> bool:
        """Tell whether one of its parameters (or a table of theirs) is among the paths `settings`."""
        return any(f"{setting}.".startswith(f"{path}.") for setting in settings for path in self.paths)


class ConflictError(ValueError):
    """Raised where parameters that are each fine alone do not fit each other."""

    def __init__(self, problems: list[Problem]) -> None:
        self.problems = problems
        super().__init__("\n".join(problem.sentence for problem in problems))
