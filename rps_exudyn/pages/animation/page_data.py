"""The data of a result on its page: bodies, motion, lines of contact, forces, curves."""

import base64
from collections.abc import Mapping
from typing import Any

import numpy as np

from rps_exudyn.base.units import pretty, words
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.pages.animation.camera import VIEWS, Camera, view
from rps_exudyn.pages.animation.motion import DISPLACEMENTS, TILTS, Factors, Motion, exploded
from rps_exudyn.pages.animation.overlays import ContactLines, arrows
from rps_exudyn.pages.animation.parts import COLOURS, PicturePart
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.tooth_contact.line_loads import STATIONS

CURVES = (
    *("pinion_torque", "rack_force", "rack_y", "rack_roll", "plunger_displacement", "mesh_normal_force"),
    *("mesh_pressure", "seat_force", "yokenut_force", "load_force"),
    *("mesh_normal_force_drive", "mesh_normal_force_coast"),
)
"""Signals that the page can draw, as far as the record has them; the first is drawn at once."""
MOVING = ("pinion_angle", "rack_displacement", *DISPLACEMENTS, *TILTS)
SECTIONED = ("plunger", "yokenut")  # the round bar stays round


def page_data(motion: Motion, parts: list[PicturePart], lines: ContactLines | None) -> dict[str, Any]:
    """Everything that the page's script reads."""
    pair, signals = GearPair.of(motion.gear), motion.signals
    most, steps = motion.largest_factors, np.diff(signals["pinion_angle"])
    half_way = Factors(*(float(np.round(np.sqrt(value))) for value in most))  # in decades
    choices = [Factors(), *([half_way] if max(most) > 10 else []), most]
    one_way = bool((steps > 0).all() or (steps < 0).all())
    return {
        "frames": motion.frames,
        "time": encoded(signals["time"], "float32") if "time" in signals else None,
        "over": "pinion_angle" if one_way else "time",
        "parts": [_part(part, motion) for part in parts],
        "motion": {name: encoded(signals[name], "float32") for name in MOVING},
        "means": {name: float(signals[name].mean()) for name in (*DISPLACEMENTS, *TILTS)},
        "frame": pair.pinion_frame.ravel().tolist(),
        "origin": pair.pinion_origin.tolist(),
        "axis": pair.bar_axis_height,
        "bushPlace": motion.gear.bush.distance + motion.gear.bush.length / 2,
        "factors": [list(each) for each in choices],
        "arrows": [
            vars(each)
            | {"point": each.point.tolist(), "direction": each.direction.tolist()}
            | {"unit": SIGNALS[each.signal].display}
            for each in arrows(motion)
        ],
        "torquePlace": [0.45 * motion.gear.pinion.shaft_length, 0.75 * motion.gear.pinion.shaft_diameter],
        "curves": _curves(signals),
        "lines": None if lines is None else _lines(lines, motion.frames),
        "views": {name: _view(view(name, motion.gear)) for name in VIEWS},
        "size": float(pair.tip_radius),
    }


def _view(camera: Camera) -> dict[str, Any]:
    return {
        "azimuth": camera.azimuth,
        "elevation": camera.elevation,
        "distance": float(camera.distance),
        "target": camera.target.tolist(),
        "shaftCut": float(camera.shaft_cut),
    }


def _part(part: PicturePart, motion: Motion) -> dict[str, Any]:
    wide = "uint16" if len(part.vertices) < 2**16 else "uint32"
    return {
        "name": part.name,
        "colour": COLOURS[part.name],
        "sectioned": part.name in SECTIONED,
        "away": exploded(motion.gear)[part.name].tolist(),
        "vertices": quantized(part.vertices, "int16"),
        "normals": encoded(np.round(127 * part.normals), "int8"),
        "faces": encoded(part.faces, wide),
    }


def _curves(signals: Mapping[str, np.ndarray]) -> list[dict[str, Any]]:
    return [
        {
            "name": words(name),
            "signal": name,
            "unit": pretty(SIGNALS[name].display),
            "values": encoded(SIGNALS[name].displayed(signals[name]), "float32"),
        }
        for name in CURVES
        if name in signals
    ]


def _lines(lines: ContactLines, frames: int) -> dict[str, Any]:
    begins = np.searchsorted(lines.frame, np.arange(frames + 1))
    return {
        "stations": STATIONS,
        "begins": encoded(begins, "uint16" if begins[-1] < 2**16 else "uint32"),
        "side": encoded(lines.side, "int8"),
        "ends": quantized(lines.ends, "int16"),
        "load": quantized(lines.load, "uint8"),
        "force": encoded(lines.force, "float32"),
    }


# --- Arrays of numbers as text for a page: fewest bytes that look the same, in base 64

Encoded = dict[str, Any]
_KINDS = {"int8": "i1", "uint8": "u1", "int16": "<i2", "uint16": "<u2", "uint32": "<u4", "float32": "<f4"}


def encoded(values: np.ndarray, kind: str) -> Encoded:
    """The array with its values rounded to a type that JavaScript has; "scale" gives them back."""
    return {"kind": kind, "scale": 1.0, "data": _text(np.asarray(values).astype(_KINDS[kind]))}


def quantized(values: np.ndarray, kind: str) -> Encoded:
    """The array as whole numbers that fill the type's range; times "scale" they are the values."""
    largest = float(np.abs(values).max(initial=0.0)) or 1.0
    scale = largest / np.iinfo(_KINDS[kind]).max
    whole = np.round(np.asarray(values) / scale).astype(_KINDS[kind])
    return {"kind": kind, "scale": scale, "data": _text(whole)}


def _text(array: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode("ascii")
