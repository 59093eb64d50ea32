"""Arrays of numbers as text for a page: fewest bytes that look the same, in base 64."""

import base64
from typing import Any

import numpy as np

Encoded = dict[str, Any]
_KINDS = {
    "int8": "i1",
    "uint8": "u1",
    "int16": "<i2",
    "uint16": "<u2",
    "uint32": "<u4",
    "float32": "<f4",
}


def encoded(values: np.ndarray, kind: str) -> Encoded:
    """The array with its values rounded to a type that JavaScript knows; "scale" gives them back."""
    return {"kind": kind, "scale": 1.0, "data": _text(np.asarray(values).astype(_KINDS[kind]))}


def quantized(values: np.ndarray, kind: str) -> Encoded:
    """The array as whole numbers that fill the type's range; times "scale" they are the values."""
    largest = float(np.abs(values).max(initial=0.0)) or 1.0
    scale = largest / np.iinfo(_KINDS[kind]).max
    whole = np.round(np.asarray(values) / scale).astype(_KINDS[kind])
    return {"kind": kind, "scale": scale, "data": _text(whole)}


def decoded(item: Encoded) -> np.ndarray:
    """The values of an encoded array, flat."""
    return item["scale"] * np.frombuffer(base64.b64decode(item["data"]), _KINDS[item["kind"]]).astype(float)


def _text(array: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode("ascii")
