"""What the pages refer to: public names, and headings."""

import re
from pathlib import Path

import pytest

import rps_exudyn as rps

ROOT = Path(__file__).parents[2]
PAGES = [
    *(ROOT / f"{name}.md" for name in ("README", "CONTRIBUTING", "CHANGELOG")),
    *sorted((ROOT / "docs").glob("*.md")),
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


def test_page_of_models_has_the_numbers_of_the_results() -> None:
    """Times and errors of each simplification stand in the tables of models and facets."""
    page = (ROOT / "docs" / "models.md").read_text(encoding="utf-8").split("<!-- table")[0]
    source = (ROOT / "results" / "accuracy_speed" / "README.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| .+ \| ([\d.]+|as below) \| ([\d.]+) \|$", page, re.M)
    assert len(rows) == 8
    for time, error in rows:
        assert f"| {time} | {error} |" in source or f"| {error} % |" in source
