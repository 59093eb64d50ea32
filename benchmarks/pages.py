"""Tables in pages: marked regions that are written from data files, never by hand.

<!-- table: NAME -->
... whatever stands here is replaced ...
<!-- end -->
"""

import re
from collections.abc import Mapping
from pathlib import Path

from benchmarks.published import origins_table
from benchmarks.topic import RESULTS, ROOT, Topic

REGION = re.compile(r"(<!-- table: (\S+) -->\n).*?(<!-- end -->)", re.DOTALL)


def pages() -> list[Path]:
    """All pages that may hold marked regions."""
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")), *sorted(RESULTS.rglob("*.md"))]


def regions(text: str) -> list[str]:
    """Names of the marked regions in a page."""
    return [name for _, name, _ in REGION.findall(text)]


def written(text: str, topics: Mapping[str, Topic], results: Path = RESULTS) -> str:
    """The page with each marked region written anew from the data files.

    Raises:
        KeyError: no topic writes a region of this name.
    """
    tables = {
        name: (table, results / topic.folder)
        for topic in topics.values()
        for name, table in topic.tables.items()
    }
    tables["published"] = (origins_table, results)

    def region(found: re.Match[str]) -> str:
        table, folder = tables[found[2]]
        return f"{found[1]}\n{table(folder)}\n\n{found[3]}"

    return REGION.sub(region, text)


def write_pages(topics: Mapping[str, Topic]) -> None:
    """Write every marked region of every page anew."""
    for page in pages():
        text = page.read_text(encoding="utf-8")
        if (again := written(text, topics)) != text:
            page.write_text(again, encoding="utf-8")
            print(f"{page.relative_to(ROOT)}: tables written anew")
