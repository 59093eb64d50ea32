"""The exception for wrong input: sentences that say what to change."""

from collections.abc import Iterable


class InputError(ValueError):
    """Wrong input by the user: parameters, files, options.

    Each of `problems` is one sentence that names what, where, which value, and what is allowed.
    The command line prints them and exits with status 2; nothing has been computed by then.
    """

    def __init__(self, problems: str | Iterable[str]) -> None:
        self.problems = [problems] if isinstance(problems, str) else list(problems)
        super().__init__("\n".join(self.problems))
