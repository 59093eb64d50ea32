"""Stills and films of a motion without a browser: GIF, WebP, MP4, PNG."""

import io
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import replacing
from rps_exudyn.pages.animation.camera import Camera
from rps_exudyn.pages.animation.camera import view as camera_of
from rps_exudyn.pages.animation.drawn import Drawing, Triangles, paint_over
from rps_exudyn.pages.animation.motion import Motion
from rps_exudyn.pages.animation.overlays import ContactLines, contact_lines
from rps_exudyn.pages.animation.parts import PicturePart, picture_parts
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

SIZE = (800, 500)  # [pixels]
FILM_FRAMES = 60
SECONDS = 4.0  # that a film lasts
STILLS, FILMS = (".png", ".webp"), (".gif", ".mp4")
TOP, BOTTOM = np.array([0.81, 0.84, 0.87]), np.array([0.97, 0.975, 0.98])  # of the background
INK = (20, 20, 25)
OUTLINE_GAP, OUTLINE = 0.006, 0.45  # step in depth, over the eye's distance, that is an edge; its brightness
Size = tuple[int, int]


def write_still(result: Result, path: Path, view: str, *, explode: float = 0.0) -> None:
    """Write one picture (.png, .webp) of the record's first instant.

    Raises:
        InputError: the result has no motion, or the file cannot be written.
    """
    motion = Motion.of(result)
    picture = still(motion, picture_parts(result.gear), contact_lines(motion), SIZE, view, explode)
    with replacing(path) as partial:
        partial.write_bytes(image_bytes(picture, path.suffix[1:].lower()))


def write_film(result: Result, path: Path, view: str, *, explode: float = 0.0) -> None:
    """Write a film (.gif, .mp4) of one tooth pitch, which repeats itself, or of the whole record.

    Raises:
        InputError: the result has no motion, the file cannot be written, or there is no ffmpeg for an MP4.
    """
    encoder = shutil.which("ffmpeg")
    if path.suffix.lower() == ".mp4" and not encoder:
        raise InputError(f"{path} needs the program ffmpeg, which is not on the PATH; a .gif needs none.")
    motion = Motion.of(result)
    drawing = Drawing(motion, picture_parts(result.gear), contact_lines(motion), explode)
    camera = camera_of(view, motion.gear, explode)
    pictures = (_picture(drawing, camera, frame, SIZE, 1) for frame in film_frames(motion))
    with replacing(path) as partial:
        if encoder and path.suffix.lower() == ".mp4":
            _write_mp4(pictures, partial, encoder)
        else:
            frames = list(pictures)
            # All share the palette of one of them: others flicker
            palette = frames[len(frames) // 2].quantize(128, dither=Image.Dither.NONE)
            first, *more = [each.quantize(palette=palette, dither=Image.Dither.NONE) for each in frames]
            duration = round(1000 * SECONDS / len(frames))
            kept = {"append_images": more, "duration": duration, "loop": 0, "optimize": False}
            first.save(partial, "gif", save_all=True, **kept)


def still(
    motion: Motion,
    parts: Sequence[PicturePart],
    lines: ContactLines | None,
    size: Size,
    view: str = "gear",
    explode: float = 0.0,
) -> Image.Image:
    """The first instant as a picture, edges smoothed."""
    drawing = Drawing(motion, parts, lines, explode)
    return _picture(drawing, camera_of(view, motion.gear, explode), 0, size, 2, written=False)


def cutout(bodies: Sequence[Triangles], camera: Camera, size: Size) -> Image.Image:
    """Bodies with their outlines on a transparent ground."""
    width, height = (2 * each for each in size)
    image, depth = np.ones((height, width, 3)), np.full((height, width), np.inf)
    paint_over(image, camera, bodies, depth)
    seen = np.isfinite(depth)
    near = np.where(seen, depth, OUTLINE_GAP * camera.distance + depth[seen].max(initial=0.0))
    edge = np.zeros_like(seen)
    for axis in (0, 1):
        step = np.abs(np.diff(near, axis=axis)) > OUTLINE_GAP * camera.distance
        edge |= np.insert(step, 0, False, axis) | np.insert(step, step.shape[axis], False, axis)
    image[edge & seen] *= OUTLINE
    solid = np.concatenate([image * seen[..., None], seen[..., None]], axis=2)
    mean = solid.reshape(size[1], 2, size[0], 2, 4).mean(axis=(1, 3))
    mean[..., :3] /= np.maximum(mean[..., 3:], 1e-9)
    return Image.fromarray((255 * np.clip(mean, 0, 1)).astype(np.uint8), "RGBA")


def image_bytes(picture: Image.Image, kind: str) -> bytes:
    """The picture as the content of a file."""
    out = io.BytesIO()
    picture.save(out, kind, **({"quality": 82} if kind == "webp" else {"optimize": True}))
    return out.getvalue()


def film_frames(motion: Motion) -> np.ndarray:
    """Numbers of the instants that a film shows: the first tooth pitch, if the pinion turns steadily on."""
    angle = motion.signals["pinion_angle"]
    turned = np.abs(angle - angle[0])
    pitch = 2 * np.pi / motion.gear.pinion.teeth
    steady = bool((np.diff(turned) > 0).all()) and turned[-1] > pitch
    last = int(np.searchsorted(turned, pitch * (1 - 1e-6))) - 1 if steady else motion.frames - 1
    return np.unique(np.round(np.linspace(0, last, FILM_FRAMES)).astype(int))


def _picture(
    drawing: Drawing, camera: Camera, frame: int, size: Size, finer: int, written: bool = True
) -> Image.Image:
    """One instant; `finer` pixels each way are averaged to one."""
    width, height = size
    background = np.linspace(TOP, BOTTOM, height * finer)[:, None, :]
    image = np.ascontiguousarray(np.broadcast_to(background, (height * finer, width * finer, 3)))
    drawing.draw(image, camera, frame)
    whole = image.reshape(height, finer, width, finer, 3).mean(axis=(1, 3))
    picture = Image.fromarray((255 * np.clip(whole, 0, 1)).astype(np.uint8))
    if written:
        signals = drawing.motion.signals
        shown = [f"{name.replace('_', ' ')} {SIGNALS[name].show(float(signals[name][frame]))}"
                 for name in ("pinion_angle", "pinion_torque") if name in signals]  # fmt: skip
        ImageDraw.Draw(picture).text((12, height - 26), ", ".join(shown), INK, font_size=16)
    return picture


def _write_mp4(pictures: Iterator[Image.Image], path: Path, encoder: str) -> None:
    rate = FILM_FRAMES / SECONDS
    size = f"{SIZE[0]}x{SIZE[1]}"
    source = f"-f rawvideo -pix_fmt rgb24 -s {size} -r {rate:g} -i -".split()
    made = [*["-c:v", "libx264", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-y"], str(path)]
    content = b"".join(picture.tobytes() for picture in pictures)
    done = subprocess.run([encoder, "-loglevel", "error", *source, *made], input=content, capture_output=True)
    if done.returncode:
        problem = done.stderr.decode(errors="replace").strip().splitlines()
        raise InputError(f"ffmpeg cannot write {path.name}: {problem[-1] if problem else 'no reason given'}.")
