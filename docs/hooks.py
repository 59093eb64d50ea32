"""What mkdocs does besides: pages outside docs/, links between them, tables made from the declarations."""

import posixpath
import re
from collections.abc import Iterator
from html import escape, unescape
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mkdocs.structure.files import Files

ROOT = Path(__file__).parents[1]
PAGES = ("CONTRIBUTING.md", "CHANGELOG.md", "CITATION.cff")
LINK = re.compile(r"(!?\[[^\]]*\])\((?!https?:|#|mailto:)([^)\s#]+)(#[^)\s]*)?\)")
MARK = re.compile(r"<!-- generated: (\w+) -->")
OPTION = re.compile(r"(?<=[ >])--[a-z-]+(?=[^<>]*</code>)")
FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.+?)\\[)\]]</\1>', re.DOTALL)
SUFFIXES = (".md", ".png", ".svg", ".webp", ".csv", ".json")


def on_files(files: "Files", config: Any) -> "Files":
    """Add published numbers and the project's own pages to the site."""
    from mkdocs.structure.files import File

    found = [ROOT / name for name in PAGES]
    found += [path for path in (ROOT / "results").rglob("*") if path.suffix in SUFFIXES]
    for path in found:
        files.append(File.generated(config, path.relative_to(ROOT).as_posix(), abs_src_path=str(path)))
    return files


def filled(markdown: str) -> str:
    """Return the text of a page with its generated tables."""
    return MARK.sub(lambda found: "\n".join(GENERATED[found[1]]()), markdown)


def on_page_markdown(markdown: str, page: Any, files: "Files", **_: Any) -> str:
    """Fill in generated tables; lead links to where the files stand in the site."""
    markdown = filled(markdown)
    uri = page.file.src_uri
    place = uri if uri.startswith(("results/", *PAGES)) else f"docs/{uri}"
    markdown = markdown.replace('--8<-- "README.md:3"', _readme()) if uri == "index.md" else markdown
    place = "README.md" if uri == "index.md" else place

    def led(found: re.Match[str]) -> str:
        text, target, anchor = found[1], found[2], found[3] or ""
        from_root = posixpath.normpath(posixpath.join(posixpath.dirname(place), target))
        in_site = from_root.removeprefix("docs/")
        if files.get_file_from_path(in_site) is None:
            return text.strip("![]")  # a file of the code: its name is enough
        return f"{text}({posixpath.relpath(in_site, posixpath.dirname(uri) or '.')}{anchor})"

    return LINK.sub(led, markdown)


def on_page_content(content: str, **_: Any) -> str:
    """Set formulas as drawings: browsers show them without a script, a font or a request. Keep options whole:
    browsers break lines behind a hyphen."""
    content = OPTION.sub(lambda found: f'<span class="option">{found[0]}</span>', content)
    return FORMULA.sub(lambda found: _formula(unescape(found[2]).strip(), found[1]), content)


def _formula(text: str, tag: str) -> str:
    from matplotlib.font_manager import FontProperties
    from matplotlib.mathtext import math_to_image

    drawn, size = BytesIO(), 100  # points: sizes are whole numbers
    text = text.replace(r"\frac", r"\dfrac") if tag == "div" else text
    text = re.sub(
        r"(?<=[\w}])\s+(?=\\(?:sin|cos|tan|max|min)\b)", r"\\,", text
    )  # a thin space before a function
    font = FontProperties(size=size, math_fontfamily="cm")
    depth = math_to_image(f"${' '.join(text.split())}$", drawn, font, dpi=72, format="svg", color="#010101")
    svg = drawn.getvalue().decode()
    svg = re.sub(r"<metadata>.*?</metadata>|<style.*?</style>|<!--.*?-->", "", svg, flags=re.DOTALL)
    svg = re.sub(r'<g id="patch_1">.*?</g>', "", svg, flags=re.DOTALL).replace("#010101", "currentColor")
    width, height = re.findall(r'viewBox="0 0 (\d+) (\d+)"', svg)[0]
    look = f"width:{int(width) / size}em;height:{int(height) / size}em;vertical-align:{-depth / size}em"
    head = f'<svg class="formula" role="img" aria-label="{escape(text)}" viewBox="0 0 {width} {height}"'
    body = re.sub(r"\s*\n\s*", " ", svg[svg.index(">", svg.index("<svg")) + 1 :]).strip()
    return f'<{tag} class="formula-{tag}">{head} style="{look}">{body}</{tag}>'


def _readme() -> str:
    return (ROOT / "README.md").read_text(encoding="utf-8").split("\n", 2)[2]


def _parameters() -> Iterator[str]:
    from rps_exudyn.parameters.gear import Setup

    setup, table = Setup(), ""
    for item in Setup.declared():
        head = item.path.rpartition(".")[0]
        if head != table:
            yield from (
                "",
                f"## {head}",
                "",
                "| parameter | value | allowed | meaning | source |",
                "|---|---|---|---|---|",
            )
            table = head
        cells = (
            f"`{item.path}`",
            item.show(setup.value_at(item.path)),
            item.allowed,
            item.meaning,
            item.source,
        )
        yield f"| {' | '.join(str(cell).replace('|', '/') for cell in cells)} |"


def _quantities() -> Iterator[str]:
    from rps_exudyn.results.quantities import GROUPS

    for group, quantities in GROUPS.items():
        how = (" error bar |", "---|") if group == "summary" else ("", "")
        yield from ("", f"## {group}", "", f"| name | unit | definition |{how[0]}", f"|---|---|---|{how[1]}")
        for name, quantity in quantities.items():
            shown = (" yes |" if quantity.simulated else " no |") if group == "summary" else ""
            yield f"| `{name}` | {quantity.unit or '1'} | {quantity.long_name.replace('|', '/')} |{shown}"


def _codes() -> Iterator[str]:
    from rps_exudyn.parameters.retired import RETIRED_CODES
    from rps_exudyn.results.outcome import Code

    yield from ("| code | meaning |", "|---|---|", *(f"| `{code}` | {code.meaning} |" for code in Code))
    yield from (f"| `{code}` | {meaning} (1.0) |" for code, meaning in RETIRED_CODES.items())


def _own_model() -> Iterator[str]:
    """The example without its beginning, as a block of code."""
    script = (ROOT / "studies" / "examples" / "own_exudyn_model.py").read_text(encoding="utf-8")
    yield from ("```python", script[script.index("gear = ") :].rstrip(), "```")


GENERATED = {
    "parameters": _parameters,
    "quantities": _quantities,
    "codes": _codes,
    "own_exudyn_model": _own_model,
}
"""Mark in a page -> lines that stand in its place."""
