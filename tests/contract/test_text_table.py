"""Tables of the commands: nothing lost where cells are broken, lines no longer than the terminal."""

import sys

import pytest
from rich.console import Console
from rich.table import Table as Grid

from rps_exudyn.cli import output
from rps_exudyn.cli.output import GAP, present, print_line, print_table
from rps_exudyn.parameters.gear import Setup
from rps_exudyn.results.sheet import Row, Sheet

HEADS = ("parameter", "value", "meaning", "source")


@pytest.fixture(scope="module")
def rows() -> list[tuple[str, ...]]:
    """The longest table of all: every parameter."""
    return [(item.path, item.show(item.default), item.meaning, item.source) for item in Setup.declared()]


def lines_at(
    width: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], rows: list
) -> list:
    monkeypatch.setattr(output, "IN_FILES", width)
    print_table(HEADS, rows)
    return capsys.readouterr().out.splitlines()


@pytest.mark.parametrize("width", [90, 120, 200])
def test_broken_cells_keep_every_word_and_the_width(
    width: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], rows: list
) -> None:
    lines = lines_at(width, monkeypatch, capsys, rows)
    assert max(map(len, lines)) <= width
    words = sorted(word for row in [HEADS, *rows] for cell in row for word in cell.split())
    assert sorted(word for line in lines for word in line.split()) == words


def test_broken_lines_of_a_sheet_keep_their_columns(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setattr(output, "_width", lambda: 40)
    monkeypatch.setenv("TERM", "dumb")
    rows = Row("0.03 N m", "ripple, " * 9), Row("a", "b")
    present(Sheet("Free pinion torque", "teeth, " * 9, rows, more="24 quantities"), [], every=False)
    lines = capsys.readouterr().out.splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("  0.03 N m  ripple"))
    last = lines.index("  a         b")
    assert all(line.startswith("  teeth") for line in lines[1:first])
    assert all(line.startswith(" " * 12 + "ripple") for line in lines[first + 1 : last])
    assert last > first + 1 > 2
    assert max(map(len, lines)) <= 40
    assert "\n".join(lines).count("teeth") == 9


def test_wide_table_is_that_of_the_library_for_help(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], rows: list
) -> None:
    """An independent layout of the same table; it pads its last column."""
    grid = Grid(box=None, pad_edge=False, padding=(0, GAP, 0, 0))
    for head in HEADS:
        grid.add_column(head, no_wrap=head in output.UNBROKEN)
    for row in rows:
        grid.add_row(*row)
    console = Console(width=400, highlight=False, markup=False, emoji=False)
    with console.capture() as captured:
        console.print(grid)
    expected = [line.rstrip() for line in captured.get().splitlines()]
    assert lines_at(400, monkeypatch, capsys, rows) == expected


def test_columns_that_stay_whole_may_exceed_a_narrow_terminal() -> None:
    widths = output.column_widths(("parameter", "meaning"), [("a" * 30, "b " * 40)], 20)
    assert widths == [30, output.NARROWEST]


def test_terminal_gets_styles_and_lines_of_its_width(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    monkeypatch.setenv("COLUMNS", "30")
    monkeypatch.setenv("TERM", "xterm")
    print_line("one two three four five six seven eight", "bold")
    print_line("written: /a/path/that/is/longer/than/the/terminal.h5")
    first, second, *rest = capsys.readouterr().out.splitlines()
    assert (first, second) == ("\x1b[1mone two three four five six\x1b[0m", "\x1b[1mseven eight\x1b[0m")
    assert rest == ["written:", "/a/path/that/is/longer/than/the/terminal.h5"]  # a path stays whole
    monkeypatch.setenv("TERM", "dumb")
    print_line("eight", "bold")
    assert capsys.readouterr().out == "eight\n"


def test_terminal_greys_vague_rows(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    sheet = Sheet("Turn", rows=(Row("1 ± 1 N", "force", is_vague=True), Row("1.0 ± 0.1 N", "force")))
    present(sheet, [], every=False)
    assert "\x1b" not in capsys.readouterr().out
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    present(sheet, [], every=False)
    print_table(("quantity",), [["a"], ["b"]], dim=[1])
    lines = capsys.readouterr().out.splitlines()
    assert [line.startswith("\x1b[2m") for line in lines] == [False, True, False, False, True, False, True]
