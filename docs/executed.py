"""Pages whose blocks are run when the site is built: the tutorial, and the gallery, whose entries stand here.

A block's output, and the pictures that it makes, follow it in the page. An error ends the build. What was run
for the same text by the same package is taken from build/executed.
"""

import hashlib
import json
import logging
import os
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import chdir, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from mkdocs.structure.files import Files

ROOT = Path(__file__).parents[1]
PLACE = ROOT / "build" / "executed"
LOG = logging.getLogger("mkdocs.hooks.executed")
HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)
BLOCK = re.compile(r"^```(sh|python)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
ENVIRONMENT = {"PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}", "COLUMNS": "100"}


SHOWN_LINES = 14  # of an output; the rest is cut
WIDTHS = {"gallery": 420}  # of pictures [px]


class Entry(NamedTuple):
    """One picture of the gallery: a run by a command, and the same from Python."""

    title: str
    scene: str
    fidelity: str = "quasi-static"
    changes: Mapping[str, str | int] = {}

    @property
    def name(self) -> str:
        return self.title.lower().replace(" ", "-")

    @property
    def command(self) -> str:
        sets = "".join(f' --set {path}="{value}"' for path, value in self.changes.items())
        return f"rps-exudyn run {self.scene} --fidelity {self.fidelity}{sets} --out {self.name}.h5"

    @property
    def code(self) -> str:
        changes = f".replace({json.dumps(dict(self.changes), ensure_ascii=False)})" if self.changes else ""
        return (
            f"import rps_exudyn as rps\n\ngear = rps.SteeringGear(){changes}\n"
            f'result = rps.run("{self.scene}", gear, fidelity="{self.fidelity}")\n'
            f'result.plot("{self.name}.png")\n'
        )


BRISTLES = {f"{part}.friction_law": "bristle" for part in ("mesh", "yoke", "bush", "bearing")}
GALLERY = (
    Entry("Free torque", "free-pinion-torque"),
    Entry("Runout", "free-pinion-torque", changes={"pinion.runout": "40 um"}),
    Entry("Lock to lock", "free-pinion-torque", changes={"test.path": "lock-to-lock"}),
    Entry("Seven teeth", "free-pinion-torque", changes={"pinion.teeth": 7}),
    Entry("Bent rack", "free-pinion-torque", changes={"rack.bow": "0.15 mm", "test.turns": 2}),
    Entry("Shaft angle error", "free-pinion-torque", changes={"installation.angle_error": "0.05 deg"}),
    Entry("Cold start", "free-pinion-torque", changes={"conditions.temperature": "-30 degC"}),
    Entry("Teeth that bend", "free-pinion-torque", changes={"mesh.law": "teeth"}),
    Entry("Load test", "load-test"),
    Entry("Heavy load", "load-test", changes={"test.load_mass": "80 kg"}),
    Entry("Rack push", "rack-push"),
    Entry("Reversal", "reversal"),
    Entry("Reversal on bristles", "reversal", changes=BRISTLES),
    Entry("Steering feel", "steering-feel"),
    Entry("Torque at the wheel", "steering-torque", changes={"test.tyre_stiffness": "50 N/mm"}),
    Entry("Stick-slip", "stick-slip", "flank"),
    Entry("Yoke impact", "yoke-impact", "flank"),
    Entry("Radial play", "radial-play"),
    Entry("Rack lift", "rack-lift"),
    Entry("Yoke setting", "yoke-setting"),
)


class Shown(NamedTuple):
    """What a block printed, and the names of the pictures that it made."""

    text: str
    pictures: list[str]


def run_blocks(name: str, markdown: str) -> tuple[Path, list[Shown]]:
    """Run the blocks of a page in their order, in a folder of its own; return it and what each block shows.

    Raises:
        RuntimeError: a command ends with a status above 1 (1 is an answer: a gear fails its requirements).
    """
    sources = (ROOT / "rps_exudyn").rglob("*.py")
    parts = [markdown.encode(), *(path.read_bytes() for path in sorted(sources))]
    key = hashlib.sha256(b"".join(parts)).hexdigest()[:16]
    folder = PLACE / name / key
    record = folder / "shown.json"
    if not record.exists():
        folder.mkdir(parents=True, exist_ok=True)
        names: dict[str, Any] = {"__name__": "__main__"}
        shown, end = [], 0
        for block in BLOCK.finditer(markdown):
            for heading in HEADING.findall(markdown, end, block.start()):
                LOG.info("Running the blocks of %s: %s", name, heading)
            end = block.end()
            before = {path: path.stat().st_mtime_ns for path in folder.glob("*.png")}
            text = _python(block[2], names, folder) if block[1] == "python" else _commands(block[2], folder)
            after = {path: path.stat().st_mtime_ns for path in folder.glob("*.png")}
            shown.append(Shown(text, sorted(path.name for path in after.keys() - before.keys())))
        record.write_text(json.dumps(shown), encoding="utf-8")
    return folder, [Shown(*each) for each in json.loads(record.read_text(encoding="utf-8"))]


def _python(text: str, names: dict[str, Any], folder: Path) -> str:
    with chdir(folder), redirect_stdout(StringIO()) as printed:
        exec(compile(text, "page", "exec"), names)
    return printed.getvalue()


def _commands(text: str, folder: Path) -> str:
    environment = os.environ | ENVIRONMENT
    done = subprocess.run(text, shell=True, cwd=folder, env=environment, capture_output=True, text=True)
    if done.returncode > 1:
        raise RuntimeError(f"{text}{done.stdout}{done.stderr}")
    return done.stdout


def gallery_page() -> str:
    """Return the gallery's text, without pictures: title, command, code of each entry."""
    return "\n".join(f"## {e.title}\n\n```sh\n{e.command}\n```\n\n```python\n{e.code}```\n" for e in GALLERY)


PAGES: dict[str, list[Shown]] = {}
"""Page -> what its blocks show."""


def on_files(files: "Files", config: Any) -> "Files":
    """Run the pages and add their pictures to the site."""
    from mkdocs.structure.files import File

    pages = sorted((ROOT / "docs" / "tutorial").glob("*.md"))
    texts = {f"tutorial/{path.name}": path.read_text(encoding="utf-8") for path in pages}
    for uri, text in {**texts, "gallery.md": gallery_page()}.items():
        name = uri.removesuffix(".md")
        folder, PAGES[uri] = run_blocks(name, text)
        for picture in (picture for each in PAGES[uri] for picture in each.pictures):
            files.append(File.generated(config, f"{name}/{picture}", abs_src_path=str(folder / picture)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Insert what each block printed and drew."""
    uri = page.file.src_uri
    if uri not in PAGES:
        return markdown
    markdown = markdown.replace("<!-- executed: gallery -->", gallery_page())
    shown = iter(PAGES[uri])
    place = Path(uri).stem

    def with_output(block: re.Match[str]) -> str:
        return "\n\n".join([block[0], *_output(next(shown), place)])

    return BLOCK.sub(with_output, markdown)


def _output(shown: Shown, place: str) -> Iterator[str]:
    lines = shown.text.strip().splitlines()
    if lines and place != "gallery":
        yield "\n".join(
            ["```text", *lines[:SHOWN_LINES], *(["..."] if len(lines) > SHOWN_LINES else []), "```"]
        )
    for picture in shown.pictures:
        yield f'<img alt="{Path(picture).stem}" src="{place}/{picture}" width="{WIDTHS.get(place, 720)}">'
