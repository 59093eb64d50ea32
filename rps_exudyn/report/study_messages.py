"""What the cases of a study say, linked to them: remarks on those that ended ok, and causes of failure."""

from collections.abc import Iterable, Sequence
from hashlib import sha256

from rps_exudyn.report.blocks import Block, Cell, Fold, Grid, Link, Links, Section, Text, Warning
from rps_exudyn.study.description import Case
from rps_exudyn.study.messages import Group, groups
from rps_exudyn.study.table import CaseTable, show_value

MOST_ROWS = 300  # cases listed one by one
MOST_LINKS = 40  # cases of one group
LINK_DIGITS = 3


def case_id(table: CaseTable, case: Case) -> str:
    """The place of a case on its page, among all cases, also those of another folder of the same study."""
    folder = sha256(str(table.path).encode(errors="replace")).hexdigest()[:6]
    return f"{table.description.name}-{folder}-{case.hash}".replace(" ", "-")


def case_link(table: CaseTable, case: Case) -> Links:
    """The case's name, which leads to its row as far as cases are listed."""
    listed = {each.hash for each in table.cases[:MOST_ROWS]}
    return Links([Link(case.hash, case_id(table, case) if case.hash in listed else "")])


def settings(table: CaseTable, case: Case, digits: int = 6) -> list[str]:
    """The values of the axes as text."""
    return [show_value(axis, case.values[axis.name], digits) for axis in table.description.axes]


def count(number: int, noun: str) -> str:
    """The number with its noun: "1 case", "3 cases"."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def remarks_section(table: CaseTable) -> list[Section]:
    """The section of remarks; none without remarks."""
    found = groups(table.remarked())
    if not found:
        return []
    blocks: list[Block] = []
    limited = int(table.limited.sum())
    if 0 < limited < table.ok.sum():
        blocks.append(
            Warning(
                f"{count(limited, 'case')} of {int(table.ok.sum())} met a limit of the gear, where a contact "
                "opens or closes: numbers have a kink there. Charts show these cases as diamonds; lines and "
                "colours are not carried from one side to the other."
            )
        )
    else:
        blocks.append(Text("These cases ended ok and say more about themselves."))
    rows: list[Sequence[Cell]] = [
        [count(len(each.cases), "case"), each.example, _links(table, each)] for each in found
    ]
    blocks.append(Grid(("how many", "remark of the first", _which(table)), rows))
    return [Section("Remarks", blocks)]


def failed_blocks(table: CaseTable) -> Iterable[Block]:
    """Causes with their numbers of cases, then every failed case by the way it ended."""
    failed = list(table.failed())
    if causes := groups(failed):
        rows: list[Sequence[Cell]] = [
            [count(len(each.cases), "case"), each.status.value, each.example, _links(table, each)]
            for each in causes
        ]
        yield Grid(("how many", "ended", "message of the first", _which(table)), rows, "Causes")
    for status in dict.fromkeys(row.status for _, row in failed):
        listed = [
            [row.message, *settings(table, case), case.hash] for case, row in failed if row.status is status
        ]
        grid = Grid(("message", *table.axes, "case"), listed[:MOST_ROWS])
        yield Fold(f"{status}: {count(len(listed), 'case')}", [Text(status.remedy), grid], is_open=True)
    if table.skipped:
        files = [[path.name, sentence] for path, sentence in table.skipped]
        yield Grid(("file", "why it could not be read"), files[:MOST_ROWS], "Files left out")
    if not failed and not table.skipped:
        yield Text("None.")


def _which(table: CaseTable) -> str:
    """The heading over links to cases, which are named by the values of the axes."""
    return f"which ({', '.join(table.axes)})"


def _links(table: CaseTable, group: Group) -> Links:
    """Links to the cases as far as they are listed on the page."""
    listed = {case.hash for case in table.cases[:MOST_ROWS]}
    links = [
        Link(
            ", ".join(settings(table, case, LINK_DIGITS)), case_id(table, case) if case.hash in listed else ""
        )
        for case in group.cases[:MOST_LINKS]
    ]
    more = len(group.cases) - len(links)
    return Links([*links, Link(f"and {more} more", "")] if more else links)
