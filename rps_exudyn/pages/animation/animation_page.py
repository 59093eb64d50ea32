"""The page that plays a result: one file without requests, which a browser opens from the disk."""

import base64
import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from rps_exudyn.base.files import replacing
from rps_exudyn.pages.animation.camera import VIEWS
from rps_exudyn.pages.animation.film import image_bytes, still
from rps_exudyn.pages.animation.motion import Motion
from rps_exudyn.pages.animation.overlays import ContactLines, contact_lines
from rps_exudyn.pages.animation.page_data import page_data
from rps_exudyn.pages.animation.parts import PicturePart, picture_parts
from rps_exudyn.pages.charts.style import about, scene_of
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import Quantity
from rps_exudyn.results.result import Result

_FOLDER = Path(__file__).parent / "viewer"
SCRIPTS = ("data.js", "gl.js", "overlay.js", "scene.js", "curve.js", "main.js")
FALLBACK = (640, 400)  # size of the still for browsers without WebGL [pixels]
_LINE_LOAD = Quantity("N/m", "N/mm", "")


def write_page(result: Result, path: str | Path) -> None:
    """Write the page of a result.

    Raises:
        InputError: the result has no motion, or the file cannot be written.
    """
    text = page(result)
    with replacing(path) as partial:
        partial.write_text(text, encoding="utf-8", errors="replace")


def page(result: Result) -> str:
    """The page as HTML.

    Raises:
        InputError: the result has no motion.
    """
    motion = Motion.of(result)
    lines, parts = contact_lines(motion), picture_parts(result.gear)
    picture = image_bytes(still(motion, parts, lines, FALLBACK), "webp")
    return rendered(result, motion, parts, lines, picture)


def rendered(
    result: Result, motion: Motion, parts: list[PicturePart], lines: ContactLines | None, picture: bytes
) -> str:
    """The page of a result's motion as HTML; `picture` (WebP) is for browsers without WebGL."""
    data = page_data(motion, parts, lines)
    style, code = _style_and_script()
    return (
        environment(_FOLDER)
        .get_template("page.html")
        .render(
            title=f"{scene_of(result)}: animation",
            lead=about(result),
            notes=_notes(result, motion),
            still=f"data:image/webp;base64,{base64.b64encode(picture).decode('ascii')}",
            views=list(VIEWS),
            factors=[
                "as they are" if lift == tilt == 1 else f"lift × {lift:g}, tilt × {tilt:g}"
                for lift, tilt in data["factors"]
            ],
            curves=data["curves"],
            arrows=data["arrows"],
            densest=None if lines is None else _LINE_LOAD.show(float(lines.load.max())),
            remarks=list(_remarks(result, motion, lines)),
            data=json.dumps(data, separators=(",", ":")).replace("<", "\\u003c"),
            script=code,
            style=style,
            script_hash=hash_of(code),
            style_hash=hash_of(style),
        )
    )


def environment(folder: Path) -> Environment:
    """What renders the templates of a folder; all text is escaped."""
    loader = FileSystemLoader(folder)
    return Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )


def admitted() -> tuple[str, str]:
    """Hashes of the page's style and script, for the policy of a page that holds this one."""
    style, code = _style_and_script()
    return hash_of(style), hash_of(code)


@cache
def _style_and_script() -> tuple[str, str]:
    style = (_FOLDER / "page.css").read_text(encoding="utf-8")
    return style, "\n".join((_FOLDER / name).read_text(encoding="utf-8") for name in SCRIPTS)


def hash_of(text: str) -> str:
    """The hash by which a page's policy admits a script or a style."""
    return base64.b64encode(hashlib.sha256(text.encode("utf-8")).digest()).decode("ascii")


def _notes(result: Result, motion: Motion) -> list[str]:
    notes = []
    if result.status is not Status.OK:
        notes.append(f"This run failed ({result.status}): {result.message}")
    if motion.rigid:
        notes.append(
            f"Fidelity {result.fidelity['name']} has no deflections and no lines of contact: "
            "the rack moves along X only."
        )
    return notes


def _remarks(result: Result, motion: Motion, lines: ContactLines | None) -> Any:
    most = motion.largest_factors
    yield (
        f"{motion.frames} of {motion.recorded} recorded instants are shown, with those of every "
        "signal's largest and smallest value; between instants nothing is interpolated."
    )
    if not motion.rigid:
        yield (
            "Deflections are micrometres and milliradians. They are magnified about their mean over the "
            f"record by up to {most.displacement:g} times (lift, sideways, plunger) and {most.tilt:g} times "
            "(angles) what was computed; the mean itself stays as it is."
        )
    if lines is not None:
        yield (
            "Lines of contact have the places and loads of the contact law, and each flank side's sum is the "
            "recorded normal force."
        )
        if result.gear.mesh.contact_law == "area":
            yield 'Law "area" has no lines; their places and shares are those of law "line".'
        if result.gear.mesh.contact_law != "teeth":
            yield "The load along a line follows the depth: its sum is right, its distribution is not."
    yield (
        "Arrows end where a force acts and are as long as it is large. The bent arrow is the torque that "
        "drives the pinion. The plunger's bore and the spring are drawn only for illustration; the model "
        "contains their mass and spring rate."
    )
