"""What a user did wrong, in sentences."""

from collections.abc import Iterable


class InputError(ValueError):
    """A mistake in what the user gave: parameters, files, options.

    Each problem is one sentence that names what, where, which value, and what is allowed.
    The command line prints them and exits with status 2; nothing has been computed by then.
    """

    def __init__(self, problems: str | Iterable[str]) -> None:
        self.problems = [problems] if isinstance(problems, str) else list(problems)
        super().__init__("\n".join(self.problems))
