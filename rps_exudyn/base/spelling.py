"""How engineers write quantities, brought to one spelling: "0,5 Nm" -> "0.5 N*m", "12 μm" -> "12 µm"."""

import re

_LETTERS = str.maketrans({"μ": "µ", "−": "-", "\u00a0": " ", "\u202f": " ", "º": "°", "″": "''", "′": "'"})
_TORQUE = re.compile(r"(?<![^\W\d_])([kmM]?N)([cm]?m)(?![^\W\d_])")
_TURNS = re.compile(r"(?<![^\W\d_])(?:U|rev|r)\s*/\s*min(?![^\W\d_])")
_COMMA = re.compile(r"\s*[+-]?(\d+),(\d+)(?![\d.,])")


def respelled(text: str) -> str:
    """The quantity with a decimal point, and with units between which a sign stands.

    Raises:
        ValueError: a comma that may divide thousands.
    """
    text = _TURNS.sub("rpm", _TORQUE.sub(r"\1*\2", text.translate(_LETTERS)))
    found = _COMMA.match(text)
    if not found:
        return text
    if len(found[2]) == 3 and len(found[1]) <= 3 and found[1] != "0":
        either = f"{found[1]}.{found[2]} or {found[1]}{found[2]}"
        raise ValueError(f"a comma that may divide thousands: write {either}")
    return text.replace(",", ".", 1)
