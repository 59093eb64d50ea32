"""What the cases of a study say, in groups: causes of failure, and remarks on cases that ended ok.

Messages of the same codes are one group; without codes, those that differ only in their numbers.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rps_exudyn.results.outcome import Status, alike
from rps_exudyn.study.description import Case
from rps_exudyn.study.store import CaseRow

SILENT = "no message"


@dataclass(frozen=True)
class Group:
    """Cases that ended alike and said the same."""

    status: Status
    example: str  # the message of the first case
    cases: Sequence[Case]

    def line(self) -> str:
        """One line: how many, how they ended, and what the first of them said."""
        count, ended = len(self.cases), "" if self.status is Status.OK else f" {self.status}"
        first = "" if count == 1 else "; for instance"
        return f"{count} case{'' if count == 1 else 's'}{ended}{first}: {self.example}"


def groups(ended: Iterable[tuple[Case, CaseRow]]) -> list[Group]:
    """The groups of cases that have something to say, or failed; the largest first."""
    found: dict[tuple[str, ...], list[tuple[Case, str]]] = {}
    for case, row in ended:
        if row.message or row.status is not Status.OK:
            key = alike(row.status, row.codes, row.message)
            found.setdefault(key, []).append((case, row.message or SILENT))
    made = [Group(Status(key[0]), pairs[0][1], [case for case, _ in pairs]) for key, pairs in found.items()]
    return sorted(made, key=lambda group: -len(group.cases))
