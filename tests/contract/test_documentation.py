"""What the pages refer to: public names, and headings."""

import re
from html import escape
from pathlib import Path

import pytest

import rps_exudyn as rps
from reader import module_of
from rps_exudyn.scenes import SCENE_NAMES

ROOT = Path(__file__).parents[2]
PAGES = [
    *(ROOT / f"{name}.md" for name in ("README", "CONTRIBUTING", "CHANGELOG")),
    *sorted((ROOT / "docs").rglob("*.md")),
    *sorted((ROOT / "results").rglob("*.md")),
]


def test_reference_has_every_public_name() -> None:
    """At the place where it is defined: the site cannot be built otherwise."""
    page = (ROOT / "docs" / "reference.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"^::: (.+)$", page, re.M))
    homes = {name: f"{getattr(rps, name).__module__}.{name}" for name in rps.__all__}
    assert {name for name, home in homes.items() if home not in listed} == set()


def linked_headings() -> set[tuple[Path, str]]:
    """Page and anchor of every heading that a link leads to."""
    found = set()
    for page in PAGES:
        for target, anchor in re.findall(r"\]\(([^)#:\s]*)#([^)\s]+)\)", page.read_text(encoding="utf-8")):
            found.add(((page.parent / target).resolve() if target else page, anchor))
    return found


@pytest.mark.parametrize(("page", "anchor"), sorted(linked_headings()), ids=lambda each: Path(each).name)
def test_linked_heading_has_the_same_anchor_everywhere(page: Path, anchor: str) -> None:
    """Words and single dashes: what is made of other signs differs between versions of Markdown."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.M)
    anchors = [re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings]
    assert anchor in anchors
    assert re.fullmatch(r"\w+(-\w+)*", anchor)


def test_links_to_headings_are_found() -> None:
    assert len(linked_headings()) > 20


def test_tutorial_has_nine_pages_and_the_gallery_twenty_entries() -> None:
    """All are in the site, which runs them when it is built; the entries' names differ."""
    executed = module_of("executed")
    pages = [path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs" / "tutorial").glob("*.md")]
    settings = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert len(pages) == 9
    assert all(f"- {page}" in settings for page in pages)
    assert len({entry.name for entry in executed.GALLERY}) == 20
    assert {entry.scene for entry in executed.GALLERY} <= set(SCENE_NAMES)


def test_build_names_each_page_and_entry_as_it_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(executed := module_of("executed"), "PLACE", tmp_path)
    caplog.set_level("INFO", "mkdocs")
    page = "# Page\n\n```python\n# no heading\n```\n\n## Entry\n\n```python\n```\n```python\n```\n"
    executed.run_blocks("page", page)
    assert [line.rpartition(": ")[2] for line in caplog.messages] == ["Page", "Entry"]


def test_executed_blocks_show_what_they_print_and_draw(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    executed = module_of("executed")
    monkeypatch.setattr(executed, "PLACE", tmp_path)
    draw = "from pathlib import Path\n\nPath('a.png').touch()\nprint(2 + 3)\n"
    page = f"```sh\necho one\n```\n\n```python\n{draw}```\n"
    _, shown = executed.run_blocks("page", page)
    assert [tuple(each) for each in shown] == [("one\n", []), ("5\n", ["a.png"])]
    assert executed.run_blocks("page", page)[1] == shown
    with pytest.raises(RuntimeError, match="exit 2"):
        executed.run_blocks("page", "```sh\nexit 2\n```\n")


def test_formulas_are_set_as_drawings_with_their_text() -> None:
    page = '<p>with <span class="arithmatex">\\(\\mu N\\)</span>.</p>'
    content = module_of("hooks").on_page_content(page)
    assert content.startswith('<p>with <span class="formula-span"><svg')
    assert 'aria-label="\\mu N"' in content
    assert "arithmatex" not in content


def test_options_stay_whole() -> None:
    page = "<p>a -- b <code>fit --free rack.bow</code>, <code>--all</code></p>"
    content = module_of("hooks").on_page_content(page)
    assert content.count('<span class="option">') == 2
    assert re.sub(r"</?span[^>]*>", "", content) == page


def formulas() -> list[tuple[str, str, str]]:
    """Page, formula and tag of every formula of the pages, outside of code."""
    found = []
    for page in PAGES:
        text = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
        for block, inline in re.findall(
            r"\$\$(.+?)\$\$|(?<![\\$\w])\$(?!\s)([^$\n]+?)(?<!\s)\$(?!\w)", text, re.DOTALL
        ):
            found.append((page.name, (block or inline).strip(), "div" if block else "span"))
    return found


def test_every_formula_can_be_drawn() -> None:
    """What the drawing of formulas does not accept ends the build of the site."""
    draw = module_of("hooks").on_page_content
    assert len(formulas()) > 100
    for page, formula, tag in formulas():
        begin, end = ("\\[", "\\]") if tag == "div" else ("\\(", "\\)")
        content = f'<{tag} class="arithmatex">{begin}{escape(formula)}{end}</{tag}>'
        assert "<svg" in draw(content), page


def test_pages_are_no_longer_than_stated() -> None:
    """Words as `wc -w` counts them: docs at most 28 000, README with its chart 700."""
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")]
    words = {page: len(page.read_text(encoding="utf-8").split()) for page in pages}
    assert sum(words.values()) <= 28_000 + 700 + 1_200
    assert words[ROOT / "README.md"] <= 700
